//! Trajectory of the vehicle by an answer, with its frame and the covariance of each pose.

use std::f64::consts::PI;

use nalgebra::{DMatrix, UnitQuaternion, Vector3};

use super::rig_layout::{VehicleFrame, prisms_in_vehicle, span_a_plane};
use super::rig_motion::{align_upright, pose_by_prisms, rig_pose};
use super::trajectory::{ObservedRig, Pose, PoseSigma, Trajectory, trajectory};
use super::usual_tilt::{ExpectedTilt, UsualTilt};
use crate::calibration::joint::prism_motion::{
    ConstantsJacobian, MotionInstant, PrismInstant, PrismsAtInstant, Solution,
};
use crate::calibration::joint::{JointEstimate, RIG_FLEX_SIGMA_M};
use crate::calibration::misfits::{compared_stations, placed_m, prisms_m};
use crate::calibration::{Calibration, Estimate, Method, distance_errors_m};
use crate::deployment::{Deployment, Rig};
use crate::geometry::{RigidTransform, align_rigid, align_weighted};
use crate::network::{Number, Pair, PerPair, PerPrism, PerStation, Prism, Station};
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::statistics::sigma_of_errors;

/// Default limit of the inter-prism error (m); trajectories leave out epochs above it.
pub const LARGEST_POSE_ERROR_M: f64 = 0.020;
/// Default limits of σ of a pose in position (m) and orientation (rad).
pub const LARGEST_POSE_SIGMA: PoseSigma =
    PoseSigma { position_m: 0.050, orientation_rad: 3.0 * PI / 180.0 };
/// Rate of the poses of the joint estimate where there are no triplets (Hz).
const USUAL_HZ: f64 = 10.0;
/// Instants further apart do not share an inter-prism error (s).
const NEAR_S: f64 = 0.5;
/// Usual jerk of a vehicle, by which a prism without readings departs from its spline (m/s³).
const USUAL_M_PER_S3: f64 = 0.5;
/// Time between the instants from which the usual tilt is taken (s).
const TILT_STEP_S: f64 = 1.0;

/// Limits beyond which a trajectory has no pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseLimits {
    /// Largest inter-prism error (m).
    pub inter_prism_error_m: f64,
    pub sigma: PoseSigma,
    /// True for no poses that the usual tilt completes.
    pub needs_three_prisms: bool,
}

impl PoseLimits {
    /// All poses, however uncertain.
    pub const NONE: Self = Self {
        needs_three_prisms: false,
        inter_prism_error_m: f64::INFINITY,
        sigma: PoseSigma { position_m: f64::INFINITY, orientation_rad: f64::INFINITY },
    };
}

impl Default for PoseLimits {
    fn default() -> Self {
        Self {
            inter_prism_error_m: LARGEST_POSE_ERROR_M,
            sigma: LARGEST_POSE_SIGMA,
            needs_three_prisms: false,
        }
    }
}

/// Reason why there are no poses.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum NoTrajectory {
    #[error(
        "{0}: all stations follow one prism, so there is no orientation; use the joint estimate for its positions"
    )]
    OnePrism(String),
    #[error(
        "{0}: the inter-prism distances are not known; put calibration_results.csv beside the tracks, or name a rig file"
    )]
    NoRig(String),
    #[error(
        "{0}: the orientation is not determined: there are fewer than three prisms, or they lie on a line"
    )]
    PrismsOnALine(String),
    #[error(
        "{0}: the distances do not determine the positions of more than three prisms; give prisms_m in deployment.toml, or a \
         reading of the rig"
    )]
    UnknownLayout(String),
    #[error(
        "{0}: this calibration is in the stations' own frames, but the tracks are in another frame; use method C or D"
    )]
    OtherFrame(String),
    #[error(
        "{0}: this method has poses at the triplets only; use the joint estimate for poses at any time"
    )]
    NoMotion(String),
    #[error("{name}: no trajectory without a calibration: {why}")]
    NoAnswer { name: String, why: String },
    #[error("{0}: the joint estimate found no motion that fits the readings; see its findings")]
    NoMotionFits(String),
}

/// The instants at which poses are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instants<'a> {
    /// The times of the triplets; with a joint estimate, further ten a second wherever it has a motion.
    Usual,
    /// Multiples of the period of this rate (Hz).
    Rate(f64),
    /// These times (s).
    At(&'a [f64]),
}

