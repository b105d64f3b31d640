//! Trajectory of the vehicle by an answer, with its frame and the covariance of each pose.

use std::f64::consts::PI;

use nalgebra::{DMatrix, UnitQuaternion, Vector3};

use super::no_trajectory::NoTrajectory;
use super::rig_layout::VehicleFrame;
use super::rig_motion::pose_by_prisms;
use super::trajectory::{ObservedRig, Pose, PoseSigma, Trajectory, trajectory};
use super::vehicle_rig::{rig_by, rig_of};
use crate::calibration::joint::prism_motion::{
    ConstantsJacobian, MotionInstant, PrismInstant, Solution,
};
use crate::calibration::misfits::{compared_stations, placed_m, prisms_m};
use crate::calibration::{Calibration, Method, distance_errors_m};
use crate::deployment::{Deployment, Rig};
use crate::geometry::RigidTransform;
use crate::network::{Pair, PerPair, PerPrism, PerStation, Prism, Station};
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
