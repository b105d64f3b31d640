//! Trajectory of the vehicle by an answer, with its frame and the covariance of each pose.

use nalgebra::{DMatrix, DVector, Rotation3, UnitQuaternion, Vector3};

use super::rig_motion::{pose_by_prisms, rig_pose};
use super::trajectory::{ObservedRig, Pose, Trajectory, rig_from_distances, trajectory};
use crate::calibration::joint::prism_motion::{ConstantsJacobian, PrismInstant, Solution};
use crate::calibration::joint::{JointEstimate, RIG_FLEX_SIGMA_M};
use crate::calibration::misfits::{compared_stations, placed_m, prisms_m};
use crate::calibration::{Calibration, Estimate, Method, distance_errors_m};
use crate::deployment::{Deployment, Rig};
use crate::geometry::{RigidTransform, align_rigid};
use crate::network::{Pair, PerPair, PerPrism, PerStation, Prism, Station};
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

/// Prisms in the vehicle's frame (m); `None` if they lie on a line, or if nothing determines the positions of more than three.
///
/// The shape is that of the inter-prism distances, which average many readings. The single reading of the rig gives its
/// attitude only; that of more than three prisms selects one of the mirrored shapes as well.
pub fn prisms_in_vehicle(rig: &Rig) -> Option<(PerPrism<Vector3<f64>>, VehicleFrame)> {
    if let Some(given) = &rig.in_vehicle_m {
        return Some((given.clone(), VehicleFrame::Given));
    }
    let standing = match (rig.inter_prism_m.as_array(), &rig.prisms_m) {
        (Some(distances_m), read) => {
            let triangle = rig_from_distances(distances_m)?;
            let Some(read) = read else {
                return Some((triangle.into(), VehicleFrame::Triangle));
            };
            let reading_from_triangle = align_rigid(read.as_slice(), &triangle)?;
            triangle.map(|prism| reading_from_triangle.rotate(&prism)).into()
        }
        (None, Some(read)) => with_distances(read, &rig.inter_prism_m)?,
        (None, None) => return None,
    };
    let towards = standing.iter().skip(1).find(|p| p.xy().norm() > 1e-3)?;
    let back = Rotation3::from_axis_angle(&Vector3::z_axis(), -towards.y.atan2(towards.x));
    Some((standing.map(|prism| back * prism), VehicleFrame::Reading))
}

/// Twice the area of the smallest triangle of prisms that has an orientation (m²).
const SMALLEST_SPAN_M2: f64 = 1e-6;
/// Gauss–Newton steps to the shape of a rig; the reading is accurate to millimetres.
const SHAPE_STEPS: usize = 4;
/// Singular values below this share of the largest belong to motions of the whole rig, which distances do not determine.
const RIGID_MOTION: f64 = 1e-9;

/// Returns the positions nearest to the reading that have these distances, or fit them best; the origin is at prism 1 (m).
fn with_distances(
    read: &PerPrism<Vector3<f64>>,
    inter_prism_m: &PerPair<f64>,
) -> Option<PerPrism<Vector3<f64>>> {
    let mut prisms_m = read.clone();
    for _ in 0..SHAPE_STEPS {
        let mut jacobian = DMatrix::zeros(inter_prism_m.len(), 3 * prisms_m.len());
        let mut error_m = DVector::zeros(inter_prism_m.len());
        for (row, (pair, known_m)) in inter_prism_m.each().enumerate() {
            let [a, b] = pair.indices();
            let apart_m = prisms_m.as_slice().get(b)? - prisms_m[a];
            let along = apart_m.try_normalize(0.0)?;
            error_m[row] = known_m - apart_m.norm();
            jacobian.fixed_view_mut::<1, 3>(row, 3 * a).copy_from(&-along.transpose());
            jacobian.fixed_view_mut::<1, 3>(row, 3 * b).copy_from(&along.transpose());
        }
        let svd = jacobian.svd(true, true);
        let least = RIGID_MOTION * svd.singular_values.max();
        let step = svd.solve(&error_m, least).ok()?;
        for (place, prism_m) in prisms_m.iter_mut().enumerate() {
            *prism_m += step.fixed_rows::<3>(3 * place);
        }
    }
    let first_m = *prisms_m.iter().next()?;
    Some(prisms_m.map(|prism_m| prism_m - first_m))
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
    followed: &PerStation<Prism>,
    calibration: &Calibration,
    wanted: Instants<'_>,
    largest_inter_prism_error_m: f64,
) -> Result<(Trajectory, VehicleFrame), NoTrajectory> {
    let placing = calibration.placing_tracks(deployment);
    let limit_m = largest_inter_prism_error_m;
    let by_triplets = || vehicle_trajectory(deployment, triplets, followed, placing, limit_m);
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
    let errors_m = distance_errors_m(triplets, station1_from_station, followed, &inter_prism_m);
    let with_error = |pose: Pose| {
        let read_m = largest_about(pose.time_s, &triplets.time_s, &errors_m);
        let inter_prism_error_m = pose.inter_prism_error_m.max(read_m);
        Pose { inter_prism_error_m, ..pose }
    };
    let mut poses: Vec<Pose> = instants
        .iter()
        .filter_map(|at| rig_pose(prisms_m.as_slice(), rig_sigma_m, at).map(with_error))
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
    align_rigid(joint.solution.prisms_m(time_s)?.as_slice(), rig_m.as_slice())
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
    let (rig_m, _, rig_sigma_m) = rig_by(deployment, joint, &joint.distances_m()?).ok()?;
    let instants = joint.solution.instants(times_s, &progress).ok()?;
    let (constants, of_rig) = (found.covariance.nrows(), 3 * rig_m.len());
    let each = instants.iter().zip(&found.instants).filter_map(|(at, (time_s, prisms))| {
        let pose = rig_pose(rig_m.as_slice(), rig_sigma_m, at)?;
        let gain = pose_by_prisms(rig_m.as_slice(), rig_sigma_m, at, &pose)?;
        let mut moved = DMatrix::zeros(6, constants + of_rig);
        moved.columns_mut(0, constants).copy_from(&(&gain * prisms));
        // An error of a prism's position on the vehicle moves the pose in the opposite direction.
        let turn = pose.orientation.to_rotation_matrix();
        for prism in 0..rig_m.len() {
            let by_rig = -gain.columns(3 * prism, 3) * turn.matrix();
            moved.columns_mut(constants + 3 * prism, 3).copy_from(&by_rig);
        }
        Some((*time_s, moved))
    });
    let all = constants + of_rig;
    let mut covariance = DMatrix::identity(all, all) * rig_sigma_m.powi(2);
    covariance.view_mut((0, 0), (constants, constants)).copy_from(&found.covariance);
    Some(ConstantsJacobian { instants: each.collect(), covariance })
}

