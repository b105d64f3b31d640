//! Shape of the drive, which decides which directions are observable.
//!
//! It is derived from prism 1's track in its own station's frame, and from height differences between the prisms. Level stations
//! measure both without a calibration, so the shape does not depend on the answer. The track is divided into chords of at least
//! half a metre, so that standstill and noise have no influence. All criteria are shares and quantiles, so that a few outliers have
//! none.
//!
//! The answer is observable because the rig rotates. A straight line is one course, in one direction or both. An L is two courses
//! without others between. On one circle the rig rotates, but its rotation is a function of its position.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector2, Vector3};

use super::CentredTriplets;
use crate::network::Station;
use crate::statistics;
use crate::statistics::{central_sigma, median};

/// A drive with a smaller extent is standing (m).
const STANDING_M: f64 = 1.0;
/// Least length of a chord (m).
const SHORTEST_CHORD_M: f64 = 0.5;
/// A chord has the extent of the drive over this number, if it is longer than [`SHORTEST_CHORD_M`].
const CHORDS_ACROSS: f64 = 30.0;
/// Chords this many times longer than the median bridge a gap.
const GAP: f64 = 3.0;
/// Courses within this are the same (rad): the effect of steering and noise on a chord of a straight leg.
const SAME_COURSE_RAD: f64 = 5.0 * PI / 180.0;
/// Smallest share of the chords on the course of a straight line.
const STRAIGHT_SHARE: f64 = 0.95;
/// Smallest share of the chords on the two courses of an L; the rest is a short corner.
const TWO_LEGS_SHARE: f64 = 0.9;
/// Smallest share of the chords on each leg of an L.
const SHORTER_LEG_SHARE: f64 = 0.1;
/// Legs whose courses differ by less than this, or are this close to opposite, form no corner (rad).
const LEAST_CORNER_RAD: f64 = 15.0 * PI / 180.0;
/// Largest distance from a line or a leg, over its length.
const LINE_SHARE: f64 = 0.03;
/// Largest distance of nearly all chords from a circle, over its radius.
const CIRCLE_SHARE: f64 = 0.03;
/// Smallest net angle over the total angle driven, for one direction of rotation.
const ONE_WAY: f64 = 0.9;
/// A shorter arc is a bend (rad).
const LEAST_ARC_RAD: f64 = PI / 3.0;
/// Below this the rig does not pitch or roll (rad). With prisms that differ by 0.35 m in height it would move a mirrored prism by
/// 2 mm, the level of the noise. Simulated: flat floors have 0.0005, the gentle bumps of a tunnel 0.006.
const FLAT_TILT_RAD: f64 = 0.003;
/// Ground with a smaller range of heights is a floor (m).
const FLOOR_RELIEF_M: f64 = 0.05;

/// Shape of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveShape {
    pub plan: PlanView,
    /// Range of prism 1's heights without the outermost hundredths (m).
    pub relief_m: f64,
    /// One standard deviation of the rig's pitch and roll (rad).
    pub tilt_rad: f64,
}

/// The drive seen from above. Positions are in station 1's frame (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlanView {
    /// The vehicle does not move.
    Standing,
    /// One line, once or there and back; nearly all of the track is within `bends_m` of it.
    StraightLine { length_m: f64, bends_m: f64 },
    /// One circle, always in the same direction of rotation, or an arc of it.
    Circle { centre_m: Vector2<f64>, radius_m: f64, driven_rad: f64 },
    /// Two straight legs with a short corner.
    TwoLegs { corner_m: Vector2<f64>, turn_rad: f64 },
    /// Anything with bends, as a drive should have.
    Winding,
}

impl DriveShape {
    /// Returns the shape's name in files and scripts.
    pub fn name(&self) -> &'static str {
        match self.plan {
            PlanView::Standing => "standing",
            PlanView::StraightLine { .. } => "straight-line",
            PlanView::Circle { .. } => "circle",
            PlanView::TwoLegs { .. } => "l-shape",
            PlanView::Winding if self.is_flat() => "flat-floor",
            PlanView::Winding => "winding",
        }
    }

    /// Returns true if the rig never pitched or rolled, so that heights have a mirror twin.
    pub fn is_flat(&self) -> bool {
        self.tilt_rad < FLAT_TILT_RAD
    }

    /// Returns true if the ground is level; an even ramp is flat only in the sense of [`DriveShape::is_flat`].
    pub fn is_floor(&self) -> bool {
        self.relief_m < FLOOR_RELIEF_M
    }

    /// Classifies the drive. `data` may be thinned, but must be in order of time and have few outliers.
    pub fn of(data: &CentredTriplets) -> Self {
        let [_, _, first_m] = &data.coordinates[Station::FIRST];
        let heights_m = quantiles(first_m, [0.01, 0.99]);
        let tilt_rad = data.network.unknown_stations().filter_map(|station| {
            let distance_m = data.network.from_station1_m(station);
            let [_, _, other_m] = &data.coordinates[station];
            let apart = first_m.iter().zip(other_m).map(|(first, other)| first - other);
            (distance_m > 0.0).then(|| central_sigma(apart).unwrap_or(0.0) / distance_m)
        });
        Self {
            plan: plan(data),
            relief_m: heights_m[1] - heights_m[0],
            tilt_rad: tilt_rad.fold(0.0, f64::max),
        }
    }
}

