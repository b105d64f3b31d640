//! Copies among the estimates: another rate, other digits, another topic, another clock or frame of one trajectory.
//!
//! Independent estimates differ by their own noise, even if both are right. Copies differ by rounding and interpolation alone.

use nalgebra::{SMatrix, SVector, Vector3};

use super::rounding::rounding_step_m;
use resect_core::deployment::EstimatedPose;
use resect_core::geometry::align_rigid;
use resect_core::statistics::median;

/// Largest number of poses that are compared, and the fewest.
const MOST_POSES: usize = 400;
const FEWEST: usize = 30;
/// Rounding of two trajectories to one step differs by 0.6 steps at most in the median of the lengths in space.
const ROUNDING_STEPS: f64 = 0.6;
/// Floating-point numbers of coordinates in a map grid differ by as much (m).
const EXACT_M: f64 = 1e-6;
/// Linear interpolation between two poses errs by a quarter of the error over the double interval.
const INTERPOLATION_SHARE: f64 = 0.25;
/// Copies are recognised if rounding and interpolation are below this share of the errors. Otherwise independent estimates are as near.
const LARGEST_SHARE: f64 = 0.4;
/// Stamps are equal if they differ by less (s): microseconds are the shortest unit that is in use.
const SAME_STAMP_S: f64 = 2e-6;
/// Poses of one trajectory are interpolated over at most this time (s).
const LONGEST_GAP_S: f64 = 1.0;
/// Half of the span of offsets around that of the fits (s), and the accuracy of the search.
const SEARCH_S: f64 = 0.05;
const SEARCH_STEPS: usize = 24;
/// Steps of the lever arm between two bodies, and the share of the normal matrix that constrains a lever arm which the drive leaves free.
const LEVER_STEPS: usize = 6;
const RIDGE: f64 = 1e-9;

/// An estimate whose copies are looked for.
#[derive(Clone, Copy, Debug)]
pub struct ComparedEstimate<'a> {
    pub poses: &'a [EstimatedPose],
    /// Added to its times by the fit (s).
    pub time_offset_s: f64,
    /// Root mean square error against the ground truth (m).
    pub rmse_m: f64,
}

/// An estimate that is a copy of an earlier one in the list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CopiedEstimate {
    pub original: usize,
    /// Median difference, after an alignment of one to the other (m).
    pub apart_m: f64,
    /// Time of the copy minus that of the original for the same pose (s).
    pub later_s: f64,
}

/// Returns for each estimate the first one of which it is a copy; `None` for sources.
pub fn copies(estimates: &[ComparedEstimate<'_>]) -> Vec<Option<CopiedEstimate>> {
    let mut copies: Vec<Option<CopiedEstimate>> = Vec::new();
    for (index, estimate) in estimates.iter().enumerate() {
        let originals = (0..index).filter(|original| copies[*original].is_none());
        let copy = originals
            .filter_map(|original| copy_of(&estimates[original], estimate, original))
            .next();
        copies.push(copy);
    }
    copies
}

/// Returns the index of the source of each estimate.
pub fn sources(copies: &[Option<CopiedEstimate>]) -> Vec<usize> {
    let source =
        |(index, copy): (usize, &Option<CopiedEstimate>)| copy.map_or(index, |copy| copy.original);
    copies.iter().enumerate().map(source).collect()
}

fn copy_of(
    original: &ComparedEstimate<'_>,
    other: &ComparedEstimate<'_>,
    index: usize,
) -> Option<CopiedEstimate> {
    let error_m = original.rmse_m.min(other.rmse_m);
    let fitted_s = original.time_offset_s - other.time_offset_s;
    for (dense, sparse, sign) in [(original, other, 1.0), (other, original, -1.0)] {
        let pair = Pair { dense: dense.poses, sparse: sparse.poses };
        for start_s in [0.0, sign * fitted_s] {
            let (later_s, apart_m) = match pair.difference_m(start_s) {
                Some(apart_m) if apart_m < pair.tolerance_m(start_s) => (start_s, apart_m),
                _ if error_m < EXACT_M => continue,
                _ => pair.nearest(start_s)?,
            };
            let tolerance_m = pair.tolerance_m(later_s);
            if apart_m < tolerance_m && tolerance_m < LARGEST_SHARE * error_m {
                return Some(CopiedEstimate { original: index, apart_m, later_s: sign * later_s });
            }
        }
    }
    None
}

/// A trajectory that is interpolated at the times of another one.
struct Pair<'a> {
    dense: &'a [EstimatedPose],
    sparse: &'a [EstimatedPose],
}

