//! Gross outliers among the triplets, such as those of a station that followed another prism for a while, and the bias of a
//! least-squares answer by them.

use crate::deployment::findings::outliers::{outliers_left_out, outliers_shift_answer};
use crate::network::{PerStation, Station};
use nalgebra::Vector3;

use super::{CentredTriplets, Minimum, NormalEquations, Parameters, PrismNetwork};
use crate::calibration::gross_error_limit::gross_error_limit_m;
use crate::calibration::{TransformSigma, Verdict};
use crate::deployment::Finding;
use crate::geometry::LevelTransform;
use crate::statistics::median;

/// Ratio of the mean square of all triplets to that of the inliers from which outliers affect least squares.
const LONG_TAIL: f64 = 1.3;
/// An answer without this share of the triplets depends on the selection, and not on the drive.
const TOO_MANY: f64 = 0.2;
/// Shortest run of rejected triplets that is reported (s). A station that follows another prism finds its own again within seconds.
const LONG_RUN_S: f64 = 20.0;
/// Share of rejected triplets in such a run; some outliers fit by chance.
const MOST: f64 = 0.6;
/// Smallest bias that is reported (m); it must also exceed the answer's own σ.
pub const NOTABLE_PULL_M: f64 = 0.002;

/// Returns the indices of the inliers, from the errors of each triplet's distances (m).
pub fn fitting<E: IntoIterator<Item = f64>>(errors_m: impl Iterator<Item = E>) -> Vec<usize> {
    let worst_m: Vec<f64> = errors_m.map(worst).collect();
    let Some(limit_m) = gross_error_limit_m(worst_m.iter().copied()) else { return Vec::new() };
    (0..worst_m.len()).filter(|i| worst_m[*i] < limit_m).collect()
}

fn worst(errors_m: impl IntoIterator<Item = f64>) -> f64 {
    errors_m.into_iter().fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

/// Returns the worst error of each triplet, from the errors of its pairs (m).
fn worst_by_triplet<'a>(
    data: &CentredTriplets,
    errors_m: &'a [f64],
) -> impl Iterator<Item = f64> + use<'a> {
    errors_m.chunks_exact(data.network.pairs.len()).map(|errors_m| worst(errors_m.iter().copied()))
}

/// Returns the triplets that are not gross outliers.
pub fn inliers(data: &CentredTriplets, answer: &Parameters) -> CentredTriplets {
    let errors_m = data.distance_errors_m(answer);
    let errors_m = errors_m.chunks_exact(data.network.pairs.len());
    data.select(&fitting(errors_m.map(|errors_m| errors_m.iter().copied())))
}

/// Returns findings about the outliers that a robust answer rejects; doubts if they are many, or consecutive.
///
/// `kept_s` are the times of the kept triplets (s); `explain` turns a long span of rejected ones (s) into a finding.
pub fn left_out(
    time_s: &[f64],
    kept_s: &[f64],
    explain: impl Fn([f64; 2]) -> Finding,
) -> Vec<(Verdict, Finding)> {
    let count = time_s.len() - kept_s.len();
    if count == 0 {
        return Vec::new();
    }
    let is_many = count as f64 >= TOO_MANY * time_s.len() as f64;
    let verdict = if is_many { Verdict::Weak } else { Verdict::Good };
    let mut doubts = vec![(verdict, outliers_left_out(count, time_s.len(), is_many))];
    if let Some(span_s) = mostly_left_out(time_s, kept_s) {
        doubts.push((Verdict::Weak, explain(span_s)));
    }
    doubts
}

/// Returns the first long span of time in which most triplets were rejected (s); pauses of the recording do not count.
fn mostly_left_out(time_s: &[f64], kept_s: &[f64]) -> Option<[f64; 2]> {
    let step_s = median(time_s.windows(2).map(|both| both[1] - both[0]))?;
    let length = (LONG_RUN_S / step_s).ceil() as usize;
    let mut kept_s = kept_s.iter().peekable();
    let is_out: Vec<bool> =
        time_s.iter().map(|time| kept_s.next_if(|kept| *kept == time).is_none()).collect();
    let most = |from: usize| {
        let out = is_out[from..from + length].iter().filter(|out| **out).count();
        out as f64 > MOST * length as f64
    };
    let starts = 0..(time_s.len() + 1).saturating_sub(length.max(1));
    let first = starts.clone().find(|from| most(*from))?;
    let last = (first..starts.end).take_while(|from| most(*from)).last()?;
    Some([time_s[first], time_s[last + length - 1]])
}

/// Returns the indices of the triplets that fit an answer, from points by station (m, each in its station's frame).
pub fn fitting_triplets(
    points_m: &PerStation<Vec<Vector3<f64>>>,
    station1_from_station: &PerStation<LevelTransform>,
    network: &PrismNetwork,
) -> Vec<usize> {
    let worst_m = worst_errors_m(points_m, station1_from_station, network);
    fitting(worst_m.map(|worst_m| [worst_m]))
}

