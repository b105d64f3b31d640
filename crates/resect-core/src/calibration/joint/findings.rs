//! Findings of the joint estimate: instruments, steps, and the sources of its σ.

use super::instrument_errors::{InstrumentError, instrument_errors};
use super::joint_estimate::{JointEstimate, LargestSource};
use super::prior_conflict::CRITICAL_SIGMAS;
use super::stated_size_conflict::StatedSizeConflict;
use super::step_search::{StationStep, StepSize};
use super::unknown::{DISTANCE, Owner};
use crate::calibration::Verdict;
use crate::calibration::{Estimate, clocks_in_words};
use crate::deployment::findings::drive::heights_undetermined;
use crate::deployment::findings::instruments::{
    NamedError, ReadingNoise, StepContext, UncertaintySource, UndecidedChange, clock_stepped,
    distance_estimated, distance_implausible, distances_implausible, errors_implausible,
    instrument_error, instrument_error_implausible, noise_levels, range_wander_implausible,
    set_up_change_undecided, set_up_changed, stated_error_contradicted, station_errors_implausible,
    station_moved, uncertainty_sources,
};
use crate::deployment::{Finding, Rig};
use crate::network::{Number, Pair, PerPair, PerStation, Station};
use crate::statistics::estimate::SUPPORTED_SIGMAS;

/// Critical distance of the constants of a station from their priors together (σ). Textbook: exceeded by chance once in a
/// thousand drives.
const CRITICAL_STATION_SIGMAS: f64 = 3.0;
/// Critical distance of all constants from their priors together (σ). Textbook: exceeded by chance once in a thousand drives.
const CRITICAL_ALL_SIGMAS: f64 = 3.3;
/// A larger standard deviation of the slow errors of ranges is implausible (m). Source: the largest errors of ranges to prisms
/// that turn are 5 mm (Lackner & Lienhart 2016).
const LARGEST_WANDER_M: f64 = 0.005;
/// Least share of the information on heights that is not noise. Measured: in a tunnel by the drive alone, heights with 0.16 of it were 14 σ off.
/// By drive and rig it is 0.59 or more.
const LEAST_HEIGHT_SHARE: f64 = 0.2;
/// Time that is shown before and after a step (s); its time is known to about six seconds.
const STEP_MARGIN_S: f64 = 20.0;

/// Reports the estimated distances that differ significantly from those measured on the vehicle (m).
fn distances(joint: &JointEstimate, inter_prism_m: &PerPair<f64>) -> Vec<Finding> {
    let estimated = joint.distances_m().into_iter().flatten().enumerate();
    let estimated = estimated.map(|(place, distance)| {
        let pair = joint.layout().pair(Pair::at(place));
        (pair, distance, inter_prism_m[pair])
    });
    estimated
        .filter(|(_, distance, measured_m)| {
            distance.sigmas_from(*measured_m).abs() > SUPPORTED_SIGMAS
        })
        .map(|(pair, distance, measured_m)| distance_estimated(pair.index(), measured_m, &distance))
        .collect()
}

/// Adds the conclusion of the survey, which comes before other notes, and the notes.
pub fn add_notes(findings: &mut Vec<Finding>, joint: &JointEstimate, rig: Option<&Rig>) {
    findings.splice(0..0, set_up_change(joint));
    findings.extend(rig.into_iter().flat_map(|rig| distances(joint, &rig.inter_prism_m)));
    findings.extend(notes(joint));
}

