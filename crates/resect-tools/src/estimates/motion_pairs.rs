//! Pairs of poses at both ends of motions of one size, as evo selects them.

use nalgebra::{UnitQuaternion, Vector3};

use super::delta::Delta;

/// Largest relative difference from the size of a motion if all pairs are compared (evo's `--delta_tol`).
const TOLERANCE: f64 = 0.1;
/// Stamps are rounded by less than this (s).
const ROUNDED_S: f64 = 1e-6;
/// Largest number of pairs of one size.
/// Effect: more would need gigabytes, because the pairs of an angle grow with the square of the poses.
const MOST_PAIRS: usize = 10_000_000;

/// Poses of the body at one instant, in the ground truth's frame.
pub struct BothPoses {
    pub time_s: f64,
    pub estimate_m: Vector3<f64>,
    pub truth_m: Vector3<f64>,
    /// Orientations by the estimate and by the ground truth; `None` if one of the two has no orientation.
    pub orientations: Option<[UnitQuaternion<f64>; 2]>,
}

/// Indices of the poses at both ends of a motion, and its size along the estimate in the unit of the delta.
pub struct MotionPair {
    pub ends: [usize; 2],
    pub size: f64,
}

/// Reason why there are no motions of a size.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum NoMotions {
    #[error("the estimate or the ground truth has no orientations")]
    NoOrientation,
    #[error("the compared drive of {driven_m:.1} m is shorter than {delta}")]
    ShortPath { driven_m: f64, delta: Delta },
    #[error("the compared drive of {lasts_s:.1} s is shorter than {delta}")]
    ShortTime { lasts_s: f64, delta: Delta },
    #[error("{poses} compared poses are too few for {delta}")]
    FewPoses { poses: usize, delta: Delta },
    #[error("the compared drive turns by {turned_degrees:.1}°, which is less than {delta}")]
    SmallRotation { turned_degrees: f64, delta: Delta },
    #[error("no two compared poses are {0} apart, up to 10 %")]
    NoPair(Delta),
    #[error("more than ten million pairs of poses are {0} apart; compare them without --all-pairs")]
    ManyPairs(Delta),
}

/// Returns the pairs of poses at both ends of motions of a size: consecutive ones without overlap, or all.
pub fn motion_pairs(
    poses: &[BothPoses],
    delta: Delta,
    all_pairs: bool,
) -> Result<Vec<MotionPair>, NoMotions> {
    let steps: Vec<f64> = match delta {
        Delta::RotationDegrees(degrees) => {
            let orientations: Option<Vec<UnitQuaternion<f64>>> =
                poses.iter().map(|pose| Some(pose.orientations?[0])).collect();
            let orientations = orientations.ok_or(NoMotions::NoOrientation)?;
            if all_pairs {
                return pairs_of_angle(&orientations, degrees);
            }
            orientations.windows(2).map(|two| two[0].angle_to(&two[1]).to_degrees()).collect()
        }
        Delta::PathM(_) => {
            poses.windows(2).map(|two| (two[1].estimate_m - two[0].estimate_m).norm()).collect()
        }
        Delta::TimeS(_) => poses.windows(2).map(|two| two[1].time_s - two[0].time_s).collect(),
        Delta::Frames(_) => vec![1.0; poses.len().saturating_sub(1)],
    };
    if all_pairs { nearest(&steps, delta) } else { consecutive(&steps, delta) }
}

/// Returns motions that follow each other: each ends at the first pose that is far enough, where the next begins.
fn consecutive(steps: &[f64], delta: Delta) -> Result<Vec<MotionPair>, NoMotions> {
    let tolerance = if matches!(delta, Delta::TimeS(_)) { ROUNDED_S } else { 0.0 };
    let (mut start, mut size, mut pairs) = (0, 0.0, Vec::new());
    for (index, step) in steps.iter().enumerate() {
        size += step;
        if size >= delta.value() - tolerance {
            pairs.push(MotionPair { ends: [start, index + 1], size });
            (start, size) = (index + 1, 0.0);
        }
    }
    if pairs.is_empty() {
        return Err(too_short(steps, delta));
    }
    Ok(pairs)
}

/// Returns, for each pose, the motion to the pose whose distance is nearest to the size, if it differs by at most 10 %.
fn nearest(steps: &[f64], delta: Delta) -> Result<Vec<MotionPair>, NoMotions> {
    let size = delta.value();
    let mut sum = 0.0;
    let sums = steps.iter().map(|step| {
        sum += step;
        sum
    });
    let along: Vec<f64> = std::iter::once(0.0).chain(sums).collect();
    let tolerance = match delta {
        Delta::Frames(_) => 0.0,
        _ => TOLERANCE * size,
    };
    let nearest_to = |start: usize| {
        let distance = |end: usize| along[end] - along[start];
        let after = &along[start + 1..];
        let far = start + 1 + after.partition_point(|value| value - along[start] < size);
        // The first of several poses at one distance.
        let before = distance(far - 1);
        let near = start + 1 + after.partition_point(|value| value - along[start] < before);
        let ends =
            [near.min(far), far].into_iter().filter(|end| *end > start && *end < along.len());
        let off = |end: usize| (distance(end) - size).abs();
        let end = ends.min_by(|a, b| off(*a).total_cmp(&off(*b)))?;
        (off(end) <= tolerance).then(|| MotionPair { ends: [start, end], size: distance(end) })
    };
    let pairs: Vec<MotionPair> = (0..steps.len()).filter_map(nearest_to).collect();
    match pairs.is_empty() {
        true if along[steps.len()] >= size => Err(NoMotions::NoPair(delta)),
        true => Err(too_short(steps, delta)),
        false => Ok(pairs),
    }
}

