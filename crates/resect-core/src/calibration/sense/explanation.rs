//! Which single misreading explains what contradicts an answer.
//!
//! Each is undone in some hundred triplets, method D is solved again, and all witnesses are asked once more.

use crate::deployment::findings::checks::{
    SuspectedMisreading, misreading_not_found, misreading_suspected,
};
use rayon::prelude::*;

use super::misreading::Misreading;
use super::shown::{Agreement, Shown, Witnesses};
use crate::calibration::TransformSigma;
use crate::calibration::checks::{POOR_FIT_M, WEAK_SIGMA_M};
use crate::calibration::inter_prism::Twins;
use crate::calibration::misfits::control_points_apart_m;
use crate::deployment::{ControlPointSet, Deployment, Finding, Remedy, Rig, Track};
use crate::geometry::RigidTransform;
use crate::pipeline;
use crate::pipeline::{PipelineSettings, Triplets};
use crate::progress::{Cancelled, Progress};

/// Triplets that a drive is thinned to: enough to tell millimetres from decimetres.
const THINNED: usize = 300;
/// Fewest triplets of a drive that is explained: with fewer a drive fits anything.
const FEWEST_TRIPLETS: usize = 20;
/// An explanation may fit this much worse than what it explains, and than the best explanation.
const NO_WORSE: f64 = 1.2;
const AS_GOOD: f64 = 1.5;
/// Differences of a fit below this are noise (m).
const FIT_NOISE_M: f64 = 0.0005;
/// What fits this many times worse than it may, near a first guess, is looked into no further.
const HOPELESS: f64 = 4.0;
/// What was off has to be off by less than this part of it.
const CLEARLY_LESS: f64 = 0.5;
/// Most explanations that are named.
const MOST_NAMED: usize = 3;
/// Where the outlier filter left a smaller part of a station's readings than this, its limits act on wrong units. Then
/// it is run again on what the readings would be, as many of them as this.
const MOSTLY_REJECTED: f64 = 0.6;
const MOST_READINGS: usize = 20_000;

/// What was misread.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scope {
    Tracks,
    ControlPoints,
    Both,
}

/// What things would show, had one mistake not been made.
#[derive(Clone, Copy)]
struct Explanation {
    misreading: Misreading,
    scope: Scope,
    shown: Shown,
}

/// What was tried on a drive: the same for all answers that are asked about, and made when the first one needs it.
#[derive(Default)]
pub struct Tried(Option<Tries>);

struct Tries {
    /// What things show as they were read; `None` without an answer.
    base: Option<(Shown, [RigidTransform; 3])>,
    undone: Option<Vec<Explanation>>,
}

/// The misreadings that explain what contradicts method D here, the likeliest first; one line that none does, where the
/// contradiction is a gross one; nothing where nothing contradicts it.
pub fn explain(
    deployment: &Deployment,
    rig: &Rig,
    triplets: &Triplets,
    sigma: Option<&[TransformSigma; 2]>,
    tried: &mut Tried,
    progress: &Progress,
) -> Result<Vec<Finding>, Cancelled> {
    let tries = tried.0.get_or_insert_with(|| {
        let points = deployment.comparable_control_points();
        let triplets = thinned(triplets);
        let base = twins(rig, &triplets, f64::INFINITY).and_then(|twins| {
            let transforms = twins.chosen(rig, points);
            Some((Shown::of(rig, points, &triplets, &transforms)?, transforms))
        });
        Tries { base, undone: None }
    });
    let Some((base, base_transforms)) = tries.base else { return Ok(Vec::new()) };
    let case = Case { witnesses: Witnesses::new(rig, sigma), base };
    if !case.is_contradicted() {
        return Ok(Vec::new());
    }
    let undone = match &tries.undone {
        Some(undone) => undone,
        None => tries.undone.insert(try_all(
            deployment,
            rig,
            triplets,
            &base,
            &base_transforms,
            progress,
        )?),
    };
    let found = undone.iter().copied().filter(|one| case.is_explained_by(&one.shown)).collect();
    Ok(case.in_words(found, deployment))
}

/// What each misreading would show if it was one, of the tracks, of the control points, and of both.
fn try_all(
    deployment: &Deployment,
    rig: &Rig,
    triplets: &Triplets,
    base: &Shown,
    base_transforms: &[RigidTransform; 3],
    progress: &Progress,
) -> Result<Vec<Explanation>, Cancelled> {
    let points = deployment.comparable_control_points();
    let constants_m = deployment.tracks.each_ref().map(|track| track.prism_constant_m);
    let rejected = mostly_rejected(deployment, triplets);
    let triplets = thinned(triplets);
    let hopeless_m = HOPELESS * (NO_WORSE * base.fit_m + FIT_NOISE_M);
    let one = |misreading: &Misreading| {
        progress.check()?;
        let misreading = *misreading;
        let undone = match misreading {
            Misreading::Feet(_) if rejected => thinned(&filtered_again(deployment, misreading)),
            _ => misreading.undone(&triplets, constants_m),
        };
        let found = twins(rig, &undone, hopeless_m);
        let show = |points: &[ControlPointSet]| {
            Shown::of(rig, points, &undone, &found.as_ref()?.chosen(rig, points))
        };
        let mut all = vec![(Scope::Tracks, show(points))];
        if base.control_points_m.is_some() {
            let points = misreading.undone_in_points(points, constants_m);
            all.push((Scope::Both, show(&points)));
            let control_points_m = control_points_apart_m(&points, base_transforms);
            all.push((Scope::ControlPoints, Some(Shown { control_points_m, ..*base })));
        }
        let explanation = |(scope, shown): (Scope, Option<Shown>)| {
            Some(Explanation { misreading, scope, shown: shown? })
        };
        Ok(all.into_iter().filter_map(explanation).collect::<Vec<_>>())
    };
    let all: Result<Vec<_>, Cancelled> = Misreading::ALL.par_iter().map(one).collect();
    Ok(all?.concat())
}

