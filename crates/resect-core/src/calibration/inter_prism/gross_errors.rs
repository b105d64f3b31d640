//! Triplets that cannot be right, such as those of a station that followed another prism for a while: which they are, and
//! how far they pull an answer by least squares.

use crate::deployment::findings::outliers::{
    outliers_left_out, outliers_shift_answer, span_left_out,
};
use nalgebra::Vector3;

use super::{CentredTriplets, Minimum, NormalEquations};
use crate::calibration::each_distance_error_m;
use crate::calibration::{TransformSigma, Verdict};
use crate::deployment::Finding;
use crate::geometry::RigidTransform;
use crate::statistics::median;

/// A triplet is wild when one of its distances is off by more than both: bends and stops make 20 mm of chords. Wild ones
/// seem to turn a rig, and so to hold what the drive leaves free: a hundredth of triplets off by 20 mm adds 5e-6 to the
/// smallest eigenvalue.
const WILD_M: f64 = 0.02;
const WILD_TIMES: f64 = 5.0;
/// Mean squares this many times that of the triplets that fit have a tail that least squares feels.
const LONG_TAIL: f64 = 1.3;
/// An answer that leaves out this share of the triplets rests on a choice, and not on the drive.
const TOO_MANY: f64 = 0.2;
/// A station that follows another prism finds its own again within seconds; this (s) is longer.
const LONG_RUN_S: f64 = 20.0;
/// Some of what does not fit fits by chance.
const MOST: f64 = 0.6;
/// A pull is worth a warning when it is more than this (m) and as much as the answer's own σ.
pub const NOTABLE_PULL_M: f64 = 0.002;

/// Instants that are not wild, out of the errors of each one's three distances (m).
pub fn fitting(errors_m: impl Iterator<Item = [f64; 3]>) -> Vec<usize> {
    let worst_m: Vec<f64> = errors_m.map(worst).collect();
    let Some(limit_m) = limit_m(worst_m.iter().copied()) else { return Vec::new() };
    (0..worst_m.len()).filter(|i| worst_m[*i] < limit_m).collect()
}

fn worst(pairs: [f64; 3]) -> f64 {
    pairs.iter().fold(0.0, |worst: f64, error| worst.max(error.abs()))
}

/// What a triplet's worst error must stay below (m).
fn limit_m(worst_m: impl Iterator<Item = f64>) -> Option<f64> {
    Some(WILD_M.max(WILD_TIMES * median(worst_m)?))
}

/// Errors of the three distances of each triplet out of a list of them all.
fn in_triplets(errors_m: &[f64]) -> impl Iterator<Item = [f64; 3]> + '_ {
    errors_m.chunks_exact(3).map(|pairs| [pairs[0], pairs[1], pairs[2]])
}

/// What is said of triplets that a robust answer leaves out as wild; a doubt where they are many, or one after the other.
///
/// `kept_s` are the times of those that it keeps.
pub fn left_out(time_s: &[f64], kept_s: &[f64]) -> Vec<(Verdict, Finding)> {
    let count = time_s.len() - kept_s.len();
    if count == 0 {
        return Vec::new();
    }
    let is_many = count as f64 >= TOO_MANY * time_s.len() as f64;
    let verdict = if is_many { Verdict::Weak } else { Verdict::Good };
    let mut doubts = vec![(verdict, outliers_left_out(count, time_s.len(), is_many))];
    if let Some(span_s) = mostly_left_out(time_s, kept_s) {
        doubts.push((Verdict::Weak, span_left_out(span_s, time_s[0])));
    }
    doubts
}

/// The first long span of time in which most triplets were left out (s); pauses of the recording do not count.
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

/// Triplets that fit an answer, out of points by station (m, each in its station's frame).
pub fn fitting_triplets(
    points_m: &[Vec<Vector3<f64>>; 3],
    station1_from_station: &[RigidTransform; 3],
    inter_prism_m: &[f64; 3],
) -> Vec<usize> {
    fitting(each_distance_error_m(points_m, station1_from_station, inter_prism_m))
}

