//! What a user can change about a calibration.

use serde::{Deserialize, Serialize};

use super::Method;

/// Where method D starts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum PriorMethod {
    /// One small linear least squares per pair; needs no guess.
    #[default]
    ClosedForm,
    /// The paper's two-step search over the speed limit τ_v.
    Search,
}

/// What a large error costs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum Loss {
    /// Its square, as published.
    #[default]
    Squared,
    /// Beyond 1.345 σ only its size.
    Huber,
    /// Hardly more than a middling one.
    Cauchy,
}

/// What method D estimates beside the transforms.
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
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, clap::ValueEnum)]
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
    /// `None` leaves it to the data: D, or C where all stations follow one prism.
    pub method: Option<Method>,
    /// Of methods B and C.
    pub alignment: Alignment,
    /// Of method D.
    pub prior: PriorMethod,
    /// How well the inter-prism distances are known (m, 1 σ); widens every σ of the answer.
    pub inter_prism_sigma_m: f64,
    /// Of method D; the rest goes beyond the paper.
    pub loss: Loss,
    /// Whether each distance counts by the noise that the instruments state for it.
    pub weigh_by_noise: bool,
    /// Whether the motion is estimated from the readings themselves, instead of interpolated before.
    pub continuous_time: bool,
    pub estimate: Estimated,
}

impl Default for CalibrationSettings {
    fn default() -> Self {
        Self {
            method: None,
            alignment: Alignment::Level,
            prior: PriorMethod::ClosedForm,
            inter_prism_sigma_m: 0.001,
            loss: Loss::Squared,
            weigh_by_noise: false,
            continuous_time: false,
            estimate: Estimated::default(),
        }
    }
}

impl CalibrationSettings {
    /// Method D with everything that holds up in the simulated campaign (`tests/campaign`): the readings themselves, Cauchy's
    /// loss, clocks, distances and tilts.
    pub fn robust() -> Self {
        Self {
            loss: Loss::Cauchy,
            continuous_time: true,
            estimate: Estimated { clocks: true, distances: true, tilt: true },
            ..Self::default()
        }
    }

    /// These settings with all that goes beyond the published method D as in others.
    pub fn beyond_as(&self, others: &Self) -> Self {
        let Self { loss, estimate, weigh_by_noise, continuous_time, .. } = *others;
        Self { loss, estimate, weigh_by_noise, continuous_time, ..*self }
    }

    /// Whether all that goes beyond the published method D is as in [`CalibrationSettings::robust`].
    pub fn is_robust(&self) -> bool {
        *self == self.beyond_as(&Self::robust())
    }

    /// Whether anything goes beyond the published method D.
    pub fn refines(&self) -> bool {
        self.loss != Loss::Squared
            || self.weigh_by_noise
            || self.continuous_time
            || self.estimate != Estimated::default()
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
