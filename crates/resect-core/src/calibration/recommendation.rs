//! The recommendation for a drive: the answer to use, the reason, and the next step.
//!
//! After a failure of the joint estimate, the answer is that of the published method. The next step then does not advise the
//! joint estimate, so that no advice leads in a circle.

use crate::deployment::kinds;
use std::fmt;

use super::inter_prism::drive_shape::PlanView;
use super::inter_prism::observability::{Direction, Hold, Observability};
use super::joint::{JointEstimate, LargestSource};
use super::{Calibration, JointFailure, Method, Offer, TransformSigma, Verdict, Witness};
use crate::deployment::{
    Deployment, Finding, FindingKind, MessageAngle, Remedy, Subject, TrackFrame, doubts,
};
use crate::network::PerStation;
use crate::pipeline::Triplets;
use crate::statistics::estimate::decimals_of;

/// The answer to use, the reason, and the next step if the answer is not good enough.
///
/// `Display` writes it as three sentences.
#[derive(Clone, Debug, PartialEq)]
pub struct Recommendation {
    /// Method of the answer to use; `None` if no answer of this data can be used.
    pub answer: Option<Method>,
    pub reason: RecommendationReason,
    /// The recommendation as one sentence.
    pub conclusion: String,
    /// The number that proves the reason.
    pub proof: RecommendationProof,
    /// The next step, as one sentence.
    pub next_step: String,
}

/// The reason of a recommendation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RecommendationReason {
    /// No finding limits the answer.
    Good,
    /// A station has changed between the survey and the drive.
    SetUpChanged,
    /// A finding limits the answer.
    Doubtful,
    /// The joint estimate did not converge; the answer is that of the published method.
    NotConverged,
    /// The readings do not determine the joint estimate; the answer is that of the published method.
    NotDetermined,
    /// Two solutions fit.
    Ambiguous,
    /// The data does not determine the stations.
    Degenerate,
}

impl RecommendationReason {
    /// Returns the stable name in JSON.
    pub fn code(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::SetUpChanged => "set-up-changed",
            Self::Doubtful => "doubtful",
            Self::NotConverged => "not-converged",
            Self::NotDetermined => "not-determined",
            Self::Ambiguous => "ambiguous",
            Self::Degenerate => "degenerate",
        }
    }
}

/// The evidence for the reason of a recommendation.
#[derive(Clone, Debug, PartialEq)]
pub enum RecommendationProof {
    /// The largest σ of a coordinate of a station's position (m; `None` without σ), and independent data that agrees.
    LargestSigma { sigma_m: Option<f64>, agreement: Option<Witness> },
    /// The finding that limits the answer most, or reports the change of a set-up.
    Finding(Box<Finding>),
    /// The unobservable directions, as a sentence.
    Unobservable(String),
}

/// Alternative to another drive.
const MEASURE_POINTS: &str = ", or let all stations measure three control points";
/// Most words of a sentence.
const MOST_WORDS: usize = 25;
/// First words of an instruction, which a reason does not repeat.
const INSTRUCTIONS: [&str; 6] = ["check", "cut", "find", "measure", "record", "spread"];

/// Doubts about the shape of a drive, which another drive removes.
const DRIVE_DOUBTS: [FindingKind; 6] = [
    kinds::DRIVE_LEAVES_DIRECTION_FREE,
    kinds::DRIVE_WEAK,
    kinds::DRIVE_STANDING,
    kinds::DRIVE_STRAIGHT_LINE,
    kinds::DRIVE_CIRCLE,
    kinds::DRIVE_TWO_LEGS,
];
/// Changes of a set-up between the survey and the drive.
const SET_UP_CHANGES: [FindingKind; 2] = [kinds::SET_UP_CHANGED, kinds::SET_UP_CHANGE_UNDECIDED];
/// Causes of an ambiguous answer, the most specific first.
const AMBIGUITIES: [FindingKind; 5] = [
    kinds::MIRROR_UNRESOLVED,
    kinds::MIRROR_WITNESS_CONTRADICTED,
    kinds::OTHER_MINIMUM_FITS_BETTER,
    kinds::RIVAL_MINIMUM,
    kinds::PRISM_COUNT_UNDECIDED,
];
/// Causes of a degenerate answer, the most specific first.
const DEGENERACIES: [FindingKind; 3] =
    [kinds::DRIVE_LEAVES_DIRECTION_FREE, kinds::POINTS_LEAVE_DIRECTION_FREE, kinds::TRACKS_APART];

