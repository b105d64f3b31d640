//! Whether the calibration of one open deployment holds for the others: what was asked, and what was found.

use std::sync::Arc;

use super::State;
use crate::app::model::{AnswerOf, OpenDeployment, Validated};
use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_core::progress::{Cancelled, Progress};
use resect_core::validation::{Earlier, Validation, drive_alone, validate};

impl State {
    /// What was found of the active deployment's calibration, as long as neither answer has changed since.
    pub fn validations(&self) -> impl Iterator<Item = &Validation> {
        self.validated().map(|(_, found)| found)
    }

    /// Validations with the names of their runs, which tell them apart.
    pub fn validated(&self) -> impl Iterator<Item = (String, &Validation)> {
        let is_newest = |(id, run): AnswerOf| {
            self.open.iter().any(|open| open.id == id && open.analysis_run == run)
        };
        let of_active = self.active().map(newest) == self.validations.of;
        let found = self.validations.found.iter();
        let found = found.filter(move |(run, _)| of_active && is_newest(*run));
        found.map(|((id, _), found)| {
            (self.name_of(*id).unwrap_or_else(|| found.deployment.clone()), found)
        })
    }

    /// Whether there is a calibration, and another run that it can be held against.
    pub fn can_validate(&self) -> bool {
        let has_answer = self.analysed().is_some_and(|(open, analysis)| {
            analysis.answer.is_ok() && !open.joint_follows() && !self.is_stale()
        });
        has_answer && self.open.len() > 1 && self.validations.running.is_none()
    }

    /// Holds the active deployment's calibration against all others that are open, beside the window.
    pub(super) fn validate_others(&mut self) {
        let Some((active, analysis)) = self.analysed().filter(|_| self.can_validate()) else {
            return;
        };
        let Ok(answer) = &analysis.answer else { return };
        let (of, earlier) = (newest(active), Earlier::of(&active.deployment, answer));
        let others = self.open.iter().filter(|open| open.id != active.id);
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
        self.validations.running = Some((number, progress));
    }

    pub(super) fn take_validated(&mut self, number: u64, result: Result<Validated, Cancelled>) {
        if self.validations.running.as_ref().is_none_or(|(running, _)| *running != number) {
            return;
        }
        self.validations.running = None;
        if let Ok(Validated { of, found }) = result {
            (self.validations.of, self.validations.found) = (Some(of), found);
        }
    }
}

fn newest(open: &OpenDeployment) -> AnswerOf {
    (open.id, open.analysis_run)
}

/// A run's own answer is the joint estimate, whatever is shown of it.
fn jointly(settings: Settings) -> Settings {
    Settings { calibration: settings.calibration.with_method(Method::Joint), ..settings }
}
