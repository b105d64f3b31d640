//! Judgement of estimates against the ground truth.

use nalgebra::{Rotation3, Vector3};

use super::agreement::{AgreeingPair, agreements};
use super::association::is_denser;
use super::convention_checks::{self, ComparedEstimate, CopiedEstimate};
use super::delta::{Delta, RelativeOptions};
use super::errors::{self, EpochError};
use super::fit::{self, Fit};
use super::ground_truth::GroundTruth;
use super::judged::{Coverage, Judged, UnalignedErrors};
use super::matched_pose::{MatchedPose, TruePose, consistent};
use super::metrics::{self, Ape, RelativeErrors};
use super::motion_pairs::NoMotions;
use super::odd::{self, OddOne, OddSpan};
use super::options::{Body, Options};
use super::ranking::{self, PairComparison};
use super::unjudged::Unjudged;
use super::varied_errors::{self, ErrorChange};
use crate::findings::conventions::estimate_copy;
use crate::findings::kinds;
use resect_core::deployment::{
    EstimatedTrajectory, Finding, FindingKind, Severity, names_of_trajectories,
};
use resect_core::geometry::RigidTransform;

/// All estimates, and the comparisons between them.
#[derive(Clone, Debug)]
pub struct EstimatesJudgement {
    pub judged: Vec<Judged>,
    /// Every pair of estimates by every kind of error, the better one first.
    pub comparisons: Vec<PairComparison>,
    /// Pairs of estimates that agree with each other against the ground truth.
    pub agreements: Vec<AgreeingPair>,
    /// Names of the estimates that could not be judged, with the reason.
    pub unjudged: Vec<(String, Unjudged)>,
    /// Motions of the relative errors.
    pub motions: RelativeOptions,
}

/// Compares estimates with the ground truth, each with its options, over the usual motions.
pub fn judge(
    truth: &GroundTruth<'_>,
    estimates: Vec<(EstimatedTrajectory, Options)>,
) -> EstimatesJudgement {
    judge_motions(truth, estimates, RelativeOptions::default())
}

/// Compares estimates with the ground truth, each with its options. Relative errors are those of the given motions.
pub fn judge_motions(
    truth: &GroundTruth<'_>,
    estimates: Vec<(EstimatedTrajectory, Options)>,
    motions: RelativeOptions,
) -> EstimatesJudgement {
    let mut compared: Vec<FittedEstimate> = Vec::new();
    let mut unjudged = Vec::new();
    let names = names_of_trajectories(estimates.iter().map(|(estimate, _)| estimate));
    for ((mut estimate, options), name) in estimates.into_iter().zip(names) {
        estimate.name.clone_from(&name);
        match judge_one(truth, estimate, options, &motions) {
            Ok(one) => compared.push(one),
            Err(why) => unjudged.push((name, why)),
        }
    }
    let copies = copies(&mut compared);
    let sources = convention_checks::sources(&copies);
    // An estimate whose file seems to have another convention is no witness for another one.
    let witnesses: Vec<&[EpochError]> = compared
        .iter()
        .map(|one| if one.has_other_convention { &[] } else { &one.by_sound[..] })
        .collect();
    let mut agreements = agreements(&witnesses);
    agreements.retain(|pair| pair.estimates.iter().all(|index| copies[*index].is_none()));
    let stations_m = truth.stations_m();
    let mut odd: Vec<Vec<OddSpan>> = (0..compared.len())
        .map(|number| {
            let mut errors = witnesses.clone();
            errors[number] = &compared[number].by_sound;
            odd::spans(number, (&errors, &sources), &compared[number].truths, &stations_m)
        })
        .collect();
    for (one, odd) in compared.iter().zip(&mut odd) {
        attribute_to_stations(truth, &one.judged, odd);
        let is_estimate = |span: &&mut OddSpan| span.odd_one == OddOne::Estimate;
        if one.has_other_convention {
            odd.iter_mut().filter(is_estimate).for_each(|span| span.odd_one = OddOne::Convention);
        }
    }
    let judged: Vec<Judged> =
        compared.into_iter().zip(odd).map(|(one, odd)| Judged { odd, ..one.judged }).collect();
    let comparisons = ranking::compare(&judged, &motions);
    EstimatesJudgement { comparisons, agreements, judged, unjudged, motions }
}

