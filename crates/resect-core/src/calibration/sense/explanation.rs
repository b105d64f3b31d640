//! Search for the single misreading that explains a contradiction of an answer.
//!
//! Each misreading is undone in some hundred triplets. Method D is solved again, and the answer is compared with all independent
//! data again.

use crate::deployment::findings::checks::{
    SuspectedMisreading, misreading_not_found, misreading_suspected,
};
use crate::network::{Number, Pair, PerStation};
use rayon::prelude::*;

use super::misreading::Misreading;
use super::shown::{Agreement, Shown, Witnesses};
use crate::calibration::TransformSigma;
use crate::calibration::checks::{POOR_FIT_M, WEAK_SIGMA_M};
use crate::calibration::followed_prisms::several_prisms;
use crate::calibration::inter_prism::{PrismNetwork, Twins};
use crate::calibration::misfits::control_points_apart_m;
use crate::deployment::{ControlPointSet, Deployment, Finding, Remedy, Rig, Track};
use crate::geometry::RigidTransform;
use crate::pipeline;
use crate::pipeline::{PipelineSettings, Triplets};
use crate::progress::{Cancelled, Progress};

/// Number of triplets to which a drive is thinned: enough to distinguish millimetres from decimetres.
const THINNED: usize = 300;
/// Fewest triplets of a drive that is explained: with fewer, any hypothesis fits.
const FEWEST_TRIPLETS: usize = 20;
/// Largest ratio of an explanation's fit to that without it.
const NO_WORSE: f64 = 1.2;
/// Largest ratio of an explanation's fit to that of the best explanation.
const AS_GOOD: f64 = 1.5;
/// Differences of a fit below this are noise (m).
const FIT_NOISE_M: f64 = 0.0005;
/// A hypothesis whose fit near the first guess is this many times worse than the limit is not searched further.
const HOPELESS: f64 = 4.0;
/// Share of its former size that an error must fall below to count as explained.
const CLEARLY_LESS: f64 = 0.5;
/// Most explanations that are reported.
const MOST_NAMED: usize = 3;
/// If the outlier filter keeps a smaller share of a station's readings than this, its limits are probably in wrong units. The
/// filter then runs again on the corrected readings.
const MOSTLY_REJECTED: f64 = 0.6;
/// Most corrected readings on which the outlier filter runs again.
const MOST_READINGS: usize = 20_000;

/// The data that was misread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scope {
    Tracks,
    ControlPoints,
    Both,
}

/// A misreading, and the properties of the answer if it is undone.
#[derive(Clone)]
struct Hypothesis {
    misreading: Misreading,
    scope: Scope,
    shown: Shown,
}

/// Hypotheses for a drive, shared by all answers to be checked and computed for the first that needs them.
#[derive(Default)]
pub struct Tried(Option<Tries>);

struct Tries {
    /// Properties and transforms of the answer as read; `None` without an answer.
    base: Option<(Shown, PerStation<RigidTransform>)>,
    undone: Option<Vec<Hypothesis>>,
}

/// Returns the misreadings that explain the contradiction of method D, the likeliest first.
///
/// Returns one finding if none explains a gross contradiction; empty if nothing contradicts the answer.
pub fn explain(
    deployment: &Deployment,
    rig: &Rig,
    triplets: &Triplets,
    (answer, sigma): (&Shown, Option<&PerStation<TransformSigma>>),
    tried: &mut Tried,
    progress: &Progress,
) -> Result<Vec<Finding>, Cancelled> {
    let followed = several_prisms(deployment, triplets);
    let tries = tried.0.get_or_insert_with(|| {
        let points = deployment.comparable_control_points();
        let triplets = thinned(triplets);
        let base = twins(deployment, rig, &triplets, f64::INFINITY).and_then(|twins| {
            let transforms = twins.chosen(rig, points);
            Some((Shown::of((rig, &followed), points, &triplets, &transforms)?, transforms))
        });
        Tries { base, undone: None }
    });
    let Some((base, base_transforms)) = &tries.base else { return Ok(Vec::new()) };
    let witnesses = Witnesses::new((rig, &followed), sigma);
    let case = Case { witnesses, answer: answer.clone(), base: base.clone() };
    if !case.is_contradicted() {
        return Ok(Vec::new());
    }
    let undone = match &tries.undone {
        Some(undone) => undone,
        None => tries.undone.insert(try_all(
            deployment,
            rig,
            triplets,
            base,
            base_transforms,
            progress,
        )?),
    };
    let found = undone.iter().filter(|one| case.is_explained_by(&one.shown)).cloned().collect();
    Ok(case.in_words(found, deployment))
}

