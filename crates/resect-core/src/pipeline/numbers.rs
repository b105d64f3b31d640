//! Numeric settings of the pipeline.

use std::ops::Bound;

use super::PipelineSettings;
use crate::number_setting::{NumberSetting, check_all};

/// All numeric settings, in the order of the pipeline.
pub static PIPELINE_NUMBERS: [&NumberSetting<PipelineSettings>; 6] =
    [&TAU_R, &TAU_A, &TAU_E, &TAU_S, &TAU_L, &RATE];

impl PipelineSettings {
    /// Checks all numeric settings.
    ///
    /// # Errors
    /// The first invalid number, as one line. Sliders cannot reach such numbers; files and flags can.
    pub fn check(&self) -> Result<(), String> {
        check_all(&PIPELINE_NUMBERS, self)
    }
}

pub static TAU_R: NumberSetting<PipelineSettings> = NumberSetting {
    name: "τ_r",
    label: "τ_r  range",
    title: "τ_r, range rate",
    key: "tau_r_m_per_s",
    flag: Some("tau-r"),
    meaning: "Largest plausible rate of the range",
    unit: "m/s",
    per_stored: 1.0,
    least: Bound::Excluded(0.0),
    most: f64::INFINITY,
    slider: [0.05, 20.0],
    field: |settings| &mut settings.thresholds.tau_r_m_per_s,
};

pub static TAU_A: NumberSetting<PipelineSettings> = NumberSetting {
    name: "τ_a",
    label: "τ_a  azimuth",
    title: "τ_a, azimuth rate",
    key: "tau_a_deg_per_s",
    flag: Some("tau-a"),
    meaning: "Largest plausible rate of the azimuth",
    unit: "°/s",
    field: |settings| &mut settings.thresholds.tau_a_deg_per_s,
    ..TAU_R
};

pub static TAU_E: NumberSetting<PipelineSettings> = NumberSetting {
    name: "τ_e",
    label: "τ_e  zenith",
    title: "τ_e, zenith rate",
    key: "tau_e_deg_per_s",
    flag: Some("tau-e"),
    meaning: "Largest plausible rate of the zenith angle",
    unit: "°/s",
    field: |settings| &mut settings.thresholds.tau_e_deg_per_s,
    ..TAU_R
};

pub static TAU_S: NumberSetting<PipelineSettings> = NumberSetting {
    name: "τ_s",
    label: "τ_s  gap",
    title: "τ_s, longest gap",
    key: "tau_s_seconds",
    flag: Some("tau-s"),
    meaning: "Longest gap inside an interval",
    unit: "s",
    per_stored: 1.0,
    least: Bound::Excluded(0.0),
    // Positions across a gap are interpolated; beyond a minute they are not measurements.
    most: 60.0,
    slider: [0.1, 10.0],
    field: |settings| &mut settings.thresholds.tau_s_seconds,
};

pub static TAU_L: NumberSetting<PipelineSettings> = NumberSetting {
    name: "τ_l",
    label: "τ_l  length",
    title: "τ_l, shortest interval",
    key: "tau_l_seconds",
    flag: Some("tau-l"),
    meaning: "Intervals up to this length are dropped",
    unit: "s",
    per_stored: 1.0,
    least: Bound::Included(0.0),
    most: f64::INFINITY,
    slider: [0.0, 60.0],
    field: |settings| &mut settings.thresholds.tau_l_seconds,
};

pub static RATE: NumberSetting<PipelineSettings> = NumberSetting {
    name: "rate",
    label: "rate",
    title: "rate of the triplets",
    key: "rate_hz",
    flag: Some("rate"),
    meaning: "Triplets per second",
    unit: "Hz",
    per_stored: 1.0,
    least: Bound::Excluded(0.0),
    most: 100.0,
    slider: [0.5, 100.0],
    field: |settings| &mut settings.rate_hz,
};
