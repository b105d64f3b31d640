//! Settings of the pipeline as plain data, shared by sliders, files and flags.

use serde::{Deserialize, Serialize};

/// Thresholds of the modules, in the units of the paper.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Thresholds {
    /// τ_r: fastest plausible change of range.
    pub tau_r_m_per_s: f64,
    /// τ_a: fastest plausible change of azimuth.
    pub tau_a_deg_per_s: f64,
    /// τ_e: fastest plausible change of the zenith angle.
    pub tau_e_deg_per_s: f64,
    /// τ_s: longest gap inside an interval.
    pub tau_s_seconds: f64,
    /// τ_l: intervals up to this length are dropped.
    pub tau_l_seconds: f64,
}

impl Default for Thresholds {
    /// The paper's values.
    fn default() -> Self {
        Self {
            tau_r_m_per_s: 2.0,
            tau_a_deg_per_s: 1.0,
            tau_e_deg_per_s: 1.0,
            tau_s_seconds: 1.0,
            tau_l_seconds: 6.0,
        }
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Interpolation {
    /// Straight lines between readings.
    #[default]
    Linear,
    /// Gaussian process with a squared-exponential kernel and learned noise.
    Gp,
    /// Gaussian process with white noise on acceleration: the motion model.
    Wnoa,
}

impl Interpolation {
    pub const ALL: [Self; 3] = [Self::Linear, Self::Gp, Self::Wnoa];

    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Gp => "gp",
            Self::Wnoa => "wnoa",
        }
    }

    /// Name for the window and plots.
    pub fn title(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Gp => "GP",
            Self::Wnoa => "GP, motion model",
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PipelineSettings {
    /// Module 1, optional.
    pub outlier_filter: bool,
    /// Module 3, optional.
    pub interval_filter: bool,
    pub thresholds: Thresholds,
    /// Module 4: the interpolation of positions between readings.
    pub interpolation: Interpolation,
    /// Module 4: triplets per second.
    pub rate_hz: f64,
    /// The joint estimate takes all readings, and not only those of the kept intervals.
    pub all_readings: bool,
}

impl Default for PipelineSettings {
    /// The paper's pipeline, with both optional modules.
    fn default() -> Self {
        Self {
            outlier_filter: true,
            interval_filter: true,
            thresholds: Thresholds::default(),
            interpolation: Interpolation::Linear,
            rate_hz: 10.0,
            all_readings: true,
        }
    }
}
