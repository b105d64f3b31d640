//! Findings of the joint estimate: instruments, steps, and the sources of its σ.

use super::instrument_errors::{InstrumentError, instrument_errors};
use super::joint_estimate::{JointEstimate, LargestSource};
use super::state_vector::{CLOCKS, DISTANCES, DRIFTS, LATENCIES};
use super::stated_size_conflict::StatedSizeConflict;
use super::step_search::{StationStep, StepSize};
use crate::calibration::Verdict;
use crate::calibration::{Estimate, Quantity, clocks_in_words};
use crate::deployment::findings::instruments::{
    NamedError, ReadingNoise, StepContext, UncertaintySource, UndecidedChange, clock_stepped,
    distance_estimated, distance_implausible, distances_implausible, errors_implausible,
    instrument_error, instrument_error_implausible, noise_levels, range_wander_implausible,
    set_up_change_undecided, set_up_changed, stated_error_contradicted, station_errors_implausible,
    station_moved, uncertainty_sources,
};
use crate::deployment::{Finding, pair_label};
use crate::network::{Number, PerStation};
use crate::statistics::estimate::SUPPORTED_SIGMAS;

/// Critical distance of one constant from its prior (σ). Textbook: one of thirty exceeds it by chance once in a thousand drives.
const CRITICAL_SIGMAS: f64 = 4.2;
/// Critical distance of the constants of a station from their priors together (σ). Textbook: exceeded by chance once in a
/// thousand drives.
const CRITICAL_STATION_SIGMAS: f64 = 3.0;
/// Critical distance of all constants from their priors together (σ). Textbook: exceeded by chance once in a thousand drives.
const CRITICAL_ALL_SIGMAS: f64 = 3.3;
/// An estimated distance this far from the measured one should be measured again (m).
const NOTABLE_DISTANCE_M: f64 = 0.003;
/// A larger standard deviation of the slow errors of ranges is implausible (m). Source: the largest errors of ranges to prisms
/// that turn are 5 mm (Lackner & Lienhart 2016).
const LARGEST_WANDER_M: f64 = 0.005;
/// Time that is shown before and after a step (s); its time is known to about six seconds.
const STEP_MARGIN_S: f64 = 20.0;

/// Reports the estimated distances that differ significantly from those measured on the vehicle (m).
pub fn distances(joint: &JointEstimate, inter_prism_m: &[f64; 3]) -> Vec<Finding> {
    let estimated = joint.distances_m.iter().flatten().zip(inter_prism_m).enumerate();
    estimated
        .filter(|(_, (distance, measured_m))| {
            distance.sigmas_from(**measured_m).abs() > SUPPORTED_SIGMAS
        })
        .map(|(pair, (distance, measured_m))| {
            let is_notable = (distance.value - measured_m).abs() > NOTABLE_DISTANCE_M;
            distance_estimated(pair, *measured_m, distance, is_notable)
        })
        .collect()
}

/// Describes noise, clocks, significant instrument errors, and the largest sources of σ.
pub fn findings(joint: &JointEstimate) -> Vec<Finding> {
    let mut findings = vec![noise(joint)];
    findings.extend(clocks_in_words::clocks(
        &by_station(joint.clock_offsets_s),
        &by_station(joint.clock_drifts),
    ));
    for (number, drive) in joint.drives.iter().enumerate().skip(1) {
        let offsets_s = by_station(drive.offsets_s);
        let clocks = clocks_in_words::clocks(&offsets_s, &offsets_s.map(|_| Estimate::ZERO));
        let context = format!("drive {}", number + 1);
        findings.extend(clocks.into_iter().map(|finding| finding.within(&context)));
    }
    let significant = instrument_errors(joint).into_iter().filter(InstrumentError::is_significant);
    findings.extend(significant.map(|error| with_name(&error, instrument_error)));
    findings.extend([1, 2].map(|station| largest_sources(joint, station)));
    findings
}

/// Describes the change of one station's set-up between the survey and the drive, which the estimate models.
pub fn set_up_change(joint: &JointEstimate) -> Option<Finding> {
    let change = joint.set_up_change()?;
    Some(set_up_changed(change.station?, &change.turned_rad, &change.moved_length_m()))
}

