//! Properties of the rig and the control points by an answer, and their comparison with known values.

use nalgebra::Vector3;

use crate::calibration::TransformSigma;
use crate::calibration::checks::{POOR_FIT_M, WEAK_SIGMA_M};
use crate::calibration::misfits::{compared_stations, control_points_apart_m, placed_m, prisms_m};
use crate::deployment::{ControlPointSet, Rig, pairwise_distances};
use crate::geometry::RigidTransform;
use crate::network::{Number, Pair, PerPrism, PerStation, Prism, Station};
use crate::pipeline::Triplets;
use crate::statistics::{central_sigma, median};

/// A triangle of prisms with a smaller height than this, seen from above (m), has no significant orientation. The same is true if
/// a tilt by [`SHEAR_RAD`] can reverse it.
const THIN_M: f64 = 0.010;
/// Tilt of the rig that must not reverse the orientation of its prisms.
const SHEAR_RAD: f64 = 0.1;
/// Error of a height by noise and by the accuracy of a reading of the rig (m).
const HEIGHT_NOISE_M: f64 = 0.005;
/// Slope of the ground when the heights of the rig were read.
const SLOPE_RAD: f64 = 0.05;
/// Number of σ of pitch and roll during the drive that is allowed beside the slope.
const CONTRADICTION_TILTS: f64 = 4.0;
/// Upper limit of slope and tilts together.
const STEEPEST_RAD: f64 = 0.2;
/// From this number of σ on, heights are suspicious, and another explanation is searched.
const SUSPICION_TILTS: f64 = 2.0;
/// Errors of heights are allowed up to this many σ of the answer.
const HEIGHT_SIGMAS: f64 = 3.0;
/// Smallest disagreement of control points that a misreading causes (m); stations are metres apart.
const CONTROL_POINTS_M: f64 = 0.25;

/// Properties of an answer that independent data can contradict.
#[derive(Clone, Debug, PartialEq)]
pub struct Shown {
    /// Median absolute error of the inter-prism distances (m).
    pub fit_m: f64,
    /// Area of the triangle of prisms 1, 2, 3 seen from above (m²), positive if they are counter-clockwise; median over the drive. `None`
    /// with fewer prisms.
    pub area_m2: Option<f64>,
    /// Heights of prism 1 above prisms 2, 3, … (m), medians over the drive.
    pub heights_m: Vec<f64>,
    /// One standard deviation of the rig's pitch and roll (rad).
    pub tilt_rad: f64,
    /// Distance between two stations' positions of a control point (m, median over all sets).
    pub control_points_m: Option<f64>,
}

impl Shown {
    /// Returns the properties of an answer; `None` without triplets.
    pub fn of(
        (rig, followed): (&Rig, &PerStation<Prism>),
        control_points: &[ControlPointSet],
        triplets: &Triplets,
        station1_from_station: &PerStation<RigidTransform>,
    ) -> Option<Self> {
        let count = triplets.len();
        let mut errors_m = Vec::with_capacity(rig.inter_prism_m.len() * count);
        let mut areas_m2 = Vec::with_capacity(count);
        let others = Prism::count(followed) - 1;
        let mut heights_m = vec![Vec::with_capacity(count); others];
        for index in 0..count {
            let placed = prisms_m(&placed_m(triplets, station1_from_station, index), followed);
            let distances_m = pairwise_distances(placed.as_slice());
            errors_m.extend(
                distances_m
                    .iter()
                    .zip(&rig.inter_prism_m)
                    .map(|(own_m, known_m)| (own_m - known_m).abs()),
            );
            areas_m2.extend(plan_area_m2(&placed));
            for (heights_m, other) in heights_m.iter_mut().zip(1..) {
                heights_m.push(placed[0].z - placed[other].z);
            }
        }
        let tilt_rad = |(other, heights_m): (usize, &Vec<f64>)| {
            let sigma_m = central_sigma(heights_m.iter().copied())?;
            Some(sigma_m / from_first_m(rig, other)?)
        };
        let tilts_rad: Option<Vec<f64>> = heights_m.iter().enumerate().map(tilt_rad).collect();
        let medians_m = heights_m.iter().map(|heights_m| median(heights_m.iter().copied()));
        Some(Self {
            fit_m: median(errors_m)?,
            area_m2: median(areas_m2),
            heights_m: medians_m.collect::<Option<_>>()?,
            tilt_rad: tilts_rad?.into_iter().fold(0.0, f64::max),
            control_points_m: control_points_apart_m(control_points, station1_from_station),
        })
    }
}