/// Describes noise, clocks, significant instrument errors, and the largest sources of σ.
fn notes(joint: &JointEstimate) -> Vec<Finding> {
    let mut findings = vec![noise(joint)];
    findings.extend(clocks_in_words::clocks(&joint.clock_offsets_s, &joint.clock_drifts()));
    for (number, drive) in joint.drives.iter().enumerate().skip(1) {
        let unknown = drive.offsets_s.map(|_| Estimate { value: 0.0, sigma: 1.0 });
        let clocks = clocks_in_words::clocks(&drive.offsets_s, &unknown);
        let context = format!("drive {}", number + 1);
        findings.extend(clocks.into_iter().map(|finding| finding.within(&context)));
    }
    let significant = instrument_errors(joint).into_iter().filter(InstrumentError::is_significant);
    findings.extend(significant.map(|error| with_name(&error, instrument_error)));
    let moved = joint.clock_offsets_s.numbers().filter_map(Station::slot);
    findings.extend(moved.map(|slot| largest_sources(joint, slot)));
    findings
}

/// Describes the change of one station's set-up between the survey and the drive, which the estimate models.
fn set_up_change(joint: &JointEstimate) -> Option<Finding> {
    let change = joint.set_up_change()?;
    Some(set_up_changed(change.station?.index(), &change.turned_rad, &change.moved_length_m()))
}

/// Lists evidence against the estimate, each with the best verdict that it allows.
pub fn doubts(joint: &JointEstimate) -> Vec<(Verdict, Finding)> {
    let mut doubts = Vec::new();
    if joint.height_share < LEAST_HEIGHT_SHARE {
        let finding = heights_undetermined(1.0 - joint.height_share.max(0.0));
        doubts.push((Verdict::Degenerate, finding));
    }
    let mut doubt = |finding: Finding| doubts.push((Verdict::Weak, finding));
    let conflict = &joint.prior_conflict;
    let mut has_conflict = false;
    for error in instrument_errors(joint) {
        let sigmas = conflict.sigmas[error.index].abs();
        if sigmas > CRITICAL_SIGMAS {
            has_conflict = true;
            let prior_mean = error.estimate.value - conflict.change[error.index];
            doubt(with_name(&error, |named| {
                instrument_error_implausible(named, prior_mean, sigmas)
            }));
        }
    }
    for (place, index) in joint.layout().indices(&DISTANCE).enumerate() {
        let sigmas = conflict.sigmas[index].abs();
        if sigmas > CRITICAL_SIGMAS {
            has_conflict = true;
            let (off_m, pair) = (conflict.change[index], joint.layout().pair(Pair::at(place)));
            doubt(distance_implausible(pair.index(), off_m, joint.sizes.inter_prism_m, sigmas));
        }
    }
    if !has_conflict && conflict.distances_sigmas > CRITICAL_STATION_SIGMAS {
        has_conflict = true;
        let distances = joint.layout().indices(&DISTANCE).enumerate();
        let off_m = distances
            .map(|(place, index)| (joint.layout().pair(Pair::at(place)), conflict.change[index]));
        let off_m: Vec<(Pair, f64)> = off_m.collect();
        doubt(distances_implausible(&off_m, conflict.distances_sigmas));
    }
    for stated_size_conflict in &joint.stated_size_conflicts {
        if stated_size_conflict.sigmas.abs() > CRITICAL_SIGMAS {
            has_conflict = true;
            doubt(stated_size(stated_size_conflict, joint));
        }
    }
    for (station, sigmas) in conflict.station_sigmas.each() {
        if *sigmas > CRITICAL_STATION_SIGMAS {
            has_conflict = true;
            doubt(station_errors_implausible(station.index(), *sigmas));
        }
    }
    if !has_conflict && conflict.all_sigmas > CRITICAL_ALL_SIGMAS {
        doubt(errors_implausible(conflict.all_sigmas));
    }
    if joint.slow_ranges.sigma_m > LARGEST_WANDER_M {
        doubt(range_wander_implausible(joint.slow_ranges.sigma_m));
    }
    if let Some(change) = joint.set_up_change().filter(|change| change.station.is_none()) {
        doubt(set_up_change_undecided(if change.distances_explain {
            UndecidedChange::StationOrRig
        } else {
            UndecidedChange::WhichStation
        }));
    }
    if joint.survey.as_ref().is_some_and(|survey| survey.may_have_changed) {
        doubt(set_up_change_undecided(UndecidedChange::Whether));
    }
    // A step that its own σ may hide was allowed by the priors, and changes nothing.
    let significant = joint.steps.iter().filter(|step| step.is_significant());
    doubts.extend(significant.map(|step| detected_step(step, joint)));
    let drifts = joint.clock_drifts_by_readings();
    let implausible = clocks_in_words::implausible_drifts(&drifts, &jumping_clocks(joint), true);
    doubts.extend(implausible.into_iter().map(|finding| (Verdict::Weak, finding)));
    doubts
}