/// Returns the recommendation for the drive of a deployment.
pub fn recommend(calibration: &Calibration, deployment: &Deployment) -> Recommendation {
    let failure = calibration.joint_failure();
    let published = calibration.published.as_deref().filter(|_| failure.is_some());
    let usable =
        UsableAnswer { calibration: published.unwrap_or(calibration), deployment, failure };
    match (usable.calibration.verdict, failure) {
        (Verdict::Degenerate, _) => usable.recommend_none_if_degenerate(),
        (Verdict::Ambiguous, _) => usable.recommend_none_if_ambiguous(),
        (Verdict::Good | Verdict::Weak, Some(failure)) => usable.recommend_published(failure),
        (Verdict::Good | Verdict::Weak, None) => usable.recommend(),
    }
}

/// The answer that can be used at most: the calibration itself, or the published one if the joint estimate failed.
struct UsableAnswer<'a> {
    calibration: &'a Calibration,
    deployment: &'a Deployment,
    failure: Option<&'a JointFailure>,
}

impl UsableAnswer<'_> {
    /// Recommends the answer of the chosen method.
    fn recommend(&self) -> Recommendation {
        let Calibration { method, verdict, findings, .. } = self.calibration;
        let drive = self.drive();
        let doubt = doubts(findings).first().copied().filter(|_| *verdict > Verdict::Good);
        let caution = if doubt.is_some() { " with caution" } else { "" };
        let change = findings.iter().find(|finding| SET_UP_CHANGES.contains(&finding.kind));
        let reason = match (change, doubt) {
            (Some(_), _) => RecommendationReason::SetUpChanged,
            (None, Some(_)) => RecommendationReason::Doubtful,
            (None, None) => RecommendationReason::Good,
        };
        let is_alone = self.calibration.station1_from_station.len() == 1;
        let conclusion = if is_alone {
            format!(
                "Use the track and the poses of {drive}{caution} in the frame of the only station."
            )
        } else if change.is_some() {
            format!(
                "Use {method}{caution} for {drive}, and its survey transforms for points of the survey."
            )
        } else if self.calibration.placing_tracks(self.deployment).is_some() {
            format!("Use {method}{caution} for {drive}.")
        } else {
            format!(
                "Use {method}{caution} for the control points only, because the tracks are in another frame."
            )
        };
        let next_step = match (change, doubt) {
            (Some(change), Some(doubt)) if change.kind != doubt.kind => {
                self.next_step_of_doubt(doubt)
            }
            (Some(change), _) => next_step_of_change(change),
            (None, Some(doubt)) => self.next_step_of_doubt(doubt),
            (None, None) if is_alone => {
                "To determine transforms, add the readings of a second station.".to_owned()
            }
            (None, None) => self.next_step_of_good(),
        };
        let proof = self.proof_by(change.or(doubt));
        Recommendation { answer: Some(*method), reason, conclusion, proof, next_step }
    }

    /// Recommends the answer of the published method in place of the joint estimate.
    fn recommend_published(&self, failure: &JointFailure) -> Recommendation {
        let method = self.calibration.answered_by();
        let doubt = doubts(&self.calibration.findings)
            .into_iter()
            .find(|doubt| !is_about_convergence(doubt.kind))
            .filter(|_| self.calibration.verdict > Verdict::Good);
        let caution = if doubt.is_some() { " with caution" } else { "" };
        let reason = if failure.is_unconverged() {
            RecommendationReason::NotConverged
        } else {
            RecommendationReason::NotDetermined
        };
        let (drive, why) = (self.drive(), failure.in_words());
        Recommendation {
            answer: Some(method),
            reason,
            conclusion: format!("Use {method}{caution} for {drive}: {why}."),
            proof: self.proof_by(doubt),
            next_step: self.next_step_to_converge(),
        }
    }

    fn recommend_none_if_ambiguous(&self) -> Recommendation {
        let cause = self.cause(&AMBIGUITIES);
        let event = match cause.map(|cause| cause.kind) {
            Some(kinds::MIRROR_UNRESOLVED | kinds::MIRROR_WITNESS_CONTRADICTED) => {
                "the mirror ambiguity is resolved"
            }
            Some(kinds::PRISM_COUNT_UNDECIDED) => "the number of prisms is known",
            _ => "one of two solutions is excluded",
        };
        Recommendation {
            answer: None,
            reason: RecommendationReason::Ambiguous,
            conclusion: match self.calibration.method {
                Method::Joint => format!("Use no answer from {} until {event}.", self.drive()),
                method => format!("Do not use {method} for {} until {event}.", self.drive()),
            },
            proof: self.proof_by(cause),
            next_step: cause
                .map_or_else(|| CORRECT_DATA.to_owned(), |cause| self.next_step_of_doubt(cause)),
        }
    }

    fn recommend_none_if_degenerate(&self) -> Recommendation {
        let cause = self.cause(&DEGENERACIES);
        let free = self.observability().and_then(free_directions_in_words);
        let method = self.calibration.method;
        let conclusion = if method.is_from_tracks() {
            format!(
                "Use no answer from {}: its data does not determine the stations.",
                self.drive()
            )
        } else {
            format!("Use no answer of {method}: its points do not determine the stations.")
        };
        Recommendation {
            answer: None,
            reason: RecommendationReason::Degenerate,
            conclusion,
            proof: free.map_or_else(|| self.proof_by(cause), RecommendationProof::Unobservable),
            next_step: cause
                .map_or_else(|| CORRECT_DATA.to_owned(), |cause| self.next_step_of_doubt(cause)),
        }
    }

    /// Returns "this drive", or "these drives" if several were solved together.
    fn drive(&self) -> &'static str {
        if self.deployment.restarts_s.is_empty() { "this drive" } else { "these drives" }
    }

    fn observability(&self) -> Option<&Observability> {
        self.calibration.inter_prism().map(|details| &details.observability)
    }

    /// Returns the first finding of these kinds, in the order of the kinds; otherwise the most severe doubt.
    fn cause(&self, kinds: &[FindingKind]) -> Option<&Finding> {
        let findings = &self.calibration.findings;
        let of_kind = |kind: &FindingKind| findings.iter().find(|finding| finding.kind == *kind);
        kinds.iter().find_map(of_kind).or_else(|| doubts(findings).first().copied())
    }

    fn proof_by(&self, cause: Option<&Finding>) -> RecommendationProof {
        match cause {
            Some(cause) => RecommendationProof::Finding(Box::new(cause.clone())),
            None => self.largest_sigma(),
        }
    }

    fn largest_sigma(&self) -> RecommendationProof {
        let largest_m = |sigma: &PerStation<TransformSigma>| {
            let others = sigma.iter().skip(1);
            others.map(|station| station.translation_m.max()).reduce(f64::max)
        };
        let sigma_m = self.calibration.sigma.as_ref().and_then(largest_m);
        let checks = &self.calibration.checked_by;
        let agreement = checks.iter().copied().find(|witness| witness.is_independent());
        RecommendationProof::LargestSigma { sigma_m, agreement }
    }

    /// Returns the step that checks a good answer, or the step to a smaller σ if it is checked.
    fn next_step_of_good(&self) -> String {
        if !self.calibration.is_independently_checked() {
            let step = match (self.calibration.method.is_from_tracks(), self.has_control_points()) {
                (true, false) => "let all stations measure three control points",
                (true, true) => "measure more control points, spread over the whole area",
                (false, _) => "drive with prisms whose distances are known",
            };
            return format!("To check it independently, {step}.");
        }
        if let Some(joint) = self.calibration.joint() {
            return reduce_largest_source(joint);
        }
        match self.observability() {
            Some(observability) => format!("For a smaller σ, {}.", observability.advice),
            None => "For a smaller σ, measure points, or drive, over a larger area.".to_owned(),
        }
    }

    fn next_step_of_doubt(&self, doubt: &Finding) -> String {
        let is_modelled = doubt.remedies.contains(&Remedy::JointEstimate);
        if is_modelled && self.calibration.method != Method::Joint && self.failure.is_none() {
            return "Try the joint estimate, which models this error, and use it if it converges."
                .to_owned();
        }
        match self.observability().filter(|_| DRIVE_DOUBTS.contains(&doubt.kind)) {
            Some(observability) => self.next_drive("Next", observability),
            None => {
                let step = doubt.kind.advice.map_or(CORRECT_DATA, |advice| advice.step);
                // Nobody is advised to measure what is there.
                if self.has_control_points() {
                    step.replace(MEASURE_POINTS, "")
                } else {
                    step.to_owned()
                }
            }
        }
    }

    /// Returns the step after which the joint estimate may converge.
    fn next_step_to_converge(&self) -> String {
        let lacking = self.observability().filter(|observability| {
            observability.drive.plan != PlanView::Winding
                || observability.count(Hold::Held) < observability.directions.len()
        });
        let purpose = "To determine the joint estimate";
        match lacking {
            Some(observability) => self.next_drive(purpose, observability),
            None => format!(
                "{purpose}, leave out the data that findings name, or drive longer with turns to both sides."
            ),
        }
    }

    /// Returns the advice on the next drive, with an alternative that needs no other drive if the sentence stays short.
    fn next_drive(&self, purpose: &str, observability: &Observability) -> String {
        let has_points = self.has_control_points();
        if has_points && observability.count(Hold::Free) > 0 {
            return "Choose method B: the control points determine the stations, the drive alone does not."
                .to_owned();
        }
        let alternative =
            if has_points { ", and solve both drives together" } else { MEASURE_POINTS };
        let step = format!("{purpose}, {}", observability.advice);
        let is_short = word_count(&step) + word_count(alternative) - 1 <= MOST_WORDS;
        format!("{step}{}.", if is_short { alternative } else { "" })
    }

    /// Returns true if method B can solve the control points, in the frames of the tracks.
    fn has_control_points(&self) -> bool {
        let offer = Offer::of(self.deployment, &Triplets::default());
        self.deployment.track_frame == TrackFrame::Own && offer.lack(Method::StaticGcp).is_none()
    }
}