/// Returns the signed area of the triangle of the first three prisms seen from above (m²), positive if they are counter-clockwise; `None`
/// with fewer prisms.
pub fn plan_area_m2(prisms_m: &PerPrism<Vector3<f64>>) -> Option<f64> {
    let [a, b, c] = prisms_m.as_slice().first_chunk::<3>()?.map(|corner| corner.xy());
    Some(0.5 * (b - a).perp(&(c - a)))
}

/// Returns the distance of prism 1 from prism 2, 3, … (m).
fn from_first_m(rig: &Rig, other: usize) -> Option<f64> {
    let pair = Pair::between(Prism::default(), Prism::at(other + 1))?;
    rig.inter_prism_m.get(pair).copied()
}

/// Agreement of an answer with independent data.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Agreement {
    Agrees,
    /// Unlikely, but possible.
    Suspicious,
    Contradicts,
}

/// Known properties of the rig, with which answers are compared.
#[derive(Clone, Debug)]
pub struct Witnesses<'a> {
    rig: &'a Rig,
    /// σ of the heights of the stations that follow prisms 2, 3, … (m).
    height_sigma_m: Vec<f64>,
}

impl<'a> Witnesses<'a> {
    /// Creates the comparison; `sigma` is the σ of the answer, if it has one.
    pub fn new(
        (rig, followed): (&'a Rig, &PerStation<Prism>),
        sigma: Option<&PerStation<TransformSigma>>,
    ) -> Self {
        // A larger σ makes an answer weak by itself, and the misreading may be its cause.
        let capped_m = |s: &TransformSigma| s.translation_m.z.min(WEAK_SIGMA_M);
        let stations = compared_stations(followed).into_iter().skip(1);
        let of_station = |station: Station| sigma.map_or(0.0, |all| capped_m(&all[station]));
        Self { rig, height_sigma_m: stations.map(of_station).collect() }
    }

    /// Compares the orientation of the prisms with the reading of the rig or, without one, with the prisms in the vehicle's frame.
    /// `None` if a triangle is too thin, or if neither is known.
    pub fn area(&self, shown: &Shown) -> Option<Agreement> {
        let (known_m2, area_m2) = (self.area_m2()?, shown.area_m2?);
        let prisms_m = self.layout_m()?.as_slice().first_chunk::<3>()?;
        let longest_m =
            pairwise_distances(&prisms_m.map(|prism| Vector3::new(prism.x, prism.y, 0.0)));
        let longest_m = longest_m.into_iter().fold(f64::MIN_POSITIVE, f64::max);
        let heights_m = prisms_m.map(|prism| prism.z);
        let high_m = heights_m.into_iter().fold(f64::NEG_INFINITY, f64::max)
            - heights_m.into_iter().fold(f64::INFINITY, f64::min);
        let thin_m = THIN_M + SHEAR_RAD * high_m;
        let tells = |area_m2: f64| 2.0 * area_m2.abs() / longest_m > thin_m;
        if !tells(known_m2) || !tells(area_m2) {
            return None;
        }
        let same = known_m2.signum() == area_m2.signum();
        Some(if same { Agreement::Agrees } else { Agreement::Contradicts })
    }

    /// Returns the known area of the prisms' triangle (m²).
    pub fn area_m2(&self) -> Option<f64> {
        self.layout_m().and_then(plan_area_m2)
    }

    fn layout_m(&self) -> Option<&PerPrism<Vector3<f64>>> {
        self.rig.prisms_m.as_ref().or(self.rig.in_vehicle_m.as_ref())
    }

    /// Compares the heights of the prisms with the reading of the rig. The limit is proportional to the size of the rig, and to the
    /// vehicle's pitch and roll during the drive.
    pub fn heights(&self, shown: &Shown) -> Option<Agreement> {
        let off_m = self.heights_off_m(shown)?;
        let limit_m = |at: usize, tilt_rad: f64| {
            HEIGHT_NOISE_M
                + HEIGHT_SIGMAS * self.height_sigma_m[at]
                + tilt_rad * from_first_m(self.rig, at).unwrap_or(0.0)
        };
        let beyond =
            |tilt_rad: f64| off_m.iter().enumerate().any(|(at, m)| *m > limit_m(at, tilt_rad));
        let steep_rad = (SLOPE_RAD + CONTRADICTION_TILTS * shown.tilt_rad).min(STEEPEST_RAD);
        Some(if beyond(steep_rad) {
            Agreement::Contradicts
        } else if beyond((SUSPICION_TILTS * shown.tilt_rad).min(steep_rad)) {
            Agreement::Suspicious
        } else {
            Agreement::Agrees
        })
    }

    /// Returns the heights of prism 1 above prisms 2, 3, … in the reading (m).
    pub fn heights_m(&self) -> Option<Vec<f64>> {
        self.rig.height_differences_m()
    }

    /// Returns the absolute differences of the heights of prism 1 above prisms 2, 3, … from the reading (m).
    pub fn heights_off_m(&self, shown: &Shown) -> Option<Vec<f64>> {
        let known_m = self.heights_m()?;
        let both = shown.heights_m.iter().zip(&known_m);
        Some(both.map(|(own_m, known_m)| (own_m - known_m).abs()).collect())
    }

    /// Compares the inter-prism distances.
    pub fn distances(shown: &Shown) -> Agreement {
        if shown.fit_m > POOR_FIT_M { Agreement::Contradicts } else { Agreement::Agrees }
    }

    /// Compares the control points. Differences smaller than those of a misreading are not judged here.
    pub fn control_points(shown: &Shown) -> Option<Agreement> {
        let far = |apart_m: f64| apart_m > CONTROL_POINTS_M;
        shown
            .control_points_m
            .map(|apart_m| if far(apart_m) { Agreement::Contradicts } else { Agreement::Agrees })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rig(prisms_m: [Vector3<f64>; 3]) -> Rig {
        let inter_prism_m = pairwise_distances(&prisms_m);
        let prisms_m = Some(prisms_m.into());
        Rig { inter_prism_m, prisms_m, in_vehicle_m: None, inter_antenna_m: None }
    }

    fn compare<'a>(rig: &'a Rig, sigma: Option<&PerStation<TransformSigma>>) -> Witnesses<'a> {
        Witnesses::new((rig, &[0, 1, 2].map(Prism::at).into()), sigma)
    }