impl Instants<'_> {
    /// Times in ascending order (s).
    fn times_s(self, triplets: &Triplets, solution: &Solution) -> Vec<f64> {
        match self {
            Self::Usual => {
                let known_s = &triplets.time_s;
                let is_between = |time_s: &f64| {
                    let next = known_s.partition_point(|known_s| known_s < time_s);
                    let around = &known_s[next.saturating_sub(1)..known_s.len().min(next + 1)];
                    // Half of a step is as near as another triplet.
                    around.iter().all(|known_s| (known_s - time_s).abs() > 0.5 / USUAL_HZ)
                };
                let between_s = at_rate(USUAL_HZ, solution).into_iter().filter(is_between);
                let mut times_s: Vec<f64> = known_s.iter().copied().chain(between_s).collect();
                times_s.sort_by(f64::total_cmp);
                times_s
            }
            Self::Rate(hz) => at_rate(hz, solution),
            Self::At(times_s) => {
                let mut times_s = times_s.to_vec();
                times_s.sort_by(f64::total_cmp);
                times_s
            }
        }
    }
}

/// Multiples of the period of a rate within the segments of a solution (s).
fn at_rate(hz: f64, solution: &Solution) -> Vec<f64> {
    // Segments that one long segment was split into share an instant.
    let mut last = f64::NEG_INFINITY;
    let mut times_s = Vec::new();
    for [start_s, end_s] in solution.spans_s() {
        let mut step = (start_s * hz).ceil().max(last + 1.0);
        while step / hz <= end_s {
            times_s.push(step / hz);
            last = step;
            step += 1.0;
        }
    }
    times_s
}

/// Returns the poses by an answer within the limits.
///
/// The motion of a joint estimate gives poses at any time, with their full covariance; where two prisms are followed, the usual tilt of
/// the vehicle completes them. Other answers give one pose for each triplet, and its covariance lacks the errors of the calibration.
pub fn trajectory_by(
    deployment: &Deployment,
    triplets: &Triplets,
    followed: &PerStation<Prism>,
    calibration: &Calibration,
    wanted: Instants<'_>,
    limits: &PoseLimits,
) -> Result<(Trajectory, VehicleFrame), NoTrajectory> {
    let placing = calibration.placing_tracks(deployment);
    let limit_m = limits.inter_prism_error_m;
    let by_triplets = || vehicle_trajectory(deployment, triplets, followed, placing, limit_m);
    let Some((joint, distances_m)) =
        calibration.joint().and_then(|joint| Some((joint, joint.distances_m()?)))
    else {
        return match wanted {
            Instants::Usual => by_triplets(),
            _ if calibration.method == Method::Joint => {
                Err(NoTrajectory::NoMotionFits(deployment.name.clone()))
            }
            _ => Err(NoTrajectory::NoMotion(deployment.name.clone())),
        };
    };
    let rig = rig_by(deployment, joint, &distances_m)?;
    let inter_prism_m = distances_m.map(|distance| distance.value);
    let times_s = wanted.times_s(triplets, &joint.solution);
    // Unreachable else branch: nothing cancels this calculation.
    let Some(instants) = rig.poses(&joint.solution, &times_s) else { return by_triplets() };
    let station1_from_station =
        placing.ok_or_else(|| NoTrajectory::OtherFrame(deployment.name.clone()))?;
    // The motion always satisfies the rig's distances, so the inter-prism error is from the readings around the instant.
    let errors_m = distance_errors_m(triplets, station1_from_station, followed, &inter_prism_m);
    let with_error = |pose: Pose| {
        let read_m = largest_about(pose.time_s, &triplets.time_s, &errors_m);
        let inter_prism_error_m = pose.inter_prism_error_m.max(read_m);
        Pose { inter_prism_error_m, ..pose }
    };
    let is_wanted = |(at, _): &(MotionInstant, Option<Pose>)| {
        !limits.needs_three_prisms || at.prisms.len() == rig.prisms_m.len()
    };
    let instants = instants.into_iter().filter(is_wanted);
    let mut trajectory = Trajectory {
        poses: instants.filter_map(|(_, pose)| pose.map(with_error)).collect(),
        ..Trajectory::default()
    };
    let determined = trajectory.poses.len();
    trajectory.poses.retain(|pose| pose.inter_prism_error_m <= limit_m);
    trajectory.above_limit = determined - trajectory.poses.len();
    let consistent = trajectory.poses.len();
    trajectory.poses.retain(|pose| pose.sigma().is_within(&limits.sigma));
    trajectory.too_uncertain = consistent - trajectory.poses.len();
    trajectory.dropped = times_s.len() - trajectory.poses.len();
    Ok((trajectory, rig.frame))
}