/// Computes the answer with each misreading undone: in the tracks, in the control points, and in both.
fn try_all(
    deployment: &Deployment,
    rig: &Rig,
    triplets: &Triplets,
    base: &Shown,
    base_transforms: &PerStation<RigidTransform>,
    progress: &Progress,
) -> Result<Vec<Hypothesis>, Cancelled> {
    let points = deployment.comparable_control_points();
    let constants_m = deployment.tracks.map(|track| track.prism_constant_m);
    let followed = &several_prisms(deployment, triplets);
    let rejected = mostly_rejected(deployment, triplets);
    let triplets = thinned(triplets);
    let hopeless_m = HOPELESS * (NO_WORSE * base.fit_m + FIT_NOISE_M);
    let one = |misreading: &Misreading| {
        progress.check()?;
        let misreading = *misreading;
        let undone = match misreading {
            Misreading::Feet(_) if rejected => thinned(&filtered_again(deployment, misreading)),
            _ => misreading.undone(&triplets, &constants_m),
        };
        let found = twins(deployment, rig, &undone, hopeless_m);
        let show = |points: &[ControlPointSet]| {
            Shown::of((rig, followed), points, &undone, &found.as_ref()?.chosen(rig, points))
        };
        let mut all = vec![(Scope::Tracks, show(points))];
        if base.control_points_m.is_some() {
            let points = misreading.undone_in_points(points, &constants_m);
            all.push((Scope::Both, show(&points)));
            let control_points_m = control_points_apart_m(&points, base_transforms);
            all.push((Scope::ControlPoints, Some(Shown { control_points_m, ..base.clone() })));
        }
        let explanation = |(scope, shown): (Scope, Option<Shown>)| {
            Some(Hypothesis { misreading, scope, shown: shown? })
        };
        Ok(all.into_iter().filter_map(explanation).collect::<Vec<_>>())
    };
    let all: Result<Vec<_>, Cancelled> =
        Misreading::all(followed.len()).par_iter().map(one).collect();
    Ok(all?.concat())
}

/// Returns the published method's solutions on some triplets; `None` if there are too few, or if they fit worse than `hopeless_m`.
fn twins(
    deployment: &Deployment,
    rig: &Rig,
    triplets: &Triplets,
    hopeless_m: f64,
) -> Option<Twins> {
    if triplets.len() < FEWEST_TRIPLETS {
        return None;
    }
    let followed = several_prisms(deployment, triplets);
    let prisms = Pair::prisms_of(rig.inter_prism_m.len())?;
    let is_known = followed.iter().all(|prism| prism.index() < prisms);
    let network = is_known.then(|| PrismNetwork::new(followed, &rig.inter_prism_m))?;
    Twins::of(network, triplets, hopeless_m)
}

/// Returns the explanation of tracks without triplets: ranges in feet, whose rates no filter accepts.
pub fn explain_no_triplets(deployment: &Deployment, rig: &Rig) -> Option<String> {
    let followed = several_prisms(deployment, &Triplets::default());
    let feet = Misreading::all(followed.len())
        .into_iter()
        .filter(|one| matches!(one, Misreading::Feet(_)));
    let (misreading, count, fit_m) = feet
        .filter_map(|misreading| {
            let triplets = filtered_again(deployment, misreading);
            let some = thinned(&triplets);
            let transforms = twins(deployment, rig, &some, f64::INFINITY)?
                .chosen(rig, deployment.comparable_control_points());
            let shown = Shown::of((rig, &followed), &[], &some, &transforms)?;
            Some((misreading, triplets.len(), shown.fit_m))
        })
        .find(|(.., fit_m)| *fit_m < POOR_FIT_M)?;
    Some(format!(
        "{}: {} there are {count} triplets, and the distances fit to {:.1} mm; {}",
        misreading.in_words(""),
        misreading.assuming(),
        fit_m * 1e3,
        correction(misreading, Scope::Tracks, deployment)
    ))
}