/// The published method's solutions on some triplets; `None` where there are too few, or they fit worse than that.
fn twins(rig: &Rig, triplets: &Triplets, hopeless_m: f64) -> Option<Twins> {
    if triplets.len() < FEWEST_TRIPLETS {
        return None;
    }
    Twins::of(rig, triplets, hopeless_m)
}

/// What makes triplets out of tracks that have none: ranges in feet, whose rates no filter lets through.
pub fn explain_no_triplets(deployment: &Deployment, rig: &Rig) -> Option<String> {
    let feet = Misreading::ALL.into_iter().filter(|one| matches!(one, Misreading::Feet(_)));
    let (misreading, count, fit_m) = feet
        .filter_map(|misreading| {
            let triplets = filtered_again(deployment, misreading);
            let some = thinned(&triplets);
            if some.len() < FEWEST_TRIPLETS {
                return None;
            }
            let transforms = Twins::of(rig, &some, f64::INFINITY)?
                .chosen(rig, deployment.comparable_control_points());
            let shown = Shown::of(rig, &[], &some, &transforms)?;
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

/// Whether the outlier filter left less than it would of readings in the right unit.
fn mostly_rejected(deployment: &Deployment, triplets: &Triplets) -> bool {
    deployment.tracks.iter().zip(triplets.readings.iter()).any(|(track, filtered)| {
        (filtered.time_s.len() as f64) < MOSTLY_REJECTED * track.measurements.len() as f64
    })
}

/// What the pipeline makes of the first readings, by its default settings, had they been read right.
fn filtered_again(deployment: &Deployment, misreading: Misreading) -> Triplets {
    let tracks: [Track; 3] = std::array::from_fn(|station| {
        let track = &deployment.tracks[station];
        let readings = track.measurements.iter().take(MOST_READINGS);
        Track {
            measurements: readings.map(|m| misreading.undone_in_range(station, m)).collect(),
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

/// What is to be explained.
struct Case<'a> {
    witnesses: Witnesses<'a>,
    /// What the answer shows as things were read.
    base: Shown,
}

/// What speaks against an answer.
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

    /// Whether all witnesses agree with what this shows, and one of them did not before.
    fn is_explained_by(&self, shown: &Shown) -> bool {
        let (was, is) = (self.complaints(&self.base), self.complaints(shown));
        if is.area || is.heights || is.control_points {
            return false;
        }
        // Prisms that lie in a line contradict nothing, and explain nothing.
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
        let heights = self.height_is_suspicious()
            && worst(shown).zip(worst(&self.base)).is_some_and(|(is, was)| is < CLEARLY_LESS * was);
        // Heights that are only suspicious are no reason to believe something that fits worse.
        let only_heights = heights && shown.fit_m < self.base.fit_m + FIT_NOISE_M;
        fit || was.area || was.control_points || (was.heights && heights) || only_heights
    }

    /// The explanations that fit as well as the best.
    fn in_words(&self, mut found: Vec<Explanation>, deployment: &Deployment) -> Vec<Finding> {
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
        one: &Explanation,
        deployment: &Deployment,
        is_alternative: bool,
    ) -> Finding {
        let Explanation { misreading, scope, .. } = one;
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
            // Where the rig is the only one to contradict them, it may be the one that is wrong.
            only_by_rig: !(was.fit || was.control_points) && *scope != Scope::ControlPoints,
            is_alternative,
            remedy: read_with.map(|overrides| Remedy::ReadWith(Box::new(overrides))),
        })
    }

    /// "the distances fit to 1.3 mm instead of 42 mm", and so on.
    fn improvements(&self, one: &Explanation) -> Vec<String> {
        let Explanation { shown, .. } = one;
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
                "prisms 1, 2, 3 lie the same way round as in the reading of the rig".to_owned(),
            );
        }
        if self.height_is_suspicious()
            && let Some((is, was)) =
                self.witnesses.heights_off_m(shown).zip(self.witnesses.heights_off_m(base))
        {
            let [is, was] = [is, was].map(|off_m| mm(off_m.into_iter().fold(0.0, f64::max)));
            compared
                .push(format!("heights of the prisms are {is} instead of {was} from that reading"));
        }
        if was.control_points
            && let Some((is, was)) = shown.control_points_m.zip(base.control_points_m)
        {
            compared.push(format!(
                "the control points lie {} instead of {} apart",
                mm(is),
                mm(was)
            ));
        }
        compared
    }
}

fn correction(misreading: Misreading, scope: Scope, deployment: &Deployment) -> String {
    let of_points = "correct the files of control points";
    let of_tracks = misreading.remedy(deployment).map_or_else(
        || "correct what that station recorded".to_owned(),
        |key| format!("set `{key}` of deployment.toml"),
    );
    match scope {
        Scope::Tracks => of_tracks,
        Scope::ControlPoints => of_points.to_owned(),
        Scope::Both => format!("{of_tracks}, and {of_points}"),
    }
}