/// Vehicle's pose at an instant (s) by the motion of the joint estimate, `station1_from_vehicle`. It has no covariance, which
/// requires a pass over the drive. `None` in a gap, and for other answers.
pub fn vehicle_at(
    deployment: &Deployment,
    calibration: &Calibration,
    time_s: f64,
) -> Option<RigidTransform> {
    calibration.placing_tracks(deployment)?;
    let joint = calibration.joint()?;
    let rig = rig_by(deployment, joint, &joint.distances_m()?).ok()?;
    rig.at(&joint.solution, time_s)
}

/// Largest |distance error| of all pairs at the triplet of this time, else at those just before and after it; zero without any.
pub fn largest_about(time_s: f64, triplet_s: &[f64], errors: &PerPair<Vec<f64>>) -> f64 {
    let after = triplet_s.partition_point(|other| *other < time_s);
    let is_there = triplet_s.get(after) == Some(&time_s);
    let around = if is_there { after..after + 1 } else { after.saturating_sub(1)..after + 1 };
    let around = around.start..around.end.min(triplet_s.len());
    let is_near = |index: &usize| (triplet_s[*index] - time_s).abs() < NEAR_S;
    let (Some(first), Some(last)) = (around.clone().find(is_near), around.rev().find(is_near))
    else {
        return 0.0;
    };
    let around = first..last + 1;
    let each = errors.iter().flat_map(|pair| pair.get(around.clone()).unwrap_or_default());
    each.fold(0.0, |most, error| error.abs().max(most))
}

/// Jacobian of each pose with respect to the constants of the drive and the rig's own errors, and the covariance of these.
///
/// The rows are position (m) and rotation (rad) in station 1's frame; a single prism has the three rows of its position only.
/// `None` for methods other than the joint estimate.
pub fn common_errors(
    deployment: &Deployment,
    followed: &PerStation<Prism>,
    calibration: &Calibration,
    times_s: &[f64],
) -> Option<ConstantsJacobian> {
    let joint = calibration.joint()?;
    let progress = Progress::default();
    let found = joint.solution.constants_jacobian(times_s, &progress).ok()?;
    if Prism::is_one(followed) {
        return Some(found);
    }
    let rig = rig_by(deployment, joint, &joint.distances_m()?).ok()?;
    let (rig_m, rig_sigma_m) = (&rig.prisms_m, rig.sigma_m);
    let poses = rig.poses(&joint.solution, times_s)?;
    let (constants, of_rig) = (found.covariance.nrows(), 3 * rig_m.len());
    let each = poses.iter().zip(&found.instants).filter_map(|((at, pose), (time_s, prisms))| {
        let pose = pose.as_ref()?;
        let gain = pose_by_prisms(rig_m.as_slice(), rig_sigma_m, at, pose)?;
        let mut moved = DMatrix::zeros(6, constants + of_rig);
        moved.columns_mut(0, constants).copy_from(&(&gain * prisms));
        // An error of a prism's position on the vehicle moves the pose in the opposite direction.
        let turn = pose.orientation.to_rotation_matrix();
        for (index, place) in at.prisms.iter().enumerate() {
            let by_rig = -gain.columns(3 * index, 3) * turn.matrix();
            moved.columns_mut(constants + 3 * place, 3).copy_from(&by_rig);
        }
        Some((*time_s, moved))
    });
    let all = constants + of_rig;
    let mut covariance = DMatrix::identity(all, all) * rig_sigma_m.powi(2);
    covariance.view_mut((0, 0), (constants, constants)).copy_from(&found.covariance);
    Some(ConstantsJacobian { instants: each.collect(), covariance })
}

/// The prisms on the vehicle.
struct VehicleRig {
    /// In the vehicle's frame, with the estimated distances (m).
    prisms_m: PerPrism<Vector3<f64>>,
    frame: VehicleFrame,
    /// σ of each prism along any axis (m).
    sigma_m: f64,
}