fn plan(data: &CentredTriplets) -> PlanView {
    let Some(chords) = chords(&data.coordinates[Station::FIRST]) else { return PlanView::Standing };
    let centroid_m = data.centre_m[Station::FIRST].xy();
    straight_line(&chords)
        .or_else(|| two_legs(&chords, centroid_m))
        .or_else(|| circle(&chords, centroid_m))
        .unwrap_or(PlanView::Winding)
}

/// A chord of the track.
struct Chord {
    middle_m: Vector2<f64>,
    length_m: f64,
    /// Direction of travel, counter-clockwise from x.
    course_rad: f64,
}

/// Divides the track into chords; `None` if the vehicle does not move.
fn chords([x, y, _]: &[Vec<f64>; 3]) -> Option<Vec<Chord>> {
    let reach_m = [x, y]
        .map(|axis| {
            let [low, high] = quantiles(axis, [0.02, 0.98]);
            high - low
        })
        .into_iter()
        .fold(0.0, f64::max);
    if reach_m < STANDING_M {
        return None;
    }
    let step_m = (reach_m / CHORDS_ACROSS).max(SHORTEST_CHORD_M);
    let mut chords = Vec::new();
    let mut from = Vector2::new(x[0], y[0]);
    for (x, y) in x.iter().zip(y) {
        let to = Vector2::new(*x, *y);
        let way = to - from;
        if way.norm_squared() >= step_m * step_m {
            let (middle_m, course_rad) = (0.5 * (from + to), way.y.atan2(way.x));
            chords.push(Chord { middle_m, length_m: way.norm(), course_rad });
            from = to;
        }
    }
    let lengths = chords.iter().map(|chord| chord.length_m);
    let longest_m = GAP * median(lengths).unwrap_or(0.0);
    chords.retain(|chord| chord.length_m <= longest_m);
    (!chords.is_empty()).then_some(chords)
}

fn straight_line(chords: &[Chord]) -> Option<PlanView> {
    // A course and its opposite are equal when doubled.
    let doubled: Vec<f64> = chords.iter().map(|chord| 2.0 * chord.course_rad).collect();
    let (doubled_rad, share) = commonest(&doubled, 2.0 * SAME_COURSE_RAD)?;
    if share < STRAIGHT_SHARE {
        return None;
    }
    let (length_m, bends_m) = along_and_beside(chords.iter(), doubled_rad / 2.0);
    (bends_m < LINE_SHARE * length_m).then_some(PlanView::StraightLine { length_m, bends_m })
}

fn two_legs(chords: &[Chord], centroid_m: Vector2<f64>) -> Option<PlanView> {
    let courses: Vec<f64> = chords.iter().map(|chord| chord.course_rad).collect();
    let (first_rad, first_share) = commonest(&courses, SAME_COURSE_RAD)?;
    let others: Vec<f64> = courses
        .iter()
        .copied()
        .filter(|course| apart_rad(*course, first_rad) > SAME_COURSE_RAD)
        .collect();
    let (second_rad, of_others) = commonest(&others, SAME_COURSE_RAD)?;
    let second_share = of_others * others.len() as f64 / courses.len() as f64;
    let turn_rad = apart_rad(first_rad, second_rad);
    let enough = first_share + second_share >= TWO_LEGS_SHARE && second_share >= SHORTER_LEG_SHARE;
    if !enough || !(LEAST_CORNER_RAD..PI - LEAST_CORNER_RAD).contains(&turn_rad) {
        return None;
    }
    let leg = |course_rad: f64| {
        let of_leg = || {
            chords.iter().filter(move |c| apart_rad(c.course_rad, course_rad) <= SAME_COURSE_RAD)
        };
        let (length_m, bends_m) = along_and_beside(of_leg(), course_rad);
        let sum: Vector2<f64> = of_leg().map(|chord| chord.middle_m).sum();
        let on_it = sum / of_leg().count() as f64;
        // More than two legs with two courses, such as a staircase, form no L.
        (bends_m < LINE_SHARE * length_m).then_some(on_it)
    };
    let (first_m, second_m) = (leg(first_rad)?, leg(second_rad)?);
    let [along, other] =
        [first_rad, second_rad].map(|course| Vector2::new(course.cos(), course.sin()));
    let to_corner_m = (second_m - first_m).perp(&other) / along.perp(&other);
    let corner_m = centroid_m + first_m + to_corner_m * along;
    Some(PlanView::TwoLegs { corner_m, turn_rad })
}

