//! Errors of two estimates at common instants, and over paths between these.
//!
//! Two estimates are compared fairly only by the same instants and paths. The relative errors in [`super::metrics`] follow evo
//! instead: their paths are measured along each estimate, so those of two estimates begin and end at different places. Here a
//! path is measured along the ground truth, and each instant is one pose of either estimate, nearest in time. Neither estimate
//! is interpolated, because interpolation averages noise and would favour it.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::delta::Delta;
use super::errors::EpochError;
use resect_core::statistics::median;

/// Largest difference in time of two common instants, relative to the shorter of both usual intervals.
const APART: f64 = 0.75;

/// Errors of two estimates at the same time or over the same path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommonError {
    /// Time, of a path its end (s).
    pub time_s: f64,
    /// Error of each estimate (m or rad).
    pub errors: [Vector3<f64>; 2],
    /// Covariance of the ground truth's own error, which both contain; zero if it states none.
    pub covariance: Matrix3<f64>,
    /// Size of the motion, in the unit of its delta; zero at an instant.
    pub size: f64,
}

/// Pairs the epochs of two estimates that are nearest in time, each used once.
pub fn common_instants<'a>(
    first: &'a [EpochError],
    second: &'a [EpochError],
) -> Vec<[&'a EpochError; 2]> {
    let intervals_s = [first, second].map(|errors| {
        median(errors.windows(2).map(|two| two[1].time_s - two[0].time_s)).unwrap_or(f64::INFINITY)
    });
    let apart_s = APART * intervals_s[0].min(intervals_s[1]);
    // Each epoch of the sparser one has its neighbour in the denser one.
    let is_swapped = intervals_s[0] < intervals_s[1];
    let (sparse, dense) = if is_swapped { (second, first) } else { (first, second) };
    let mut from = 0;
    let mut pairs = Vec::new();
    for epoch in sparse {
        let away_s = |index: usize| (dense[index].time_s - epoch.time_s).abs();
        while from + 1 < dense.len() && away_s(from + 1) <= away_s(from) {
            from += 1;
        }
        if from < dense.len() && away_s(from) <= apart_s {
            let other = &dense[from];
            pairs.push(if is_swapped { [other, epoch] } else { [epoch, other] });
            from += 1;
        }
    }
    pairs
}

/// Absolute errors of positions (m).
pub fn positions(pairs: &[[&EpochError; 2]]) -> Vec<CommonError> {
    let one = |pair: &[&EpochError; 2]| CommonError {
        time_s: pair[0].time_s,
        errors: pair.map(|epoch| epoch.position_m),
        covariance: mean(pair.map(|epoch| epoch.covariance_m2)),
        size: 0.0,
    };
    pairs.iter().map(one).collect()
}

/// Absolute errors of orientations (rad) at the instants at which both have one.
pub fn rotations(pairs: &[[&EpochError; 2]]) -> Vec<CommonError> {
    let one = |pair: &[&EpochError; 2]| {
        Some(CommonError {
            time_s: pair[0].time_s,
            errors: [pair[0].rotation_rad?, pair[1].rotation_rad?],
            covariance: mean(pair.map(|epoch| epoch.covariance_rad2)),
            size: 0.0,
        })
    };
    pairs.iter().filter_map(one).collect()
}

/// Mean of two covariances; zero without one.
fn mean(both: [Option<Matrix3<f64>>; 2]) -> Matrix3<f64> {
    let [first, second] = both;
    first.zip(second).map_or(Matrix3::zeros(), |(first, second)| (first + second) / 2.0)
}

/// Relative errors over one motion: of the position (m) and of the orientation (rad).
pub struct MotionErrors {
    pub position: CommonError,
    /// `None` if an estimate has no orientations. The position's error is then that of the distance between both ends.
    pub rotation: Option<CommonError>,
}

/// Relative errors over consecutive motions of a size. `None` for angles of rotation, which the two do not have in common.
pub fn over_motions(pairs: &[[&EpochError; 2]], delta: Delta) -> Option<Vec<MotionErrors>> {
    let step = |index: usize| {
        let [before, after] = [&pairs[index - 1], &pairs[index]];
        let step_m =
            |which: usize| (after[which].true_position_m - before[which].true_position_m).norm();
        match delta {
            Delta::PathM(_) => Some((step_m(0) + step_m(1)) / 2.0),
            Delta::TimeS(_) => Some(after[0].time_s - before[0].time_s),
            Delta::Frames(_) => Some(1.0),
            Delta::RotationDegrees(_) => None,
        }
    };
    let (mut start, mut size) = (0, 0.0);
    let mut motions = Vec::new();
    for index in 1..pairs.len() {
        size += step(index)?;
        // Sums of stamps miss whole numbers by rounding.
        if size >= delta.value() * (1.0 - 1e-9) {
            motions.push(motion_errors(pairs[start], pairs[index], size));
            (start, size) = (index, 0.0);
        }
    }
    Some(motions)
}