/// Returns the estimates that are copies of others, and adds a finding to each.
fn copies(compared: &mut [FittedEstimate]) -> Vec<Option<CopiedEstimate>> {
    let all: Vec<ComparedEstimate<'_>> = compared
        .iter()
        .map(|FittedEstimate { judged, .. }| ComparedEstimate {
            poses: &judged.estimate.poses,
            time_offset_s: judged.fit.time_offset_s,
            rmse_m: judged.position.rmse,
        })
        .collect();
    let copies = convention_checks::copies(&all);
    for (index, copy) in copies.iter().enumerate() {
        let Some(copy) = copy else { continue };
        let original = compared[copy.original].judged.estimate.name.clone();
        let judged = &mut compared[index].judged;
        let differences_m = [copy.apart_m, judged.position.rmse];
        let finding = estimate_copy(&judged.estimate.name, &original, differences_m);
        judged.fit.findings.push(finding);
    }
    copies
}

/// Adds the spans in which the readings of a deployment were rejected, and names the station whose readings are wrong.
fn attribute_to_stations(truth: &GroundTruth<'_>, judged: &Judged, odd: &mut Vec<OddSpan>) {
    let GroundTruth::Deployment { analysis, .. } = truth else { return };
    let Ok(answer) = &analysis.answer else { return };
    let triplet_s = &analysis.triplets().time_s;
    let without_s = judged.times_without_truth_s();
    odd.extend(odd::left_out_spans(&without_s, triplet_s, truth.has_orientation()));
    odd.sort_by(|a, b| a.span_s[0].total_cmp(&b.span_s[0]));
    for span in odd {
        if matches!(span.odd_one, OddOne::Readings | OddOne::LeftOut) {
            let errors_mm = &answer.evaluation.distance_errors_mm;
            span.station = odd::station_at_fault(span.span_s, triplet_s, errors_mm);
        }
    }
}

/// An estimate compared with the ground truth, before contradictions are attributed.
struct FittedEstimate {
    judged: Judged,
    /// Ground truth at each of the errors.
    truths: Vec<TruePose>,
    /// Errors after aligning on self-consistent epochs only. A ground truth that is metres off for some seconds rotates the
    /// frame of evo's alignment, and would make the estimate seem wrong elsewhere.
    by_sound: Vec<EpochError>,
    /// True if the estimate's file seems to have another convention than the one with which it was read.
    has_other_convention: bool,
}

fn judge_one(
    truth: &GroundTruth<'_>,
    mut estimate: EstimatedTrajectory,
    options: Options,
    motions: &RelativeOptions,
) -> Result<FittedEstimate, Unjudged> {
    let ConventionalFit { mut fit, matched, has_other_convention } =
        fit_with_convention(truth, &mut estimate, &options)?;
    fit.plane = options.plane;
    let is_denser = match truth {
        GroundTruth::Trajectory(truth, _) => is_denser(&truth.poses, &estimate.poses),
        GroundTruth::Deployment { .. } => true,
    };
    leave_out_other_times(&mut estimate, fit.time_offset_s, &options);
    let coverage = match truth {
        GroundTruth::Trajectory(truth, _) if !is_denser => {
            let in_span = truth.poses.iter().filter(|pose| options.has_time(pose.time_s)).count();
            Coverage::TruthsWithoutPose(in_span.saturating_sub(matched.len()))
        }
        // Nearest stamps may lie on both sides of the span's ends.
        _ => Coverage::PosesWithoutTruth(estimate.poses.len().saturating_sub(matched.len())),
    };
    let SizedErrors { errors, changes, position, rotation, relative } =
        sized_errors(&matched, &fit, &options, motions);
    let mut by_sound = fit.clone();
    // With too few self-consistent epochs, the alignment on all epochs is used.
    if fit::align(&mut by_sound, &consistent(&matched), options.alignment).is_err() {
        by_sound = fit.clone();
    }
    let by_sound = errors::errors(&matched, &by_sound);
    let judged = Judged {
        against_sigma: errors::against_sigma(&errors),
        odd: Vec::new(),
        unaligned: unaligned(&matched, &fit),
        estimate,
        alignment: options.alignment,
        options,
        fit,
        errors,
        changes,
        coverage,
        position,
        rotation,
        relative,
    };
    let truths = matched.into_iter().map(|pair| pair.truth).collect();
    Ok(FittedEstimate { judged, truths, by_sound, has_other_convention })
}