/// What the wild triplets do to an answer by least squares: a finding where they move it by more than it is certain.
/// `thinned` are some of the triplets, enough to see how large their errors usually are.
pub fn pull(
    data: &CentredTriplets,
    thinned: &CentredTriplets,
    answer: &Minimum,
    sigma: Option<&[TransformSigma; 2]>,
) -> Option<Finding> {
    let some_m = thinned.distance_errors_m(&answer.parameters);
    let limit_m = limit_m(in_triplets(&some_m).map(worst))?;
    // All are looked at only where their mean square says that there is more than noise: wild ones that do not show in it
    // pull nothing.
    let (fitting_m2, count) = some_m
        .iter()
        .filter(|error| error.abs() < limit_m)
        .fold((0.0, 0), |(sum, count), error| (sum + error * error, count + 1));
    let mean_square_m2 = answer.normal.cost / (3 * data.len()) as f64;
    if mean_square_m2 < LONG_TAIL * fitting_m2 / f64::from(count.max(1)) {
        return None;
    }
    let errors_m = data.distance_errors_m(&answer.parameters);
    let is_wild = |(index, pairs): (usize, [f64; 3])| (worst(pairs) >= limit_m).then_some(index);
    let wild: Vec<usize> = in_triplets(&errors_m).enumerate().filter_map(is_wild).collect();
    if wild.is_empty() || wild.len() > data.len() / 2 {
        return None;
    }
    // One step of Gauss–Newton to where the answer would be without them.
    let theirs = NormalEquations::at(&data.select(&wild), &answer.parameters);
    let rest = (answer.normal.matrix - theirs.matrix).cholesky()?;
    let without = answer.parameters - rest.solve(&(answer.normal.gradient - theirs.gradient));
    let (with, without) = (data.transforms(&answer.parameters), data.transforms(&without));
    let (mut pull_m, mut sigmas) = (0.0_f64, 0.0_f64);
    for slot in 0..2 {
        let moved = with[slot + 1].translation_m - without[slot + 1].translation_m;
        pull_m = pull_m.max(moved.norm());
        let sigma_m = sigma.map_or(f64::INFINITY, |sigma| sigma[slot].translation_m.norm());
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
    use crate::deployment::FindingKind;

    #[test]
    fn wild_ones_are_told_from_chords() {
        let mut errors_m = vec![[0.001, -0.002, 0.001]; 30];
        errors_m[4] = [0.0, 0.015, 0.0];
        errors_m[7] = [0.0, 0.0, -0.9];
        let kept = fitting(errors_m.into_iter());
        assert!(kept.contains(&4) && !kept.contains(&7));
        assert_eq!(kept.len(), 29);
        assert!(fitting(std::iter::empty()).is_empty());
    }

    #[test]
    fn half_a_minute_in_a_row_is_a_doubt_and_as_many_here_and_there_are_not() {
        let time_s: Vec<f64> = (0..4000).map(|i| 100.0 + f64::from(i) * 0.1).collect();
        let verdicts = |kept: &dyn Fn(usize) -> bool| {
            let kept_s = (0..time_s.len()).filter(|i| kept(*i)).map(|i| time_s[i]);
            left_out(&time_s, &kept_s.collect::<Vec<_>>())
        };
        assert!(verdicts(&|_| true).is_empty());
        assert_eq!(verdicts(&|i| i % 13 != 0).iter().map(|d| d.0).max(), Some(Verdict::Good));
        let run = verdicts(&|i| !(600..900).contains(&i));
        assert_eq!(run[1].0, Verdict::Weak);
        assert_eq!(run[1].1.kind, FindingKind::SpanLeftOut);
        let span_s = ["from", "to"].map(|name| run[1].1.value(name).expect("a span").round());
        assert_eq!(span_s, [152.0, 198.0], "{run:?}");
    }
}
