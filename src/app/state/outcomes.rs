//! Outcomes of background jobs.

use std::sync::Arc;

use super::State;
use crate::app::model::Pane;
use crate::app::model::new_findings::{forget_past, new_findings};
use crate::app::prepared::PreparedPlots;
use crate::app::prepared::analyser::Answered;
use resect_report::summary::ResultSummary;

impl State {
    /// Applies the outcomes since the last frame.
    pub fn take_outcomes(&mut self) {
        while let Some(outcome) = self.jobs.outcome() {
            outcome(self);
        }
    }

    /// Waits until no job is running; for pictures and tests.
    pub fn settle(&mut self) {
        while self.is_busy() {
            match self.jobs.wait() {
                Some(outcome) => outcome(self),
                None => break,
            }
        }
    }

    /// Waits for the next outcome of a job and applies it; returns false if there is none. For tests of jobs that are not counted.
    pub fn wait_for_outcome(&mut self) -> bool {
        self.jobs.wait().map(|outcome| outcome(self)).is_some()
    }

    /// Ends a job, by its number, that failed because of a bug.
    pub(super) fn failed(&mut self, number: u64) {
        self.opening_failed(number);
        self.path_requests.retain(|looking| *looking != number);
        self.session.done(number);
        for open in &mut self.deployments.open {
            open.analysing = open.analysing.filter(|newest| newest.number != number);
            open.way.failed(number);
            open.beside.failed(number);
            open.judging.judgement.failed(number);
            open.judging.extrinsics.failed(number);
        }
        self.planning.foreseen.failed(number);
        self.planning.better.failed(number);
        self.results.studies.running =
            self.results.studies.running.take().filter(|(n, _)| *n != number);
        let validating = &mut self.results.validations.running;
        *validating = validating.take().filter(|(n, _)| *n != number);
        self.toasts.error(
            "a bug in resect stopped the calculation; please report it with the data and the settings",
        );
    }

    /// Stores the residuals of a pinned result.
    pub(super) fn take_drawn_pin(&mut self, id: u64, plots: Arc<PreparedPlots>) {
        if let Some(pin) = self.results.pins.iter_mut().find(|pin| pin.id == id) {
            pin.plots = Some(plots);
        }
    }

    pub(super) fn take_analysed(&mut self, answered: Answered) {
        let id = answered.id;
        let shown = self.active().map(|open| open.id);
        let Some(name) = self.name_of(id) else { return };
        let is_read = shown == Some(id) && self.workspace.layout.place(Pane::Result).is_some();
        let Some(open) = self.deployments.get_mut(id) else { return };
        let analysis = Arc::clone(&answered.analysis);
        // While a deployment grows, a preliminary result of the paper's method does not replace the joint estimate. Findings
        // and drawing must belong to the same result.
        if answered.joint_follows
            && open.answered
            && let Some(more) = open.more.as_ref()
            && let Some(session) = self.live.session.as_ref().filter(|_| self.live.id == Some(id))
        {
            session.answered(Arc::clone(more), analysis, true);
            return;
        }
        let (first, joint_follows) = (!open.answered, answered.joint_follows);
        let before = open.summary.clone();
        if !open.take(answered) {
            return;
        }
        // The live pane already shows the findings of each second.
        let is_live = self.live.is_running() && self.live.id == Some(id);
        if !joint_follows && !is_live {
            let of_answer = analysis.answer.as_ref().map(|answer| &answer.calibration.findings[..]);
            let now = open.deployment.findings.iter().chain(of_answer.unwrap_or_default());
            self.toasts.update((id, &name), &now);
            match of_answer {
                // The result pane shows the findings. Toasts show only those that a change of the settings adds while it is not
                // in sight.
                Ok(findings) if first || is_read => {
                    new_findings(findings, &mut open.told);
                }
                Ok(findings) => {
                    forget_past(now, &mut open.told);
                    self.toasts.findings((id, &name), findings, &mut open.told);
                }
                Err(_) => {}
            }
        }
        let stations =
            |summary: &Option<Arc<ResultSummary>>| summary.as_ref().map(|s| s.stations.clone());
        if stations(&before) != stations(&open.summary) && Some(id) == shown {
            // The frame has changed; only ends on prisms are still valid.
            self.scene.ruler.ends.retain(|end| end.prism.is_some());
        }
        self.tell_live(id, &analysis, joint_follows);
        if let Some(look) = self.scene.view.last_look.filter(|_| is_live && Some(id) == shown) {
            // Keeps the growing track in view.
            self.scene.view.look_again(look);
        }
        // Only the joint estimate is reported, remembered and pinned, not the preliminary result.
        if !joint_follows {
            self.remember_run(id, &analysis);
        }
    }
}

#[cfg(test)]
mod tests {

    use super::*;
    use resect_core::calibration::Method;
    use resect_io::sample::Sample;

    /// Applies the next outcome.
    fn take_next(state: &mut State) {
        let outcome = state.jobs.wait().expect("an outcome");
        outcome(state);
    }

    fn shown(state: &State) -> Method {
        let (_, analysis) = state.analysed().expect("an answer");
        analysis.answer.as_ref().expect("an answer").calibration.method
    }

    #[test]
    fn what_is_pinned_remembered_and_told_is_the_joint_estimate() {
        let mut state = State::new(egui::Context::default());
        state.add(Arc::new(Sample::Warthog.open().expect("built in")), None);
        take_next(&mut state);
        assert_eq!(shown(&state), Method::InterPrism);
        assert!(state.deployments.open[0].joint_follows() && state.is_busy() && !state.is_stale());
        let before = state.deployments.open[0].analysis_run;
        state.pin_active();
        assert!(state.results.pins.is_empty() && state.results.runs.is_empty());

        take_next(&mut state);
        assert_eq!(shown(&state), Method::Joint);
        assert!(
            !state.deployments.open[0].joint_follows() && !state.is_busy() && !state.is_stale()
        );
        assert_ne!(state.deployments.open[0].analysis_run, before, "what is drawn is drawn again");
        state.pin_active();
        assert_eq!(state.results.pins[0].summary.method, Method::Joint);
        let run = state.results.runs[0].result.as_ref().expect("an answer");
        assert_eq!(run.method, Method::Joint);
        assert!(state.toasts.shown().is_empty(), "at first nothing is news");
    }
}
