//! Reasons why numbers cannot be a reading.

use std::f64::consts::{PI, TAU};

use resect_core::deployment::Measurement;
use resect_core::geometry::LONGEST_RANGE_M;

/// The year 5138 in Unix seconds; milliseconds and nanoseconds are beyond it.
pub const LATEST_STAMP_S: f64 = 1e11;
/// Some instruments go on counting past a full turn or two; no further.
pub const LARGEST_AZIMUTH_RAD: f64 = 2.0 * TAU;

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
    pub const DOUBTFUL: [Self; 5] =
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

    pub fn short(self) -> &'static str {
        match self {
            Self::ZeroRange => "ranges of zero",
            Self::NegativeRange => "negative ranges",
            other => other.words(),
        }
    }
}
