//! The check of all stations of a recording.

use super::station_sense::StationSense;
use super::units;
use super::words::{number, stations};
use crate::error::OpenError;
use resect_core::deployment::Finding;

/// Stamps before March 1973 count from a start of their own.
const EARLIEST_UNIX_S: f64 = 1e8;

/// An error where a column of any station cannot be in its unit; else what there is to say of the stations.
///
/// `is_table` tells whether `[columns]` of `deployment.toml` can put it right.
pub fn check(
    all: &[StationSense; 3],
    files: &str,
    is_table: bool,
) -> Result<Vec<Finding>, OpenError> {
    units::check(all, files, is_table)?;
    let mut findings: Vec<_> =
        all.iter().enumerate().filter_map(|(station, own)| own.doubt(station + 1)).collect();
    let whole: Vec<_> = (1..=3).filter(|n| all[n - 1].has_whole_seconds()).collect();
    if !whole.is_empty() {
        findings.push(Finding::doubt(format!(
            "every stamp of {} is a whole second: too coarse for a moving prism, which goes a metre in that time",
            stations(&whole)
        )));
    }
    findings.extend(clocks(all));
    Ok(findings)
}

/// Notes of clocks that count from a start of their own, and of stations that never measured at the same time.
fn clocks(all: &[StationSense; 3]) -> Vec<Finding> {
    let spans: Vec<_> = (1..=3).filter_map(|n| Some((n, all[n - 1].span_s?))).collect();
    let Some((_, [start_s, _])) = spans.iter().min_by(|a, b| a.1[0].total_cmp(&b.1[0])) else {
        return Vec::new();
    };
    let mut findings = Vec::new();
    if start_s.abs() < EARLIEST_UNIX_S {
        findings.push(Finding::note(format!(
            "stamps count from a start of their own (the first is {start_s:.3} s): they cannot be compared with GNSS"
        )));
    }
    let apart = spans.iter().enumerate().find_map(|(index, (a, [a_from, a_to]))| {
        let after = &spans[index + 1..];
        let (b, [b_from, b_to]) =
            after.iter().find(|(_, [from, to])| from > a_to || to < a_from)?;
        Some(format!(
            "stations {a} and {b} never measured at the same time: {} to {} s, {} to {} s; their clocks differ, or they \
             are not of one drive",
            number(*a_from), number(*a_to), number(*b_from), number(*b_to)
        ))
    });
    findings.extend(apart.map(Finding::problem));
    findings
}
