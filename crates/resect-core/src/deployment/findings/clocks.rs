//! Findings about the clocks against that of station 1.

use crate::deployment::kinds;
use crate::deployment::{Finding, FindingKind, Remedy, Subject, Unit};
use crate::statistics::estimate::{Estimate, sigmas_in_words};

fn late_or_early(offset_s: &Estimate) -> &'static str {
    if offset_s.value > 0.0 { "late" } else { "early" }
}

fn about(kind: FindingKind, station: usize, message: String) -> Finding {
    Finding::new(kind, message).about(Subject::Station(station))
}

pub fn clock_offset(station: usize, offset_s: &Estimate) -> Finding {
    let message = format!(
        "station {}'s stamps are {:.2} ± {:.2} ms {} against station 1's{}",
        station + 1,
        offset_s.value.abs() * 1e3,
        offset_s.sigma * 1e3,
        late_or_early(offset_s),
        sigmas_in_words(offset_s.sigmas_from(0.0)),
    );
    about(kinds::CLOCK_OFFSET, station, message).estimate("offset", offset_s, Unit::Second)
}

pub fn clock_drift(station: usize, drift: &Estimate) -> Finding {
    let message = format!(
        "station {}'s clock drifts by {:+.1} ± {:.1} µs a second",
        station + 1,
        drift.value * 1e6,
        drift.sigma * 1e6,
    );
    about(kinds::CLOCK_DRIFT, station, message).estimate("drift", drift, Unit::Ratio)
}

pub fn clock_offset_suspected(station: usize, offset_s: &Estimate) -> Finding {
    let message = format!(
        "station {}'s stamps seem {:.1} ± {:.1} ms {} against station 1's, which biases this answer; the joint \
         estimate corrects it if it converges",
        station + 1,
        offset_s.value.abs() * 1e3,
        offset_s.sigma * 1e3,
        late_or_early(offset_s),
    );
    about(kinds::CLOCK_OFFSET_SUSPECTED, station, message)
        .estimate("offset", offset_s, Unit::Second)
        .with(Remedy::JointEstimate)
}

/// `jump_s` is the difference between the second half of the drive and the first.
pub fn clock_jump_suspected(station: usize, jump_s: &Estimate) -> Finding {
    let message = format!(
        "station {}'s stamps seem {:+.1} ± {:.1} ms later in the second half of the drive than in the first, which biases this \
         answer; the joint estimate reports its time if it converges",
        station + 1,
        jump_s.value * 1e3,
        jump_s.sigma * 1e3,
    );
    about(kinds::CLOCK_JUMP_SUSPECTED, station, message)
        .estimate("jump", jump_s, Unit::Second)
        .with(Remedy::JointEstimate)
}

/// `is_allowed_for` is true if the drift is a parameter of the estimate.
pub fn clock_drift_implausible(station: usize, drift: &Estimate, is_allowed_for: bool) -> Finding {
    let consequence = if is_allowed_for {
        "the estimate models a constant drift only"
    } else {
        "the answer is not corrected for it"
    };
    let message = format!(
        "station {}'s clock seems to drift by {:+.0} ± {:.0} µs a second, more than those of total stations do: it \
         is not synchronised, jumps or wanders; {consequence}",
        station + 1,
        drift.value * 1e6,
        drift.sigma * 1e6,
    );
    about(kinds::CLOCK_DRIFT_IMPLAUSIBLE, station, message).estimate("drift", drift, Unit::Ratio)
}

pub(super) fn examples() -> Vec<Finding> {
    let estimate = |value, sigma| Estimate { value, sigma };
    vec![
        clock_offset(2, &estimate(0.0037, 0.0003)),
        clock_drift(2, &estimate(3e-6, 5e-7)),
        clock_offset_suspected(1, &estimate(-0.01, 0.001)),
        clock_jump_suspected(1, &estimate(0.02, 0.001)),
        clock_drift_implausible(1, &estimate(4e-5, 1e-6), true),
    ]
}
