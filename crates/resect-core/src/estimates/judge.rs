//! Judgement of estimates against the ground truth.

use super::errors::{self, EpochError};
use super::estimate::{EstimatedTrajectory, names};
use super::fit::{self, Fit};
use super::metrics::{self, Ape, RelativeErrors};
use super::odd::{self, OddOne, OddSpan};
use super::options::{Options, TrajectoryAlignment};
use super::ranking::{self, PairComparison};
use super::reference::{GroundTruthSource, True, matched, sound};
use super::unjudged::Unjudged;
use crate::analysis::Analysis;
use crate::deployment::Deployment;

/// An estimate compared with the ground truth.
#[derive(Clone, Debug)]
pub struct Judged {
    pub estimate: EstimatedTrajectory,
    pub alignment: TrajectoryAlignment,
    pub fit: Fit,
    /// Errors of the poses with ground truth, in order of time.
    pub errors: Vec<EpochError>,
    /// Number of poses without ground truth: before, after, and in its gaps.
    pub without_truth: usize,
    pub position: Ape,
    /// Angles between orientations (rad); `None` without orientations.
    pub rotation: Option<Ape>,
    /// Relative errors over paths of these lengths, the shortest first; empty without orientations.
    pub relative: Vec<RelativeErrors>,
    pub against_sigma: errors::AgainstSigma,
    /// Spans in which the estimate and the ground truth contradict each other, in order of time.
    pub odd: Vec<OddSpan>,
}

impl Judged {
    /// Times of poses without ground truth (s, in the ground truth's time).
    fn times_without_truth_s(&self) -> Vec<f64> {
        let all_s = self.estimate.poses.iter().map(|pose| pose.time_s + self.fit.time_offset_s);
        let mut with = self.errors.iter().map(|error| error.time_s).peekable();
        all_s.filter(|time_s| with.next_if(|with_s| with_s <= time_s).is_none()).collect()
    }
}

/// All estimates, and the comparisons between them.
#[derive(Clone, Debug)]
pub struct EstimatesJudgement {
    pub judged: Vec<Judged>,
    /// Every pair of estimates, compared by position, the better one first.
    pub comparisons: Vec<PairComparison>,
    /// Names of the estimates that could not be judged, with the reason.
    pub unjudged: Vec<(String, Unjudged)>,
}

/// Lengths of the paths of relative errors (m).
pub const RELATIVE_M: [f64; 4] = [1.0, 5.0, 20.0, 100.0];

/// Compares estimates with the deployment's own trajectory by its answer, each with its options.
pub fn judge(
    deployment: &Deployment,
    analysis: &Analysis,
    estimates: Vec<(EstimatedTrajectory, Options)>,
) -> EstimatesJudgement {
    let reference = GroundTruthSource::new(deployment, analysis);
    let mut compared: Vec<FittedEstimate> = Vec::new();
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
    EstimatesJudgement {
        judged: judged.map(|(one, odd)| Judged { odd, ..one.judged }).collect(),
        comparisons,
        unjudged,
    }
}

/// An estimate compared with the ground truth, before contradictions are attributed.
struct FittedEstimate {
    judged: Judged,
    /// Ground truth at each of the errors.
    truths: Vec<True>,
    /// Errors after aligning on self-consistent epochs only. A ground truth that is metres off for some seconds rotates the
    /// frame of evo's alignment, and would make the estimate seem wrong elsewhere.
    by_sound: Vec<EpochError>,
}

fn judge_one(
    reference: &GroundTruthSource<'_>,
    estimate: EstimatedTrajectory,
    options: Options,
) -> Result<FittedEstimate, Unjudged> {
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
    // With too few self-consistent epochs, the alignment on all epochs is used.
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
    Ok(FittedEstimate { judged, truths, by_sound })
}