fn circle(chords: &[Chord], centroid_m: Vector2<f64>) -> Option<PlanView> {
    let mut middles: Vec<Vector2<f64>> = chords.iter().map(|chord| chord.middle_m).collect();
    let mut fit = circle_through(&middles)?;
    for _ in 0..2 {
        // The worst tenth may be outliers.
        let (centre, radius) = fit;
        let beside = |p: &Vector2<f64>| ((p - centre).norm() - radius).abs();
        middles.sort_by(|a, b| beside(a).total_cmp(&beside(b)));
        fit = circle_through(&middles[..(9 * middles.len()).div_ceil(10)])?;
    }
    let (centre, radius_m) = fit;
    let on_it: Vec<&Chord> = chords
        .iter()
        .filter(|c| ((c.middle_m - centre).norm() - radius_m).abs() < CIRCLE_SHARE * radius_m)
        .collect();
    if (on_it.len() as f64) < STRAIGHT_SHARE * chords.len() as f64 {
        return None;
    }
    let driven_rad: f64 = on_it
        .iter()
        .map(|chord| {
            let (sin, cos) = chord.course_rad.sin_cos();
            let way = Vector2::new(cos, sin) * chord.length_m;
            (chord.middle_m - centre).perp(&way) / radius_m.powi(2)
        })
        .sum();
    let whole_rad = on_it.iter().map(|chord| chord.length_m).sum::<f64>() / radius_m;
    let one_way = driven_rad.abs() > ONE_WAY * whole_rad && driven_rad.abs() > LEAST_ARC_RAD;
    let centre_m = centroid_m + centre;
    one_way.then_some(PlanView::Circle { centre_m, radius_m, driven_rad: driven_rad.abs() })
}

/// Fits centre and radius by Kåsa's linear least squares: 2 c·p + (r² − c²) = p².
fn circle_through(points: &[Vector2<f64>]) -> Option<(Vector2<f64>, f64)> {
    let (mut matrix, mut right) = (Matrix3::zeros(), Vector3::zeros());
    for p in points {
        let row = Vector3::new(2.0 * p.x, 2.0 * p.y, 1.0);
        matrix += row * row.transpose();
        right += row * p.norm_squared();
    }
    let solution = matrix.cholesky()?.solve(&right);
    let centre = solution.xy();
    Some((centre, (solution.z + centre.norm_squared()).max(0.0).sqrt()))
}

/// Returns the mean of the largest group of angles within `tolerance_rad`, and its share of all; `None` of an empty list.
fn commonest(angles_rad: &[f64], tolerance_rad: f64) -> Option<(f64, f64)> {
    let count = (TAU / tolerance_rad).floor() as usize;
    let mut bins = vec![0_usize; count];
    for angle in angles_rad {
        bins[((angle.rem_euclid(TAU) / TAU * count as f64) as usize).min(count - 1)] += 1;
    }
    // Counts two neighbouring bins together, so that a course on their border is not split.
    let fullest = (0..count).max_by_key(|bin| bins[*bin] + bins[(bin + 1) % count])?;
    let mut middle_rad = (fullest + 1) as f64 / count as f64 * TAU;
    let near = |middle_rad: f64| {
        angles_rad.iter().filter(move |angle| apart_rad(**angle, middle_rad) <= tolerance_rad)
    };
    let sum: Vector2<f64> = near(middle_rad).map(|a| Vector2::new(a.cos(), a.sin())).sum();
    middle_rad = sum.y.atan2(sum.x);
    let share = near(middle_rad).count() as f64 / angles_rad.len().max(1) as f64;
    (share > 0.0).then_some((middle_rad, share))
}

fn apart_rad(a: f64, b: f64) -> f64 {
    crate::geometry::wrap_to_pi(a - b).abs()
}

/// Returns the extent of the chords' middles along a course, and half the width of nearly all across it (m).
fn along_and_beside<'a>(chords: impl Iterator<Item = &'a Chord>, course_rad: f64) -> (f64, f64) {
    let course = Vector2::new(course_rad.cos(), course_rad.sin());
    let (along, beside): (Vec<f64>, Vec<f64>) =
        chords.map(|c| (c.middle_m.dot(&course), course.perp(&c.middle_m))).unzip();
    let [start, end] = quantiles(&along, [0.01, 0.99]);
    let [right, left] = quantiles(&beside, [0.025, 0.975]);
    (end - start, 0.5 * (left - right))
}