/// Returns true if the outlier filter kept fewer readings than it would in the right unit.
fn mostly_rejected(deployment: &Deployment, triplets: &Triplets) -> bool {
    deployment.tracks.iter().zip(triplets.readings.iter()).any(|(track, filtered)| {
        (filtered.time_s.len() as f64) < MOSTLY_REJECTED * track.measurements.len() as f64
    })
}

/// Returns the pipeline's triplets of the first readings with the misreading undone, by default settings.
fn filtered_again(deployment: &Deployment, misreading: Misreading) -> Triplets {
    let tracks = deployment.tracks.map_each(|station, track| {
        let readings = track.measurements.iter().take(MOST_READINGS);
        Track {
            measurements: readings
                .map(|m| misreading.undone_in_range(station.index(), m))
                .collect(),
            prism_constant_m: track.prism_constant_m,
            left_out: track.left_out.clone(),
            ..Track::default()
        }
    });
    let deployment = Deployment { tracks, ..deployment.clone() };
    pipeline::run(&deployment, &PipelineSettings::default()).triplets.as_ref().clone()
}

fn thinned(triplets: &Triplets) -> Triplets {
    let step = triplets.len().div_ceil(THINNED).max(1);
    triplets.select(&(0..triplets.len()).step_by(step).collect::<Vec<_>>())
}

/// The contradiction to be explained.
struct Case<'a> {
    witnesses: Witnesses<'a>,
    /// Properties of the answer to be explained.
    answer: Shown,
    /// Properties of the published method's answer as read, with which those of misreadings undone are compared.
    base: Shown,
}

/// Data that contradicts an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Complaints {
    fit: bool,
    area: bool,
    heights: bool,
    control_points: bool,
}

