//! Findings of the joint estimate: instruments, steps, and the sources of its σ.

use super::contradiction::Contradiction;
use super::instruments::{InstrumentError, instruments};
use super::joint_estimate::{Dominant, JointEstimate};
use super::stability::{Step, Stepped};
use super::unknowns::{CLOCKS, DISTANCES, DRIFTS, LATENCIES};
use crate::calibration::Verdict;
use crate::calibration::{Estimate, Quantity, clocks_in_words};
use crate::deployment::findings::instruments::{
    NamedError, Noise, StepContext, UncertaintySource, clock_stepped, distance_estimated,
    distance_implausible, distances_implausible, errors_implausible, instrument_error,
    instrument_error_implausible, noise_levels, range_wander_implausible,
    stated_error_contradicted, station_errors_implausible, station_moved, uncertainty_sources,
};
use crate::deployment::{Finding, pair_label};

/// How far one estimate may be from its prior by chance (σ): once in forty thousand, by some of thirty.
const MOST_STRAIN: f64 = 4.2;
/// How far the estimates of a station, or all of them, may be from their priors together by chance (σ): once in a
/// thousand.
const MOST_STRAIN_OF_STATION: f64 = 3.0;
const MOST_STRAIN_OF_ALL: f64 = 3.3;
/// A distance this far from its measurement asks for a new one (m).
const NOTABLE_DISTANCE_M: f64 = 0.003;
/// The largest errors of ranges to prisms that turn are 5 mm (Lackner & Lienhart 2016).
const MOST_WANDER_M: f64 = 0.005;
/// What is looked at before and after a step (s): its moment is known to about six seconds.
const AROUND_A_STEP_S: f64 = 20.0;

/// Estimated distances, and the distances measured on the vehicle (m).
pub fn distances(found: &JointEstimate, inter_prism_m: &[f64; 3]) -> Vec<Finding> {
    let estimated = found.distances_m.iter().flatten().zip(inter_prism_m).enumerate();
    estimated
        .map(|(pair, (distance, measured_m))| {
            let is_notable = (distance.value - measured_m).abs() > NOTABLE_DISTANCE_M;
            distance_estimated(pair, *measured_m, distance, is_notable)
        })
        .collect()
}

pub fn findings(found: &JointEstimate) -> Vec<Finding> {
    let mut findings = vec![noise(found)];
    findings.extend(clocks_in_words::clocks(&found.clock_offsets_s, &found.clock_drifts));
    for (number, drive) in found.drives.iter().enumerate().skip(1) {
        let clocks =
            clocks_in_words::clocks(&drive.late_s, &[Estimate { value: 0.0, sigma: 1.0 }; 2]);
        let context = format!("drive {}", number + 1);
        findings.extend(clocks.into_iter().map(|finding| finding.within(&context)));
    }
    let told = instruments(found).into_iter().filter(InstrumentError::is_told);
    findings.extend(told.map(|error| with_name(&error, instrument_error)));
    findings.extend([1, 2].map(|station| dominant(found, station)));
    findings
}

/// What speaks against the estimate itself, each with the verdict that it allows at most.
pub fn doubts(found: &JointEstimate) -> Vec<(Verdict, Finding)> {
    let mut doubts = Vec::new();
    let mut doubt = |finding: Finding| doubts.push((Verdict::Weak, finding));
    let strain = &found.strain;
    let mut strained = false;
    for error in instruments(found) {
        let sigmas = strain.of[error.place].abs();
        if sigmas > MOST_STRAIN {
            strained = true;
            doubt(with_name(&error, |named| instrument_error_implausible(named, sigmas)));
        }
    }
    for pair in 0..3 {
        let sigmas = strain.of[DISTANCES + pair].abs();
        if found.distances_m.is_some() && sigmas > MOST_STRAIN {
            strained = true;
            let off_m = strain.moved[DISTANCES + pair];
            doubt(distance_implausible(pair, off_m, found.sizes.inter_prism_m, sigmas));
        }
    }
    if !strained && found.distances_m.is_some() && strain.of_distances > MOST_STRAIN_OF_STATION {
        strained = true;
        let off_m = [0, 1, 2].map(|pair| strain.moved[DISTANCES + pair]);
        doubt(distances_implausible(off_m, strain.of_distances));
    }
    for contradiction in &found.contradictions {
        if contradiction.sigmas.abs() > MOST_STRAIN {
            strained = true;
            doubt(contradicted(contradiction, found));
        }
    }
    for (station, sigmas) in strain.of_stations.into_iter().enumerate() {
        if sigmas > MOST_STRAIN_OF_STATION {
            strained = true;
            doubt(station_errors_implausible(station, sigmas));
        }
    }
    if !strained && strain.of_all > MOST_STRAIN_OF_ALL {
        doubt(errors_implausible(strain.of_all));
    }
    if found.wander.sigma_m > MOST_WANDER_M {
        doubt(range_wander_implausible(found.wander.sigma_m));
    }
    doubts.extend(found.stepped.iter().map(|step| stepped(step, found)));
    doubts.extend(
        clocks_in_words::implausible_drifts(&found.clock_drifts, &jumping(found), true)
            .into_iter()
            .map(|finding| (Verdict::Weak, finding)),
    );
    doubts
}

