//! Kinds of instruments' errors, with their names.

use crate::calibration::Quantity;

/// Kind of an instrument's error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstrumentErrorKind {
    RangeOffset,
    RangeScale,
    Index,
    Collimation,
    Latency,
    /// About the station's own x (0) or y (1).
    Lean(usize),
}

impl InstrumentErrorKind {
    /// Name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::RangeOffset => "range offset",
            Self::RangeScale => "range scale",
            Self::Index => "vertical index",
            Self::Collimation => "collimation",
            Self::Latency => "latency",
            Self::Lean(0) => "lean about x",
            Self::Lean(_) => "lean about y",
        }
    }

    /// Symbol in tables and files: that of the page [`super`].
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RangeOffset => "a",
            Self::RangeScale => "k",
            Self::Index => "ι",
            Self::Collimation => "κ",
            Self::Latency => "λ",
            Self::Lean(0) => "η",
            Self::Lean(_) => "ξ",
        }
    }

    /// Physical quantity of the error.
    pub fn quantity(self) -> Quantity {
        match self {
            Self::RangeOffset => Quantity::Length,
            Self::RangeScale => Quantity::Share,
            Self::Index | Self::Collimation | Self::Lean(_) => Quantity::Angle,
            Self::Latency => Quantity::Time,
        }
    }

    /// Beginning of a sentence: "station 2's ranges are off by".
    pub fn sentence(self, station: usize) -> String {
        let number = station + 1;
        match self {
            Self::RangeOffset | Self::RangeScale => format!("station {number}'s ranges are off by"),
            Self::Index => format!("station {number}'s vertical index error is"),
            Self::Collimation => format!("station {number}'s collimation error is"),
            Self::Latency => format!("station {number}'s angles are older than its ranges by"),
            Self::Lean(axis) => format!("station {number} leans about {} by", ["x", "y"][axis]),
        }
    }
}
