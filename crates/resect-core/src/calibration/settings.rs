//! What a user can change about a calibration.

use serde::{Deserialize, Serialize};

use super::Method;
use crate::calibration::ErrorSizes;
use crate::deployment::Finding;

/// What method D starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum PriorMethod {
    /// One small linear least squares per pair; needs no guess.
    #[default]
    ClosedForm,
    /// The paper's two-step search over the speed limit τ_v.
    Search,
}

/// What a large error costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// The square of the error, as published.
    #[default]
    Squared,
    /// Beyond 1.345 σ only its size.
    Huber,
    /// Hardly more than a middling one.
    Cauchy,
}

/// What the published methods C and D estimate beside the transforms; the joint estimate has its own list.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Estimated {
    /// Offsets of the clocks of stations 2 and 3 against station 1's.
    pub clocks: bool,
    /// The inter-prism distances, held by [`CalibrationSettings::inter_prism_sigma_m`].
    pub distances: bool,
    /// Tilts of stations 2 and 3, held to arcseconds.
    pub tilt: bool,
}

/// What methods B and C may turn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Alignment {
    /// Translation and yaw: the stations are levelled.
    #[default]
    Level,
    /// Roll and pitch as well.
    Rigid,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct CalibrationSettings {
    /// `None` is the joint estimate.
    pub method: Option<Method>,
    /// What methods B and C may turn.
    pub alignment: Alignment,
    /// Where method D, which the joint estimate begins with, starts from.
    pub prior: PriorMethod,
    /// How well the inter-prism distances are known (m, 1 σ); widens every σ of the answer.
    pub inter_prism_sigma_m: f64,
    /// What a large error costs in methods C and D as published; the joint estimate has its own loss.
    pub loss: Loss,
    /// What methods C and D as published estimate beside the frames; the joint estimate has its own unknowns.
    pub estimate: Estimated,
    /// How large the errors of instruments are that the joint estimate allows for.
    pub errors: ErrorSizes,
    /// Only read: what older versions called it; see [`CalibrationSettings::take_removed`].
    #[serde(skip_serializing)]
    pub weigh_by_noise: bool,
    /// Only read: what older versions called it; see [`CalibrationSettings::take_removed`].
    #[serde(skip_serializing)]
    pub continuous_time: bool,
}

impl Default for CalibrationSettings {
    fn default() -> Self {
        Self {
            method: None,
            alignment: Alignment::Level,
            prior: PriorMethod::ClosedForm,
            inter_prism_sigma_m: 0.001,
            loss: Loss::Squared,
            estimate: Estimated::default(),
            errors: ErrorSizes::default(),
            weigh_by_noise: false,
            continuous_time: false,
        }
    }
}

impl CalibrationSettings {
    /// These settings with this method as it comes: without a loss or estimates of the user's choice.
    pub fn plain(&self, method: Method) -> Self {
        let Self { loss, estimate, .. } = Self::default();
        Self { method: Some(method), loss, estimate, ..*self }
    }

    /// Whether a loss, or estimates beside the transforms, were chosen.
    pub fn has_parts(&self) -> bool {
        self.loss != Loss::Squared || self.estimate != Estimated::default()
    }

    /// Takes out what older versions wrote and this one has no switch for; says what became of it.
    ///
    /// What they called continuous time is the joint estimate now, with the loss and the estimates that went with it.
    pub fn take_removed(&mut self) -> Vec<Finding> {
        let mut findings = Vec::new();
        if std::mem::take(&mut self.weigh_by_noise) {
            findings.push(Finding::warning(
                "weigh_by_noise is no setting any more: simulated drives never confirmed it, and it is left out",
            ));
        }
        if std::mem::take(&mut self.continuous_time) {
            findings.push(Finding::warning(match self.method {
                None | Some(Method::InterPrism | Method::Joint) => {
                    *self = self.plain(Method::Joint);
                    "continuous_time is no setting any more: it became the joint estimate, which is the method now"
                }
                Some(_) => "continuous_time is no setting any more: it is left out, and the method did not use it",
            }));
        }
        findings
    }

    pub fn check(&self) -> Result<(), String> {
        let sigma = self.inter_prism_sigma_m;
        if (0.0..=1.0).contains(&sigma) {
            Ok(())
        } else {
            Err(format!("inter_prism_sigma_m is {sigma}; it must be from 0 to 1 m"))
        }
    }
}
