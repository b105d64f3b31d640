//! The thresholds τ_s and τ_l of the settings, as controls.

use super::super::threshold::Threshold;
use resect_core::analysis::Settings;
use resect_core::number_setting::NumberSetting;
use resect_core::pipeline::{PipelineSettings, TAU_L, TAU_S};

pub struct GapThresholds(pub [Threshold<'static>; 2]);

impl GapThresholds {
    pub fn of(settings: &Settings) -> Self {
        let threshold = |setting: &NumberSetting<PipelineSettings>, range, enabled| Threshold {
            symbol: setting.name,
            value: setting.value(&settings.pipeline),
            paper: setting.default_shown(),
            unit: setting.unit,
            range,
            enabled,
        };
        Self([
            threshold(&TAU_S, 0.05..=TAU_S.most, true),
            threshold(&TAU_L, 0.1..=600.0, settings.pipeline.interval_filter),
        ])
    }
}
