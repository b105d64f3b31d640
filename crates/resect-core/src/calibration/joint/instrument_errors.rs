//! The estimated errors of instruments, one by one.

use super::joint_estimate::JointEstimate;
use super::unknown::Unknown;
use crate::calibration::{Estimate, SUPPORTED_SIGMAS};
use crate::network::{Number, Station};

/// A significant error has a prior σ that the data reduced to this share.
const SIGNIFICANT_REDUCTION: f64 = 0.8;

/// An estimated error of an instrument.
pub struct InstrumentError {
    pub station: Station,
    pub unknown: &'static Unknown,
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
    let of_station = |station: Station| {
        joint.layout().of_instrument(station).map(move |(unknown, index)| {
            let prior_sigma = unknown.prior.map_or(0.0, |prior| (prior.sigma)(&joint.sizes));
            let estimate = joint.constants[index];
            InstrumentError { station, unknown, index, estimate, prior_sigma }
        })
    };
    (0..joint.layout().stations()).map(Station::at).flat_map(of_station).collect()
}
