//! What was found of the clocks of stations 2 and 3, in words.

use super::Estimate;
use super::estimate::{SUPPORTED_SIGMAS, sigmas_in_words};
use crate::deployment::{Finding, Remedy};

/// A clock that is off by more than both is worth a warning where it is not estimated (s).
const SUSPICIOUS_SIGMAS: f64 = 3.5;
pub const SUSPICIOUS_OFFSET_S: f64 = 0.002;
/// Four times what the prior allows (s per s).
const IMPLAUSIBLE_DRIFT: f64 = 20e-6;

/// What the clocks of stations 2 and 3 were found to do.
pub fn clocks(offsets_s: &[Estimate; 2], drifts: &[Estimate; 2]) -> Vec<Finding> {
    let offsets = offsets_s.iter().enumerate().map(|(slot, clock)| clock_in_words(slot + 2, clock));
    let drifts = drifts
        .iter()
        .enumerate()
        .filter(|(_, drift)| drift.sigmas_from(0.0).abs() > SUPPORTED_SIGMAS)
        .map(|(slot, drift)| {
            Finding::note(format!(
                "station {}'s clock drifts by {:+.1} ± {:.1} µs a second",
                slot + 2,
                drift.value * 1e6,
                drift.sigma * 1e6,
            ))
        });
    offsets.chain(drifts).collect()
}

/// "station 3's stamps are 3.7 ± 0.3 ms late".
fn clock_in_words(station: usize, clock: &Estimate) -> Finding {
    let direction = if clock.value > 0.0 { "late" } else { "early" };
    let sigmas = clock.sigmas_from(0.0).abs();
    let line = format!(
        "station {station}'s stamps are {:.2} ± {:.2} ms {direction} against station 1's{}",
        clock.value.abs() * 1e3,
        clock.sigma * 1e3,
        sigmas_in_words(sigmas),
    );
    Finding::note(line)
}

/// Clocks that differ between the halves of a drive.
pub fn suspected_jumps(jumps_s: &[Estimate; 2]) -> Vec<Finding> {
    jumps_s
        .iter()
        .enumerate()
        .filter(|(_, jump)| {
            jump.sigmas_from(0.0).abs() > SUSPICIOUS_SIGMAS
                && jump.value.abs() > SUSPICIOUS_OFFSET_S
        })
        .map(|(slot, jump)| {
            Finding::warning(format!(
                "station {}'s stamps seem {:+.1} ± {:.1} ms later in the second half of the drive than in the first, which \
                 biases this answer: look for a clock that jumped (the joint estimate says when)",
                slot + 2,
                jump.value * 1e3,
                jump.sigma * 1e3,
            ))
            .with(Remedy::JointEstimate)
        })
        .collect()
}

/// What becomes of a drift where none is estimated.
pub const NOT_CORRECTED: &str = "the answer is not corrected for that";

/// Drifts that no clock in order has, where no jump explains them, with what becomes of them.
pub fn implausible_drifts(
    drifts: &[Estimate; 2],
    jumping: &[bool; 2],
    consequence: &str,
) -> Vec<Finding> {
    drifts
        .iter()
        .zip(jumping)
        .enumerate()
        .filter(|(_, (drift, jumping))| {
            drift.value.abs() > IMPLAUSIBLE_DRIFT
                && drift.sigmas_from(0.0).abs() > SUSPICIOUS_SIGMAS
                && !**jumping
        })
        .map(|(slot, (drift, _))| {
            Finding::warning(format!(
                "station {}'s clock seems to drift by {:+.0} µs a second, more than those of total stations do: nothing keeps \
                 it, or it jumps or wanders; {consequence}",
                slot + 2,
                drift.value * 1e6,
            ))
        })
        .collect()
}

/// Clocks that are clearly off although they were not estimated: they bias the answer.
pub fn suspicions(clocks: &[Estimate; 2]) -> Vec<Finding> {
    clocks
        .iter()
        .enumerate()
        .filter(|(_, clock)| {
            clock.sigmas_from(0.0).abs() > SUSPICIOUS_SIGMAS
                && clock.value.abs() > SUSPICIOUS_OFFSET_S
        })
        .map(|(slot, clock)| {
            let direction = if clock.value > 0.0 { "late" } else { "early" };
            Finding::warning(format!(
                "station {}'s stamps seem {:.1} ± {:.1} ms {direction} against station 1's, which biases this answer: \
                 estimate the clocks, as the joint estimate does",
                slot + 2,
                clock.value.abs() * 1e3,
                clock.sigma * 1e3,
            ))
            .with(Remedy::JointEstimate)
        })
        .collect()
}
