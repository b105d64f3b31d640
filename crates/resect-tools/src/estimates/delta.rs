//! Size of the motions whose relative errors are measured.

use std::fmt;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// Size of a motion between two poses.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Delta {
    /// Length of the path along the estimate (m).
    PathM(f64),
    /// Time between both poses (s).
    TimeS(f64),
    /// Number of compared poses from one to the other.
    Frames(usize),
    /// Angle of rotation (°).
    RotationDegrees(f64),
}

/// Motions whose relative errors are measured.
#[derive(Clone, Debug, PartialEq)]
pub struct RelativeOptions {
    pub deltas: Vec<Delta>,
    /// True if a motion begins at each pose; otherwise motions follow each other without overlap.
    pub all_pairs: bool,
}

impl Default for RelativeOptions {
    fn default() -> Self {
        Self { deltas: [1.0, 5.0, 20.0, 100.0].map(Delta::PathM).to_vec(), all_pairs: false }
    }
}

impl Delta {
    /// Returns the number in its unit.
    pub fn value(self) -> f64 {
        match self {
            Self::PathM(value) | Self::TimeS(value) | Self::RotationDegrees(value) => value,
            Self::Frames(count) => count as f64,
        }
    }

    /// Name of the unit, as in the command line.
    pub fn unit(self) -> &'static str {
        match self {
            Self::PathM(_) => "m",
            Self::TimeS(_) => "s",
            Self::Frames(_) => "f",
            Self::RotationDegrees(_) => "deg",
        }
    }
}

impl fmt::Display for Delta {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::PathM(value) => write!(formatter, "{value} m"),
            Self::TimeS(value) => write!(formatter, "{value} s"),
            Self::Frames(1) => formatter.write_str("1 frame"),
            Self::Frames(count) => write!(formatter, "{count} frames"),
            Self::RotationDegrees(value) => write!(formatter, "{value}°"),
        }
    }
}

/// Error of a text that is no size of a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("give a positive number with m, s, f (frames) or deg (at most 180), such as 5m")]
pub struct NoDelta;

impl FromStr for Delta {
    type Err = NoDelta;

    /// Reads "5", "5m", "10s", "20f" or "30deg"; a number alone is in metres.
    fn from_str(text: &str) -> Result<Self, NoDelta> {
        let text = text.trim();
        let number = text.trim_end_matches(|letter: char| letter.is_ascii_alphabetic());
        let value: f64 = number.trim_end().parse().map_err(|_| NoDelta)?;
        if !(value.is_finite() && value > 0.0) {
            return Err(NoDelta);
        }
        match &text[number.len()..] {
            "" | "m" => Ok(Self::PathM(value)),
            "s" => Ok(Self::TimeS(value)),
            "f" if value.fract() == 0.0 && value < 1e9 => Ok(Self::Frames(value as usize)),
            "deg" if value <= 180.0 => Ok(Self::RotationDegrees(value)),
            _ => Err(NoDelta),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_may_have_one_of_four_units() {
        let read = |text: &str| text.parse::<Delta>();
        assert_eq!(read("5"), Ok(Delta::PathM(5.0)));
        assert_eq!(read("0.5m"), Ok(Delta::PathM(0.5)));
        assert_eq!(read("10 s"), Ok(Delta::TimeS(10.0)));
        assert_eq!(read("20f"), Ok(Delta::Frames(20)));
        assert_eq!(read("30deg"), Ok(Delta::RotationDegrees(30.0)));
        for text in ["", "m", "-1m", "0", "1.5f", "181deg", "5km", "nan", "inf", "5mm"] {
            assert_eq!(read(text), Err(NoDelta), "{text}");
        }
    }
}
