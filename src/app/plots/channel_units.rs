//! The values of channels in the units that the user reads.

use crate::app::model::Units;
use crate::app::model::units::without_negative_zero;
use crate::app::prepared::channels::{Channel, Dimension};

/// What a stored value is multiplied by to be shown.
pub fn per_stored(channel: Channel, units: Units) -> f64 {
    match channel.dimension() {
        Dimension::Length => units.length.per_metre(),
        Dimension::Angle => units.angle.per_radian(),
        Dimension::AngleRate => units.angle.rate_per_deg_per_s(),
        Dimension::Other(_) => 1.0,
    }
}

/// The symbol of the unit.
pub fn unit(channel: Channel, units: Units) -> &'static str {
    match channel.dimension() {
        Dimension::Length => units.length.name(),
        Dimension::Angle => units.angle.name(),
        Dimension::AngleRate => units.angle.rate_name(),
        Dimension::Other(unit) => unit,
    }
}

/// A stored value with its unit.
pub fn with_unit(channel: Channel, units: Units, stored: f64) -> String {
    match channel.dimension() {
        Dimension::Length => units.length_with_unit(stored),
        Dimension::Angle => units.angle_with_unit(stored),
        Dimension::AngleRate | Dimension::Other(_) => {
            let shown = stored * per_stored(channel, units);
            format!("{} {}", without_negative_zero(shown, 3), unit(channel, units))
        }
    }
}
