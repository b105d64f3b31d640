//! Association of the poses of an estimate with those of a trajectory that is the ground truth.

use nalgebra::Matrix3;

use super::matched_pose::{MatchedPose, PoseTwist, TruePose, TrueRotation};
use super::options::Association;
use super::pose_interpolation::{InterpolatedPose, PoseInterpolation, median_interval_s};
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory, PoseCovariance};

/// Largest difference of the stamps of two poses that are associated without interpolation (s): evo's `--t_max_diff`.
const NEAREST_S: f64 = 0.01;

/// Returns at most this number of values, evenly spread.
pub fn thinned<T>(all: &[T], most: usize) -> impl Iterator<Item = &T> {
    all.iter().step_by(all.len().div_ceil(most).max(1))
}

/// Returns at most `most` pairs of a pose and the ground truth at its time, in order of time. The offset is added to the times
/// of the poses (s).
pub fn associate(
    truth: &EstimatedTrajectory,
    poses: &[EstimatedPose],
    time_offset_s: f64,
    (association, most): (Association, usize),
) -> Vec<MatchedPose> {
    if association == Association::Nearest {
        return nearest(truth, poses, time_offset_s);
    }
    if is_denser(&truth.poses, poses) {
        let curve = PoseInterpolation::new(&truth.poses);
        let at = |pose: &EstimatedPose| {
            let between = curve.at(pose.time_s + time_offset_s)?;
            let truth = true_pose(truth, &between);
            Some(MatchedPose { pose: *pose, truth, pose_twist: None })
        };
        return thinned(poses, most).filter_map(at).collect();
    }
    let curve = PoseInterpolation::new(poses);
    let indices: Vec<usize> = (0..truth.poses.len()).collect();
    let at = |index: &usize| {
        let at_pose = InterpolatedPose::at_pose(&truth.poses, *index);
        let between = curve.at(at_pose.pose.time_s - time_offset_s)?;
        let truth = true_pose(truth, &at_pose);
        Some(MatchedPose { pose: between.pose, truth, pose_twist: Some(between.twist) })
    };
    thinned(&indices, most).filter_map(at).collect()
}

/// Returns true if the first trajectory is interpolated at the times of the second.
pub fn is_denser(truth: &[EstimatedPose], poses: &[EstimatedPose]) -> bool {
    median_interval_s(truth) <= median_interval_s(poses)
}

/// Pairs each pose of the shorter trajectory with the nearest one of the longer, as evo does.
fn nearest(
    truth: &EstimatedTrajectory,
    poses: &[EstimatedPose],
    time_offset_s: f64,
) -> Vec<MatchedPose> {
    let pair = |pose: &EstimatedPose, index: usize| MatchedPose {
        pose: *pose,
        truth: true_pose(truth, &InterpolatedPose::at_pose(&truth.poses, index)),
        pose_twist: Some(PoseTwist::default()),
    };
    if poses.len() > truth.poses.len() {
        let of_truth = |(index, own): (usize, &EstimatedPose)| {
            let near = nearest_index(poses, own.time_s - time_offset_s)?;
            Some(pair(&poses[near], index))
        };
        truth.poses.iter().enumerate().filter_map(of_truth).collect()
    } else {
        let of_pose = |pose: &EstimatedPose| {
            Some(pair(pose, nearest_index(&truth.poses, pose.time_s + time_offset_s)?))
        };
        poses.iter().filter_map(of_pose).collect()
    }
}

fn nearest_index(poses: &[EstimatedPose], time_s: f64) -> Option<usize> {
    let after = poses.partition_point(|pose| pose.time_s < time_s);
    let apart_s = |index: &usize| (poses[*index].time_s - time_s).abs();
    let beside = after.saturating_sub(1)..poses.len().min(after + 1);
    let index = beside.min_by(|a, b| apart_s(a).total_cmp(&apart_s(b)))?;
    (apart_s(&index) <= NEAREST_S).then_some(index)
}

/// Ground truth at an instant of a trajectory, with the covariance between those of its neighbours.
fn true_pose(truth: &EstimatedTrajectory, at: &InterpolatedPose) -> TruePose {
    let covariance = covariance(&truth.covariances, at);
    let rotation = at.pose.orientation.map(|orientation| TrueRotation {
        orientation,
        rate_rad_per_s: at.twist.rate_rad_per_s,
        covariance_rad2: covariance.and_then(|covariance| covariance.rotation_rad2),
        with_position: covariance
            .map_or(Matrix3::zeros(), |covariance| covariance.rotation_with_position),
    });
    TruePose {
        time_s: at.pose.time_s,
        position_m: at.pose.position_m,
        velocity_m_per_s: at.twist.velocity_m_per_s,
        rotation,
        covariance_m2: covariance.map(|covariance| covariance.position_m2),
        contradiction_m: None,
    }
}

/// Covariance at an instant. Neighbouring errors are taken as fully correlated: independent ones would have smaller variance.
fn covariance(all: &[PoseCovariance], at: &InterpolatedPose) -> Option<PoseCovariance> {
    let [before, after] = at.between;
    let (before, after) = all.get(before).zip(all.get(after))?;
    let mean = |a: Matrix3<f64>, b: Matrix3<f64>| a * (1.0 - at.share) + b * at.share;
    Some(PoseCovariance {
        position_m2: mean(before.position_m2, after.position_m2),
        rotation_rad2: before.rotation_rad2.zip(after.rotation_rad2).map(|(a, b)| mean(a, b)),
        rotation_with_position: mean(before.rotation_with_position, after.rotation_with_position),
    })
}
