//! A long and narrow place, as a drive shows it: the lateral room of a tunnel or a corridor.
//!
//! A drive shows where a vehicle fits, never where it does not. So a place counts as narrow only after much evidence: within
//! [`WINDOW_M`] of the vehicle the drive extends over at least [`LONG_M`], and across over less than [`NARROW`] of that. The
//! same shape on an open field restricts advice too, at little cost: turns on the spot determine as much as wide bends.

use nalgebra::{Rotation2, Vector2};

/// Distance from the vehicle within which the shape of the drive is evaluated (m).
const WINDOW_M: f64 = 30.0;
/// Shortest extent of a long drive (m): clearly more than the opening's 15 m, which every drive begins with.
const LONG_M: f64 = 25.0;
/// Largest width of a narrow drive, relative to its length. Figure-eights and loops of an open field exceed it.
const NARROW: f64 = 0.25;
/// Distance from the vehicle within which the width is taken (m); shorter, because tunnels bend.
const NEAR_M: f64 = 15.0;
/// Room beside the positions driven so far (m): no driver holds a line better, and no passage is narrower than that.
const MARGIN_M: f64 = 0.5;
/// Spacing of positions at which a manoeuvre is tested, and of those of the drive (m).
const SPACING_M: f64 = 0.5;
/// Largest angle to the axis at which a direction counts as along it (rad).
const ALONG_RAD: f64 = std::f64::consts::FRAC_PI_8;

/// The lateral room of a narrow place.
#[derive(Clone, Debug)]
pub struct Corridor {
    here_m: Vector2<f64>,
    axis: Vector2<f64>,
    across: Vector2<f64>,
    /// Lateral positions between which there is room, from the vehicle (m): right negative, left positive.
    bounds_m: [f64; 2],
    driven_m: Vec<Vector2<f64>>,
}

impl Corridor {
    /// Returns the room at a position of a drive; `None` if the drive is short or wide there.
    pub fn shown(positions_m: &[Vector2<f64>], here_m: &Vector2<f64>) -> Option<Self> {
        let driven_m = spaced(positions_m);
        let within = |reach_m: f64| -> Vec<Vector2<f64>> {
            driven_m.iter().filter(|at| (*at - here_m).norm() <= reach_m).copied().collect()
        };
        let window = Strip::around(&within(WINDOW_M))?;
        if window.along_m < LONG_M || window.relative_width() > NARROW {
            return None;
        }
        // In a bend the nearer part has the direction; elsewhere the longer one has it more precisely.
        let near = Strip::around(&within(NEAR_M))?;
        let is_bend = near.relative_width() < window.relative_width();
        let axis = if is_bend { near.axis } else { window.axis };
        let across = left_of(&axis);
        let [right_m, left_m] = extent_m(&within(NEAR_M), &across);
        let own_m = across.dot(here_m);
        let bounds_m = [right_m - MARGIN_M - own_m, left_m + MARGIN_M - own_m];
        Some(Self { here_m: *here_m, axis, across, bounds_m, driven_m })
    }

    /// Returns the room to the right and to the left of the vehicle as seen along a direction (m).
    pub fn sides_m(&self, along: &Vector2<f64>) -> [f64; 2] {
        let [right_m, left_m] = [-self.bounds_m[0], self.bounds_m[1]];
        if along.dot(&self.axis) < 0.0 { [left_m, right_m] } else { [right_m, left_m] }
    }

    /// Returns a direction, turned into the axis if it is nearly along it.
    pub fn aligned(&self, along: &Vector2<f64>) -> Vector2<f64> {
        let cosine = along.dot(&self.axis);
        if cosine.abs() > ALONG_RAD.cos() { self.axis * cosine.signum() } else { *along }
    }

    /// Returns true if a path stays within the room. Further away than the evaluated window it must be where the drive was.
    pub fn fits(&self, way_m: &[Vector2<f64>]) -> bool {
        way_m.windows(2).all(|leg| {
            let leg_m = leg[1] - leg[0];
            let steps = (leg_m.norm() / SPACING_M).ceil().max(1.0) as u32;
            (0..=steps)
                .all(|step| self.has_room(&(leg[0] + leg_m * (f64::from(step) / f64::from(steps)))))
        })
    }

    fn has_room(&self, place_m: &Vector2<f64>) -> bool {
        let from_here_m = place_m - self.here_m;
        let aside_m = self.across.dot(&from_here_m);
        let is_in_strip = (self.bounds_m[0]..=self.bounds_m[1]).contains(&aside_m);
        let is_driven = || {
            let mut driven_m = self.driven_m.iter();
            driven_m.any(|at| (at - place_m).norm() <= MARGIN_M)
        };
        (is_in_strip && from_here_m.norm() <= WINDOW_M) || is_driven()
    }
}

/// Extent of some positions along their principal axis and across (m).
struct Strip {
    axis: Vector2<f64>,
    along_m: f64,
    across_m: f64,
}

