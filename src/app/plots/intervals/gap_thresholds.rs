//! The thresholds τ_s and τ_l of the settings, as controls.

use super::super::threshold::Threshold;
use resect_core::analysis::Settings;
use resect_core::pipeline::Thresholds;

pub struct GapThresholds(pub [Threshold<'static>; 2]);

impl GapThresholds {
    pub fn of(settings: &Settings) -> Self {
        let (set, paper) = (&settings.pipeline.thresholds, Thresholds::default());
        Self([
            Threshold {
                symbol: "τ_s",
                value: set.tau_s_seconds,
                paper: paper.tau_s_seconds,
                unit: "s",
                // What the settings allow.
                range: 0.05..=60.0,
                enabled: true,
            },
            Threshold {
                symbol: "τ_l",
                value: set.tau_l_seconds,
                paper: paper.tau_l_seconds,
                unit: "s",
                range: 0.1..=600.0,
                enabled: settings.pipeline.interval_filter,
            },
        ])
    }
}