/// Returns all pairs of poses whose orientations differ by an angle (°), up to 10 %, not only neighbouring ones.
fn pairs_of_angle(
    orientations: &[UnitQuaternion<f64>],
    degrees: f64,
) -> Result<Vec<MotionPair>, NoMotions> {
    let delta = Delta::RotationDegrees(degrees);
    let mut pairs = Vec::new();
    for (start, first) in orientations.iter().enumerate() {
        for (offset, second) in orientations[start + 1..].iter().enumerate() {
            let size = first.angle_to(second).to_degrees();
            if (size - degrees).abs() <= TOLERANCE * degrees {
                pairs.push(MotionPair { ends: [start, start + 1 + offset], size });
            }
        }
        if pairs.len() > MOST_PAIRS {
            return Err(NoMotions::ManyPairs(delta));
        }
    }
    if pairs.is_empty() {
        return Err(NoMotions::NoPair(delta));
    }
    Ok(pairs)
}

/// Returns the reason why a drive has no motion of a size, from the steps between its poses.
fn too_short(steps: &[f64], delta: Delta) -> NoMotions {
    let whole = steps.iter().sum();
    match delta {
        Delta::PathM(_) => NoMotions::ShortPath { driven_m: whole, delta },
        Delta::TimeS(_) => NoMotions::ShortTime { lasts_s: whole, delta },
        Delta::Frames(_) => NoMotions::FewPoses { poses: steps.len() + 1, delta },
        Delta::RotationDegrees(_) => NoMotions::SmallRotation { turned_degrees: whole, delta },
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Poses along x at these positions (m), one each 0.1 s, that turn by 10° from one to the next.
    fn poses(x_m: &[f64]) -> Vec<BothPoses> {
        let pose = |(index, x_m): (usize, &f64)| {
            let turn =
                UnitQuaternion::from_euler_angles(0.0, 0.0, index as f64 * 10_f64.to_radians());
            BothPoses {
                time_s: 0.1 * index as f64,
                estimate_m: Vector3::new(*x_m, 0.0, 0.0),
                truth_m: Vector3::zeros(),
                orientations: Some([turn, turn]),
            }
        };
        x_m.iter().enumerate().map(pose).collect()
    }

    fn ends(x_m: &[f64], delta: Delta, all_pairs: bool) -> Vec<[usize; 2]> {
        let pairs = motion_pairs(&poses(x_m), delta, all_pairs).expect("long enough");
        pairs.iter().map(|pair| pair.ends).collect()
    }

    #[test]
    fn consecutive_motions_end_at_the_first_pose_that_is_far_enough() {
        let x_m = [0.0, 0.6, 1.2, 1.2, 1.8, 2.4, 3.0];
        assert_eq!(ends(&x_m, Delta::PathM(1.0), false), [[0, 2], [2, 5]]);
        assert_eq!(ends(&x_m, Delta::Frames(3), false), [[0, 3], [3, 6]]);
        // Three tenths are 0.30000000000000004 s and not less.
        assert_eq!(ends(&x_m, Delta::TimeS(0.3), false), [[0, 3], [3, 6]]);
        assert_eq!(ends(&x_m, Delta::RotationDegrees(15.0), false), [[0, 2], [2, 4], [4, 6]]);
    }

    #[test]
    fn all_pairs_are_within_a_tenth_of_the_size() {
        // The first of two poses at one distance, and none that is off by more than a tenth.
        let x_m = [0.0, 0.5, 1.0, 1.0, 1.55, 3.0];
        assert_eq!(ends(&x_m, Delta::PathM(1.0), true), [[0, 2], [1, 4]]);
        assert_eq!(ends(&x_m, Delta::Frames(4), true), [[0, 4], [1, 5]]);
        assert_eq!(ends(&x_m, Delta::TimeS(0.4), true), [[0, 4], [1, 5]]);
        assert_eq!(ends(&x_m, Delta::RotationDegrees(40.0), true), [[0, 4], [1, 5]]);
    }

    #[test]
    fn missing_motions_have_their_reason() {
        let why = |delta: Delta, all_pairs: bool| {
            let drive = poses(&[0.0, 1.0, 2.0]);
            motion_pairs(&drive, delta, all_pairs).err().map(|why| why.to_string())
        };
        for (delta, all_pairs, reason) in [
            (Delta::PathM(100.0), false, "the compared drive of 2.0 m is shorter than 100 m"),
            (Delta::PathM(100.0), true, "the compared drive of 2.0 m is shorter than 100 m"),
            (Delta::PathM(1.5), true, "no two compared poses are 1.5 m apart, up to 10 %"),
            (Delta::TimeS(5.0), false, "the compared drive of 0.2 s is shorter than 5 s"),
            (Delta::Frames(3), true, "3 compared poses are too few for 3 frames"),
            (
                Delta::RotationDegrees(90.0),
                false,
                "the compared drive turns by 20.0°, which is less than 90°",
            ),
        ] {
            assert_eq!(why(delta, all_pairs).as_deref(), Some(reason));
        }
        let mut without = poses(&[0.0, 1.0]);
        without[1].orientations = None;
        let why = motion_pairs(&without, Delta::RotationDegrees(9.0), false).err();
        assert_eq!(why, Some(NoMotions::NoOrientation));
        assert!(motion_pairs(&[], Delta::PathM(1.0), true).is_err());
    }
}
