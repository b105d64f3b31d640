//! Jumps of a trajectory, in place and in time: poses far from both neighbours, frames that change during the drive, and bursts.

use crate::estimates::pose_interpolation::median_interval_s;
use crate::estimates::trajectory_summary::extent_m;
use resect_core::deployment::EstimatedPose;
use resect_core::statistics::{median, quantiles};

/// A step is a jump if it is this many times as fast as the fastest twentieth, and longer than this (m).
/// Field: loop closures of a lidar odometry move by decimetres; a vehicle does not become five times as fast between two poses.
const TIMES_FASTER: f64 = 5.0;
const SHORTEST_M: f64 = 0.5;
const USUAL: f64 = 0.95;
/// Poses that stay away together are no outliers but a segment in another frame.
const MOST_AWAY: usize = 3;

/// Jumps of a trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jumps {
    /// Poses far from both neighbours.
    pub outliers: usize,
    /// Largest distance of an outlier from the pose before (m), and its time (s).
    pub outlier_m: f64,
    pub outlier_s: f64,
    /// Jumps after which the trajectory continues elsewhere.
    pub resets: usize,
    /// Largest of these (m), and its time (s).
    pub reset_m: f64,
    pub reset_s: f64,
    /// Root mean square distance of all other poses from their mean (m).
    pub extent_m: f64,
}

/// Returns the jumps; `None` without any.
pub fn jumps(poses: &[EstimatedPose]) -> Option<Jumps> {
    let step_m = |from: usize, to: usize| (poses[to].position_m - poses[from].position_m).norm();
    let speed = |two: &[EstimatedPose]| {
        (two[1].position_m - two[0].position_m).norm() / (two[1].time_s - two[0].time_s)
    };
    let [usual_m_per_s] = quantiles(poses.windows(2).map(speed), [USUAL])?;
    let is_jump = |from: usize, to: usize| {
        let usual_m = usual_m_per_s * (poses[to].time_s - poses[from].time_s);
        step_m(from, to) > (TIMES_FASTER * usual_m).max(SHORTEST_M)
    };
    let mut jumps = Jumps {
        outliers: 0,
        outlier_m: 0.0,
        outlier_s: 0.0,
        resets: 0,
        reset_m: 0.0,
        reset_s: 0.0,
        extent_m: 0.0,
    };
    let mut kept: Vec<EstimatedPose> = poses.first().copied().into_iter().collect();
    let mut before = 0;
    let mut index = 1;
    while index < poses.len() {
        if is_jump(before, index) {
            let (jump_m, jump_s) = (step_m(before, index), poses[index].time_s);
            let end = (index + MOST_AWAY + 1).min(poses.len());
            match (index + 1..end).find(|next| !is_jump(before, *next)) {
                Some(next) => {
                    jumps.outliers += next - index;
                    if jump_m > jumps.outlier_m {
                        (jumps.outlier_m, jumps.outlier_s) = (jump_m, jump_s);
                    }
                    index = next;
                }
                None => {
                    jumps.resets += 1;
                    if jump_m > jumps.reset_m {
                        (jumps.reset_m, jumps.reset_s) = (jump_m, jump_s);
                    }
                }
            }
        }
        kept.push(poses[index]);
        before = index;
        index += 1;
    }
    jumps.extent_m = extent_m(&kept);
    (jumps.outliers + jumps.resets > 0).then_some(jumps)
}

/// Poses come in bursts if this share of the intervals is shorter than the second share of the usual one.
const BURST_SHARE: f64 = 0.25;
const SHORT_INTERVAL: f64 = 0.3;

/// Returns the usual interval between poses and the median one within bursts (s); `None` if the poses do not come in bursts.
pub fn bursts_s(poses: &[EstimatedPose]) -> Option<[f64; 2]> {
    let usual_s = median_interval_s(poses);
    let intervals_s = poses.windows(2).map(|two| two[1].time_s - two[0].time_s);
    let short_s: Vec<f64> =
        intervals_s.filter(|interval_s| *interval_s < SHORT_INTERVAL * usual_s).collect();
    let are_bursts = short_s.len() as f64 > BURST_SHARE * poses.len() as f64;
    Some([usual_s, median(short_s)?]).filter(|_| are_bursts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// A drive at 1 m/s and 10 Hz with a jump for the poses of a range.
    fn driven(away: std::ops::Range<usize>, by_m: f64) -> Vec<EstimatedPose> {
        let pose = |index: usize| EstimatedPose {
            time_s: 0.1 * index as f64,
            position_m: Vector3::new(
                0.1 * index as f64,
                if away.contains(&index) { by_m } else { 0.0 },
                0.0,
            ),
            orientation: None,
        };
        (0..400).map(pose).collect()
    }

    #[test]
    fn bursts_have_short_intervals() {
        let mut poses = driven(0..0, 0.0);
        assert_eq!(bursts_s(&poses), None);
        for (index, pose) in poses.iter_mut().enumerate() {
            pose.time_s += if index % 2 == 0 { 0.09 } else { 0.0 };
        }
        let [usual_s, within_s] = bursts_s(&poses).expect("bursts");
        assert!((usual_s - 0.1).abs() < 1e-9 && (within_s - 0.01).abs() < 1e-9);
    }

    #[test]
    fn outliers_return_and_resets_stay() {
        assert_eq!(jumps(&driven(0..0, 0.0)), None);
        assert_eq!(jumps(&driven(200..400, 0.3)), None, "a loop closure");
        let outliers = jumps(&driven(200..202, 9999.0)).expect("outliers");
        assert_eq!((outliers.outliers, outliers.resets), (2, 0));
        assert!((outliers.outlier_s - 20.0).abs() < 1e-9 && outliers.extent_m < 15.0);
        let reset = jumps(&driven(200..400, 20.0)).expect("a reset");
        assert_eq!((reset.outliers, reset.resets), (0, 1));
        assert!((reset.reset_m - 20.0).abs() < 0.1 && (reset.reset_s - 20.0).abs() < 1e-9);
    }
}
