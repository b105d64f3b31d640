//! The prisms on the vehicle by an estimate, and its poses by their motion.

use nalgebra::Vector3;

use super::no_trajectory::NoTrajectory;
use super::rig_layout::{VehicleFrame, prisms_in_vehicle, span_a_plane};
use super::rig_motion::{align_upright, rig_pose};
use super::trajectory::Pose;
use super::usual_tilt::{ExpectedTilt, UsualTilt};
use crate::calibration::Estimate;
use crate::calibration::joint::prism_motion::{MotionInstant, PrismsAtInstant, Solution};
use crate::calibration::joint::{JointEstimate, RIG_FLEX_SIGMA_M};
use crate::deployment::{Deployment, Rig};
use crate::geometry::{RigidTransform, align_rigid, align_weighted};
use crate::network::{Number, Pair, PerPair, PerPrism};
use crate::progress::Progress;

/// Usual jerk of a vehicle, by which a prism without readings departs from its spline (m/s³).
const USUAL_M_PER_S3: f64 = 0.5;
/// Time between the instants from which the usual tilt is taken (s).
const TILT_STEP_S: f64 = 1.0;

/// The prisms on the vehicle.
pub struct VehicleRig {
    /// In the vehicle's frame, with the estimated distances (m).
    pub prisms_m: PerPrism<Vector3<f64>>,
    pub frame: VehicleFrame,
    /// σ of each prism along any axis (m).
    pub sigma_m: f64,
}

impl VehicleRig {
    /// Returns the motion at those of some increasing times that have one (s), with the pose where the prisms determine it; `None` if the
    /// calculation is cancelled.
    pub fn poses(
        &self,
        solution: &Solution,
        times_s: &[f64],
    ) -> Option<Vec<(MotionInstant, Option<Pose>)>> {
        let pose = |at: &MotionInstant, expected: Option<&ExpectedTilt>| {
            rig_pose(self.prisms_m.as_slice(), self.sigma_m, at, expected)
        };
        let instants = |times_s: &[f64]| solution.instants(times_s, &Progress::default()).ok();
        let wanted = instants(times_s)?;
        let is_complete = |at: &MotionInstant| at.prisms.len() == self.prisms_m.len();
        let with_all_prisms: Vec<Pose> = if wanted.iter().all(is_complete) {
            Vec::new()
        } else {
            let all = instants(&tilt_times_s(solution))?;
            all.iter().filter_map(|at| pose(at, None)).collect()
        };
        let tilt = UsualTilt::new(&with_all_prisms);
        let with_pose = |at: MotionInstant| {
            let expected = tilt.as_ref().map(|tilt| tilt.at(at.time_s));
            let pose = pose(&at, expected.as_ref());
            (at, pose)
        };
        Some(wanted.into_iter().map(with_pose).collect())
    }

    /// Returns the pose at an instant (s) without a covariance.
    pub fn at(&self, solution: &Solution, time_s: f64) -> Option<RigidTransform> {
        let PrismsAtInstant { places, position_m, to_reading_s } = solution.prisms_at(time_s)?;
        let rig_m: Vec<Vector3<f64>> = places.iter().map(|place| self.prisms_m[*place]).collect();
        let weights = to_reading_s.iter().map(|to_reading_s| {
            let sigma_m = self.sigma_m + USUAL_M_PER_S3 * to_reading_s.powi(3) / 6.0;
            sigma_m.powi(-2)
        });
        let weights: Vec<f64> = weights.collect();
        if let Some(aligned) = align_weighted(&position_m, &rig_m, &weights) {
            return Some(aligned);
        }
        // Upwards as at the ends of the spans beside it that have all prisms.
        let spans_s = solution.spans_of_all_prisms_s();
        let next = spans_s.partition_point(|[_, end_s]| *end_s < time_s);
        let before_s = next.checked_sub(1).map(|last| spans_s[last][1]);
        let beside_s = before_s.into_iter().chain(spans_s.get(next).map(|[start_s, _]| *start_s));
        let up = beside_s.filter_map(|beside_s| {
            let beside = solution.prisms_at(beside_s)?;
            let aligned = align_rigid(&beside.position_m, self.prisms_m.as_slice())?;
            let near = 1.0 / (beside_s - time_s).abs().max(1e-3);
            Some(aligned.rotation.inverse() * Vector3::z() * near)
        });
        let up = up.sum::<Vector3<f64>>().try_normalize(0.0)?;
        align_upright(&position_m, &rig_m, &up)
    }
}

/// Instants from which the usual tilt is taken (s): one a second where all prisms are followed, and the last ones before gaps.
fn tilt_times_s(solution: &Solution) -> Vec<f64> {
    let spans_s = solution.spans_of_all_prisms_s();
    let of_span = |[start_s, end_s]: [f64; 2]| {
        let steps = ((end_s - start_s) / TILT_STEP_S) as usize;
        let within = (0..=steps).map(move |step| start_s + TILT_STEP_S * step as f64);
        within.chain(std::iter::once(end_s))
    };
    spans_s.into_iter().flat_map(of_span).collect()
}

/// Returns the followed prisms on the vehicle by an estimate.
pub fn rig_by(
    deployment: &Deployment,
    joint: &JointEstimate,
    distances_m: &PerPair<Estimate>,
) -> Result<VehicleRig, NoTrajectory> {
    let inter_prism_m = distances_m.map(|distance| distance.value);
    let followed = |all: &PerPrism<Vector3<f64>>| -> Option<PerPrism<Vector3<f64>>> {
        let prisms = joint.layout().followed_prisms();
        prisms.map(|prism| all.as_slice().get(prism.index()).copied()).collect()
    };
    let shaped = |rig: &Rig| Rig {
        inter_prism_m: inter_prism_m.clone(),
        prisms_m: rig.prisms_m.as_ref().and_then(followed),
        in_vehicle_m: rig.in_vehicle_m.as_ref().and_then(followed),
        inter_antenna_m: rig.inter_antenna_m,
    };
    let (prisms_m, frame) = rig_of(deployment, &shaped)?;
    let sigma_m = match frame {
        // Two prisms share the error of their distance.
        VehicleFrame::Given => joint.sizes.inter_prism_m * std::f64::consts::FRAC_1_SQRT_2,
        VehicleFrame::Reading | VehicleFrame::Triangle => RIG_FLEX_SIGMA_M,
    };
    Ok(VehicleRig { prisms_m, frame, sigma_m })
}

/// Returns the prisms of a deployment's rig on the vehicle, in a changed shape, and the frame.
pub fn rig_of(
    deployment: &Deployment,
    shaped: &dyn Fn(&Rig) -> Rig,
) -> Result<(PerPrism<Vector3<f64>>, VehicleFrame), NoTrajectory> {
    let name = || deployment.name.clone();
    let rig = shaped(deployment.rig.as_ref().ok_or_else(|| NoTrajectory::NoRig(name()))?);
    let is_unknown = rig.inter_prism_m.len() > Pair::count(3)
        && rig.prisms_m.is_none()
        && rig.in_vehicle_m.is_none();
    if is_unknown {
        return Err(NoTrajectory::UnknownLayout(name()));
    }
    let layout = prisms_in_vehicle(&rig).filter(|(prisms_m, _)| span_a_plane(prisms_m));
    layout.ok_or_else(|| NoTrajectory::PrismsOnALine(name()))
}
