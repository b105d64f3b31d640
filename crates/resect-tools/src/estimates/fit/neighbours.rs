//! Orientation and motion of an epoch by the epochs before and after, whose noise is independent of its own.
//!
//! One trajectory is interpolated at the times of the other, which averages its noise most between two poses. With the velocity of the interpolated
//! one, the clock would go there: on a smooth drive with equal stamps it was off by 0.4 intervals. So the velocity is that of both, each as
//! far as it is smoother than the other.

use nalgebra::{UnitQuaternion, Vector3};

use crate::estimates::matched_pose::{MatchedPose, PoseTwist};
use resect_core::statistics::median;

/// Orientation and motion of an epoch by the epochs before and after.
#[derive(Clone, Copy, Default)]
pub struct Neighbours {
    /// Orientation of the estimate.
    pub orientation: Option<UnitQuaternion<f64>>,
    /// Motion of the trajectory that is not interpolated, in its own frame.
    pub twist: Option<PoseTwist>,
}

/// Longest time between the neighbours of an epoch (s), between which the body hardly turns otherwise than steadily.
/// Effect: a longer one makes orientations between them useless, a shorter one leaves the noise of sparse poses in the information.
const LONGEST_BETWEEN_S: f64 = 1.0;
/// Time between the neighbours by which the motion is computed, if there are so many (s).
/// Effect: over a shorter time noise counts as motion, over a longer one fast motions are lost.
const MOTION_S: f64 = 0.5;

impl Neighbours {
    /// Returns what the neighbours of an epoch say of it; nothing if they are not near.
    pub fn at(pairs: &[MatchedPose], number: usize) -> Self {
        let beside = |count: usize, longest_s: f64| {
            let (before, after) = (number.checked_sub(count)?, number + count);
            let two = [pairs.get(before)?, pairs.get(after)?];
            (two[1].truth.time_s - two[0].truth.time_s <= longest_s).then_some(two)
        };
        let Some(near) = beside(1, LONGEST_BETWEEN_S) else { return Self::default() };
        let far = (2..).map_while(|count| beside(count, MOTION_S)).last().unwrap_or(near);
        let [before_s, after_s] = near.map(|pair| pair.truth.time_s);
        let share = (pairs[number].truth.time_s - before_s) / (after_s - before_s);
        let [before, after] = near.map(|pair| pair.pose.orientation);
        let orientation =
            before.zip(after).and_then(|(from, to)| from.try_slerp(&to, share, f64::EPSILON));
        Self { orientation, twist: Some(twist(far)) }
    }
}

/// Noise of the interpolated trajectory counts this many times, because it moves the clock as well.
/// Field: speeds on legged_room00 of FusionPortable say 2915 ± 20 ms; with 1 the offset is 2846 ± 27 ms, with 10 it is 2866 ± 27 ms.
/// Simulated: without the interpolated one, noise of 5 mm against 1 mm makes the offset a quarter less accurate.
const TIMES: f64 = 10.0;

/// Returns the share of the trajectory that is not interpolated in the best mean of both velocities, by the noise of each. The third
/// differences of consecutive positions show it: there the motion is small, and the same in both.
pub fn share_of_stamped(pairs: &[MatchedPose]) -> f64 {
    let square = |position_m: fn(&MatchedPose) -> Vector3<f64>| {
        let thirds = pairs.windows(4).map(|four| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|index| position_m(&four[index]));
            (d - a + 3.0 * (b - c)).norm()
        });
        median(thirds).unwrap_or_default().powi(2)
    };
    let by_truth = square(|pair| pair.truth.position_m);
    let by_estimate = square(|pair| pair.pose.position_m);
    let is_interpolated = pairs.first().is_some_and(|pair| pair.pose_twist.is_some());
    let [stamped, interpolated] =
        if is_interpolated { [by_truth, by_estimate] } else { [by_estimate, by_truth] };
    let sum = stamped + TIMES * interpolated;
    if sum > 0.0 { TIMES * interpolated / sum } else { 1.0 }
}

/// Motion between two epochs by the trajectory that is not interpolated.
fn twist(two: [&MatchedPose; 2]) -> PoseTwist {
    let [(from_s, from_m, from), (to_s, to_m, to)] =
        two.map(|MatchedPose { pose, truth, pose_twist }| {
            let true_orientation = truth.rotation.as_ref().map(|rotation| rotation.orientation);
            match pose_twist {
                Some(_) => (truth.time_s, truth.position_m, true_orientation),
                None => (truth.time_s, pose.position_m, pose.orientation),
            }
        });
    let turned = from.zip(to).map(|(from, to)| (to * from.inverse()).scaled_axis());
    PoseTwist {
        velocity_m_per_s: (to_m - from_m) / (to_s - from_s),
        rate_rad_per_s: turned.unwrap_or_default() / (to_s - from_s),
    }
}