const CORRECT_DATA: &str = "Correct or leave out the data that the findings name.";

fn is_about_convergence(kind: FindingKind) -> bool {
    matches!(
        kind,
        kinds::ESTIMATE_NOT_CONVERGED
            | kinds::ESTIMATE_DIVERGED
            | kinds::JOINT_ESTIMATE_UNDETERMINED
            | kinds::NO_COMMON_READINGS
            | kinds::PRIORS_TIGHTENED
    )
}

fn next_step_of_change(change: &Finding) -> String {
    match change.subject {
        Some(Subject::Station(station)) => format!(
            "If station {} was not touched, check its control points for a wrong marker or prism constant.",
            station + 1
        ),
        _ => "Measure the control points again from every station, to decide which one moved."
            .to_owned(),
    }
}

/// Returns the step that reduces the largest source of the largest σ of a position.
fn reduce_largest_source(joint: &JointEstimate) -> String {
    let positions = (0..joint.covariance.nrows()).filter(|coordinate| coordinate % 4 < 3);
    let largest = positions
        .map(|coordinate| joint.largest_source(coordinate))
        .max_by(|a, b| a.total_sigma.total_cmp(&b.total_sigma));
    let Some(LargestSource { name, sigma, .. }) = largest else { return CORRECT_DATA.to_owned() };
    let step = match name {
        "clocks" | "wandering clocks" => "synchronise the stations",
        "latencies" => "drive more slowly",
        "inter-prism distances" => "measure the rig again",
        "leans" => "adjust the compensators",
        "range offsets" | "range scales" => "check prism constants, temperature and pressure",
        "vertical indices" | "collimations" => "adjust the instruments",
        "control points" => "measure more control points",
        "settling" => "set the tripods on firm ground",
        _ => "drive longer",
    };
    format!("For a smaller σ, reduce its largest source, {name} ({}): {step}.", millimetres(sigma))
}

