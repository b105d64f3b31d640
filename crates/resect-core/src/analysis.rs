//! The processing chain: deployment → pipeline → calibration → evaluation.
//!
//! The window, the commands and the tests all use [`Analyst::run`].

mod setting_change;
mod settings;

pub use setting_change::{SettingChange, changes_in_words, setting_changes};
pub use settings::Settings;

use std::sync::Arc;

use crate::calibration;
use crate::calibration::{Calibration, CalibrationError, Method, Offer};
use crate::deployment::Deployment;
use crate::evaluation;
use crate::evaluation::Evaluation;
use crate::evaluation::answer_rows::{AnswerRow, answer_rows};
use crate::pipeline::{PipelineOutput, StagedPipeline, Triplets};
use crate::progress::{Cancelled, Progress};
use crate::stopwatch::Stopwatch;

/// An answer with its evaluation.
#[derive(Clone, Debug)]
pub struct Answer {
    pub calibration: Calibration,
    pub evaluation: Evaluation,
    /// Triplets of the pipeline, with corrected clocks if they were estimated.
    pub triplets: Arc<Triplets>,
}

/// Result of one run.
#[derive(Clone, Debug)]
pub struct Analysis {
    pub settings: Settings,
    pub pipeline: PipelineOutput,
    /// Methods that the data allows.
    pub offer: Offer,
    /// The answer, or the reason why there is none; the pipeline's output is valid in both cases.
    pub answer: Result<Arc<Answer>, CalibrationError>,
    pub pipeline_ms: f64,
    pub evaluation_ms: f64,
}

impl Analysis {
    /// Returns the triplets of the answer, or those of the pipeline without an answer.
    pub fn triplets(&self) -> &Arc<Triplets> {
        self.answer.as_ref().map_or(&self.pipeline.triplets, |answer| &answer.triplets)
    }

    /// Wall time of pipeline, calibration and evaluation (ms).
    pub fn total_ms(&self) -> f64 {
        let calibration = self
            .answer
            .as_ref()
            .map_or(0.0, |answer| answer.calibration.prior_ms + answer.calibration.solve_ms);
        self.pipeline_ms + calibration + self.evaluation_ms
    }

    /// Returns the rows of the answer; empty without one.
    pub fn rows(&self, deployment: &Deployment) -> Vec<AnswerRow> {
        self.answer.as_ref().map_or_else(
            |_| Vec::new(),
            |answer| {
                let Answer { calibration, evaluation, .. } = &**answer;
                answer_rows(deployment, calibration, evaluation, &self.offer.followed)
            },
        )
    }
}

/// Runs one deployment repeatedly, and caches the stages that a change does not affect.
pub struct Analyst {
    deployment: Arc<Deployment>,
    pipeline: StagedPipeline,
}

impl Analyst {
    pub fn new(deployment: Arc<Deployment>) -> Self {
        Self { deployment, pipeline: StagedPipeline::default() }
    }

    pub fn deployment(&self) -> &Arc<Deployment> {
        &self.deployment
    }

    pub fn run(&mut self, settings: &Settings) -> Analysis {
        self.run_while(settings, &Progress::default()).expect("nobody else can cancel it")
    }

    /// Runs like [`Self::run`] until `progress` is cancelled. Completed stages of the pipeline are cached.
    pub fn run_while(
        &mut self,
        settings: &Settings,
        progress: &Progress,
    ) -> Result<Analysis, Cancelled> {
        let started = Stopwatch::start();
        let pipeline = self.pipeline.run_while(&self.deployment, &settings.pipeline, progress)?;
        let pipeline_ms = started.elapsed_ms();
        let triplets = &pipeline.triplets;
        let offer = Offer::of(&self.deployment, triplets);
        progress.check()?;
        let calibration = calibration::solve_while(
            &self.deployment,
            triplets,
            &settings.calibration,
            &offer,
            progress,
        );
        progress.check()?;
        let started = Stopwatch::start();
        let answer = calibration.map(|calibration| {
            let (corrected, evaluation) = evaluation::evaluate_answer(
                &self.deployment,
                triplets,
                &offer.followed,
                &calibration,
            );
            let triplets = corrected.map_or_else(|| Arc::clone(triplets), Arc::new);
            Arc::new(Answer { calibration, evaluation, triplets })
        });
        let evaluation_ms = started.elapsed_ms();
        Ok(Analysis { settings: *settings, pipeline, offer, answer, pipeline_ms, evaluation_ms })
    }

    /// Returns the paper's answer alone, which is available at once, if these settings select the joint estimate; otherwise
    /// `None`. One station has the joint estimate only.
    pub fn run_published_while(
        &mut self,
        settings: &Settings,
        progress: &Progress,
    ) -> Result<Option<Analysis>, Cancelled> {
        if settings.calibration.method.unwrap_or_default() != Method::Joint {
            return Ok(None);
        }
        let started = Stopwatch::start();
        let pipeline = self.pipeline.run_while(&self.deployment, &settings.pipeline, progress)?;
        let pipeline_ms = started.elapsed_ms();
        let method = Offer::of(&self.deployment, &pipeline.triplets).first_method();
        let calibration = settings.calibration.with_method(method);
        let mut analysis = self.run_while(&Settings { calibration, ..*settings }, progress)?;
        analysis.pipeline_ms += pipeline_ms;
        Ok(Some(analysis))
    }
}
