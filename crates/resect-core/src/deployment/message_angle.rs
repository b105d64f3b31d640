//! Angles inside messages: the command line formats them itself, the window in the user's unit.

use std::fmt;

use crate::geometry::ARCSECONDS_PER_RAD;

/// Unit of an angle on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AngleFormat {
    Milliradians,
    Arcseconds,
    /// Rotations that are visible to people.
    Degrees,
}

/// An angle in a message. Displays as "+0.412 ± 0.011 mrad", "1.2″" or "90°".
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MessageAngle {
    pub value_rad: f64,
    pub sigma_rad: Option<f64>,
    pub unit: AngleFormat,
    pub decimals: usize,
    pub signed: bool,
}

impl MessageAngle {
    /// An angle without sign (rad).
    pub fn size(value_rad: f64, unit: AngleFormat, decimals: usize) -> Self {
        Self { value_rad, sigma_rad: None, unit, decimals, signed: false }
    }

    /// An angle with its sign (rad).
    pub fn signed(value_rad: f64, unit: AngleFormat, decimals: usize) -> Self {
        Self { signed: true, ..Self::size(value_rad, unit, decimals) }
    }

    /// Adds one σ (rad).
    #[must_use]
    pub fn sigma(self, sigma_rad: f64) -> Self {
        Self { sigma_rad: Some(sigma_rad), ..self }
    }
}

impl fmt::Display for MessageAngle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (per_rad, unit) = match self.unit {
            AngleFormat::Milliradians => (1e3, " mrad"),
            AngleFormat::Arcseconds => (ARCSECONDS_PER_RAD, "″"),
            AngleFormat::Degrees => (1.0_f64.to_degrees(), "°"),
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