/// Returns the number of unobservable directions, and as many of their descriptions as a sentence has place for.
fn free_directions_in_words(observability: &Observability) -> Option<String> {
    let free = observability.directions.iter().filter(|direction| direction.hold == Hold::Free);
    let mut descriptions = free.map(Direction::short);
    let first = descriptions.next()?;
    let mut sentence = match observability.count(Hold::Free) {
        1 => format!("1 of 8 directions is not determined: {first}"),
        count => format!("{count} of 8 directions are not determined: {first}"),
    };
    for description in descriptions {
        if word_count(&sentence) + word_count(description) <= MOST_WORDS {
            sentence = format!("{sentence}, {description}");
        }
    }
    Some(sentence + ".")
}

impl Recommendation {
    /// Returns conclusion, reason and next step, a sentence each; `render_angle` renders each angle.
    pub fn sentences(&self, render_angle: impl Fn(&MessageAngle) -> String) -> [String; 3] {
        [self.conclusion.clone(), self.proof.in_words(render_angle), self.next_step.clone()]
    }
}

impl fmt::Display for Recommendation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.sentences(MessageAngle::to_string).join(" "))
    }
}

impl RecommendationProof {
    fn in_words(&self, render_angle: impl Fn(&MessageAngle) -> String) -> String {
        match self {
            Self::LargestSigma { sigma_m: None, .. } => {
                "There is no σ of a station's position.".to_owned()
            }
            Self::LargestSigma { sigma_m: Some(sigma_m), agreement } => {
                let sigma = millimetres(*sigma_m);
                let agreement = match agreement {
                    Some(Witness::ControlPoints) => ", and the control points agree",
                    Some(Witness::Distances) => {
                        ", and the inter-prism distances of the drive agree"
                    }
                    Some(Witness::Rig) | None => "",
                };
                format!("σ of a station's position is at most {sigma} along an axis{agreement}.")
            }
            Self::Finding(finding) if finding.kind == kinds::MIRROR_UNRESOLVED => {
                mirror_in_words(finding)
            }
            Self::Finding(finding) => first_clause(&finding.render(render_angle)),
            Self::Unobservable(sentence) => sentence.clone(),
        }
    }
}

