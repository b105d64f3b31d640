//! Cubic interpolation of a trajectory in time, within its gaps.

use nalgebra::{UnitQuaternion, Vector3};

use super::matched_pose::PoseTwist;
use resect_core::deployment::EstimatedPose;
use resect_core::statistics::median;

/// Poses further apart than this multiple of the median interval, and than this time (s), have a gap between them.
const GAP_INTERVALS: f64 = 3.5;
const SHORTEST_GAP_S: f64 = 0.25;
/// Halves of the time over which velocities are computed (s): the first one within which there are poses on both sides.
/// Effect: over shorter times noise of the positions counts as motion, and the time offset converges slowly with a small σ.
const HALVES_S: [f64; 3] = [0.25, 0.15, 0.05];

/// A trajectory that is interpolated.
///
/// Between two poses, positions and rotation vectors follow a cubic Hermite polynomial whose slopes are the quadratic ones of
/// neighbouring poses (Catmull & Rom 1974, for uneven times). The error is of fourth order in the interval.
pub struct PoseInterpolation<'a> {
    poses: &'a [EstimatedPose],
    /// Indices of the poses between which is interpolated.
    knots: Vec<usize>,
    longest_gap_s: f64,
}

/// Least time between two knots, as a share of the usual interval. Nearer poses came together in a burst or twice.
/// Effect: with a smaller share, the noise of two near poses becomes a large velocity beside them.
const LEAST_APART: f64 = 0.3;

/// A pose between two others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InterpolatedPose {
    pub pose: EstimatedPose,
    pub twist: PoseTwist,
    /// Indices of the poses before and after, and the share of the interval between them (0 to 1).
    pub between: [usize; 2],
    pub share: f64,
}

impl InterpolatedPose {
    /// Returns a pose of the trajectory itself. Its motion is unknown.
    pub fn at_pose(poses: &[EstimatedPose], index: usize) -> Self {
        Self { pose: poses[index], twist: PoseTwist::default(), between: [index; 2], share: 0.0 }
    }
}

/// Number of intervals of which the mean counts, so that poses in bursts have their usual rate.
const INTERVALS: usize = 8;

/// Median time between poses (s), each the mean of some consecutive intervals; 0 with fewer than two poses.
pub fn median_interval_s(poses: &[EstimatedPose]) -> f64 {
    let intervals = if poses.len() > 4 * INTERVALS { INTERVALS } else { 1 };
    let means = poses
        .windows(intervals + 1)
        .map(|poses| (poses[intervals].time_s - poses[0].time_s) / intervals as f64);
    median(means).unwrap_or_default()
}

impl<'a> PoseInterpolation<'a> {
    /// The poses are in strictly increasing order of time.
    pub fn new(poses: &'a [EstimatedPose]) -> Self {
        let usual_s = median_interval_s(poses);
        let mut knots: Vec<usize> = Vec::with_capacity(poses.len());
        for (index, pose) in poses.iter().enumerate() {
            let is_apart =
                |before: &usize| pose.time_s - poses[*before].time_s >= LEAST_APART * usual_s;
            if knots.last().is_none_or(is_apart) || index + 1 == poses.len() {
                knots.push(index);
            }
        }
        Self { poses, knots, longest_gap_s: (GAP_INTERVALS * usual_s).max(SHORTEST_GAP_S) }
    }

    /// Returns the pose and its motion at a time (s); `None` outside the trajectory and in its gaps.
    pub fn at(&self, time_s: f64) -> Option<InterpolatedPose> {
        let (between, pose) = self.between(time_s)?;
        let [start, end] = between.map(|index| self.poses[index].time_s);
        let beside =
            |half_s: f64| [time_s - half_s, time_s + half_s].map(|at_s| self.between(at_s));
        let both = HALVES_S.iter().find_map(|half_s| {
            let [earlier, later] = beside(*half_s);
            Some([earlier?.1, later?.1])
        });
        let [earlier, later] = both.unwrap_or_else(|| {
            beside(HALVES_S[HALVES_S.len() - 1]).map(|beside| beside.map_or(pose, |(_, pose)| pose))
        });
        let length_s = later.time_s - earlier.time_s;
        let mut twist = PoseTwist::default();
        if length_s > 0.0 {
            twist.velocity_m_per_s = (later.position_m - earlier.position_m) / length_s;
            if let (Some(from), Some(to)) = (earlier.orientation, later.orientation) {
                twist.rate_rad_per_s = (to * from.inverse()).scaled_axis() / length_s;
            }
        }
        let share = (time_s - start) / (end - start);
        Some(InterpolatedPose { pose, twist, between, share })
    }

    /// Returns the pose at a time (s) without its motion; `None` outside the trajectory and in its gaps.
    pub fn pose_at(&self, time_s: f64) -> Option<EstimatedPose> {
        self.between(time_s).map(|(_, pose)| pose)
    }

