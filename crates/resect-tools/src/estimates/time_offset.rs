//! Coarse time offset between two clocks by correlation of speeds, independent of frames and lever arms.

use super::ground_truth::GroundTruth;
use super::pose_interpolation::{PoseInterpolation, median_interval_s};
use nalgebra::Vector3;
use resect_core::deployment::EstimatedPose;
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::vehicle::Instants;
use resect_core::geometry::align_similar;
use resect_core::statistics::{median, quantiles};

/// Rate at which speeds are compared (Hz).
const RATE_HZ: f64 = 10.0;
/// Largest number of speeds: a day. One wrong stamp may be years away.
const MOST_SPEEDS: usize = 864_000;
/// Largest number of products of speeds in a search over all offsets, and of offsets in one by positions.
const MOST_PRODUCTS: u64 = 10_000_000_000;
const MOST_OFFSETS: usize = 100_000;
/// Usual limit of the offset between clocks of one robot (s); GPS and UTC differ by 18 s, TAI and UTC by 37 s.
const USUAL_S: f64 = 60.0;
/// Shortest common time of a lag (s).
const LEAST_COMMON_S: f64 = 10.0;
/// Half of the span over which a speed is computed (s).
const HALF_S: f64 = 0.3;
/// Smallest correlation of speeds that determines an offset.
const LEAST_CORRELATION: f64 = 0.5;

/// Prior standard deviation of the offset from surveyed points (s): clocks of one robot are synchronised to that, and the
/// offset is searched in steps of that size. It decides only where the estimate stands still at the points.
const POINTS_SIGMA_S: f64 = 0.25;

/// Coarse offset to add to the estimate's times.
#[derive(Clone, Debug, PartialEq)]
pub struct CoarseOffset {
    pub offset_s: f64,
    /// Prior standard deviation (s); `None` if the ground truth is dense enough for its speeds.
    pub sigma_s: Option<f64>,
    /// Offsets at which the speeds fit not significantly worse (s).
    pub rivals_s: Vec<f64>,
}

/// Returns the offset to add to the estimate's times (s), to a tenth of a second. It is zero if speeds do not determine it but
/// the times overlap, and `None` if they do not overlap either.
pub fn coarse(
    poses: &[EstimatedPose],
    truth: &GroundTruth<'_>,
) -> Result<Option<CoarseOffset>, NoTrajectory> {
    match truth {
        GroundTruth::Deployment { .. } => {
            let truths = truth.at(Instants::Rate(RATE_HZ))?;
            let (Some(first), Some(last)) = (truths.first(), truths.last()) else {
                return Ok(None);
            };
            let from_s = first.time_s;
            let mut known = vec![None; ((last.time_s - from_s) * RATE_HZ) as usize + 2];
            for truth in &truths {
                let at = ((truth.time_s - from_s) * RATE_HZ).round() as usize;
                known[at] = Some(truth.velocity_m_per_s.norm());
            }
            Ok(by_speeds(poses, [from_s, last.time_s], &known))
        }
        GroundTruth::Trajectory(truth, _) => {
            let truth = &truth.poses[..];
            if median_interval_s(truth) > HALF_S || median_interval_s(poses) > HALF_S {
                let sigma_s = Some(POINTS_SIGMA_S);
                let of_points =
                    |offset_s: f64| CoarseOffset { offset_s, sigma_s, rivals_s: Vec::new() };
                return Ok(by_positions(poses, truth).map(of_points));
            }
            let (Some(first), Some(last)) = (truth.first(), truth.last()) else {
                return Ok(None);
            };
            Ok(by_speeds(poses, [first.time_s, last.time_s], &speeds(truth)))
        }
    }
}

/// Correlation of the speeds of two prisms of one vehicle: above the first, their clocks agree; above the second at another time,
/// they do not.
const CLOCKS_AGREE: f64 = 0.6;
const CLOCKS_DIFFER: f64 = 0.8;

/// Returns the offset to add to the first times (s) at which the speeds of two prisms of one vehicle match, within a minute; `None`
/// if they match as they are, or nowhere.
pub fn offset_by_speeds_s(poses: &[EstimatedPose], known: &[EstimatedPose]) -> Option<f64> {
    let (own, beside) = (limited(speeds(poses)), limited(speeds(known)));
    let zero = ((poses.first()?.time_s - known.first()?.time_s) * RATE_HZ).round() as i64;
    if correlation(&own, &beside, zero).is_none_or(|alike| alike > CLOCKS_AGREE) {
        return None;
    }
    let usual = (USUAL_S * RATE_HZ) as i64;
    let (alike, lag) = (-usual..=usual)
        .filter_map(|lag| Some((correlation(&own, &beside, zero + lag)?, lag)))
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    (alike > CLOCKS_DIFFER).then_some(lag as f64 / RATE_HZ)
}

