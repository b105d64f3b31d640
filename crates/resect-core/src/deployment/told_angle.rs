//! Angles inside messages: the command line words them itself, the window in the user's unit.

use std::fmt;

use crate::geometry::ARCSECONDS_PER_RAD;

/// The unit in which the command line tells an angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ToldIn {
    Milliradians,
    Arcseconds,
    /// Turns that people see.
    Degrees,
}

/// An angle that a message tells. Displays as "+0.412 ± 0.011 mrad", "1.2″" or "90°".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToldAngle {
    pub value_rad: f64,
    pub sigma_rad: Option<f64>,
    pub unit: ToldIn,
    pub decimals: usize,
    pub signed: bool,
}

impl ToldAngle {
    /// A size.
    pub fn size(value_rad: f64, unit: ToldIn, decimals: usize) -> Self {
        Self { value_rad, sigma_rad: None, unit, decimals, signed: false }
    }

    /// A number with its sign.
    pub fn signed(value_rad: f64, unit: ToldIn, decimals: usize) -> Self {
        Self { signed: true, ..Self::size(value_rad, unit, decimals) }
    }

    /// Puts one σ beside the number (rad).
    #[must_use]
    pub fn sigma(self, sigma_rad: f64) -> Self {
        Self { sigma_rad: Some(sigma_rad), ..self }
    }
}

impl fmt::Display for ToldAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (per_rad, unit) = match self.unit {
            ToldIn::Milliradians => (1e3, " mrad"),
            ToldIn::Arcseconds => (ARCSECONDS_PER_RAD, "″"),
            ToldIn::Degrees => (1.0_f64.to_degrees(), "°"),
        };
        let (value, digits) = (self.value_rad * per_rad, self.decimals);
        if self.signed {
            write!(f, "{value:+.digits$}")?;
        } else {
            write!(f, "{value:.digits$}")?;
        }
        if let Some(sigma_rad) = self.sigma_rad {
            write!(f, " ± {:.digits$}", sigma_rad * per_rad)?;
        }
        f.write_str(unit)
    }
}
