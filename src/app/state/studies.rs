//! Studies: their jobs, results and files.

use std::sync::Arc;

use super::State;
use crate::app::file_dialog::{Question, Wanted};
use crate::app::model::{StudyResult, studies};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_tools::experiment::StudyError;

impl State {
    pub(super) fn run_study(&mut self) {
        let options = self.results.studies.options;
        let deployments: Vec<Arc<Deployment>> = if options.all_open {
            let named = self.deployments.open.iter().zip(self.names());
            named.map(|(open, name)| open.named(name)).collect()
        } else {
            self.active().map(|open| Arc::clone(&open.deployment)).into_iter().collect()
        };
        let settings = *self.settings();
        let progress = Arc::new(Progress::default());
        let shared = Arc::clone(&progress);
        let number = self.jobs.start(
            move || studies::run(&options, &deployments, &settings, &shared).map(Arc::new),
            Self::take_studied,
        );
        self.results.studies.running = Some((number, progress));
    }

    fn take_studied(&mut self, number: u64, result: Result<Arc<StudyResult>, StudyError>) {
        if self.results.studies.running.as_ref().is_none_or(|(running, _)| *running != number) {
            return;
        }
        self.results.studies.running = None;
        match result {
            Ok(result) => self.results.studies.result = Some(result),
            Err(StudyError::Cancelled) => {}
            Err(error) => self.toasts.error(&error.to_string()),
        }
    }

    pub(super) fn save_study(&mut self) {
        let Some(result) = self.results.studies.result.clone() else { return };
        let question = Question::new("Save CSV, SVG and PNG into a folder", Wanted::Folder);
        let answer = self.ask(question);
        self.tell_when_done(move || {
            let folder = answer.wait()?;
            let written = resect_report::study::write(result.study(), &folder);
            Some(
                written
                    .map(|files| format!("{} files written to {}", files.len(), folder.display()))
                    .map_err(|error| error.to_string()),
            )
        });
    }
}