/// Lists evidence against the estimate, each with the best verdict that it allows.
pub fn doubts(joint: &JointEstimate) -> Vec<(Verdict, Finding)> {
    let mut doubts = Vec::new();
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
    for pair in 0..3 {
        let sigmas = conflict.sigmas[DISTANCES + pair].abs();
        if joint.distances_m.is_some() && sigmas > CRITICAL_SIGMAS {
            has_conflict = true;
            let off_m = conflict.change[DISTANCES + pair];
            doubt(distance_implausible(pair, off_m, joint.sizes.inter_prism_m, sigmas));
        }
    }
    if !has_conflict
        && joint.distances_m.is_some()
        && conflict.distances_sigmas > CRITICAL_STATION_SIGMAS
    {
        has_conflict = true;
        let off_m = [0, 1, 2].map(|pair| conflict.change[DISTANCES + pair]);
        doubt(distances_implausible(off_m, conflict.distances_sigmas));
    }
    for stated_size_conflict in &joint.stated_size_conflicts {
        if stated_size_conflict.sigmas.abs() > CRITICAL_SIGMAS {
            has_conflict = true;
            doubt(stated_size(stated_size_conflict, joint));
        }
    }
    for (station, sigmas) in conflict.station_sigmas.into_iter().enumerate() {
        if sigmas > CRITICAL_STATION_SIGMAS {
            has_conflict = true;
            doubt(station_errors_implausible(station, sigmas));
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
    doubts.extend(joint.steps.iter().map(|step| detected_step(step, joint)));
    doubts.extend(
        clocks_in_words::implausible_drifts(
            &by_station(joint.clock_drifts),
            &jumping_clocks(joint),
            true,
        )
        .into_iter()
        .map(|finding| (Verdict::Weak, finding)),
    );
    doubts
}

/// Returns what a constructor of findings makes of an instrument's error.
fn with_name(error: &InstrumentError, finding: impl FnOnce(&NamedError<'_>) -> Finding) -> Finding {
    let InstrumentError { station, kind, estimate, prior_sigma, .. } = *error;
    finding(&NamedError {
        sentence: &kind.sentence(station),
        station: Some(station),
        quantity: kind.quantity(),
        estimate,
        prior_sigma,
    })
}

/// The finding of an error that the data shows to be larger than stated.
fn stated_size(conflict: &StatedSizeConflict, joint: &JointEstimate) -> Finding {
    let StatedSizeConflict { index, estimate, sigmas } = *conflict;
    let of_instruments = instrument_errors(joint);
    if let Some(error) = of_instruments.into_iter().find(|error| error.index == index) {
        let error = InstrumentError { estimate, ..error };
        return with_name(&error, |named| stated_error_contradicted(named, sigmas));
    }
    let sizes = &joint.sizes;
    let (sentence, quantity, prior_sigma) = match index {
        CLOCKS..DRIFTS => {
            let sentence = format!("station {}'s stamps are late by", index - CLOCKS + 2);
            (sentence, Quantity::Time, sizes.clock_offset_s)
        }
        DRIFTS..LATENCIES => {
            let sentence = format!("station {}'s clock drifts by", index - DRIFTS + 2);
            (sentence, Quantity::Drift, sizes.clock_drift)
        }
        _ => {
            let pair = pair_label(index - DISTANCES);
            let sentence = format!("the distance between prisms {pair} is off by");
            (sentence, Quantity::Length, sizes.inter_prism_m)
        }
    };
    let named = NamedError { sentence: &sentence, station: None, quantity, estimate, prior_sigma };
    stated_error_contradicted(&named, sigmas)
}

/// Returns true for each station whose clock has a step.
fn jumping_clocks(joint: &JointEstimate) -> PerStation<bool> {
    joint.station1_from_station.map_each(|station, _| {
        let of_it = |step: &StationStep| {
            matches!(step.size, StepSize::Clock(_)) && step.station == station.index()
        };
        joint.steps.iter().any(of_it)
    })
}

/// Returns the estimates of stations 2 and 3 after that of station 1, the reference.
fn by_station([second, third]: [Estimate; 2]) -> PerStation<Estimate> {
    [Estimate::ZERO, second, third].into()
}

/// The finding of a step, and the best verdict that it allows.
fn detected_step(step: &StationStep, joint: &JointEstimate) -> (Verdict, Finding) {
    let is_usual = joint.is_usual(step);
    let time_s = joint.step_time_s(step);
    let context = StepContext {
        station: step.station,
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

/// The largest sources of σ of station 2 or 3 (1 or 2).
fn largest_sources(joint: &JointEstimate, station: usize) -> Finding {
    let sources = [0, 1, 2, 3].map(|axis| {
        let LargestSource { name, sigma, total_sigma } =
            joint.largest_source(4 * (station - 1) + axis);
        UncertaintySource { source: name, part: sigma, whole: total_sigma }
    });
    uncertainty_sources(station, sources)
}

fn noise(joint: &JointEstimate) -> Finding {
    let levels = &joint.levels;
    noise_levels(ReadingNoise {
        range_m: levels.range_m(),
        angle_rad: levels.angle_rad,
        stamp_s: levels.jitter_s,
        slow_range_m: joint.slow_ranges.sigma_m,
        slow_across_m: joint.slow_across.sigma_m,
        slow_upward_m: joint.slow_upward.sigma_m,
    })
}
