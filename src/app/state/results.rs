//! Results of the session: runs, and pinned results for comparison.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use crate::app::model::undo::Moment;
use crate::app::model::{Pin, ResultsCommand, Run};
use crate::app::prepared::{PreparedPlots, RawReadings};
use resect_core::analysis::{Analysis, Analyst, Settings};
use resect_core::calibration::Method;
use resect_report::summary::ResultSummary;

/// Largest number of runs kept; the oldest are removed.
const MOST_RUNS: usize = 200;

impl State {
    #[expect(clippy::needless_pass_by_value, reason = "a command is handled once")]
    pub(super) fn handle_results(&mut self, command: ResultsCommand, ctx: &egui::Context) {
        use ResultsCommand as Command;
        match command {
            Command::Pin => self.pin_active(),
            Command::PinRun(id) => self.pin_run(id),
            Command::Unpin(id) => self.results.pins.retain(|pin| pin.id != id),
            Command::ShowPin(id, shown) => {
                if let Some(pin) = self.results.pins.iter_mut().find(|pin| pin.id == id) {
                    pin.shown = shown;
                }
            }
            Command::UsePinned(id) => {
                if let Some(settings) = self.settings_of_pin(id) {
                    self.change_active(settings, Moment::now(ctx));
                }
            }
            Command::RestoreRun(id) => {
                if let Some(settings) = self.results.run(id).map(|run| run.settings) {
                    self.change_active(settings, Moment::now(ctx));
                }
            }
            Command::ValidateOthers => self.validate_others(),
            Command::SetStudy(options) => self.results.studies.options = options.within_bounds(),
            Command::RunStudy => self.run_study(),
            Command::CancelStudy => self.results.studies.cancel(),
            Command::SaveStudyDialog => self.save_study(),
            Command::CopyTransforms(format, part) => self.copy_transforms(format, part, ctx),
            Command::OpenInRerun => self.open_in_rerun(),
            Command::SaveRecordingDialog => self.save_recording(),
            Command::SaveTrajectoryDialog => self.save_trajectory(),
            Command::SaveReportDialog => self.save_report(),
        }
    }

    /// Returns the pinned result to compare the active deployment with: the last of the same data, or else the last of all.
    pub fn compared_with(&self) -> Option<&Pin> {
        let now = self.active()?.summary.as_ref()?;
        let pins = &self.results.pins;
        pins.iter().rev().find(|pin| pin.summary.has_same_data(now)).or(pins.last())
    }

    /// Returns the unique name of a result's deployment.
    pub fn name_of_result(&self, summary: &ResultSummary) -> String {
        let mut of = self.deployments.open.iter().filter(|open| summary.is_of(&open.deployment));
        let only = of.next().filter(|_| of.next().is_none());
        only.and_then(|open| self.name_of(open.id)).unwrap_or_else(|| summary.deployment.clone())
    }

    /// Cancels a calibration and restores the settings of the displayed result, if there is one.
    pub(super) fn cancel_analysis(&mut self, id: u64) {
        let Some(open) = self.deployments.get_mut(id) else { return };
        if open.analysing.take().is_none() {
            return;
        }
        if let Some(progress) = self.analyser.progress(id) {
            progress.cancel();
        }
        match open.analysis.as_ref().map(|analysis| analysis.settings) {
            Some(settings) => {
                self.change(&[id], settings, Moment::NEVER);
                self.toasts
                    .done("calibration stopped; the settings of the shown result are restored");
            }
            None => self
                .toasts
                .warning("the calibration was stopped; change a setting to start it again"),
        }
    }

    /// Returns the settings of a pinned result.
    pub fn settings_of_pin(&self, id: u64) -> Option<Settings> {
        let summary = &self.results.pins.iter().find(|pin| pin.id == id)?.summary;
        let mut settings = summary.settings;
        // The default method may have been another one when the result was pinned.
        let method = summary.method;
        settings.calibration.method = (method != Method::default()).then_some(method);
        Some(settings)
    }

    /// Records the result of an analysis as a run; a drag is one run.
    pub(super) fn remember_run(&mut self, deployment: u64, analysis: &Analysis) {
        let Some(open) = self.deployments.open.iter().find(|open| open.id == deployment) else {
            return;
        };
        let result = match (&analysis.answer, &open.summary) {
            (Ok(_), Some(summary)) => Ok(Arc::clone(summary)),
            (Err(error), _) => Err(error.finding().to_string()),
            (Ok(_), None) => return,
        };
        let step = self.deployments.undo.begun();
        let runs = &mut self.results.runs;
        let replaces = |run: &Run| run.deployment == deployment && run.step == step;
        if runs.last().is_some_and(replaces) {
            runs.pop();
        }
        let settings = analysis.settings;
        // Undo and redo give earlier results again.
        let is_again = |run: &Run| {
            run.deployment == deployment && run.settings == settings && run.result == result
        };
        runs.retain(|run| !is_again(run));
        if runs.len() >= MOST_RUNS {
            runs.remove(0);
        }
        let id = self.results.next_id();
        let run = Run { id, deployment, at: Instant::now(), result, settings, step };
        self.results.runs.push(run);
    }

    /// Describes the change of settings since the previous run of the deployment; `None` for its first.
    pub fn run_change(&self, run: &Run) -> Option<String> {
        let before = self.results.runs.iter().rev();
        let before = before.skip_while(|other| other.id != run.id).skip(1);
        let before = before.into_iter().find(|other| other.deployment == run.deployment)?;
        Some(self.workspace.units.changes(&before.settings, &run.settings))
    }

    pub(super) fn pin_active(&mut self) {
        let Some(open) = self.active().filter(|open| !open.joint_follows()) else { return };
        let Some(summary) = open.summary.clone() else { return };
        let plots = Some(Arc::clone(&open.plots));
        self.results.pin(summary, plots);
    }

    pub(super) fn pin_run(&mut self, id: u64) {
        if let Some(Ok(summary)) = self.results.run(id).map(|run| run.result.clone()) {
            self.results.pin(summary, None);
            self.draw_pins();
        }
    }

    /// Computes missing residuals of pinned results whose data is open. The results of one deployment are computed in turn,
    /// to reuse common intermediate results.
    pub(super) fn draw_pins(&mut self) {
        for open in &self.deployments.open {
            let missing = |pin: &&mut Pin| {
                pin.plots.is_none() && !pin.drawing && pin.summary.is_of(&open.deployment)
            };
            let wanted: Vec<(u64, Settings)> = (self.results.pins.iter_mut().filter(missing))
                .map(|pin| {
                    pin.drawing = true;
                    let mut settings = pin.summary.settings;
                    // The default method may have been another one when the result was pinned.
                    settings.calibration.method = Some(pin.summary.method);
                    (pin.id, settings)
                })
                .collect();
            if wanted.is_empty() {
                continue;
            }
            let deployment = Arc::clone(&open.deployment);
            let readings = open.analysis.is_some().then(|| Arc::clone(&open.plots.readings));
            let outbox = self.jobs.outbox();
            let each = move || {
                let readings = readings.unwrap_or_else(|| RawReadings::of(&deployment).into());
                let mut analyst = Analyst::new(deployment);
                for (id, settings) in wanted {
                    let analysis = analyst.run(&settings);
                    let plots =
                        Arc::new(PreparedPlots::of(analyst.deployment(), &analysis, &readings));
                    outbox.put(move |state: &mut Self| state.take_drawn_pin(id, plots));
                }
                None
            };
            self.jobs.start_unnumbered(each, |_, ()| {});
        }
    }
}
