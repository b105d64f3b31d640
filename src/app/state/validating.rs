//! Validation of one open deployment's calibration on the others: requests and results.

use std::sync::Arc;

use super::State;
use crate::app::model::{AnswerOf, OpenDeployment, Validated};
use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_core::progress::{Cancelled, Progress};
use resect_tools::validation::{Earlier, Validation, drive_alone, validate};

impl State {
    /// Returns the validations of the active deployment's calibration whose two results are still the newest.
    pub fn validations(&self) -> impl Iterator<Item = &Validation> {
        self.validated().map(|(_, found)| found)
    }

    /// Returns the validations, each with its run's unique name.
    pub fn validated(&self) -> impl Iterator<Item = (String, &Validation)> {
        let is_newest = |(id, run): AnswerOf| {
            self.deployments.open.iter().any(|open| open.id == id && open.analysis_run == run)
        };
        let of_active = self.active().map(newest) == self.results.validations.of;
        let found = self.results.validations.found.iter();
        let found = found.filter(move |(run, _)| of_active && is_newest(*run));
        found.map(|((id, _), found)| {
            (self.name_of(*id).unwrap_or_else(|| found.deployment.clone()), found)
        })
    }

    /// Returns true if there is a calibration, and another run to validate it on.
    pub fn can_validate(&self) -> bool {
        let has_answer = self.analysed().is_some_and(|(open, analysis)| {
            analysis.answer.is_ok() && !open.joint_follows() && !self.is_stale()
        });
        has_answer && self.deployments.open.len() > 1 && self.results.validations.running.is_none()
    }

    /// Validates the active deployment's calibration on all other open ones, in the background.
    pub(super) fn validate_others(&mut self) {
        let Some((active, analysis)) = self.analysed().filter(|_| self.can_validate()) else {
            return;
        };
        let Ok(answer) = &analysis.answer else { return };
        let (of, earlier) = (newest(active), Earlier::of(&active.deployment, answer));
        let others = self.deployments.open.iter().filter(|open| open.id != active.id);
        let runs: Vec<(AnswerOf, Arc<Deployment>, Settings)> = others
            .map(|open| (newest(open), Arc::clone(&open.deployment), jointly(open.settings)))
            .collect();
        let progress = Arc::new(Progress::default());
        let shared = Arc::clone(&progress);
        let job = move || {
            let of_run = |(run, deployment, settings): (AnswerOf, Arc<Deployment>, Settings)| {
                let alone = drive_alone(&deployment);
                let own = Analyst::new(Arc::clone(&alone)).run_while(&settings, &shared)?;
                Ok((run, validate(&earlier, &alone, &own)))
            };
            let found = runs.into_iter().map(of_run).collect::<Result<_, Cancelled>>()?;
            Ok(Validated { of, found })
        };
        let number = self.jobs.start(job, Self::take_validated);
        self.results.validations.running = Some((number, progress));
    }

    pub(super) fn take_validated(&mut self, number: u64, result: Result<Validated, Cancelled>) {
        if self.results.validations.running.as_ref().is_none_or(|(running, _)| *running != number) {
            return;
        }
        self.results.validations.running = None;
        if let Ok(Validated { of, found }) = result {
            (self.results.validations.of, self.results.validations.found) = (Some(of), found);
        }
    }
}

fn newest(open: &OpenDeployment) -> AnswerOf {
    (open.id, open.analysis_run)
}

/// A run is always compared by its joint estimate, whichever method is shown.
fn jointly(settings: Settings) -> Settings {
    Settings { calibration: settings.calibration.with_method(Method::Joint), ..settings }
}