impl Pair<'_> {
    fn sampled(&self) -> impl Iterator<Item = &EstimatedPose> {
        self.sparse.iter().step_by(self.sparse.len().div_ceil(MOST_POSES).max(1))
    }

    /// Median difference of the positions if the sparse one is later by a time, with a free lever arm between the two
    /// if there are orientations (m); `None` without common times.
    fn difference_m(&self, later_s: f64) -> Option<f64> {
        let common: Vec<(EstimatedPose, Vector3<f64>)> = self
            .sampled()
            .filter_map(|pose| {
                Some((interpolated(self.dense, pose.time_s - later_s)?, pose.position_m))
            })
            .collect();
        if common.len() < FEWEST {
            return None;
        }
        let mut lever_m = Vector3::zeros();
        let mut difference_m = None;
        for _ in 0..LEVER_STEPS {
            let dense_m: Vec<Vector3<f64>> = common
                .iter()
                .map(|(pose, _)| {
                    let arm_m = pose.orientation.map(|orientation| orientation * lever_m);
                    pose.position_m + arm_m.unwrap_or_default()
                })
                .collect();
            let sparse_m: Vec<Vector3<f64>> = common.iter().map(|(_, other_m)| *other_m).collect();
            let transform = align_rigid(&dense_m, &sparse_m)?;
            let residuals_m: Vec<Vector3<f64>> = dense_m
                .iter()
                .zip(&sparse_m)
                .map(|(dense_m, sparse_m)| transform.apply(sparse_m) - dense_m)
                .collect();
            difference_m = median(residuals_m.iter().map(Vector3::norm));
            match lever_step_m(&common, &residuals_m) {
                Some(step_m) if step_m.norm() > EXACT_M => lever_m += step_m,
                _ => break,
            }
        }
        difference_m
    }

    /// Returns the difference of times around a first value at which the difference of the positions is least, and that.
    fn nearest(&self, start_s: f64) -> Option<(f64, f64)> {
        let (mut best_s, mut best_m) = (start_s, self.difference_m(start_s)?);
        let mut step_s = 0.5 * SEARCH_S;
        for _ in 0..SEARCH_STEPS {
            let [earlier_s, later_s] = [best_s - step_s, best_s + step_s];
            let [earlier_m, later_m] = [self.difference_m(earlier_s)?, self.difference_m(later_s)?];
            if earlier_m < best_m && earlier_m <= later_m {
                (best_s, best_m) = (earlier_s, earlier_m);
            } else if later_m < best_m {
                (best_s, best_m) = (later_s, later_m);
            }
            step_s *= 0.5;
        }
        Some((best_s, best_m))
    }

    /// Largest difference by rounding, and by interpolation unless the stamps are equal (m).
    fn tolerance_m(&self, later_s: f64) -> f64 {
        let step_m = rounding_step_m(self.dense).max(rounding_step_m(self.sparse));
        let rounding_m = (ROUNDING_STEPS * step_m).max(EXACT_M);
        let has_stamp = |pose: &&EstimatedPose| {
            let time_s = pose.time_s - later_s;
            let after = self.dense.partition_point(|pose| pose.time_s < time_s - SAME_STAMP_S);
            self.dense.get(after).is_some_and(|pose| pose.time_s <= time_s + SAME_STAMP_S)
        };
        let (all, equal) = (self.sampled().count(), self.sampled().filter(has_stamp).count());
        if 2 * equal > all {
            return rounding_m;
        }
        let bends_m = self.dense.windows(3).map(|three| {
            let share = (three[1].time_s - three[0].time_s) / (three[2].time_s - three[0].time_s);
            (three[1].position_m - three[0].position_m.lerp(&three[2].position_m, share)).norm()
        });
        rounding_m + INTERPOLATION_SHARE * median(bends_m).unwrap_or_default()
    }
}

/// Least-squares change of the lever arm, with the change of the frame that goes with it; `None` without orientations or
/// if the drive does not determine it.
fn lever_step_m(
    common: &[(EstimatedPose, Vector3<f64>)],
    residuals_m: &[Vector3<f64>],
) -> Option<Vector3<f64>> {
    let mut normal = SMatrix::<f64, 9, 9>::zeros();
    let mut right = SVector::<f64, 9>::zeros();
    let centre_m =
        common.iter().map(|(pose, _)| pose.position_m).sum::<Vector3<f64>>() / common.len() as f64;
    for ((pose, _), residual_m) in common.iter().zip(residuals_m) {
        let mut rows = SMatrix::<f64, 3, 9>::zeros();
        let turned = pose.orientation?.to_rotation_matrix();
        rows.fixed_view_mut::<3, 3>(0, 0).copy_from(turned.matrix());
        rows.fixed_view_mut::<3, 3>(0, 3).fill_with_identity();
        rows.fixed_view_mut::<3, 3>(0, 6).copy_from(&(pose.position_m - centre_m).cross_matrix());
        normal += rows.transpose() * rows;
        right += rows.transpose() * residual_m;
    }
    let ridge = RIDGE * normal.trace();
    (0..9).for_each(|k| normal[(k, k)] += ridge);
    Some(normal.cholesky()?.solve(&right).fixed_rows::<3>(0).into_owned())
}

fn interpolated(poses: &[EstimatedPose], time_s: f64) -> Option<EstimatedPose> {
    let after = poses.partition_point(|pose| pose.time_s < time_s);
    let near = |pose: &&EstimatedPose| (pose.time_s - time_s).abs() < SAME_STAMP_S;
    let before = after.checked_sub(1);
    let equal = poses.get(after).filter(near).or_else(|| poses.get(before?).filter(near));
    if let Some(pose) = equal {
        return Some(*pose);
    }
    let (start, end) = (poses.get(before?)?, poses.get(after)?);
    let length_s = end.time_s - start.time_s;
    let share = (time_s - start.time_s) / length_s;
    let orientation = start.orientation.zip(end.orientation);
    (length_s <= LONGEST_GAP_S).then(|| EstimatedPose {
        time_s,
        position_m: start.position_m.lerp(&end.position_m, share),
        orientation: orientation
            .and_then(|(start, end)| start.try_slerp(&end, share, f64::EPSILON).or(Some(start))),
    })
}