/// Returns quantiles; zeros of an empty list.
fn quantiles<const N: usize>(values: &[f64], shares: [f64; N]) -> [f64; N] {
    statistics::quantiles(values.iter().copied(), shares).unwrap_or([0.0; N])
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::calibration::inter_prism::PrismNetwork;
    use crate::pipeline::Triplets;

    /// Shape of a drive of a level rig along segments of (length, curvature). It has a point every decimetre, with a millimetre of
    /// noise, and every hundredth point is off by metres.
    fn driven(pieces: &[(f64, f64)]) -> DriveShape {
        let (mut x, mut y, mut course) = (30.0, -10.0, 0.4_f64);
        let mut points = Vec::new();
        for (length_m, curvature_per_m) in pieces {
            for _ in 0..(length_m / 0.1) as usize {
                let noise = |k: f64| 0.001 * ((points.len() as f64 * 12.9898 + k) * 78.233).sin();
                let off = if points.len() % 100 == 50 { 5.0 } else { 0.0 };
                let error = Vector3::new(noise(1.0) + off, noise(2.0) - off, noise(3.0));
                points.push(Vector3::new(x, y, -1.6) + error);
                x += 0.1 * course.cos();
                y += 0.1 * course.sin();
                course += 0.1 * curvature_per_m;
            }
        }
        let count = points.len();
        let triplets = Triplets::new(
            vec![0.0; count],
            vec![0; count],
            [points.clone(), points.clone(), points],
        );
        let network = PrismNetwork::of_own_prisms([1.0; 3]);
        DriveShape::of(&CentredTriplets::new(&triplets, &network))
    }

    /// Segment of a tight turn by an angle (rad): sixteen points.
    fn turn(by_rad: f64) -> (f64, f64) {
        (1.6, by_rad / 1.6)
    }

    #[test]
    fn a_corner_is_found_where_it_is() {
        let plan = driven(&[(30.0, 0.0), turn(FRAC_PI_2), (20.0, 0.0)]).plan;
        let PlanView::TwoLegs { corner_m, turn_rad } = plan else { panic!("{plan:?}") };
        let to_corner_m = 30.0 + 1.6 / FRAC_PI_2;
        let expected =
            Vector2::new(30.0, -10.0) + to_corner_m * Vector2::new(0.4_f64.cos(), 0.4_f64.sin());
        assert!((corner_m - expected).norm() < 0.1, "{corner_m} {expected}");
        assert!((turn_rad - FRAC_PI_2).abs() < 0.02, "{turn_rad}");
    }

    #[test]
    fn an_arc_is_a_circle_and_its_size_is_known() {
        let plan = driven(&[(60.0, 1.0 / 30.0)]).plan;
        let PlanView::Circle { radius_m, driven_rad, .. } = plan else { panic!("{plan:?}") };
        assert!((radius_m - 30.0).abs() < 0.1, "{radius_m}");
        // Chords that outliers remove are missing in the driven angle.
        assert!((1.5..2.05).contains(&driven_rad), "{driven_rad}");
    }

    #[test]
    fn drives_with_more_than_one_bend_are_none_of_these() {
        let straight = (20.0, 0.0);
        for (what, pieces) in [
            ("an S", &[(20.0, 0.1), (20.0, -0.1)][..]),
            ("a square", &[straight, turn(FRAC_PI_2)].repeat(4)),
            ("lanes", &[straight, turn(PI), straight, turn(-PI)].repeat(4)),
            ("a staircase", &[straight, turn(FRAC_PI_2), straight, turn(-FRAC_PI_2)].repeat(3)),
            ("a circle both ways", &[(60.0, 0.1), turn(PI), (60.0, -0.1)]),
            ("a line with one bend", &[(30.0, 0.0), (15.0, 0.1), (30.0, 0.0)]),
        ] {
            assert_eq!(driven(pieces).plan, PlanView::Winding, "{what}");
        }
    }

    #[test]
    fn there_and_back_is_one_line_and_a_trembling_stand_is_none() {
        let plan = driven(&[(40.0, 0.0), turn(PI), (40.0, 0.0)]).plan;
        assert!(matches!(plan, PlanView::StraightLine { .. }), "{plan:?}");
        assert_eq!(driven(&[(0.8, 0.0)]).plan, PlanView::Standing);
        assert_eq!(driven(&[]).plan, PlanView::Standing);
    }
}
