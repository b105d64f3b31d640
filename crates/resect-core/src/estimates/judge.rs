//! Judgement of estimates against the ground truth.

use super::errors::{self, EpochError};
use super::estimate::{Estimate, names};
use super::fit::{self, Fit};
use super::metrics::{self, Ape, RelativeErrors};
use super::odd::{self, OddOne, OddSpan};
use super::options::{Alignment, Options};
use super::ranking::{self, Comparison};
use super::reference::{Reference, True, matched, sound};
use super::unjudged::Unjudged;
use crate::analysis::Analysis;
use crate::deployment::Deployment;

/// An estimate beside the ground truth.
#[derive(Clone, Debug)]
pub struct Judged {
    pub estimate: Estimate,
    pub alignment: Alignment,
    pub fit: Fit,
    /// In order of time, each of a pose where there is ground truth.
    pub errors: Vec<EpochError>,
    /// Poses at whose time there is no ground truth: before, after, and in its gaps.
    pub without_truth: usize,
    pub position: Ape,
    /// Angles between orientations (rad); `None` without orientations.
    pub rotation: Option<Ape>,
    /// Over paths of these lengths, the shortest first; none without orientations.
    pub relative: Vec<RelativeErrors>,
    pub against_sigma: errors::AgainstSigma,
    /// Where the estimate and the ground truth contradict each other, in order of time.
    pub odd: Vec<OddSpan>,
}

impl Judged {
    /// The times of poses at which there is no ground truth, in the ground truth's time (s).
    fn times_without_truth_s(&self) -> Vec<f64> {
        let all_s = self.estimate.poses.iter().map(|pose| pose.time_s + self.fit.time_offset_s);
        let mut with = self.errors.iter().map(|error| error.time_s).peekable();
        all_s.filter(|time_s| with.next_if(|with_s| with_s <= time_s).is_none()).collect()
    }
}

/// All estimates, and what they say about each other.
#[derive(Clone, Debug)]
pub struct Judgement {
    pub judged: Vec<Judged>,
    /// Each two of them by position, the better one first.
    pub comparisons: Vec<Comparison>,
    /// The names of estimates that could not be judged, and why.
    pub unjudged: Vec<(String, Unjudged)>,
}

/// Lengths of path over which relative errors are told (m).
pub const RELATIVE_M: [f64; 4] = [1.0, 5.0, 20.0, 100.0];

/// Holds estimates against the deployment's own trajectory by its answer, each as its options say.
pub fn judge(
    deployment: &Deployment,
    analysis: &Analysis,
    estimates: Vec<(Estimate, Options)>,
) -> Judgement {
    let reference = Reference::new(deployment, analysis);
    let mut compared: Vec<Compared> = Vec::new();
    let mut unjudged = Vec::new();
    let names = names(estimates.iter().map(|(estimate, _)| estimate));
    for ((mut estimate, options), name) in estimates.into_iter().zip(names) {
        estimate.name.clone_from(&name);
        match judge_one(&reference, estimate, options) {
            Ok(one) => compared.push(one),
            Err(why) => unjudged.push((name, why)),
        }
    }
    let by_sound: Vec<&[EpochError]> = compared.iter().map(|one| &one.by_sound[..]).collect();
    let mut odd: Vec<Vec<OddSpan>> =
        (0..by_sound.len()).map(|own| odd::spans(own, &by_sound, &compared[own].truths)).collect();
    let by_readings =
        |span: &&mut OddSpan| matches!(span.odd_one, OddOne::Readings | OddOne::LeftOut);
    if let Ok(answer) = &analysis.answer {
        let triplet_s = &analysis.triplets().time_s;
        for (one, odd) in compared.iter().zip(&mut odd) {
            let (without_s, by_rig) =
                (one.judged.times_without_truth_s(), reference.has_orientation());
            odd.extend(odd::left_out_spans(&without_s, triplet_s, by_rig));
            odd.sort_by(|a, b| a.span_s[0].total_cmp(&b.span_s[0]));
        }
        for span in odd.iter_mut().flatten().filter(by_readings) {
            let errors_mm = &answer.evaluation.distance_errors_mm;
            span.station = odd::station_at_fault(span.span_s, triplet_s, errors_mm);
        }
    }
    let all: Vec<&[EpochError]> = compared.iter().map(|one| &one.judged.errors[..]).collect();
    let comparisons = ranking::compare(&all);
    let judged = compared.into_iter().zip(odd);
    Judgement {
        judged: judged.map(|(one, odd)| Judged { odd, ..one.judged }).collect(),
        comparisons,
        unjudged,
    }
}

/// An estimate beside the ground truth, before it is known who is wrong where.
struct Compared {
    judged: Judged,
    /// The ground truth at each of its errors.
    truths: Vec<True>,
    /// Its errors where only the epochs align it at which the readings do not contradict themselves: a ground truth that is
    /// metres off for some seconds turns the frame of evo's alignment, and would make the estimate seem wrong elsewhere.
    by_sound: Vec<EpochError>,
}

fn judge_one(
    reference: &Reference<'_>,
    estimate: Estimate,
    options: Options,
) -> Result<Compared, Unjudged> {
    let (fit, truths) = fit::fit(reference, &estimate, &options)?;
    let matched = matched(&estimate.poses, &truths, fit.time_offset_s);
    let without_truth = estimate.poses.len() - matched.len();
    let errors = errors::errors(&matched, &fit);
    let position = Ape::of(errors.iter().map(|error| error.position_m.norm()));
    let rotation = fit
        .body_rotation
        .map(|_| Ape::of(errors.iter().filter_map(|error| Some(error.rotation_rad?.norm()))));
    let relative = metrics::relative(&matched, &fit, &RELATIVE_M);
    let mut by_sound = fit.clone();
    // Where too few are left, they are no better than all.
    if fit::align(&mut by_sound, &sound(&matched), options.alignment).is_err() {
        by_sound = fit.clone();
    }
    let by_sound = errors::errors(&matched, &by_sound);
    let truths = matched.into_iter().map(|(_, truth)| truth.clone()).collect();
    let judged = Judged {
        against_sigma: errors::against_sigma(&errors),
        odd: Vec::new(),
        estimate,
        alignment: options.alignment,
        fit,
        errors,
        without_truth,
        position,
        rotation,
        relative,
    };
    Ok(Compared { judged, truths, by_sound })
}