/// The finding that `finding` makes of an error of an instrument.
fn with_name(error: &InstrumentError, finding: impl FnOnce(&NamedError<'_>) -> Finding) -> Finding {
    let InstrumentError { station, kind, estimate, known, .. } = *error;
    finding(&NamedError {
        sentence: &kind.sentence(station),
        station: Some(station),
        quantity: kind.quantity(),
        estimate,
        prior_sigma: known,
    })
}

/// An error that was stated to be smaller than the data shows.
fn contradicted(contradiction: &Contradiction, found: &JointEstimate) -> Finding {
    let Contradiction { place, found: estimate, sigmas } = *contradiction;
    let of_instruments = instruments(found);
    if let Some(error) = of_instruments.into_iter().find(|error| error.place == place) {
        let error = InstrumentError { estimate, ..error };
        return with_name(&error, |named| stated_error_contradicted(named, sigmas));
    }
    let sizes = &found.sizes;
    let (sentence, quantity, prior_sigma) = match place {
        CLOCKS..DRIFTS => {
            let sentence = format!("station {}'s stamps are late by", place - CLOCKS + 2);
            (sentence, Quantity::Time, sizes.clock_offset_s)
        }
        DRIFTS..LATENCIES => {
            let sentence = format!("station {}'s clock drifts by", place - DRIFTS + 2);
            (sentence, Quantity::Drift, sizes.clock_drift)
        }
        _ => {
            let pair = pair_label(place - DISTANCES);
            let sentence = format!("prisms {pair} are farther apart by");
            (sentence, Quantity::Length, sizes.inter_prism_m)
        }
    };
    let named = NamedError { sentence: &sentence, station: None, quantity, estimate, prior_sigma };
    stated_error_contradicted(&named, sigmas)
}

/// Whether the clocks of stations 2 and 3 jump.
fn jumping(found: &JointEstimate) -> [bool; 2] {
    [1, 2].map(|station| {
        let of_it = |step: &Step| matches!(step.what, Stepped::Clock(_)) && step.station == station;
        found.stepped.iter().any(of_it)
    })
}

/// A step of a station or its clock, and the verdict that it allows.
fn stepped(step: &Step, found: &JointEstimate) -> (Verdict, Finding) {
    let is_usual = found.is_usual(step);
    let at_s = found.at_s(step);
    let context = StepContext {
        station: step.station,
        when: &found.when(step),
        is_usual,
        span_s: (!step.slowly).then_some([at_s - AROUND_A_STEP_S, at_s + AROUND_A_STEP_S]),
    };
    let finding = match &step.what {
        Stepped::Clock(by_s) => clock_stepped(context, by_s),
        Stepped::Station { turned_rad, .. } => {
            let moved_m = step.moved_m().unwrap_or(Estimate { value: 0.0, sigma: 0.0 });
            station_moved(context, turned_rad, &moved_m)
        }
    };
    (if is_usual { Verdict::Good } else { Verdict::Weak }, finding)
}

/// The largest sources of σ of station 2 or 3 (1 or 2).
fn dominant(found: &JointEstimate, station: usize) -> Finding {
    let sources = [0, 1, 2, 3].map(|axis| {
        let Dominant { what, part, whole } = found.dominant(4 * (station - 1) + axis);
        UncertaintySource { source: what, part, whole }
    });
    uncertainty_sources(station, sources)
}

fn noise(found: &JointEstimate) -> Finding {
    let levels = &found.levels;
    noise_levels(Noise {
        range_m: levels.range_m(),
        angle_rad: levels.angle_rad,
        stamp_s: levels.jitter_s,
        range_wander_m: found.wander.sigma_m,
    })
}