impl Case<'_> {
    fn complaints(&self, shown: &Shown) -> Complaints {
        let contradicts = |agreement: Option<Agreement>| agreement == Some(Agreement::Contradicts);
        Complaints {
            fit: Witnesses::distances(shown) == Agreement::Contradicts,
            area: contradicts(self.witnesses.area(shown)),
            heights: contradicts(self.witnesses.heights(shown)),
            control_points: contradicts(Witnesses::control_points(shown)),
        }
    }

    fn height_is_suspicious(&self) -> bool {
        self.witnesses.heights(&self.base) >= Some(Agreement::Suspicious)
    }

    fn is_contradicted(&self) -> bool {
        let Complaints { fit, area, heights, control_points } = self.complaints(&self.base);
        fit || area || heights || control_points || self.height_is_suspicious()
    }

    /// Returns true if these properties contradict nothing and remove a contradiction.
    fn is_explained_by(&self, shown: &Shown) -> bool {
        let (was, is) = (self.complaints(&self.base), self.complaints(shown));
        if is.area || is.heights || is.control_points {
            return false;
        }
        // Collinear prisms contradict nothing, and explain nothing.
        if was.area && self.witnesses.area(shown).is_none() {
            return false;
        }
        let fits = !is.fit || shown.fit_m < WEAK_SIGMA_M;
        if !fits || shown.fit_m > NO_WORSE * self.base.fit_m + FIT_NOISE_M {
            return false;
        }
        let worst = |shown: &Shown| {
            self.witnesses.heights_off_m(shown).map(|off_m| off_m.into_iter().fold(0.0, f64::max))
        };
        let fit = was.fit && shown.fit_m < CLEARLY_LESS * self.base.fit_m;
        let is_better = |before: &Shown| {
            worst(shown).zip(worst(before)).is_some_and(|(is, was)| is < CLEARLY_LESS * was)
        };
        // A joint estimate may have better heights already.
        let heights =
            self.height_is_suspicious() && is_better(&self.base) && is_better(&self.answer);
        // Suspicious heights alone do not justify an explanation that fits worse.
        let only_heights = heights && shown.fit_m < self.base.fit_m + FIT_NOISE_M;
        fit || was.area || was.control_points || (was.heights && heights) || only_heights
    }

    /// Returns findings for the explanations that fit about as well as the best.
    fn in_words(&self, mut found: Vec<Hypothesis>, deployment: &Deployment) -> Vec<Finding> {
        let Complaints { fit, area, heights, control_points } = self.complaints(&self.base);
        let best_m = found.iter().map(|one| one.shown.fit_m).fold(f64::INFINITY, f64::min);
        found.retain(|one| one.shown.fit_m < AS_GOOD * best_m + FIT_NOISE_M);
        if found.is_empty() {
            let gross =
                area || heights || control_points || (fit && self.base.fit_m > WEAK_SIGMA_M);
            return if gross { vec![misreading_not_found()] } else { Vec::new() };
        }
        let named = found.len().min(MOST_NAMED);
        let lines = found[..named]
            .iter()
            .enumerate()
            .map(|(index, one)| self.suspected(one, deployment, index > 0));
        lines.collect()
    }

    fn suspected(
        &self,
        one: &Hypothesis,
        deployment: &Deployment,
        is_alternative: bool,
    ) -> Finding {
        let Hypothesis { misreading, scope, .. } = one;
        let of = match scope {
            Scope::Tracks if self.base.control_points_m.is_none() => "",
            Scope::Tracks => " of the tracks",
            Scope::ControlPoints => " of the control points",
            Scope::Both => " of both tracks and control points",
        };
        let was = self.complaints(&self.base);
        let read_with = match scope {
            Scope::Tracks => misreading.read_with(deployment),
            Scope::ControlPoints | Scope::Both => None,
        };
        misreading_suspected(SuspectedMisreading {
            misreading: &misreading.in_words(of),
            assuming: misreading.assuming(),
            correction: &correction(*misreading, *scope, deployment),
            improvements: &self.improvements(one),
            // If only the rig contradicts the tracks, the rig may be wrong instead.
            only_by_rig: !(was.fit || was.control_points) && *scope != Scope::ControlPoints,
            is_alternative,
            remedy: read_with.map(|overrides| Remedy::ReadWith(Box::new(overrides))),
        })
    }

    /// Returns the improvements in words, such as "the distances fit to 1.3 mm instead of 42 mm".
    fn improvements(&self, one: &Hypothesis) -> Vec<String> {
        let Hypothesis { shown, .. } = one;
        let base = &self.base;
        let mm = |m: f64| {
            let mm = m * 1e3;
            if mm < 100.0 { format!("{mm:.1} mm") } else { format!("{mm:.0} mm") }
        };
        let was = self.complaints(base);
        let mut compared = Vec::new();
        if was.fit || !(was.area || was.control_points) {
            compared.push(format!(
                "the distances fit to {} instead of {}",
                mm(shown.fit_m),
                mm(base.fit_m)
            ));
        }
        if was.area {
            compared.push(
                "the order of prisms 1, 2, 3 seen from above agrees with the reading of the rig"
                    .to_owned(),
            );
        }
        if self.height_is_suspicious()
            && let Some((is, was)) =
                self.witnesses.heights_off_m(shown).zip(self.witnesses.heights_off_m(base))
        {
            let [is, was] = [is, was].map(|off_m| mm(off_m.into_iter().fold(0.0, f64::max)));
            compared.push(format!(
                "prism heights differ from the reading of the rig by {is} instead of {was}"
            ));
        }
        if was.control_points
            && let Some((is, was)) = shown.control_points_m.zip(base.control_points_m)
        {
            compared.push(format!(
                "the control points differ by {} instead of {}",
                mm(is),
                mm(was)
            ));
        }
        compared
    }
}

fn correction(misreading: Misreading, scope: Scope, deployment: &Deployment) -> String {
    let of_points = "correct the control-point files";
    let of_tracks = misreading.remedy(deployment).map_or_else(
        || "correct that station's recording".to_owned(),
        |key| format!("set `{key}` of deployment.toml"),
    );
    match scope {
        Scope::Tracks => of_tracks,
        Scope::ControlPoints => of_points.to_owned(),
        Scope::Both => format!("{of_tracks}, and {of_points}"),
    }
}