    fn shown(area_m2: f64, heights_m: [f64; 2], tilt_rad: f64) -> Shown {
        let (area_m2, heights_m) = (Some(area_m2), heights_m.to_vec());
        Shown { fit_m: 0.001, area_m2, heights_m, tilt_rad, control_points_m: None }
    }

    #[test]
    fn a_triangle_has_a_way_round_unless_it_is_nearly_a_line() {
        let round = rig([Vector3::zeros(), Vector3::x(), Vector3::y()]);
        let witnesses = compare(&round, None);
        let area = |area_m2| witnesses.area(&shown(area_m2, [0.0; 2], 0.0));
        assert_eq!(area(0.48), Some(Agreement::Agrees));
        assert_eq!(area(-0.48), Some(Agreement::Contradicts));
        assert_eq!(area(-0.002), None, "too thin to tell");
        let line = rig([Vector3::zeros(), Vector3::x(), Vector3::new(2.0, 0.01, 0.3)]);
        let line = compare(&line, None);
        assert_eq!(line.area(&shown(-0.1, [0.0; 2], 0.0)), None);
    }

    #[test]
    fn heights_are_judged_by_the_rig_and_by_what_the_vehicle_tilts() {
        let small = rig([Vector3::zeros(), 0.35 * Vector3::x(), 0.35 * Vector3::y()]);
        let witnesses = compare(&small, None);
        let heights = |off_m, tilt| witnesses.heights(&shown(0.06, [off_m, 0.0], tilt));
        assert_eq!(heights(0.004, 0.0), Some(Agreement::Agrees));
        assert_eq!(heights(0.015, 0.002), Some(Agreement::Suspicious));
        // 0.2 rad of this rig would be 70 mm.
        assert_eq!(heights(0.05, 0.002), Some(Agreement::Contradicts));
        assert_eq!(heights(0.05, 0.1), Some(Agreement::Agrees), "a rig that tilts a lot");
        let unsure = TransformSigma { translation_m: Vector3::repeat(0.02), yaw_rad: 0.0 };
        let unsure = compare(&small, Some(&[TransformSigma::ZERO, unsure, unsure].into()))
            .heights(&shown(0.06, [0.05, 0.0], 0.0));
        assert_eq!(unsure, Some(Agreement::Agrees), "an answer that is no better than that");
    }
}