/// Prisms in the vehicle's frame (m) with the estimated distances, the frame, and σ of each prism along any axis (m).
fn rig_by(
    deployment: &Deployment,
    joint: &JointEstimate,
    distances_m: &PerPair<Estimate>,
) -> Result<(PerPrism<Vector3<f64>>, VehicleFrame, f64), NoTrajectory> {
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
) -> Result<(PerPrism<Vector3<f64>>, VehicleFrame), NoTrajectory> {
    let name = || deployment.name.clone();
    let rig = deployment.rig.as_ref().ok_or_else(|| NoTrajectory::NoRig(name()))?;
    let is_unknown = rig.inter_prism_m.len() > Pair::count(3)
        && rig.prisms_m.is_none()
        && rig.in_vehicle_m.is_none();
    if is_unknown {
        return Err(NoTrajectory::UnknownLayout(name()));
    }
    let found = prisms_in_vehicle(&shaped(rig)).filter(|(prisms_m, _)| span_a_plane(prisms_m));
    found.ok_or_else(|| NoTrajectory::PrismsOnALine(name()))
}

/// Returns true if three of the prisms (m) do not lie on a line, so that they have an orientation.
fn span_a_plane(prisms_m: &PerPrism<Vector3<f64>>) -> bool {
    let from_first = || prisms_m.iter().skip(1).map(|prism_m| prism_m - prisms_m[0]);
    let pairs = from_first().flat_map(|a| from_first().map(move |b| a.cross(&b).norm()));
    pairs.fold(0.0, f64::max) > SMALLEST_SPAN_M2
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::pairwise_distances;

    #[test]
    fn four_prisms_have_the_measured_distances_in_the_attitude_of_the_reading() {
        let prisms_m = [[0.0, 0.0, 0.0], [1.1, 0.0, 0.0], [0.2, 0.9, 0.1], [0.4, 0.3, 0.8]];
        let prisms_m = prisms_m.map(Vector3::from);
        let inter_prism_m = pairwise_distances(&prisms_m);
        let turn = Rotation3::from_euler_angles(0.0, 0.0, 0.7);
        // Every reading of a prism has an error of millimetres.
        let read = prisms_m.map(|p| turn * p + Vector3::new(4.0, 7.0 + 2e-3 * p.x, -1e-3 * p.z));
        let rig = |read: Option<PerPrism<Vector3<f64>>>| Rig {
            inter_prism_m: inter_prism_m.clone(),
            prisms_m: read,
            in_vehicle_m: None,
            inter_antenna_m: None,
        };
        let (found, frame) = prisms_in_vehicle(&rig(Some(read.into()))).expect("a layout");
        assert_eq!(frame, VehicleFrame::Reading);
        for (found_m, known_m) in pairwise_distances(found.as_slice()).iter().zip(&inter_prism_m) {
            assert!((found_m - known_m).abs() < 1e-9, "{found_m} {known_m}");
        }
        for (found_m, prism_m) in found.iter().zip(&prisms_m) {
            assert!((found_m - prism_m).norm() < 5e-3, "{found_m} {prism_m}");
        }
        assert_eq!(prisms_in_vehicle(&rig(None)), None);
    }
}