impl VehicleRig {
    /// Returns the motion at those of some increasing times that have one (s), with the pose where the prisms determine it; `None` if the
    /// calculation is cancelled.
    fn poses(
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
    fn at(&self, solution: &Solution, time_s: f64) -> Option<RigidTransform> {
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
fn rig_by(
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

/// Positions of the single prism that all stations follow, by the motion of the joint estimate.
pub fn prism_by(
    deployment: &Deployment,
    triplets: &Triplets,
    calibration: &Calibration,
    wanted: Instants<'_>,
) -> Result<Vec<PrismInstant>, NoTrajectory> {
    let none = || NoTrajectory::OnePrism(deployment.name.clone());
    let solution = &calibration.joint().ok_or_else(none)?.solution;
    let times_s = wanted.times_s(triplets, solution);
    let instants = solution.instants(&times_s, &Progress::default()).map_err(|_| none())?;
    Ok(instants.iter().map(|instant| instant.prism(0)).collect())
}

fn rig_of(
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

/// Returns one pose for every triplet whose inter-prism distances are within the limit.
///
/// `station1_from_station` transforms the tracks ([`crate::calibration::Calibration::placing_tracks`]).
pub fn vehicle_trajectory(
    deployment: &Deployment,
    triplets: &Triplets,
    followed: &PerStation<Prism>,
    station1_from_station: Option<&PerStation<RigidTransform>>,
    largest_inter_prism_error_m: f64,
) -> Result<(Trajectory, VehicleFrame), NoTrajectory> {
    let name = || deployment.name.clone();
    if Prism::is_one(followed) {
        return Err(NoTrajectory::OnePrism(name()));
    }
    let station1_from_station =
        station1_from_station.ok_or_else(|| NoTrajectory::OtherFrame(name()))?;
    let (prisms_m, frame) = rig_of(deployment, &Rig::clone)?;
    if prisms_m.len() != Prism::count(followed) {
        return Err(NoTrajectory::PrismsOnALine(name()));
    }
    let rig = deployment.rig.as_ref().ok_or_else(|| NoTrajectory::NoRig(name()))?;
    let observed = observed(triplets, station1_from_station, followed, &rig.inter_prism_m);
    Ok((trajectory(prisms_m.as_slice(), observed, largest_inter_prism_error_m), frame))
}

/// Prisms at every instant, with σ scaled to the distance errors.
///
/// A distance error is the difference of two points along one axis, so its σ over √2 is that of a point along an axis. The
/// interpolation's own σ is widened until it explains the distance errors, never narrowed.
fn observed(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    followed: &PerStation<Prism>,
    inter_prism_m: &PerPair<f64>,
) -> Vec<ObservedRig> {
    let placed =
        |index: usize| prisms_m(&placed_m(triplets, station1_from_station, index), followed);
    // The means of several stations are not claimed to be better than one of them.
    let first = compared_stations(followed);
    let stated = |station: Station, index: usize| {
        triplets.sigma_m.as_ref().map_or(Vector3::repeat(1.0), |all| all[station][index])
    };
    // Distance errors over their expected σ. Without a σ of the interpolation, 1 m on every axis is assumed.
    let pairs = inter_prism_m.len();
    let mut ratios = Vec::with_capacity(pairs * triplets.len());
    for index in 0..triplets.len() {
        let points = placed(index);
        let sigma_m = distance_sigma_m(triplets, index, station1_from_station, &first)
            .unwrap_or_else(|| PerPair::repeat(pairs, std::f64::consts::SQRT_2));
        for ((pair, known_m), sigma_m) in inter_prism_m.each().zip(&sigma_m) {
            let [a, b] = pair.indices();
            ratios.push(((points[b] - points[a]).norm() - known_m) / sigma_m);
        }
    }
    let shown = sigma_of_errors(ratios).unwrap_or(0.0);
    let factor = if triplets.sigma_m.is_some() { shown.max(1.0) } else { shown };
    (0..triplets.len())
        .map(|index| ObservedRig {
            time_s: triplets.time_s[index],
            points_m: placed(index),
            sigma_m: first.map(|station| stated(*station, index) * factor),
        })
        .collect()
}

/// σ of the distances of all pairs of prisms at an instant by the interpolation (m), each prism by one station; `None` if the
/// interpolation gives none.
pub fn distance_sigma_m(
    triplets: &Triplets,
    index: usize,
    station1_from_station: &PerStation<RigidTransform>,
    by_station: &PerPrism<Station>,
) -> Option<PerPair<f64>> {
    let sigma_m = triplets.sigma_m.as_ref()?;
    let placed = placed_m(triplets, station1_from_station, index);
    let distance_sigma_m = |pair: Pair| {
        let [a, b] = [pair.first, pair.second].map(|prism| by_station[prism]);
        let direction = (placed[b] - placed[a]).normalize();
        let variance = |station: Station| {
            // Direction in the station's own frame, in which σ is given.
            let own = station1_from_station[station].rotation.inverse() * direction;
            sigma_m[station][index].component_mul(&own).norm_squared()
        };
        (variance(a) + variance(b)).sqrt()
    };
    Some(Pair::among(by_station.len()).map(distance_sigma_m).collect())
}

/// Transform from the position (m) and orientation of a pose.
pub fn station1_from_vehicle(
    position_m: Vector3<f64>,
    orientation: UnitQuaternion<f64>,
) -> RigidTransform {
    RigidTransform { rotation: orientation.to_rotation_matrix(), translation_m: position_m }
}
