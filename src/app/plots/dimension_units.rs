//! Values over time in the user's units.

use crate::app::model::Units;
use crate::app::model::units::without_negative_zero;
use crate::app::prepared::dimension::Dimension;

/// Factor from a stored value to the value shown.
pub fn per_stored(dimension: Dimension, units: Units) -> f64 {
    match dimension {
        Dimension::Length => units.length.per_metre(),
        Dimension::LengthSigma => 1e3,
        Dimension::Angle => units.angle.per_radian(),
        Dimension::AngleSigma => units.angle.small_per_radian(),
        Dimension::AngleRate => units.angle.rate_per_deg_per_s(),
        Dimension::Other(_) => 1.0,
    }
}

/// Symbol of the unit.
pub fn unit(dimension: Dimension, units: Units) -> &'static str {
    match dimension {
        Dimension::Length => units.length.name(),
        Dimension::LengthSigma => "mm",
        Dimension::Angle => units.angle.name(),
        Dimension::AngleSigma => units.angle.small_name(),
        Dimension::AngleRate => units.angle.rate_name(),
        Dimension::Other(unit) => unit,
    }
}

/// A stored value with its unit.
pub fn with_unit(dimension: Dimension, units: Units, stored: f64) -> String {
    match dimension {
        Dimension::Length => units.length_with_unit(stored),
        Dimension::Angle => units.angle_with_unit(stored),
        Dimension::LengthSigma
        | Dimension::AngleSigma
        | Dimension::AngleRate
        | Dimension::Other(_) => {
            let shown = stored * per_stored(dimension, units);
            format!("{} {}", without_negative_zero(shown, 3), unit(dimension, units))
        }
    }
}
