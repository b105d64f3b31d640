//! Trajectory of the vehicle by an answer, with its frame and the covariance of each pose.

use nalgebra::{DMatrix, Rotation3, UnitQuaternion, Vector3};

use super::rig_motion::{pose_by_prisms, rig_pose};
use super::trajectory::{ObservedRig, Pose, Trajectory, rig_from_distances, trajectory};
use crate::calibration::joint::prism_motion::{ConstantsJacobian, PrismInstant, Solution};
use crate::calibration::joint::{JointEstimate, RIG_FLEX_SIGMA_M};
use crate::calibration::{Calibration, Estimate, Method, Targets, distance_errors_m};
use crate::deployment::{Deployment, Rig};
use crate::geometry::{RigidTransform, align_rigid};
use crate::network::{Pair, PerPair, PerStation};
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::statistics::sigma_of_errors;

/// Default limit of the inter-prism error (m); trajectories leave out epochs above it.
pub const LARGEST_POSE_ERROR_M: f64 = 0.020;

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
    #[error("{0}: the three prisms lie on a line, so the orientation is not determined")]
    PrismsOnALine(String),
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

/// The frame of the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum VehicleFrame {
    /// The frame in which `deployment.toml` gives the prisms.
    Given,
    /// Origin at prism 1, z up in the attitude in which the rig was read, x level and towards prism 2.
    Reading,
    /// Origin at prism 1, x to prism 2, y on the side of prism 3, z normal to the three.
    Triangle,
}

impl VehicleFrame {
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Given => "the vehicle's own, as prisms_m of deployment.toml",
            Self::Reading => {
                "origin at prism 1, z up as in the reading of the rig, x level towards prism 2"
            }
            Self::Triangle => {
                "origin at prism 1, x to prism 2, y on the side of prism 3, z normal to the three"
            }
        }
    }
}

/// Prisms in the vehicle's frame (m); `None` if they lie on a line.
///
/// The shape is that of the inter-prism distances, which average many readings. The single reading of the rig gives its
/// attitude only.
pub fn prisms_in_vehicle(rig: &Rig) -> Option<([Vector3<f64>; 3], VehicleFrame)> {
    if let Some(given) = &rig.in_vehicle_m {
        return Some((*given.as_array()?, VehicleFrame::Given));
    }
    let triangle = rig_from_distances(rig.inter_prism_m.as_array()?)?;
    let Some(read) = rig.prisms_m.as_ref().and_then(|prisms_m| prisms_m.as_array::<3>()) else {
        return Some((triangle, VehicleFrame::Triangle));
    };
    let reading_from_triangle = align_rigid(read, &triangle)?;
    let standing = triangle.map(|prism| reading_from_triangle.rotate(&prism));
    let towards = [standing[1], standing[2]].into_iter().find(|p| p.xy().norm() > 1e-3)?;
    let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -towards.y.atan2(towards.x));
    Some((standing.map(|prism| back * prism), VehicleFrame::Reading))
}

/// The instants at which poses are wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Instants<'a> {
    /// The times of the triplets.
    Triplets,
    /// Multiples of the period of this rate (Hz).
    Rate(f64),
    /// These times (s).
    At(&'a [f64]),
}

impl Instants<'_> {
    /// Times in ascending order (s).
    fn times_s(self, triplets: &Triplets, solution: &Solution) -> Vec<f64> {
        match self {
            Self::Triplets => triplets.time_s.clone(),
            Self::Rate(hz) => {
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
            Self::At(times_s) => {
                let mut times_s = times_s.to_vec();
                times_s.sort_by(f64::total_cmp);
                times_s
            }
        }
    }
}