fn motion_errors(start: [&EpochError; 2], end: [&EpochError; 2], size: f64) -> MotionErrors {
    let common = |errors: [Vector3<f64>; 2]| CommonError {
        time_s: end[0].time_s,
        errors,
        // Errors of the ground truth differ from motion to motion, so the scatter of the blocks contains them.
        covariance: Matrix3::zeros(),
        size,
    };
    let turned = |which: usize| {
        let [before, after] = [start[which].rotation_rad?, end[which].rotation_rad?];
        Some([before, after].map(UnitQuaternion::from_scaled_axis))
    };
    let moved_m = |which: usize| {
        let true_m = end[which].true_position_m - start[which].true_position_m;
        [true_m + end[which].position_m - start[which].position_m, true_m]
    };
    let [first_m, second_m] = [moved_m(0), moved_m(1)];
    let Some(turns) = turned(0).zip(turned(1)) else {
        let off_m = |[estimated_m, true_m]: [Vector3<f64>; 2]| {
            Vector3::x() * (estimated_m.norm() - true_m.norm())
        };
        return MotionErrors { position: common([first_m, second_m].map(off_m)), rotation: None };
    };
    let each = [(first_m, turns.0), (second_m, turns.1)];
    MotionErrors {
        // The error of the relative pose up to the true orientations, which leave sizes unchanged.
        position: common(
            each.map(|([estimated_m, true_m], [before, _])| {
                before.inverse() * estimated_m - true_m
            }),
        ),
        rotation: Some(common(
            each.map(|(_, [before, after])| (before.inverse() * after).scaled_axis()),
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn epochs(times_s: impl Iterator<Item = f64>) -> Vec<EpochError> {
        let at = |time_s: f64| EpochError {
            time_s,
            true_position_m: Vector3::new(time_s, 0.0, 0.0),
            position_m: Vector3::new(0.0, 0.1 * time_s, 0.0),
            rotation_rad: Some(Vector3::new(0.0, 0.0, 0.01 * time_s)),
            covariance_m2: None,
            covariance_rad2: None,
            contradiction_m: None,
        };
        times_s.map(at).collect()
    }

    #[test]
    fn instants_are_nearest_in_time_and_used_once() {
        let dense = epochs((0..100).map(|k| f64::from(k) * 0.1));
        let sparse = epochs((0..10).map(|k| f64::from(k) + 0.04));
        for (first, second) in [(&dense, &sparse), (&sparse, &dense)] {
            let pairs = common_instants(first, second);
            assert_eq!(pairs.len(), 10);
            assert!(pairs.iter().all(|[a, b]| (a.time_s - b.time_s).abs() < 0.041));
        }
        // A gap of one has no instants, and nothing else has a common time.
        let with_gap =
            epochs((0..100).filter(|k| !(30..60).contains(k)).map(|k| f64::from(k) * 0.1));
        assert_eq!(common_instants(&dense, &with_gap).len(), 70);
        let later = epochs((0..10).map(|k| 50.0 + f64::from(k)));
        assert!(common_instants(&dense, &later).is_empty());
        assert!(common_instants(&dense, &[]).is_empty());
    }

    #[test]
    fn a_path_has_the_error_of_its_relative_pose() {
        let all = epochs((0..100).map(|k| f64::from(k) * 0.25));
        let pairs = common_instants(&all, &all);
        let paths = over_motions(&pairs, Delta::PathM(5.0)).expect("paths");
        assert_eq!(paths.len(), 4);
        for (index, path) in paths.iter().enumerate() {
            assert_eq!(path.position.size, 5.0);
            let rotation = path.rotation.as_ref().expect("orientations");
            assert!((rotation.errors[0].norm() - 0.05).abs() < 1e-12);
            // The start is turned, so 5 m ahead end up aside as well.
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * (0.05 * index as f64));
            let expected_m = turn.inverse() * Vector3::new(5.0, 0.5, 0.0) - Vector3::x() * 5.0;
            assert!((path.position.errors[1] - expected_m).norm() < 1e-12);
        }
        let mut positions_only = all.clone();
        positions_only.iter_mut().for_each(|epoch| epoch.rotation_rad = None);
        let paths = over_motions(&common_instants(&all, &positions_only), Delta::PathM(5.0))
            .expect("paths");
        assert!(paths.iter().all(|path| path.rotation.is_none()));
        let off_m = paths[0].position.errors[0].norm();
        assert!((off_m - (25.25_f64.sqrt() - 5.0)).abs() < 1e-12, "{off_m}");
    }
}