/// Returns the median of the triplets' worst errors (m); infinite without triplets.
pub fn median_worst_m(
    points_m: &PerStation<Vec<Vector3<f64>>>,
    station1_from_station: &PerStation<LevelTransform>,
    network: &PrismNetwork,
) -> f64 {
    let worst_m = worst_errors_m(points_m, station1_from_station, network);
    median(worst_m).unwrap_or(f64::INFINITY)
}

/// Returns the worst error of each triplet with an answer (m).
fn worst_errors_m(
    points_m: &PerStation<Vec<Vector3<f64>>>,
    station1_from_station: &PerStation<LevelTransform>,
    network: &PrismNetwork,
) -> impl Iterator<Item = f64> {
    let mut placed_m = vec![Vector3::zeros(); points_m.len()];
    (0..points_m[Station::FIRST].len()).map(move |index| {
        let stations = points_m.iter().zip(station1_from_station);
        for (placed_m, (points_m, transform)) in placed_m.iter_mut().zip(stations) {
            *placed_m = transform.apply(&points_m[index]);
        }
        worst(network.errors_m(&placed_m))
    })
}

/// Returns the finding that gross outliers bias a least-squares answer by more than its σ.
///
/// `thinned` are some of the triplets, sufficient for the usual size of their errors.
pub fn pull(
    data: &CentredTriplets,
    thinned: &CentredTriplets,
    answer: &Minimum,
    sigma: Option<&PerStation<TransformSigma>>,
) -> Option<Finding> {
    let some_m = thinned.distance_errors_m(&answer.parameters);
    let limit_m = gross_error_limit_m(worst_by_triplet(thinned, &some_m))?;
    // All triplets are examined only if their mean square shows more than noise: outliers that do not affect it cause no bias.
    let (fitting_m2, count) = some_m
        .iter()
        .filter(|error| error.abs() < limit_m)
        .fold((0.0, 0), |(sum, count), error| (sum + error * error, count + 1));
    let mean_square_m2 = data.mean_square_m2(answer.normal.cost);
    if mean_square_m2 < LONG_TAIL * fitting_m2 / f64::from(count.max(1)) {
        return None;
    }
    let errors_m = data.distance_errors_m(&answer.parameters);
    let is_wild = |(index, worst_m): (usize, f64)| (worst_m >= limit_m).then_some(index);
    let wild: Vec<usize> =
        worst_by_triplet(data, &errors_m).enumerate().filter_map(is_wild).collect();
    if wild.is_empty() || wild.len() > data.len() / 2 {
        return None;
    }
    // One Gauss–Newton step to the answer without them.
    let theirs = NormalEquations::at(&data.select(&wild), &answer.parameters);
    let rest = (&answer.normal.matrix - theirs.matrix).cholesky()?;
    let without = &answer.parameters - rest.solve(&(&answer.normal.gradient - theirs.gradient));
    let (with, without) = (data.transforms(&answer.parameters), data.transforms(&without));
    let (mut pull_m, mut sigmas) = (0.0_f64, 0.0_f64);
    for station in data.network.unknown_stations() {
        let moved = with[station].translation_m - without[station].translation_m;
        pull_m = pull_m.max(moved.norm());
        let sigma_m = sigma.map_or(f64::INFINITY, |sigma| sigma[station].translation_m.norm());
        sigmas = sigmas.max(moved.norm() / sigma_m);
    }
    (pull_m > NOTABLE_PULL_M && sigmas > 1.0).then(|| {
        let largest_m = errors_m.iter().fold(0.0, |worst: f64, e| worst.max(e.abs()));
        outliers_shift_answer(wild.len(), Some(largest_m), pull_m)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::findings::outliers::span_left_out;
    use crate::deployment::kinds;

    #[test]
    fn wild_ones_are_told_from_chords() {
        let mut errors_m = vec![[0.001, -0.002, 0.001]; 30];
        errors_m[4] = [0.0, 0.015, 0.0];
        errors_m[7] = [0.0, 0.0, -0.9];
        let kept = fitting(errors_m.into_iter());
        assert!(kept.contains(&4) && !kept.contains(&7));
        assert_eq!(kept.len(), 29);
        assert!(fitting(std::iter::empty::<[f64; 3]>()).is_empty());
    }

    #[test]
    fn half_a_minute_in_a_row_is_a_doubt_and_as_many_here_and_there_are_not() {
        let time_s: Vec<f64> = (0..4000).map(|i| 100.0 + f64::from(i) * 0.1).collect();
        let verdicts = |kept: &dyn Fn(usize) -> bool| {
            let kept_s = (0..time_s.len()).filter(|i| kept(*i)).map(|i| time_s[i]);
            left_out(&time_s, &kept_s.collect::<Vec<_>>(), |span_s| span_left_out(span_s, 100.0))
        };
        assert!(verdicts(&|_| true).is_empty());
        assert_eq!(verdicts(&|i| i % 13 != 0).iter().map(|d| d.0).max(), Some(Verdict::Good));
        let run = verdicts(&|i| !(600..900).contains(&i));
        assert_eq!(run[1].0, Verdict::Weak);
        assert_eq!(run[1].1.kind, kinds::SPAN_LEFT_OUT);
        let span_s = ["from", "to"].map(|name| run[1].1.value(name).expect("a span").round());
        assert_eq!(span_s, [152.0, 198.0], "{run:?}");
    }
}
