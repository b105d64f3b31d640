//! The check of all stations of a recording.

use super::station_sense::StationSense;
use super::units;
use crate::error::OpenError;
use crate::findings::readings::{stamps_coarse, stamps_relative, stations_without_common_time};
use resect_core::deployment::Finding;
use resect_core::network::PerStation;

/// Stamps before March 1973 do not count from 1970.
const EARLIEST_UNIX_S: f64 = 1e8;

/// Returns findings about the stations; an error if a column of any station cannot be in its unit.
///
/// `is_table` is true if `[columns]` of `deployment.toml` can correct it.
pub fn check(
    all: &PerStation<&StationSense>,
    files: &str,
    is_table: bool,
) -> Result<Vec<Finding>, OpenError> {
    units::check(all, files, is_table)?;
    let mut findings: Vec<_> =
        all.iter().enumerate().filter_map(|(station, own)| own.doubt(station)).collect();
    let mut resolutions_s: Vec<(usize, f64)> = (0..all.len())
        .filter_map(|station| Some((station, all[station].coarse_stamps_s()?)))
        .collect();
    // A single station may measure at exact tenths of a second.
    let measuring = all.iter().filter(|station| station.span_s.is_some()).count();
    if resolutions_s.len() < measuring {
        resolutions_s.retain(|(_, resolution_s)| *resolution_s >= 1.0);
    }
    if !resolutions_s.is_empty() {
        let stations: Vec<usize> = resolutions_s.iter().map(|(station, _)| *station).collect();
        let coarsest_s = resolutions_s.iter().map(|(_, own_s)| *own_s).fold(0.0, f64::max);
        findings.push(stamps_coarse(&stations, coarsest_s));
    }
    findings.extend(clocks(all));
    Ok(findings)
}

/// Returns findings about clocks that do not count from 1970, and about stations without common measuring time.
fn clocks(all: &PerStation<&StationSense>) -> Vec<Finding> {
    let spans: Vec<_> =
        (0..all.len()).filter_map(|station| Some((station, all[station].span_s?))).collect();
    let Some((_, [start_s, _])) = spans.iter().min_by(|a, b| a.1[0].total_cmp(&b.1[0])) else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    if start_s.abs() < EARLIEST_UNIX_S {
        findings.push(stamps_relative(*start_s));
    }
    let apart = spans.iter().enumerate().find_map(|(index, (a, [a_from, a_to]))| {
        let after = &spans[index + 1..];
        let (b, b_span) = after.iter().find(|(_, [from, to])| from > a_to || to < a_from)?;
        Some(stations_without_common_time([*a, *b], [[*a_from, *a_to], *b_span]))
    });
    findings.extend(apart);
    findings
}