impl Strip {
    fn around(positions_m: &[Vector2<f64>]) -> Option<Self> {
        let axis = principal_axis(positions_m)?;
        let [along_m, across_m] = [axis, left_of(&axis)].map(|direction| {
            let [least_m, most_m] = extent_m(positions_m, &direction);
            most_m - least_m
        });
        Some(Self { axis, along_m, across_m })
    }

    fn relative_width(&self) -> f64 {
        self.across_m / self.along_m
    }
}

/// Thins positions to a spacing.
fn spaced(positions_m: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
    let mut spaced: Vec<Vector2<f64>> = Vec::new();
    for at in positions_m {
        if spaced.last().is_none_or(|last| (at - last).norm() >= SPACING_M) {
            spaced.push(*at);
        }
    }
    spaced
}

fn left_of(direction: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-direction.y, direction.x)
}

/// Direction of the largest variance; `None` without positions.
fn principal_axis(positions_m: &[Vector2<f64>]) -> Option<Vector2<f64>> {
    let count = positions_m.len() as f64;
    let mean_m = (count > 0.0).then(|| positions_m.iter().sum::<Vector2<f64>>() / count)?;
    let (mut difference, mut product) = (0.0, 0.0);
    for at in positions_m.iter().map(|at| at - mean_m) {
        difference += at.x * at.x - at.y * at.y;
        product += 2.0 * at.x * at.y;
    }
    Some(Rotation2::new(0.5 * product.atan2(difference)) * Vector2::x())
}

/// Smallest and largest coordinate along a direction (m).
fn extent_m(positions_m: &[Vector2<f64>], direction: &Vector2<f64>) -> [f64; 2] {
    let along_m = positions_m.iter().map(|at| at.dot(direction));
    along_m.fold([f64::INFINITY, f64::NEG_INFINITY], |[least_m, most_m], m| {
        [least_m.min(m), most_m.max(m)]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive there and back, 1 m to each side of a line or of an arc of a radius (m).
    fn there_and_back(length_m: f64, radius_m: f64) -> Vec<Vector2<f64>> {
        let steps = (length_m / 0.2) as usize;
        let at = |step: usize, side: f64| {
            let angle = step as f64 * 0.2 / radius_m;
            Vector2::new(angle.sin(), 1.0 - angle.cos()) * radius_m
                + Vector2::new(-angle.sin(), angle.cos()) * side
        };
        let there = (0..=steps).map(|step| at(step, -1.0));
        there.chain((0..=steps).rev().map(|step| at(step, 1.0))).collect()
    }

    #[test]
    fn a_drive_that_began_or_is_wide_shows_no_corridor() {
        let here_m = Vector2::new(0.0, 1.0);
        for length_m in [10.0, 15.0, 24.0] {
            assert!(Corridor::shown(&there_and_back(length_m, 1e6), &here_m).is_none());
        }
        let circle = (0..500).map(|k| Rotation2::new(f64::from(k) * 0.02) * Vector2::x() * 20.0);
        let circle: Vec<Vector2<f64>> = circle.collect();
        assert!(Corridor::shown(&circle, &circle[499]).is_none());
        assert!(Corridor::shown(&[], &here_m).is_none());
        assert!(Corridor::shown(&[here_m; 40], &here_m).is_none());
    }

    #[test]
    fn a_corridor_has_the_width_that_was_driven_and_a_margin() {
        for radius_m in [1e6, -80.0, 80.0] {
            let driven_m = there_and_back(60.0, radius_m);
            for here_m in [driven_m[driven_m.len() - 1], driven_m[driven_m.len() / 4]] {
                let corridor = Corridor::shown(&driven_m, &here_m).expect("long and narrow");
                let [right_m, left_m] = corridor.bounds_m;
                let width_m = left_m - right_m;
                // The bend itself adds up to 15² / (2 · 80) m.
                assert!((2.9..4.5).contains(&width_m), "{width_m} at {radius_m}");
                let there_m = &driven_m[..driven_m.len() / 2];
                assert!(corridor.fits(there_m), "the drive itself at {radius_m}");
                let ahead = corridor.aligned(&(Rotation2::new(0.2) * corridor.axis));
                assert_eq!(ahead, corridor.axis);
                let aside_m = here_m + corridor.across * (left_m + 0.1);
                assert!(!corridor.fits(&[here_m, aside_m]), "{left_m} at {radius_m}");
            }
        }
    }

    #[test]
    fn sides_are_those_of_the_direction() {
        let driven_m = there_and_back(60.0, 1e6);
        let here_m = Vector2::new(30.0, 1.0);
        let corridor = Corridor::shown(&driven_m, &here_m).expect("long and narrow");
        let near = |sides_m: [f64; 2], expected_m: [f64; 2]| {
            let off = sides_m.iter().zip(expected_m).map(|(a, b)| (a - b).abs());
            assert!(off.fold(0.0, f64::max) < 1e-2, "{sides_m:?}");
        };
        near(corridor.sides_m(&Vector2::x()), [2.5, 0.5]);
        near(corridor.sides_m(&-Vector2::x()), [0.5, 2.5]);
    }
}