    /// Returns the indices of the poses before and after, and the interpolated pose.
    fn between(&self, time_s: f64) -> Option<([usize; 2], EstimatedPose)> {
        let (poses, knots) = (self.poses, &self.knots);
        let after = knots.partition_point(|index| poses[*index].time_s <= time_s);
        let after =
            if after == knots.len() && poses.last()?.time_s == time_s { after - 1 } else { after };
        let before = after.checked_sub(1)?;
        let between = [*knots.get(before)?, *knots.get(after)?];
        let [start, end] = between.map(|index| &poses[index]);
        if end.time_s - start.time_s > self.longest_gap_s {
            return None;
        }
        let neighbour = |index: Option<usize>, beside: &EstimatedPose| {
            let pose = &poses[*knots.get(index?)?];
            ((pose.time_s - beside.time_s).abs() <= self.longest_gap_s).then_some(pose)
        };
        let earlier = neighbour(before.checked_sub(1), start);
        let later = neighbour(Some(after + 1), end);
        let knots = [earlier, Some(start), Some(end), later];
        let along = |value: &dyn Fn(&EstimatedPose) -> Vector3<f64>| {
            cubic(knots.map(|knot| knot.map(|pose| (pose.time_s, value(pose)))), time_s)
        };
        let position_m = start.position_m + along(&|pose| pose.position_m - start.position_m);
        let orientation = start.orientation.zip(end.orientation).map(|(first, _)| {
            let turn = along(&|pose| {
                let turn = pose.orientation.map(|own| first.inverse() * own);
                turn.map_or(Vector3::zeros(), |turn| turn.scaled_axis())
            });
            first * UnitQuaternion::from_scaled_axis(turn)
        });
        Some((between, EstimatedPose { time_s, position_m, orientation }))
    }
}

/// Value at a time between the second and third of four knots (time, value); the outer ones may be missing.
fn cubic(knots: [Option<(f64, Vector3<f64>)>; 4], time_s: f64) -> Vector3<f64> {
    let [earlier, Some((start_s, start)), Some((end_s, end)), later] = knots else {
        return Vector3::zeros();
    };
    let length_s = end_s - start_s;
    let slope = (end - start) / length_s;
    // Derivative at the common knot of two intervals: that of the parabola through the three knots.
    let between = |own: Vector3<f64>, own_s: f64, other: Vector3<f64>, other_s: f64| {
        (own * other_s + other * own_s) / (own_s + other_s)
    };
    let from = earlier.map_or(slope, |(time_s, value)| {
        let other_s = start_s - time_s;
        between(slope, length_s, (start - value) / other_s, other_s)
    });
    let to = later.map_or(slope, |(time_s, value)| {
        let other_s = time_s - end_s;
        between(slope, length_s, (value - end) / other_s, other_s)
    });
    let u = (time_s - start_s) / length_s;
    let (u2, u3) = (u * u, u * u * u);
    start * (2.0 * u3 - 3.0 * u2 + 1.0)
        + end * (3.0 * u2 - 2.0 * u3)
        + (from * (u3 - 2.0 * u2 + u) + to * (u3 - u2)) * length_s
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A circle of 2 m radius at 1 rad/s, with a rotation about z.
    fn circle(time_s: f64) -> EstimatedPose {
        EstimatedPose {
            time_s,
            position_m: Vector3::new(5e6 + 2.0 * time_s.cos(), 2.0 * time_s.sin(), 0.1 * time_s),
            orientation: Some(UnitQuaternion::from_scaled_axis(Vector3::z() * time_s)),
        }
    }

    #[test]
    fn a_curve_is_followed_to_hundredths_of_a_millimetre_and_gaps_are_none() {
        let times_s = (0..60).map(|i| 0.1 * f64::from(i) + 0.01 * f64::from(i % 3));
        let poses: Vec<EstimatedPose> =
            times_s.filter(|t| !(3.0..4.0).contains(t)).map(circle).collect();
        let curve = PoseInterpolation::new(&poses);
        for step in 10..50 {
            let time_s = 0.0537 + 0.05 * f64::from(step);
            let found = curve.at(time_s).expect("within the trajectory");
            let truth = circle(time_s);
            let off_m = (found.pose.position_m - truth.position_m).norm();
            assert!(off_m < 5e-5, "{time_s}: {off_m}");
            let turn = found.pose.orientation.expect("turned").inverse()
                * truth.orientation.expect("turned");
            assert!(turn.angle() < 1e-5, "{time_s}: {}", turn.angle());
            // The mean over the time of the difference: of a circle, shorter by sin h / h.
            let off = HALVES_S.map(|half_s| {
                let mean = half_s.sin() / half_s;
                let [sin, cos] = [time_s.sin(), time_s.cos()].map(|value| 2.0 * mean * value);
                (found.twist.velocity_m_per_s - Vector3::new(-sin, cos, 0.1)).norm()
            });
            assert!(off.iter().any(|off| *off < 0.003), "{time_s} {off:?}");
            assert!((found.twist.rate_rad_per_s - Vector3::z()).norm() < 0.01, "{found:?}");
        }
        assert_eq!(curve.at(3.5), None);
        assert_eq!(curve.at(-0.1), None);
        assert_eq!(curve.at(7.0), None);
        let last = poses[poses.len() - 1];
        assert_eq!(curve.at(last.time_s).map(|found| found.pose.time_s), Some(last.time_s));
    }
}