/// Returns what a constructor of findings makes of an instrument's error.
fn with_name(error: &InstrumentError, finding: impl FnOnce(&NamedError<'_>) -> Finding) -> Finding {
    let InstrumentError { station, unknown, estimate, prior_sigma, .. } = *error;
    finding(&NamedError {
        sentence: &unknown.sentence_of(&station.to_string()),
        station: Some(station.index()),
        quantity: unknown.quantity,
        estimate,
        prior_sigma,
    })
}

/// The finding of an error that the data shows to be larger than stated.
fn stated_size(conflict: &StatedSizeConflict, joint: &JointEstimate) -> Finding {
    let StatedSizeConflict { unknown, owner, estimate, sigmas } = *conflict;
    let named = NamedError {
        sentence: &unknown.sentence_of(&joint.layout().owner_in_words(unknown, owner)),
        station: (unknown.owner == Owner::Station).then_some(owner),
        quantity: unknown.quantity,
        estimate,
        prior_sigma: unknown.prior.map_or(0.0, |prior| (prior.sigma)(&joint.sizes)),
    };
    stated_error_contradicted(&named, sigmas)
}

/// Returns true for each clock that has a step.
fn jumping_clocks(joint: &JointEstimate) -> PerStation<bool> {
    PerStation::from_fn(joint.layout().stations(), |station| {
        let of_it =
            |step: &StationStep| matches!(step.size, StepSize::Clock(_)) && step.station == station;
        joint.steps.iter().any(of_it)
    })
}

/// The finding of a step, and the best verdict that it allows.
fn detected_step(step: &StationStep, joint: &JointEstimate) -> (Verdict, Finding) {
    let is_usual = joint.is_usual(step);
    let time_s = joint.step_time_s(step);
    let context = StepContext {
        station: step.station.index(),
        other: (joint.layout().stations() == 2).then(|| 1 - step.station.index()),
        when: &joint.describe_time(step),
        is_usual,
        span_s: (!step.slowly).then_some([time_s - STEP_MARGIN_S, time_s + STEP_MARGIN_S]),
    };
    let finding = match &step.size {
        StepSize::Clock(by_s) => clock_stepped(context, by_s),
        StepSize::Station { turned_rad, .. } => {
            let moved_m = step.moved_m().unwrap_or(Estimate { value: 0.0, sigma: 0.0 });
            station_moved(context, turned_rad, &moved_m)
        }
    };
    (if is_usual { Verdict::Good } else { Verdict::Weak }, finding)
}

/// The largest sources of σ of the station of a slot.
fn largest_sources(joint: &JointEstimate, slot: usize) -> Finding {
    let sources = [0, 1, 2, 3].map(|axis| {
        let LargestSource { name, sigma, total_sigma } = joint.largest_source(4 * slot + axis);
        UncertaintySource { source: name, part: sigma, whole: total_sigma }
    });
    uncertainty_sources(slot + 1, sources)
}

fn noise(joint: &JointEstimate) -> Finding {
    let levels = &joint.levels;
    noise_levels(ReadingNoise {
        range_m: levels.range_m(),
        horizontal_rad: levels.horizontal_rad,
        vertical_rad: levels.vertical_rad,
        stamp_s: levels.jitter_s,
        slow_range_m: joint.slow_ranges.sigma_m,
        slow_across_m: joint.slow_across.sigma_m,
        slow_upward_m: joint.slow_upward.sigma_m,
    })
}
