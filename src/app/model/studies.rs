//! The studies of the window: options, running job, and result.

use std::ops::RangeInclusive;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_tools::experiment::{
    Comparison, Parameter, Reference, Splits, Study, StudyError, Sweep, ablate, compare, sweep,
    sweep_answers,
};

#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum StudyKind {
    Comparison,
    Ablation,
    Sensitivity,
    Answers,
}

impl StudyKind {
    pub const ALL: [Self; 4] = [Self::Comparison, Self::Ablation, Self::Sensitivity, Self::Answers];

    pub fn title(self) -> &'static str {
        match self {
            Self::Comparison => "Compare calibrations",
            Self::Ablation => "Ablate the pipeline",
            Self::Sensitivity => "Sweep a threshold",
            Self::Answers => "Sweep D and the joint estimate",
        }
    }

    /// Returns true if a threshold is swept.
    pub fn is_sweep(self) -> bool {
        matches!(self, Self::Sensitivity | Self::Answers)
    }

    /// Returns true if the transforms that the errors are computed with can be chosen.
    pub fn has_reference(self) -> bool {
        matches!(self, Self::Ablation | Self::Sensitivity)
    }
}

/// Options of a study.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct StudyOptions {
    pub kind: StudyKind,
    /// True for all open deployments, false for the active one.
    pub all_open: bool,
    pub sweep: Sweep,
    pub reference: Reference,
    /// True to solve with a random part of the data and evaluate on the rest.
    pub split: bool,
    pub splits: Splits,
}

impl Default for StudyOptions {
    fn default() -> Self {
        Self {
            kind: StudyKind::Comparison,
            all_open: true,
            sweep: Sweep { parameter: Parameter::TauS, from: 0.5, to: 3.0, steps: 11 },
            reference: None,
            split: false,
            splits: Splits { repeats: 10, seed: 1 },
        }
    }
}

impl StudyOptions {
    /// Limits of the options in the window; a sweep's ends are in the parameter's unit.
    pub const REPEATS: RangeInclusive<usize> = 1..=200;
    pub const SEEDS: RangeInclusive<u64> = 0..=u32::MAX as u64;
    pub const ENDS: RangeInclusive<f64> = 0.0..=100.0;
    pub const STEPS: RangeInclusive<usize> = 2..=60;

    /// Clamps the options to the limits of the window, as a file may contain any.
    pub fn within_bounds(mut self) -> Self {
        let repeats = &mut self.splits.repeats;
        *repeats = (*repeats).clamp(*Self::REPEATS.start(), *Self::REPEATS.end());
        let seed = &mut self.splits.seed;
        *seed = (*seed).clamp(*Self::SEEDS.start(), *Self::SEEDS.end());
        let steps = &mut self.sweep.steps;
        *steps = (*steps).clamp(*Self::STEPS.start(), *Self::STEPS.end());
        for end in [&mut self.sweep.from, &mut self.sweep.to] {
            // NaN becomes the lower limit.
            *end = end.max(*Self::ENDS.start()).min(*Self::ENDS.end());
        }
        self
    }
}

/// Result of a study.
#[derive(Clone, Debug)]
pub enum StudyResult {
    Pipeline(Study),
    Comparison(Comparison),
}

impl StudyResult {
    pub fn study(&self) -> &Study {
        match self {
            Self::Pipeline(study) => study,
            Self::Comparison(comparison) => &comparison.study,
        }
    }
}

/// Runs a study on the calling thread.
pub fn run(
    options: &StudyOptions,
    deployments: &[Arc<Deployment>],
    settings: &Settings,
    progress: &Progress,
) -> Result<StudyResult, StudyError> {
    let splits = options.split.then_some(options.splits);
    let StudyOptions { reference, sweep: range, .. } = options;
    match options.kind {
        StudyKind::Comparison => {
            compare(deployments, settings, splits, progress).map(StudyResult::Comparison)
        }
        StudyKind::Ablation => {
            ablate(deployments, settings, *reference, splits, progress).map(StudyResult::Pipeline)
        }
        StudyKind::Sensitivity => sweep(deployments, settings, range, *reference, splits, progress)
            .map(StudyResult::Pipeline),
        StudyKind::Answers => {
            sweep_answers(deployments, settings, range, progress).map(StudyResult::Pipeline)
        }
    }
}

/// State of the studies pane.
#[derive(Default)]
pub struct Studies {
    pub options: StudyOptions,
    /// Number and progress of the running study.
    pub running: Option<(u64, Arc<Progress>)>,
    pub result: Option<Arc<StudyResult>>,
}

impl Studies {
    /// Cancels the running study.
    pub fn cancel(&self) {
        if let Some((_, progress)) = &self.running {
            progress.cancel();
        }
    }
}