/// Errors and their sizes, with the σ that clock, lever arm and body give to these.
struct SizedErrors {
    errors: Vec<EpochError>,
    changes: Vec<Vec<ErrorChange>>,
    position: Ape,
    rotation: Option<Ape>,
    relative: Vec<Result<RelativeErrors, (Delta, NoMotions)>>,
}

fn sized_errors(
    matched: &[MatchedPose],
    fit: &Fit,
    options: &Options,
    motions: &RelativeOptions,
) -> SizedErrors {
    let errors = errors::errors(matched, fit);
    let has_rotation = fit.body_rotation.is_some();
    let mut position = ape_of(&errors);
    let mut rotation = has_rotation.then(|| rotation_of(&errors));
    let motions = metrics::motions(matched, fit, motions);
    let mut relative = metrics::relative(matched, fit, &motions);
    let mut changes = Vec::new();
    for varied in varied_errors::varied_estimates(matched, fit, options) {
        let of_errors = varied_errors::changes(&varied, &errors);
        let changed = varied_errors::changed(&errors, &of_errors);
        changes.push(of_errors);
        position.add_change(&ape_of(&changed));
        if let Some(rotation) = &mut rotation {
            rotation.add_change(&rotation_of(&changed));
        }
        let of_motions = metrics::relative(&varied.matched, &varied.fit, &motions);
        for (errors, changed) in relative.iter_mut().flatten().zip(of_motions.iter().flatten()) {
            errors.position.add_change(&changed.position);
            if let (Some(rotation), Some(changed)) = (&mut errors.rotation, &changed.rotation) {
                rotation.add_change(changed);
            }
        }
    }
    SizedErrors { errors, changes, position, rotation, relative }
}

fn rotation_of(errors: &[EpochError]) -> Ape {
    let sizes = errors.iter().filter_map(|error| Some((error.time_s, error.rotation_rad?.norm())));
    Ape::over_time(&sizes.collect::<Vec<_>>())
}

/// Leaves out the poses outside the compared span.
fn leave_out_other_times(estimate: &mut EstimatedTrajectory, offset_s: f64, options: &Options) {
    let is_compared: Vec<bool> =
        estimate.poses.iter().map(|pose| options.has_time(pose.time_s + offset_s)).collect();
    let mut is_pose_compared = is_compared.iter();
    estimate.poses.retain(|_| is_pose_compared.next() == Some(&true));
    let mut has_compared_pose = is_compared.iter();
    estimate.covariances.retain(|_| has_compared_pose.next() == Some(&true));
}

/// A fit of an estimate with the stated convention.
pub struct ConventionalFit {
    pub fit: Fit,
    pub matched: Vec<MatchedPose>,
    pub has_other_convention: bool,
}

/// Returns the convention that hinders the fit of a lever arm: that of orientations which do not follow the drive.
fn by_convention(
    truth: &GroundTruth<'_>,
    estimate: &EstimatedTrajectory,
    options: &Options,
) -> Option<Unjudged> {
    let same = Options { body: Body::Same, ..*options };
    let (fit, matched) =
        fit::fit(truth, estimate, &same).ok().filter(|_| options.body != Body::Same)?;
    let late = convention_checks::after_fit(truth, estimate, (&matched, &fit), &same);
    let is_warning = |finding: &&Finding| finding.severity == Severity::Warning;
    let finding = late.iter().find(is_warning)?;
    Some(Unjudged::OtherConvention(finding.to_string()))
}

/// Findings about the poses of a trajectory by themselves.
const OF_POSES: [FindingKind; 3] =
    [kinds::ESTIMATE_POSES_HELD, kinds::ESTIMATE_POSES_UNSET, kinds::ESTIMATE_JUMPS];

/// Returns true if so many poses are wrong that the clock seems to change.
fn hinders_clock(finding: &Finding) -> bool {
    /// Most outliers that leave the clock as it is.
    const FEW: f64 = 5.0;
    let outliers = finding.quantities.iter().find(|quantity| quantity.name == "outliers");
    match finding.kind {
        kinds::ESTIMATE_POSES_HELD | kinds::ESTIMATE_POSES_UNSET => true,
        kinds::ESTIMATE_JUMPS => outliers.is_some_and(|outliers| outliers.value > FEW),
        _ => false,
    }
}

