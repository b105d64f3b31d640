//! Reasons why a reading is impossible.

use std::f64::consts::{PI, TAU};

use resect_core::deployment::Measurement;
use resect_core::geometry::LONGEST_RANGE_M;

/// The year 5138 in Unix seconds; smaller than any stamp of today in milliseconds or nanoseconds.
pub const LATEST_STAMP_S: f64 = 1e11;
/// Limit of the azimuth: some instruments count beyond one or two full turns, but no further.
pub const LARGEST_AZIMUTH_RAD: f64 = 2.0 * TAU;

/// Reason why a reading of a total station is impossible.
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
    /// Reasons that cast doubt on the recorder: it wrote the readings as valid.
    pub const DOUBTFUL: [Self; 5] =
        [Self::ZeroRange, Self::NegativeRange, Self::Zenith, Self::Far, Self::Azimuth];

    /// Returns the first reason why a reading is impossible; the range lacks the prism constant.
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

    /// Description, to follow "a reading with".
    pub fn words(self) -> &'static str {
        match self {
            Self::NotANumber => "not a number",
            Self::ZeroRange => "a range of zero (no reading, despite its status)",
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