/// Returns the poses by an answer, without those above the limit of the inter-prism error (m).
///
/// The motion of a joint estimate gives poses at any time, with their full covariance. Other answers give one pose for each
/// triplet, and its covariance lacks the errors of the calibration.
pub fn trajectory_by(
    deployment: &Deployment,
    triplets: &Triplets,
    targets: Targets,
    calibration: &Calibration,
    wanted: Instants<'_>,
    largest_inter_prism_error_m: f64,
) -> Result<(Trajectory, VehicleFrame), NoTrajectory> {
    let placing = calibration.placing_tracks(deployment);
    let limit_m = largest_inter_prism_error_m;
    let by_triplets = || vehicle_trajectory(deployment, triplets, targets, placing, limit_m);
    let Some((joint, distances_m)) =
        calibration.joint().and_then(|joint| Some((joint, joint.distances_m()?)))
    else {
        return match wanted {
            Instants::Triplets => by_triplets(),
            _ if calibration.method == Method::Joint => {
                Err(NoTrajectory::NoMotionFits(deployment.name.clone()))
            }
            _ => Err(NoTrajectory::NoMotion(deployment.name.clone())),
        };
    };
    let (prisms_m, frame, rig_sigma_m) = rig_by(deployment, joint, &distances_m)?;
    let inter_prism_m = distances_m.map(|distance| distance.value);
    let times_s = wanted.times_s(triplets, &joint.solution);
    let found = joint.solution.instants(&times_s, &Progress::default());
    // Unreachable else branch: nothing cancels this calculation.
    let Ok(instants) = found else { return by_triplets() };
    let station1_from_station =
        placing.ok_or_else(|| NoTrajectory::OtherFrame(deployment.name.clone()))?;
    // The motion always satisfies the rig's distances, so the inter-prism error is from the readings around the instant.
    let errors_m = distance_errors_m(triplets, station1_from_station, &inter_prism_m);
    let with_error = |pose: Pose| {
        let read_m = largest_about(pose.time_s, &triplets.time_s, &errors_m);
        let inter_prism_error_m = pose.inter_prism_error_m.max(read_m);
        Pose { inter_prism_error_m, ..pose }
    };
    let mut poses: Vec<Pose> = instants
        .iter()
        .filter_map(|at| rig_pose(&prisms_m, rig_sigma_m, at).map(with_error))
        .collect();
    let determined = poses.len();
    poses.retain(|pose| pose.inter_prism_error_m <= limit_m);
    let above_limit = determined - poses.len();
    let dropped = times_s.len() - poses.len();
    Ok((Trajectory { poses, dropped, above_limit }, frame))
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
    let (rig_m, _, _) = rig_by(deployment, joint, &joint.distances_m()?).ok()?;
    align_rigid(joint.solution.prisms_m(time_s)?.as_slice(), &rig_m)
}

/// Largest |distance error| of all pairs at the triplet of this time, else at the triplets before and after it.
pub fn largest_about(time_s: f64, triplet_s: &[f64], errors: &PerPair<Vec<f64>>) -> f64 {
    let after = triplet_s.partition_point(|other| *other < time_s);
    let is_there = triplet_s.get(after) == Some(&time_s);
    let around = if is_there { after..after + 1 } else { after.saturating_sub(1)..after + 1 };
    let around = around.start..around.end.min(triplet_s.len());
    let each = errors.iter().flat_map(|pair| pair.get(around.clone()).unwrap_or_default());
    each.fold(0.0, |most, error| error.abs().max(most))
}

/// Jacobian of each pose with respect to the constants of the drive and the rig's own errors, and the covariance of these.
///
/// The rows are position (m) and rotation (rad) in station 1's frame; a single prism has the three rows of its position only.
/// `None` for methods other than the joint estimate.
pub fn common_errors(
    deployment: &Deployment,
    targets: Targets,
    calibration: &Calibration,
    times_s: &[f64],
) -> Option<ConstantsJacobian> {
    let joint = calibration.joint()?;
    let progress = Progress::default();
    let found = joint.solution.constants_jacobian(times_s, &progress).ok()?;
    if targets == Targets::OnePrism {
        return Some(found);
    }
    let (rig_m, _, rig_sigma_m) = rig_by(deployment, joint, &joint.distances_m()?).ok()?;
    let instants = joint.solution.instants(times_s, &progress).ok()?;
    let constants = found.covariance.nrows();
    let each = instants.iter().zip(&found.instants).filter_map(|(at, (time_s, prisms))| {
        let pose = rig_pose(&rig_m, rig_sigma_m, at)?;
        let gain = pose_by_prisms(&rig_m, rig_sigma_m, at, &pose)?;
        let mut moved = DMatrix::zeros(6, constants + 9);
        moved.columns_mut(0, constants).copy_from(&(&gain * prisms));
        // An error of a prism's position on the vehicle moves the pose in the opposite direction.
        let turn = pose.orientation.to_rotation_matrix();
        for prism in 0..3 {
            let by_rig = -gain.columns(3 * prism, 3) * turn.matrix();
            moved.columns_mut(constants + 3 * prism, 3).copy_from(&by_rig);
        }
        Some((*time_s, moved))
    });
    let mut covariance = DMatrix::identity(constants + 9, constants + 9) * rig_sigma_m.powi(2);
    covariance.view_mut((0, 0), (constants, constants)).copy_from(&found.covariance);
    Some(ConstantsJacobian { instants: each.collect(), covariance })
}

/// Prisms in the vehicle's frame (m) with the estimated distances, the frame, and σ of each prism along any axis (m).
fn rig_by(
    deployment: &Deployment,
    joint: &JointEstimate,
    distances_m: &PerPair<Estimate>,
) -> Result<([Vector3<f64>; 3], VehicleFrame, f64), NoTrajectory> {
    let inter_prism_m = distances_m.map(|distance| distance.value);
    let shaped = |rig: &Rig| Rig { inter_prism_m: inter_prism_m.clone(), ..rig.clone() };
    let (prisms_m, frame) = rig_of(deployment, &shaped)?;
    let rig_sigma_m = match frame {
        // Two prisms share the error of their distance.
        VehicleFrame::Given => joint.sizes.inter_prism_m * std::f64::consts::FRAC_1_SQRT_2,
        VehicleFrame::Reading | VehicleFrame::Triangle => RIG_FLEX_SIGMA_M,
    };
    Ok((prisms_m, frame, rig_sigma_m))
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
) -> Result<([Vector3<f64>; 3], VehicleFrame), NoTrajectory> {
    let name = || deployment.name.clone();
    let rig = deployment.rig.as_ref().ok_or_else(|| NoTrajectory::NoRig(name()))?;
    prisms_in_vehicle(&shaped(rig)).ok_or_else(|| NoTrajectory::PrismsOnALine(name()))
}

