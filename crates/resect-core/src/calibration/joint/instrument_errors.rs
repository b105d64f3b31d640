//! The estimated errors of instruments, one by one.

use super::instrument_error_kind::InstrumentErrorKind;
use super::joint_estimate::JointEstimate;
use super::state_vector::{COLLIMATIONS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES};
use crate::calibration::{Estimate, SUPPORTED_SIGMAS};

/// A significant error has a prior σ that the data reduced to this share.
const SIGNIFICANT_REDUCTION: f64 = 0.8;

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
