//! Findings about the stations' clocks relative to station 1: the estimates to report, and the suspicious ones.

use super::Estimate;
use super::estimate::SUPPORTED_SIGMAS;
use crate::deployment::Finding;
use crate::deployment::findings::clocks::{
    clock_drift, clock_drift_implausible, clock_jump_suspected, clock_offset,
    clock_offset_suspected,
};
use crate::network::PerStation;

/// An offset of more σ is reported if clocks are not estimated and it exceeds the other limit as well.
const SUSPICIOUS_SIGMAS: f64 = 3.5;
/// An offset of more seconds is reported if clocks are not estimated and it exceeds the limit in σ as well.
pub const SUSPICIOUS_OFFSET_S: f64 = 0.002;
/// Drifts beyond this are implausible (s/s): four times the σ of the prior.
const IMPLAUSIBLE_DRIFT: f64 = 20e-6;

/// Returns true if an offset (s) is too large for a clock that is not estimated.
fn is_suspicious(offset_s: &Estimate) -> bool {
    offset_s.sigmas_from(0.0).abs() > SUSPICIOUS_SIGMAS
        && offset_s.value.abs() > SUSPICIOUS_OFFSET_S
}

/// Returns the estimates with their stations, without the reference.
fn by_station(estimates: &PerStation<Estimate>) -> impl Iterator<Item = (usize, &Estimate)> {
    estimates.iter().enumerate().skip(1)
}

/// Returns findings for the significant clock offsets (s) and drifts (s/s).
pub fn clocks(offsets_s: &PerStation<Estimate>, drifts: &PerStation<Estimate>) -> Vec<Finding> {
    let is_significant =
        |(_, estimate): &(usize, &Estimate)| estimate.sigmas_from(0.0).abs() > SUPPORTED_SIGMAS;
    let offsets = by_station(offsets_s)
        .filter(is_significant)
        .map(|(station, offset)| clock_offset(station, offset));
    let drifts = by_station(drifts)
        .filter(is_significant)
        .map(|(station, drift)| clock_drift(station, drift));
    offsets.chain(drifts).collect()
}

/// Returns findings for clock offsets that differ between the halves of a drive (s).
pub fn suspected_jumps(jumps_s: &PerStation<Estimate>) -> Vec<Finding> {
    by_station(jumps_s)
        .filter(|(_, jump)| is_suspicious(jump))
        .map(|(station, jump)| clock_jump_suspected(station, jump))
        .collect()
}

/// Returns findings for drifts that no sound clock has (s/s), except for clocks that jump. `are_estimated` is true if the answer
/// estimates drifts.
pub fn implausible_drifts(
    drifts: &PerStation<Estimate>,
    jumping: &PerStation<bool>,
    are_estimated: bool,
) -> Vec<Finding> {
    let is_implausible = |drift: &Estimate| {
        drift.value.abs() > IMPLAUSIBLE_DRIFT && drift.sigmas_from(0.0).abs() > SUSPICIOUS_SIGMAS
    };
    by_station(drifts)
        .filter(|(station, drift)| is_implausible(drift) && !jumping[*station])
        .map(|(station, drift)| clock_drift_implausible(station, drift, are_estimated))
        .collect()
}

/// Returns findings for significant clock offsets that the answer does not estimate (s): they bias it.
pub fn suspicions(clocks: &PerStation<Estimate>) -> Vec<Finding> {
    by_station(clocks)
        .filter(|(_, offset)| is_suspicious(offset))
        .map(|(station, offset)| clock_offset_suspected(station, offset))
        .collect()
}
