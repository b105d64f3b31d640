//! What the worker has done, taken in.

use std::sync::Arc;

use super::{Notice, State};
use crate::app::worker::{Reply, Source};
use crate::deployment::Deployment;
use crate::experiment::StudyError;

impl State {
    /// Takes in what the worker has done since the last frame.
    pub fn take_replies(&mut self) {
        while let Some(reply) = self.worker.try_reply() {
            self.take(reply);
        }
    }

    /// Waits until nothing is under way; for pictures and tests.
    pub fn settle(&mut self) {
        while self.is_busy() {
            match self.worker.wait_reply() {
                Some(reply) => self.take(reply),
                None => break,
            }
        }
    }

    fn take(&mut self, reply: Reply) {
        match reply {
            Reply::Opened(number, result) => self.take_opened(number, result),
            Reply::Analysed { number, id, analysis, plots, clouds } => {
                if let Some(open) = self.open.iter_mut().find(|open| open.id == id) {
                    open.take(number, analysis, plots, clouds);
                }
            }
            Reply::Studied(number, result) => {
                if self.studies.running.as_ref().is_none_or(|(running, _)| *running != number) {
                    return;
                }
                self.studies.running = None;
                match result {
                    Ok(result) => self.studies.result = Some(result),
                    Err(StudyError::Cancelled) => {}
                    Err(error) => self.notice = Some(Notice::Error(error.to_string())),
                }
            }
            Reply::Failed(number) => {
                self.opening.retain(|opening| *opening != number);
                for open in &mut self.open {
                    open.analysing = open.analysing.filter(|(newest, _)| *newest != number);
                }
                self.studies.running = self.studies.running.take().filter(|(n, _)| *n != number);
                self.notice = Some(Notice::Error(
                    "a bug in resect stopped the calculation; please report it with the data and the settings".to_owned(),
                ));
            }
            Reply::Picked(path) => self.open_source(Source::Path(path)),
            Reply::Done(Ok(line)) => self.notice = Some(Notice::Done(line)),
            Reply::Done(Err(line)) => self.notice = Some(Notice::Error(line)),
        }
    }

    fn take_opened(&mut self, number: u64, result: Result<Arc<Deployment>, String>) {
        self.opening.retain(|opening| *opening != number);
        match result {
            Ok(deployment) => {
                self.notice = None;
                self.add(deployment);
                if self.placeholder == Some(number) {
                    self.open[self.active].placeholder = true;
                }
            }
            Err(line) => self.notice = Some(Notice::Error(line)),
        }
    }
}