/// Returns one pose for every triplet whose inter-prism distances are within the limit.
///
/// `station1_from_station` transforms the tracks ([`crate::calibration::Calibration::placing_tracks`]).
pub fn vehicle_trajectory(
    deployment: &Deployment,
    triplets: &Triplets,
    targets: Targets,
    station1_from_station: Option<&PerStation<RigidTransform>>,
    largest_inter_prism_error_m: f64,
) -> Result<(Trajectory, VehicleFrame), NoTrajectory> {
    let name = || deployment.name.clone();
    if targets == Targets::OnePrism {
        return Err(NoTrajectory::OnePrism(name()));
    }
    let station1_from_station =
        station1_from_station.ok_or_else(|| NoTrajectory::OtherFrame(name()))?;
    let (prisms_m, frame) = rig_of(deployment, &Rig::clone)?;
    let inter_prism_m = deployment.rig.as_ref().map(|rig| &rig.inter_prism_m);
    let inter_prism_m = inter_prism_m.and_then(|all_m| all_m.as_array()).unwrap_or(&[0.0; 3]);
    let observed = observed(triplets, station1_from_station, inter_prism_m);
    Ok((trajectory(&prisms_m, observed, largest_inter_prism_error_m), frame))
}

/// Prisms at every instant, with σ scaled to the distance errors.
///
/// A distance error is the difference of two points along one axis, so its σ over √2 is that of a point along an axis. The
/// interpolation's own σ is widened until it explains the distance errors, never narrowed.
fn observed(
    triplets: &Triplets,
    station1_from_station: &PerStation<RigidTransform>,
    inter_prism_m: &[f64; 3],
) -> Vec<ObservedRig> {
    let placed = |index: usize| -> [Vector3<f64>; 3] {
        let points = triplets.triplet_m(index);
        std::array::from_fn(|station| station1_from_station[station].apply(&points[station]))
    };
    let stated = |station: usize, index: usize| {
        triplets.sigma_m.as_ref().map_or(Vector3::repeat(1.0), |all| all[station][index])
    };
    // Distance errors over their expected σ. Without a σ of the interpolation, 1 m on every axis is assumed.
    let mut ratios = Vec::with_capacity(3 * triplets.len());
    for index in 0..triplets.len() {
        let points = placed(index);
        let sigma_m = distance_sigma_m(triplets, index, station1_from_station)
            .unwrap_or_else(|| PerPair::repeat(3, std::f64::consts::SQRT_2));
        for (pair, [a, b]) in Pair::among(3).map(Pair::indices).enumerate() {
            let error_m = (points[b] - points[a]).norm() - inter_prism_m[pair];
            ratios.push(error_m / sigma_m[pair]);
        }
    }
    let shown = sigma_of_errors(ratios).unwrap_or(0.0);
    let factor = if triplets.sigma_m.is_some() { shown.max(1.0) } else { shown };
    (0..triplets.len())
        .map(|index| ObservedRig {
            time_s: triplets.time_s[index],
            points_m: placed(index),
            sigma_m: std::array::from_fn(|station| stated(station, index) * factor),
        })
        .collect()
}

/// σ of the distances of all pairs of stations at an instant by the interpolation (m); `None` if the interpolation gives none.
pub fn distance_sigma_m(
    triplets: &Triplets,
    index: usize,
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<PerPair<f64>> {
    let sigma_m = triplets.sigma_m.as_ref()?;
    let placed = station1_from_station
        .zip(&triplets.points_m, |transform, points_m| transform.apply(&points_m[index]));
    let distance_sigma_m = |[a, b]: [usize; 2]| {
        let direction = (placed[b] - placed[a]).normalize();
        let variance = |station: usize| {
            // Direction in the station's own frame, in which σ is given.
            let own = station1_from_station[station].rotation.inverse() * direction;
            sigma_m[station][index].component_mul(&own).norm_squared()
        };
        (variance(a) + variance(b)).sqrt()
    };
    Some(Pair::among(placed.len()).map(Pair::indices).map(distance_sigma_m).collect())
}

/// Transform from the position (m) and orientation of a pose.
pub fn station1_from_vehicle(
    position_m: Vector3<f64>,
    orientation: UnitQuaternion<f64>,
) -> RigidTransform {
    RigidTransform { rotation: orientation.to_rotation_matrix(), translation_m: position_m }
}