fn mirror_in_words(finding: &Finding) -> String {
    let [apart_m, cost_ratio] =
        ["apart", "cost_ratio"].map(|name| finding.value(name).unwrap_or(f64::NAN));
    format!(
        "The mirrored solution, {apart_m:.2} m away in height, has {cost_ratio:.2} times the cost."
    )
}

/// Formats a σ with two digits.
fn millimetres(sigma_m: f64) -> String {
    let sigma_mm = sigma_m * 1e3;
    format!("{sigma_mm:.*} mm", decimals_of(sigma_mm).unwrap_or(1))
}

fn word_count(text: &str) -> usize {
    text.split_whitespace().count()
}

/// Returns the first clause of a message as a sentence, without an instruction that follows it.
fn first_clause(message: &str) -> String {
    let sentence = message.split(". ").next().unwrap_or_default();
    let clause = sentence.split("; ").next().unwrap_or_default();
    let clause = match clause.split_once(": ") {
        Some((before, _)) if word_count(clause) > MOST_WORDS => before,
        Some((before, after)) if INSTRUCTIONS.iter().any(|verb| after.starts_with(verb)) => before,
        _ => clause,
    };
    let words: Vec<&str> = clause.split_whitespace().take(MOST_WORDS).collect();
    let clause = words.join(" ");
    let mut characters = clause.trim_end_matches('.').chars();
    let first: String = characters.next().into_iter().flat_map(char::to_uppercase).collect();
    format!("{first}{}.", characters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::deployment::findings;

    #[test]
    fn every_finding_has_a_short_first_clause() {
        for finding in findings::examples() {
            let clause = first_clause(&finding.to_string());
            let is_sentence = clause.ends_with('.') && clause.len() > 3;
            assert!(is_sentence && word_count(&clause) <= MOST_WORDS, "{clause}");
        }
        let poor = "the tracks fit poorly (20.0 mm rms): check the clocks and the filters";
        assert_eq!(first_clause(poor), "The tracks fit poorly (20.0 mm rms).");
    }
}
