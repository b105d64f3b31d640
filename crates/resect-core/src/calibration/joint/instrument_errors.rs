//! The estimated errors of instruments, one by one.

use super::joint_estimate::JointEstimate;
use super::state_vector::{COLLIMATIONS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES};
use crate::calibration::{Estimate, Quantity, SUPPORTED_SIGMAS};

/// A significant error has a prior σ that the data reduced to this share.
const SIGNIFICANT_REDUCTION: f64 = 0.8;

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

    /// Symbol in tables and files.
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

/// An estimated error of an instrument.
pub struct InstrumentError {
    /// The station, 0 to 2.
    pub station: usize,
    pub kind: InstrumentErrorKind,
    /// Index among the constants.
    pub index: usize,
    pub estimate: Estimate,
    /// Standard deviation of the prior.
    pub prior_sigma: f64,
}

impl InstrumentError {
    /// Returns true if the data by itself shows that the error is not zero.
    pub fn is_significant(&self) -> bool {
        self.estimate.sigmas_from(0.0).abs() > SUPPORTED_SIGMAS
            && self.estimate.sigma < SIGNIFICANT_REDUCTION * self.prior_sigma
    }
}

/// Lists all errors, station by station.
pub fn instrument_errors(joint: &JointEstimate) -> Vec<InstrumentError> {
    let sizes = &joint.sizes;
    let mut errors = Vec::new();
    for station in 0..3 {
        let mut add = |kind, index, estimate, prior_sigma| {
            errors.push(InstrumentError { station, kind, index, estimate, prior_sigma });
        };
        let offset = joint.range_offsets_m[station];
        add(InstrumentErrorKind::RangeOffset, OFFSETS + station, offset, sizes.range_offset_m);
        let scale = joint.range_scales[station];
        add(InstrumentErrorKind::RangeScale, SCALES + station, scale, sizes.range_scale);
        let vertical_index = joint.indices_rad[station];
        add(InstrumentErrorKind::Index, INDICES + station, vertical_index, sizes.index_rad);
        let sight = joint.collimations_rad[station];
        add(InstrumentErrorKind::Collimation, COLLIMATIONS + station, sight, sizes.collimation_rad);
        let latency = joint.latencies_s[station];
        add(InstrumentErrorKind::Latency, LATENCIES + station, latency, sizes.latency_s);
        for (axis, lean) in joint.leans_rad[station].into_iter().enumerate() {
            let index = LEANS + 2 * station + axis;
            add(InstrumentErrorKind::Lean(axis), index, lean, sizes.lean_rad);
        }
    }
    errors
}
