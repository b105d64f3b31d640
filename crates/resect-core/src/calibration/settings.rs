//! The settings of a calibration.

use serde::{Deserialize, Serialize};

use super::Method;
use crate::calibration::{ErrorSizes, Evidence};

/// The starting point of method D.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PriorMethod {
    /// One small linear least-squares problem per pair; needs no initial guess.
    #[default]
    ClosedForm,
    /// The paper's two-step search over the speed limit τ_v.
    Search,
}

/// The rotations that methods B and C estimate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// Translation and yaw, for levelled stations.
    #[default]
    Level,
    /// Roll and pitch as well.
    Rigid,
}

/// Largest standard deviation of the distances in method D (m).
const PUBLISHED_DISTANCE_SIGMA_M: f64 = 0.001;

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationSettings {
    /// `None` selects the joint estimate.
    pub method: Option<Method>,
    /// The rotations that methods B and C estimate.
    pub alignment: Alignment,
    /// The starting point of method D, and of the joint estimate.
    pub prior: PriorMethod,
    /// Standard deviation of the measured inter-prism distances (m); it increases every σ of the joint estimate.
    pub inter_prism_sigma_m: f64,
    /// Measurements that the joint estimate uses.
    pub evidence: Evidence,
    /// Priors of the instrument errors in the joint estimate.
    pub errors: ErrorSizes,
}

impl Default for CalibrationSettings {
    fn default() -> Self {
        Self {
            method: None,
            alignment: Alignment::Level,
            prior: PriorMethod::ClosedForm,
            inter_prism_sigma_m: 0.003,
            evidence: Evidence::ALL,
            errors: ErrorSizes::default(),
        }
    }
}

impl CalibrationSettings {
    /// Standard deviation of the distances in method D (m), which the paper takes as good to a millimetre.
    pub fn published_distance_sigma_m(&self) -> f64 {
        self.inter_prism_sigma_m.min(PUBLISHED_DISTANCE_SIGMA_M)
    }

    /// Returns these settings with another method.
    pub fn with_method(&self, method: Method) -> Self {
        Self { method: Some(method), ..*self }
    }
}
