//! Whether the numbers of a recording can be what they are taken for: radians, metres, seconds, and readings at all.
//!
//! Judged by each station and column alone, before any calibration. What no column tells by itself (feet, a few degrees
//! of azimuth) is left to the answer's own checks.

mod units;

use crate::findings::readings::{
    readings_implausible, stamps_relative, stamps_whole_seconds, stations_without_common_time,
};
use std::f64::consts::{PI, TAU};

use crate::error::OpenError;
use resect_core::deployment::{Finding, Measurement};
use resect_core::geometry::LONGEST_RANGE_M;
use resect_core::statistics::median;

/// The year 5138 in Unix seconds; milliseconds and nanoseconds are beyond it.
const LATEST_STAMP_S: f64 = 1e11;
/// Stamps before March 1973 count from a start of their own.
const EARLIEST_UNIX_S: f64 = 1e8;
/// Some instruments go on counting past a full turn or two; no further.
const LARGEST_AZIMUTH_RAD: f64 = 2.0 * TAU;
/// Fewest readings of a column of which anything is said as a whole.
const FEWEST: usize = 10;
/// More whole-second stamps than this in a row are no chance.
const MANY: usize = 50;
/// Share of impossible readings from which on the recorder is not believed.
const DOUBTFUL_SHARE: f64 = 0.01;
const LARGEST_SAMPLE: usize = 4096;

/// Why numbers cannot be a reading of a total station.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Impossible {
    NotANumber,
    ZeroRange,
    NegativeRange,
    Zenith,
    Far,
    Azimuth,
    Stamp,
}

impl Impossible {
    /// Reasons that a recorder does not know of: it would not write such numbers if it knew that they are no readings.
    const DOUBTFUL: [Self; 5] =
        [Self::ZeroRange, Self::NegativeRange, Self::Zenith, Self::Far, Self::Azimuth];

    /// The first thing that is impossible about a reading whose range lacks the prism constant.
    pub fn of(m: &Measurement) -> Option<Self> {
        if ![m.time_s, m.range_m, m.azimuth_rad, m.zenith_rad].iter().all(|v| v.is_finite()) {
            Some(Self::NotANumber)
        } else if m.range_m == 0.0 {
            Some(Self::ZeroRange)
        } else if m.range_m < 0.0 {
            Some(Self::NegativeRange)
        } else if !(0.0..=PI).contains(&m.zenith_rad) {
            Some(Self::Zenith)
        } else if m.range_m >= LONGEST_RANGE_M {
            Some(Self::Far)
        } else if m.azimuth_rad.abs() > LARGEST_AZIMUTH_RAD {
            Some(Self::Azimuth)
        } else if m.time_s.abs() > LATEST_STAMP_S {
            Some(Self::Stamp)
        } else {
            None
        }
    }

    /// What it is, after "a reading with".
    pub fn words(self) -> &'static str {
        match self {
            Self::NotANumber => "not a number",
            Self::ZeroRange => "a range of zero (no reading, whatever its status says)",
            Self::NegativeRange => "a negative range",
            Self::Zenith => "zenith angle outside 0..π rad",
            Self::Far => "range beyond 10 km",
            Self::Azimuth => "azimuth beyond ±4π rad",
            Self::Stamp => "not a time stamp in seconds",
        }
    }

    fn short(self) -> &'static str {
        match self {
            Self::ZeroRange => "ranges of zero",
            Self::NegativeRange => "negative ranges",
            other => other.words(),
        }
    }
}

/// What is remembered of a station's readings that its recorder calls valid: how many are impossible, and a sample spread
/// evenly over all.
#[derive(Clone, Debug, Default)]
pub struct StationSense {
    valid: u64,
    impossible: [u64; Impossible::DOUBTFUL.len()],
    sample: Vec<Sampled>,
    /// Every how manieth reading is in the sample, less one.
    skipped: u64,
    seen: u64,
    last_s: Option<f64>,
    span_s: Option<[f64; 2]>,
}

#[derive(Clone, Copy, Debug)]
struct Sampled {
    measurement: Measurement,
    /// Since the reading before.
    step_s: Option<f64>,
}

impl StationSense {
    /// Takes note of a reading with a valid status, and of what is impossible about it.
    pub fn take(&mut self, m: &Measurement, impossible: Option<Impossible>) {
        self.valid += 1;
        if let Some(kind) = Impossible::DOUBTFUL.iter().position(|own| Some(*own) == impossible) {
            self.impossible[kind] += 1;
        }
        // Where there is no range the rest is no reading either.
        if matches!(impossible, Some(Impossible::NotANumber | Impossible::ZeroRange)) {
            return;
        }
        let step_s = self.last_s.map(|last_s| m.time_s - last_s).filter(|step_s| *step_s > 0.0);
        self.last_s = Some(m.time_s);
        let [first_s, last_s] = self.span_s.get_or_insert([m.time_s; 2]);
        (*first_s, *last_s) = (first_s.min(m.time_s), last_s.max(m.time_s));
        if self.seen.is_multiple_of(self.skipped + 1) {
            self.sample.push(Sampled { measurement: *m, step_s });
            if self.sample.len() == LARGEST_SAMPLE {
                let mut index = 0;
                self.sample.retain(|_| {
                    index += 1;
                    index % 2 == 1
                });
                self.skipped = 2 * self.skipped + 1;
            }
        }
        self.seen += 1;
    }

    fn column(&self, of: impl Fn(&Sampled) -> f64) -> Column {
        Column(self.sample.iter().map(of).collect())
    }

    fn has_whole_seconds(&self) -> bool {
        let stamps = self.column(|s| s.measurement.time_s);
        stamps.0.len() >= MANY && stamps.0.iter().all(|stamp_s| stamp_s.fract() == 0.0)
    }

    /// The doubt that its impossible readings raise.
    fn doubt(&self, station: usize) -> Option<Finding> {
        let impossible: u64 = self.impossible.iter().sum();
        let share = impossible as f64 / self.valid.max(1) as f64;
        if share < DOUBTFUL_SHARE {
            return None;
        }
        let counts =
            Impossible::DOUBTFUL.iter().zip(self.impossible).filter(|(_, count)| *count > 0);
        let counts: Vec<_> = counts.map(|(kind, count)| (kind.short(), count as usize)).collect();
        let (impossible, valid) = (impossible as usize, self.valid as usize);
        Some(readings_implausible(station, impossible, valid, &counts))
    }
}

/// One column of the sample.
struct Column(Vec<f64>);

impl Column {
    fn median(&self) -> Option<f64> {
        if self.0.len() < FEWEST {
            return None;
        }
        median(self.0.iter().copied())
    }

    fn share(&self, is: impl Fn(f64) -> bool) -> f64 {
        if self.0.len() < FEWEST {
            return 0.0;
        }
        self.0.iter().filter(|value| is(**value)).count() as f64 / self.0.len() as f64
    }
}

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
        all.iter().enumerate().filter_map(|(station, own)| own.doubt(station)).collect();
    let whole: Vec<_> = (0..3).filter(|station| all[*station].has_whole_seconds()).collect();
    if !whole.is_empty() {
        findings.push(stamps_whole_seconds(&whole));
    }
    findings.extend(clocks(all));
    Ok(findings)
}

/// Notes of clocks that count from a start of their own, and of stations that never measured at the same time.
fn clocks(all: &[StationSense; 3]) -> Vec<Finding> {
    let spans: Vec<_> =
        (0..3).filter_map(|station| Some((station, all[station].span_s?))).collect();
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

#[cfg(test)]
mod tests;