/// Findings that such poses explain, and those of another convention.
const BY_POSES: [FindingKind; 5] = [
    kinds::ESTIMATE_STAMPS_JITTER,
    kinds::ESTIMATE_CLOCK_WANDERS,
    kinds::ESTIMATE_CLOCK_STEPPED,
    kinds::ESTIMATE_CLOCK_DRIFTS,
    kinds::ESTIMATE_ORIENTATIONS_LATE,
];

/// Applies the stated convention, fits the estimate, and adds findings about conventions that it seems to have besides.
pub fn fit_with_convention(
    truth: &GroundTruth<'_>,
    estimate: &mut EstimatedTrajectory,
    options: &Options,
) -> Result<ConventionalFit, Unjudged> {
    options.convention.apply(estimate);
    let early = convention_checks::before_fit(truth, estimate, options)?;
    // Poses of the ground truth that were held or never set hinder the fit as well.
    let of_truth = match truth {
        GroundTruth::Trajectory(truth, _) => &truth.findings[..],
        GroundTruth::Deployment { .. } => &[],
    };
    let causes: Vec<&Finding> = of_truth
        .iter()
        .filter(|finding| OF_POSES.contains(&finding.kind))
        .chain(&early.findings)
        .collect();
    let said = || {
        let messages: Vec<String> = causes.iter().map(ToString::to_string).collect();
        messages.join("; ")
    };
    // Options that leave nothing to estimate are those of evo, whose numbers are wanted as they are.
    let is_estimated = options.time_offset_s.is_none() || options.body == Body::Found;
    let has_unset_truth =
        of_truth.iter().any(|finding| finding.kind == kinds::ESTIMATE_POSES_UNSET);
    if (early.excludes_judgement || has_unset_truth) && is_estimated {
        return Err(Unjudged::OtherConvention(said()));
    }
    let (mut fit, matched) = match fit::fit(truth, estimate, options) {
        Err(why) => {
            let by_poses = || match causes.is_empty() {
                true => why,
                false => Unjudged::OtherConvention(format!("{why}; {}", said())),
            };
            return Err(by_convention(truth, estimate, options).unwrap_or_else(by_poses));
        }
        Ok(fitted) => fitted,
    };
    let mut late = convention_checks::after_fit(truth, estimate, (&matched, &fit), options);
    let is_wrong_file = late.iter().any(|finding| finding.severity == Severity::Warning);
    if is_wrong_file || causes.iter().any(|finding| hinders_clock(finding)) {
        fit.findings.retain(|finding| !BY_POSES.contains(&finding.kind));
        late.retain(|finding| !BY_POSES.contains(&finding.kind));
    }
    let mut suspicions = early.findings.iter().chain(&late);
    let has_other_convention = suspicions.any(|finding| finding.severity == Severity::Warning);
    fit.findings.extend(early.findings.into_iter().chain(late));
    Ok(ConventionalFit { fit, matched, has_other_convention })
}

fn ape_of(errors: &[EpochError]) -> Ape {
    let sizes = errors.iter().map(|error| (error.time_s, error.position_m.norm()));
    Ape::over_time(&sizes.collect::<Vec<_>>())
}

/// Errors in the frames as they are, and with these aligned by the first pose.
fn unaligned(matched: &[MatchedPose], fit: &Fit) -> UnalignedErrors {
    let by = |truth_from_estimate: RigidTransform| {
        ape_of(&errors::errors(matched, &Fit { truth_from_estimate, scale: 1.0, ..fit.clone() }))
    };
    let own_frame =
        RigidTransform { rotation: Rotation3::identity(), translation_m: Vector3::zeros() };
    let first = matched.first().and_then(|MatchedPose { pose, truth, .. }| {
        let orientation = truth.rotation.as_ref()?.orientation * fit.body_rotation?;
        let rotation = (orientation * pose.orientation?.inverse()).to_rotation_matrix();
        let true_m = fit.both_positions_m(pose, truth)[1];
        Some(RigidTransform { rotation, translation_m: true_m - rotation * pose.position_m })
    });
    UnalignedErrors { in_own_frame: by(own_frame), at_first_pose: first.map(by) }
}
