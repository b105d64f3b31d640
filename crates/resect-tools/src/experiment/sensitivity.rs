//! Dependence of the errors on one threshold (Vaidis et al. 2022, section "Sensitivity and ablation tests").

use std::sync::Arc;

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::StudyError;
use super::reference::{self, Reference};
use super::split::Splits;
use super::study::{Group, Quantiles, Series, Study};
use crate::palette;
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::number_setting::NumberSetting;
use resect_core::pipeline::{PipelineSettings, RATE, TAU_A, TAU_E, TAU_L, TAU_R, TAU_S};
use resect_core::progress::Progress;

/// Parameter of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Parameter {
    TauR,
    TauA,
    TauE,
    TauS,
    TauL,
    Rate,
}

impl Parameter {
    pub const ALL: [Self; 6] =
        [Self::TauR, Self::TauA, Self::TauE, Self::TauS, Self::TauL, Self::Rate];

    /// The setting that is swept.
    pub fn setting(self) -> &'static NumberSetting<PipelineSettings> {
        match self {
            Self::TauR => &TAU_R,
            Self::TauA => &TAU_A,
            Self::TauE => &TAU_E,
            Self::TauS => &TAU_S,
            Self::TauL => &TAU_L,
            Self::Rate => &RATE,
        }
    }

    /// Returns the name on the command line and in files.
    pub fn flag(self) -> &'static str {
        self.setting().flag.unwrap_or(self.setting().key)
    }

    /// Returns true if the parameter's module runs.
    fn matters(self, settings: &PipelineSettings) -> bool {
        match self {
            Self::TauR | Self::TauA | Self::TauE => settings.outlier_filter,
            Self::TauL => settings.interval_filter,
            Self::TauS | Self::Rate => true,
        }
    }
}

/// Equal steps of a parameter, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sweep {
    pub parameter: Parameter,
    pub from: f64,
    pub to: f64,
    pub steps: usize,
}

impl Sweep {
    pub const MOST_STEPS: usize = 200;

    pub fn values(&self) -> Vec<f64> {
        let last = self.steps.saturating_sub(1).max(1) as f64;
        (0..self.steps).map(|i| self.from + (self.to - self.from) * i as f64 / last).collect()
    }

    /// Returns the settings with one value of the parameter.
    pub fn with(&self, settings: &PipelineSettings, value: f64) -> PipelineSettings {
        let mut variant = *settings;
        *(self.parameter.setting().field)(&mut variant) = value;
        variant
    }

    /// Returns a value with enough digits to distinguish the steps, without trailing zeros.
    pub fn label_of(&self, value: f64) -> String {
        let values = self.values();
        short(value, values[1] - values[0])
    }

    /// Returns the parameter with its unit and the value of the settings.
    pub fn axis_label(&self, settings: &PipelineSettings) -> String {
        let setting = self.parameter.setting();
        format!("{} ({}), set to {}", setting.title, setting.unit, setting.value(settings))
    }

    /// Checks the values; the error is one line.
    pub fn check(&self, settings: &PipelineSettings) -> Result<(), String> {
        let Self { parameter, steps, .. } = *self;
        if !(2..=Self::MOST_STEPS).contains(&steps) {
            return Err(format!("steps is {steps}; it must be from 2 to {}", Self::MOST_STEPS));
        }
        if self.from == self.to {
            return Err(format!("from and to are both {}; give two different values", self.from));
        }
        if !parameter.matters(settings) {
            return Err(format!("{} has no effect while its filter is off", parameter.flag()));
        }
        for value in [self.from, self.to] {
            self.with(settings, value).check()?;
        }
        Ok(())
    }
}

/// Inter-prism errors for every value of the parameter.
pub fn sweep(
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    sweep: &Sweep,
    reference: Reference,
    splits: Option<Splits>,
    progress: &Progress,
) -> Result<Study, StudyError> {
    sweep.check(&settings.pipeline).map_err(StudyError::Nothing)?;
    let values = sweep.values();
    progress.expect(1 + values.len() as u64);
    let (judges, findings) =
        progress.step(|| reference::judges(deployments, settings, reference, splits))??;
    let parameter = sweep.parameter;
    let groups = values
        .par_iter()
        .map(|value| {
            let variant = sweep.with(&settings.pipeline, *value);
            let (errors, count) = progress.step(|| reference::pooled(&judges, &variant))?;
            Ok(Group {
                label: sweep.label_of(*value),
                note: format!("{count}"),
                boxes: vec![Quantiles::of(errors).ok_or_else(|| "no triplets".to_owned())],
            })
        })
        .collect::<Result<Vec<_>, StudyError>>()?;
    Ok(Study {
        name: format!("sweep-{}", parameter.flag()),
        title: format!("Sensitivity of the errors to {}", parameter.setting().title),
        subtitle: reference::in_words(&judges, splits),
        value_label: "inter-prism error (mm)".to_owned(),
        group_label: format!("{}; below: number of triplets", sweep.axis_label(&settings.pipeline)),
        series: vec![Series {
            name: settings.pipeline.interpolation.title().to_owned(),
            rgb: palette::interpolation(settings.pipeline.interpolation),
        }],
        groups,
        levels: Vec::new(),
        findings,
        settings: *settings,
    })
}

/// Formats a value with enough digits to distinguish the steps, without trailing zeros.
fn short(value: f64, step: f64) -> String {
    let digits = (2.0 - step.abs().log10().floor()).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.digits$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_swept_and_nonsense_is_refused() {
        let tau_s = Sweep { parameter: Parameter::TauS, from: 0.5, to: 3.0, steps: 11 };
        let values = tau_s.values();
        assert_eq!((values[0], values[10], values.len()), (0.5, 3.0, 11));
        assert_eq!(short(values[1], 0.25), "0.75");
        assert_eq!(short(1.2e-8, 1e-9), "0.000000012");
        let paper = PipelineSettings::default();
        assert_eq!(tau_s.check(&paper), Ok(()));
        assert!(Sweep { from: -1.0, ..tau_s }.check(&paper).is_err());
        assert!(Sweep { steps: 1, ..tau_s }.check(&paper).is_err());
        let no_filter = PipelineSettings { outlier_filter: false, ..paper };
        assert!(Sweep { parameter: Parameter::TauR, ..tau_s }.check(&no_filter).is_err());
    }
}
