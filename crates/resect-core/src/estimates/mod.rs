//! Trajectories that other systems estimated, held against a deployment's own: SLAM, odometry, GNSS.
//!
//! ```text
//! files ──read──▶ Estimate ──┐
//! Analysis ──reference──▶ ground truth at the estimate's times ──fit──▶ Fit ──errors──▶ Judged ──ranking, odd──▶ Judgement
//! ```
//! [`fit`] finds what the two do not share: the zero of the clocks, where the estimate's body is in the vehicle, and the
//! estimate's frame. [`metrics`] are evo's, so that numbers compare with those of papers. What evo cannot say comes after it:
//! how much of an error the ground truth itself leaves open ([`errors`]), whether one estimate is better than another by more
//! than chance ([`ranking`]), and where the ground truth is the odd one out ([`odd`]).

pub mod errors;
pub mod fit;
pub mod metrics;
pub mod odd;
pub mod ranking;
pub mod reference;
mod time_offset;
pub mod unfit;

use crate::deployment::findings::studies::estimate_not_judged;
use std::path::PathBuf;

use nalgebra::{UnitQuaternion, Vector3};
use serde::{Deserialize, Serialize};

use crate::analysis::Analysis;
use crate::deployment::names::told_apart;
use crate::deployment::{Deployment, Finding, Remedy};
use crate::evaluation::vehicle::NoTrajectory;

use errors::EpochError;
use fit::Fit;
use metrics::{Ape, RelativeErrors};
use odd::{OddOne, OddSpan};
use ranking::Comparison;
use reference::{Reference, True, sound};
use unfit::Unfit;

/// A trajectory as another system estimated it.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The file's name without its ending, and what else tells it from others.
    pub name: String,
    pub path: PathBuf,
    /// Which of those in a bag it is; `None` where there is one.
    pub topic: Option<String>,
    /// The poses in order of time, no two at one time.
    pub poses: Vec<EstimatedPose>,
    pub findings: Vec<Finding>,
}

impl Estimate {
    /// Whether the other was read from the same place.
    pub fn is_same(&self, other: &Self) -> bool {
        self.path == other.path && self.topic == other.topic
    }
}

/// The names of estimates, with as much of their folders as tells them apart: systems often call their files the same.
pub fn names<'a>(estimates: impl Iterator<Item = &'a Estimate>) -> Vec<String> {
    let named: Vec<(&str, PathBuf)> =
        estimates.map(|one| (&*one.name, one.path.with_extension(""))).collect();
    let named = named.iter().map(|(name, path)| ((*name).to_owned(), Some(&**path)));
    told_apart(&named.collect::<Vec<_>>())
}

/// Where the estimate's body is in the estimate's own frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EstimatedPose {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    /// `None` where the file has positions only.
    pub orientation: Option<UnitQuaternion<f64>>,
}

/// How an estimate is brought together with the ground truth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Options {
    pub alignment: Alignment,
    /// What is added to the estimate's times (s); found if `None`.
    pub time_offset_s: Option<f64>,
    pub body: Body,
}

impl Default for Options {
    fn default() -> Self {
        Self { alignment: Alignment::Rigid, time_offset_s: None, body: Body::Found }
    }
}

/// What an estimate's frame may be turned by, moved by and stretched by.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// Nothing: the estimate is in station 1's frame.
    None,
    /// A rotation and a translation (evo's `--align`).
    Rigid,
    /// A scale too, for one camera alone (evo's `--align --correct_scale`).
    Similarity,
}

impl Alignment {
    /// What the frame is turned, moved and stretched by, in words: "turn and shift".
    pub fn in_words(self) -> &'static str {
        match self {
            Self::None => "nothing",
            Self::Rigid => "turn and shift",
            Self::Similarity => "scale too",
        }
    }
}

/// Where the estimate's body is in the vehicle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Body {
    /// Nobody knows: the lever arm is found, and its rotation where the estimate has orientations.
    Found,
    /// It is the vehicle's frame, as evo takes it to be.
    Same,
    /// The lever arm is known: the body's origin in the vehicle's frame, or in the body's the one prism (m).
    Lever(Vector3<f64>),
}

/// Why an estimate cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Unjudged {
    #[error(transparent)]
    NoReference(#[from] NoTrajectory),
    #[error("{name}: {why}")]
    Unfit { name: String, why: Unfit },
}

impl Unjudged {
    /// The same as a finding with what can be done about it.
    pub fn finding(&self) -> Finding {
        let remedy = match self {
            Self::NoReference(NoTrajectory::OnePrism(_) | NoTrajectory::NoMotion(_)) => {
                Some(Remedy::JointEstimate)
            }
            Self::NoReference(NoTrajectory::NoRig(_)) => Some(Remedy::GiveRig),
            Self::NoReference(_) | Self::Unfit { .. } => None,
        };
        estimate_not_judged(&self.to_string(), remedy)
    }

    /// The flag, or the command, that does what is advised where there is no window with fields for it.
    pub fn flag(&self) -> Option<&'static str> {
        match self {
            Self::NoReference(why) => why.flag(),
            Self::Unfit { why, .. } => why.flag(),
        }
    }
}

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
    let matched = errors::matched(&estimate.poses, &truths, fit.time_offset_s);
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
