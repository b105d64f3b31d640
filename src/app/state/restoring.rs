//! Restoring of a session's deployments in turn; those that cannot be opened stay in the session.

use std::sync::Arc;

use super::State;
use super::session_state::{Missing, Waiting, title_of_each};
use crate::app::model::{Command, SessionCommand};
use crate::app::persist::session::Session;
use resect_core::deployment::Deployment;
use resect_io::source::Source;

impl State {
    /// Restores the session of a crash at the time `when`, and offers to discard it.
    pub fn recover(&mut self, session: Session, when: &str) {
        let names = title_of_each(session.deployments.iter().map(|saved| &saved.source));
        let pins = match session.pins.len() {
            0 => None,
            1 => Some("a pinned result".to_owned()),
            several => Some(format!("{several} pinned results")),
        };
        let what = names.into_iter().chain(pins).collect::<Vec<_>>().join(", ");
        let line = format!("restored the session from before the crash: {what}; saved {when}");
        self.toasts.offer(&line, ("Discard", Command::Session(SessionCommand::DiscardRecovered)));
        self.session.recovered = true;
        self.restore(session);
    }

    /// Closes the deployments restored after a crash.
    pub(super) fn discard_recovered(&mut self) {
        if self.session.recovered {
            self.clear();
            self.toasts.done("discarded; File › Reopen the last session brings it back");
        }
    }

    /// Opens the next deployment of the session.
    pub(super) fn restore_next(&mut self) {
        if self.session.restoring.is_none()
            && let Some(next) = self.session.waiting.pop_front()
        {
            let cache = Arc::clone(&self.session.cache);
            self.read_again(&next.saved, cache);
            self.session.restoring = Some(next);
        } else if self.session.waiting.is_empty() && self.session.restoring.is_none() {
            self.session.shown = None;
        }
    }

    /// Reads the deployment that is being restored again, with the user's answer.
    pub(super) fn restore_with(&mut self, source: Source) {
        let Some(restoring) = &mut self.session.restoring else { return };
        restoring.saved.source = source;
        let (saved, cache) = (restoring.saved.clone(), Arc::clone(&self.session.cache));
        self.read_again(&saved, cache);
    }

    /// Adds a restored deployment with its window, cursor and other saved state.
    pub(super) fn restored(&mut self, deployment: Arc<Deployment>) {
        let Some(Waiting { saved, shown, .. }) = self.session.restoring.take() else { return };
        self.add_with(deployment, Some(saved.source), saved.settings);
        if let Some(open) = self.deployments.open.last_mut() {
            let timeline = &mut open.timeline;
            if let Some(window_s) = saved.window_s {
                timeline.show(window_s);
            }
            if let Some(cursor_s) = saved.cursor_s {
                timeline.move_cursor(cursor_s);
            }
            timeline.select(saved.selection_s);
            if shown {
                self.session.shown = Some(open.id);
            }
        }
        if !saved.estimates.is_empty() {
            self.read_saved_estimates(self.deployments.newest_id, saved.estimates);
        }
        self.tell_of_reading(self.deployments.open.len() - 1);
        let shown = self.session.shown;
        if let Some(index) = self.deployments.open.iter().position(|open| Some(open.id) == shown) {
            self.deployments.active = index;
        }
        self.restore_next();
    }

    /// Records that a deployment could not be opened; it stays in the session.
    pub(super) fn not_restored(&mut self, why: &str) {
        let Some(Waiting { saved, place, .. }) = self.session.restoring.take() else { return };
        self.toasts.not_opened(&saved.source.place, &format!("{why} (it stays in the session)"));
        self.session.missing.push(Missing { saved, why: why.to_owned(), place });
        self.restore_next();
    }

    /// Retries the deployments that could not be opened.
    pub fn retry_missing(&mut self) {
        let missing = std::mem::take(&mut self.session.missing);
        let again = |Missing { saved, place, .. }| Waiting { saved, shown: false, place };
        self.session.waiting.extend(missing.into_iter().map(again));
        self.restore_next();
    }

    /// Removes a deployment that could not be opened from the session, by its index among those.
    pub(super) fn forget_missing(&mut self, index: usize) {
        if index < self.session.missing.len() {
            let missing = self.session.missing.remove(index);
            self.toasts.settled(&missing.saved.source.place);
        }
    }
}