/// Limits speeds to their 90 % quantile: raw readings have outliers.
fn limited(mut speeds: Vec<Option<f64>>) -> Vec<Option<f64>> {
    if let Some([most]) = quantiles(speeds.iter().copied().flatten(), [0.9]) {
        speeds.iter_mut().flatten().for_each(|speed| *speed = speed.min(most));
    }
    speeds
}

/// Step of the offsets that are compared by positions (s), and the largest number of points.
const STEP_S: f64 = 0.25;
const MOST_POINTS: usize = 50;
/// An offset replaces zero if the positions fit this many times better.
const TIMES_BETTER: f64 = 2.0;
/// Smallest share of the points that has poses at an offset.
const LEAST_SHARE: f64 = 0.7;

/// Returns the offset at which the positions fit best: surveyed points have no speed.
fn by_positions(poses: &[EstimatedPose], truth: &[EstimatedPose]) -> Option<f64> {
    let curve = PoseInterpolation::new(poses);
    let points: Vec<&EstimatedPose> =
        truth.iter().step_by(truth.len().div_ceil(MOST_POINTS).max(1)).collect();
    let misfit_m = |offset_s: f64| {
        let pairs: Vec<(Vector3<f64>, Vector3<f64>)> = points
            .iter()
            .filter_map(|point| {
                Some((point.position_m, curve.at(point.time_s - offset_s)?.pose.position_m))
            })
            .collect();
        let (truth_m, own_m): (Vec<_>, Vec<_>) = pairs.into_iter().unzip();
        if (truth_m.len() as f64) < LEAST_SHARE * points.len() as f64 || truth_m.len() < 4 {
            return None;
        }
        let (transform, scale) = align_similar(&truth_m, &own_m)?;
        let off_m =
            |(a, b): (&Vector3<f64>, &Vector3<f64>)| (a - transform.apply(&(b * scale))).norm();
        median(truth_m.iter().zip(&own_m).map(off_m))
    };
    let best = |from_s: f64, to_s: f64| {
        let steps = (((to_s - from_s) / STEP_S) as usize).min(MOST_OFFSETS);
        let offsets = (0..=steps).map(|step| from_s + step as f64 * STEP_S);
        offsets
            .filter_map(|offset_s| Some((misfit_m(offset_s)?, offset_s)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
    };
    if let Some(at_zero_m) = misfit_m(0.0) {
        let near = best(-USUAL_S, USUAL_S).filter(|(off_m, _)| TIMES_BETTER * off_m < at_zero_m);
        return Some(near.map_or(0.0, |(_, offset_s)| offset_s));
    }
    let (first, last) = (poses.first()?, poses.last()?);
    let (from_s, to_s) = (truth.first()?.time_s, truth.last()?.time_s);
    best(from_s - last.time_s, to_s - first.time_s).map(|(_, offset_s)| offset_s)
}

/// Shortest time between two offsets that are rivals (s), and their largest number.
const RIVALS_APART_S: f64 = 1.0;
const MOST_RIVALS: usize = 8;
/// Time within which speeds change (s), for the number of independent ones.
const INDEPENDENT_S: f64 = 2.0;
/// Difference of two correlations, in σ, that decides between two offsets.
/// Effect: a smaller one takes a chance match for the offset. Textbook: 3 σ.
const DECISIVE_SIGMAS: f64 = 3.0;
/// Largest of the correlations at all offsets by chance, in σ. Textbook: of 600, 4 σ are exceeded once in fifty times.
const CHANCE_SIGMAS: f64 = 4.0;

/// Returns the offset at which the speeds correlate best. The known speeds are at even steps from the start of the span (s).
fn by_speeds(
    poses: &[EstimatedPose],
    [from_s, to_s]: [f64; 2],
    known: &[Option<f64>],
) -> Option<CoarseOffset> {
    let (first, last) = (poses.first()?, poses.last()?);
    let overlap =
        |offset_s: f64| (last.time_s + offset_s).min(to_s) - (first.time_s + offset_s).max(from_s);
    let speeds = speeds(poses);
    // A lag of whole steps aligns the estimate's first sample with one of the truth's.
    let zero = ((first.time_s - from_s) * RATE_HZ).round();
    let usual = (USUAL_S * RATE_HZ) as i64;
    let near = -usual..=usual;
    let far = -(speeds.len() as i64)..=known.len() as i64;
    let all = |lags: std::ops::RangeInclusive<i64>, zero: i64| -> Vec<(f64, i64)> {
        lags.filter_map(|lag| Some((correlation(&speeds, known, zero + lag)?, lag))).collect()
    };
    let common = speeds.len().min(known.len());
    let is_overlapping = overlap(0.0) > -USUAL_S;
    let near = if is_overlapping { best_of(&all(near, zero as i64), common) } else { None };
    let coarse = |(_, lag, rivals): (f64, i64, Vec<i64>), later_s: f64| {
        let offset_s = |lag: i64| later_s + lag as f64 / RATE_HZ;
        CoarseOffset {
            offset_s: offset_s(lag),
            sigma_s: None,
            rivals_s: rivals.into_iter().map(offset_s).collect(),
        }
    };
    // The largest of hundreds of correlations by chance is large if few speeds are independent.
    let by_chance = (CHANCE_SIGMAS / (independent(common) - 3.0).max(1.0).sqrt()).tanh();
    match near {
        Some(best) if best.0 > LEAST_CORRELATION.max(by_chance) => Some(coarse(best, 0.0)),
        Some((alike, lag, mut rivals)) if overlap(0.0) > LEAST_COMMON_S => {
            if lag.abs() >= (RIVALS_APART_S * RATE_HZ) as i64 {
                rivals.push(0);
            }
            Some(coarse((alike, lag, rivals), 0.0))
        }
        _ if overlap(0.0) > LEAST_COMMON_S => Some(coarse((0.0, 0, Vec::new()), 0.0)),
        // The stamps have different origins.
        _ if (speeds.len() as u64).saturating_mul(known.len() as u64) > MOST_PRODUCTS => None,
        _ => best_of(&all(far, 0), common)
            .filter(|best| best.0 > LEAST_CORRELATION.max(by_chance))
            .map(|best| coarse(best, from_s - first.time_s)),
    }
}

/// Number of independent ones among speeds.
fn independent(speeds: usize) -> f64 {
    speeds as f64 / (INDEPENDENT_S * RATE_HZ)
}

/// Returns the largest correlation with its lag, and the lags of maxima that are not significantly smaller; `common` is the number of
/// speeds that both have.
fn best_of(all: &[(f64, i64)], common: usize) -> Option<(f64, i64, Vec<i64>)> {
    let (alike, lag) = *all.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let apart = (RIVALS_APART_S * RATE_HZ) as i64;
    let fisher = |alike: f64| alike.clamp(-0.999, 0.999).atanh();
    // Fisher's transform of a correlation has the variance 1 / (n − 3).
    let sigma = (2.0 / (independent(common) - 3.0).max(1.0)).sqrt();
    let mut maxima: Vec<(f64, i64)> = all
        .windows(3)
        .filter(|three| three[1].0 >= three[0].0 && three[1].0 > three[2].0)
        .map(|three| three[1])
        .filter(|(other, _)| fisher(alike) - fisher(*other) < DECISIVE_SIGMAS * sigma)
        .collect();
    maxima.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut rivals: Vec<i64> = Vec::new();
    for (_, other) in maxima {
        let is_apart = |known: &i64| (known - other).abs() >= apart;
        if rivals.len() < MOST_RIVALS && is_apart(&lag) && rivals.iter().all(is_apart) {
            rivals.push(other);
        }
    }
    Some((alike, lag, rivals))
}

/// Speeds of the estimate (m/s) at even steps from its first time; `None` without poses nearby.
fn speeds(poses: &[EstimatedPose]) -> Vec<Option<f64>> {
    let (Some(first), Some(last)) = (poses.first(), poses.last()) else { return Vec::new() };
    let count = (((last.time_s - first.time_s) * RATE_HZ) as usize).min(MOST_SPEEDS) + 1;
    let place = |time_s: f64| {
        let after = poses.partition_point(|pose| pose.time_s < time_s);
        let (a, b) = (poses.get(after.checked_sub(1)?)?, poses.get(after)?);
        let length_s = b.time_s - a.time_s;
        let share = (time_s - a.time_s) / length_s;
        (length_s < 2.0 * HALF_S).then(|| a.position_m.lerp(&b.position_m, share))
    };
    (0..count)
        .map(|step| {
            let time_s = first.time_s + step as f64 / RATE_HZ;
            Some((place(time_s + HALF_S)? - place(time_s - HALF_S)?).norm() / (2.0 * HALF_S))
        })
        .collect()
}

/// Correlation of the speeds; the truth's index of the estimate's first speed is `first`.
fn correlation(own: &[Option<f64>], known: &[Option<f64>], first: i64) -> Option<f64> {
    let from = (-first).max(0) as usize;
    let beside = known.get((first + from as i64) as usize..)?;
    let (mut n, mut sums, mut squares, mut product) = (0.0, [0.0; 2], [0.0; 2], 0.0);
    for (a, b) in own.get(from..)?.iter().zip(beside) {
        let (Some(a), Some(b)) = (a, b) else { continue };
        n += 1.0;
        sums[0] += a;
        sums[1] += b;
        squares[0] += a * a;
        squares[1] += b * b;
        product += a * b;
    }
    if n < LEAST_COMMON_S * RATE_HZ {
        return None;
    }
    let spread = |k: usize| squares[k] - sums[k] * sums[k] / n;
    let size = (spread(0) * spread(1)).sqrt();
    // A longer common time has more weight, because short segments correlate by chance.
    let share = n / own.len().min(known.len()) as f64;
    (size > 0.0).then(|| (product - sums[0] * sums[1] / n) / size * share.min(1.0).sqrt())
}
