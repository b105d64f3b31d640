//! Numbers with their uncertainty.

use serde::{Deserialize, Serialize};

use crate::geometry::ARCSECONDS_PER_RAD;

/// A number with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub sigma: f64,
}

impl Estimate {
    /// Returns the difference from another value, in σ.
    pub fn sigmas_from(&self, other: f64) -> f64 {
        (self.value - other) / self.sigma.max(f64::MIN_POSITIVE)
    }
}

/// The dimension of an estimate, in SI units (m, rad, s, ratios).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    Length,
    Angle,
    Time,
    /// Seconds per second.
    Drift,
    /// Ratio to a range.
    Share,
}

impl Quantity {
    /// Returns the SI unit.
    pub fn si_unit(self) -> &'static str {
        match self {
            Self::Length => "m",
            Self::Angle => "rad",
            Self::Time => "s",
            Self::Drift => "s/s",
            Self::Share => "1",
        }
    }

    /// Returns the factor to the unit for display, and that unit.
    pub fn told(self) -> (f64, &'static str) {
        match self {
            Self::Length => (1e3, "mm"),
            Self::Angle => (ARCSECONDS_PER_RAD, "″"),
            Self::Time => (1e3, "ms"),
            Self::Drift => (1e6, "µs/s"),
            Self::Share => (1e6, "ppm"),
        }
    }
}

/// Estimates within this many σ of their reference are not significant.
pub const SUPPORTED_SIGMAS: f64 = 2.0;

/// Returns " (3.1 σ)", with a note that it is not significant where that is so.
pub fn sigmas_in_words(sigmas: f64) -> String {
    let sigmas = sigmas.abs();
    if sigmas > SUPPORTED_SIGMAS {
        format!(" ({sigmas:.1} σ)")
    } else {
        format!(" ({sigmas:.1} σ: not significant)")
    }
}
