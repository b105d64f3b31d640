//! The errors of instruments that the joint estimate knows, one by one.

use super::joint_estimate::JointEstimate;
use super::unknowns::{COLLIMATIONS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES};
use crate::calibration::{Estimate, Quantity};

/// An error is told where it is this many of its σ, and the data narrowed what was known by this share.
const TOLD_SIGMAS: f64 = 2.5;
const TOLD_NARROWED: f64 = 0.8;

/// What is wrong with an instrument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    RangeOffset,
    RangeScale,
    Index,
    Collimation,
    Latency,
    /// About the station's own x (0) or y (1).
    Lean(usize),
}

impl Kind {
    /// What a table calls it.
    pub fn name(self) -> &'static str {
        match self {
            Self::RangeOffset => "range offset",
            Self::RangeScale => "range scale",
            Self::Index => "vertical index",
            Self::Collimation => "collimation",
            Self::Latency => "angles' delay",
            Self::Lean(0) => "lean about x",
            Self::Lean(_) => "lean about y",
        }
    }

    /// The symbol in tables and files.
    pub fn symbol(self) -> &'static str {
        match self {
            Self::RangeOffset => "a",
            Self::RangeScale => "k",
            Self::Index => "i",
            Self::Collimation => "c",
            Self::Latency => "λ",
            Self::Lean(0) => "η",
            Self::Lean(_) => "ξ",
        }
    }

    pub fn quantity(self) -> Quantity {
        match self {
            Self::RangeOffset => Quantity::Length,
            Self::RangeScale => Quantity::Share,
            Self::Index | Self::Collimation | Self::Lean(_) => Quantity::Angle,
            Self::Latency => Quantity::Time,
        }
    }

    /// "station 2's ranges are off by".
    pub fn sentence(self, station: usize) -> String {
        let number = station + 1;
        match self {
            Self::RangeOffset | Self::RangeScale => format!("station {number}'s ranges are off by"),
            Self::Index => format!("station {number}'s zenith angles are off by"),
            Self::Collimation => format!("station {number}'s line of sight is off by"),
            Self::Latency => format!("station {number}'s angles are older than its ranges by"),
            Self::Lean(axis) => format!("station {number} leans about {} by", ["x", "y"][axis]),
        }
    }
}

/// An error of an instrument that was estimated.
pub struct InstrumentError {
    /// The station, 0 to 2.
    pub station: usize,
    pub kind: Kind,
    pub place: usize,
    /// The error about zero, or about what geometry says.
    pub estimate: Estimate,
    /// What was known of it beforehand (1 σ).
    pub known: f64,
}

impl InstrumentError {
    /// Whether the data says that it is not zero, and says it by itself.
    pub fn is_told(&self) -> bool {
        self.estimate.sigmas_from(0.0).abs() > TOLD_SIGMAS
            && self.estimate.sigma < TOLD_NARROWED * self.known
    }
}

/// All of them, station by station.
pub fn instruments(found: &JointEstimate) -> Vec<InstrumentError> {
    let sizes = &found.sizes;
    let mut errors = Vec::new();
    for station in 0..3 {
        let mut add = |kind, place, estimate, known| {
            errors.push(InstrumentError { station, kind, place, estimate, known });
        };
        let offset = found.range_offsets_m[station];
        add(Kind::RangeOffset, OFFSETS + station, offset, sizes.range_offset_m);
        let scale = found.range_scales[station];
        add(Kind::RangeScale, SCALES + station, scale, sizes.range_scale);
        let index = found.indices_rad[station];
        add(Kind::Index, INDICES + station, index, sizes.index_rad);
        let sight = found.collimations_rad[station];
        add(Kind::Collimation, COLLIMATIONS + station, sight, sizes.collimation_rad);
        let latency = found.latencies_s[station];
        add(Kind::Latency, LATENCIES + station, latency, sizes.latency_s);
        for (axis, lean) in found.leans_rad[station].into_iter().enumerate() {
            let place = LEANS + 2 * station + axis;
            add(Kind::Lean(axis), place, lean, sizes.lean_rad);
        }
    }
    errors
}
