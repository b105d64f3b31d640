//! Conversion between the window's state and a session.

use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use super::session_state::{Missing, Waiting};
use crate::app::layout::Layout;
use crate::app::model::{OpenDeployment, Pin, SessionCommand};
use crate::app::persist::last::LastSession;
use crate::app::persist::session::{
    EXTENSION, SavedDeployment, SavedPin, SavedView, Session, SessionError,
};
use crate::app::persist::session_file;
use resect_core::deployment::Finding;
use resect_io::source::Source;

/// Number of closed deployments that can be reopened.
const MOST_CLOSED: usize = 10;

impl State {
    #[expect(clippy::needless_pass_by_value, reason = "a command is handled once")]
    pub(super) fn handle_session(&mut self, command: SessionCommand) {
        match command {
            SessionCommand::OpenDialog => self.open_session_dialog(),
            SessionCommand::DiscardRecovered => self.discard_recovered(),
            SessionCommand::ReopenLast => self.reopen_last(),
            SessionCommand::Save => self.save_session(false),
            SessionCommand::SaveAs => self.save_session(true),
            SessionCommand::RetryMissing => self.retry_missing(),
            SessionCommand::ForgetMissing(index) => self.forget_missing(index),
        }
    }

    /// Returns the session: open, waiting and missing deployments, and the view. Deployments whose reading was just
    /// requested are not included.
    pub fn session(&self) -> Session {
        let shown = self.active().map(|open| open.id);
        let mut active = None;
        let mut deployments = Vec::new();
        for open in self.deployments.open.iter().filter(|open| !open.placeholder) {
            let Some(source) = open.source.clone() else { continue };
            if Some(open.id) == shown {
                active = Some(deployments.len());
            }
            deployments.push(self.saved(open, source));
        }
        for waiting in self.session.restoring.iter().chain(&self.session.waiting) {
            if waiting.shown {
                active = Some(deployments.len());
            }
            deployments.push(waiting.saved.clone());
        }
        // In ascending order, since each index counts the missing deployments before it.
        let mut missing: Vec<&Missing> = self.session.missing.iter().collect();
        missing.sort_by_key(|missing| missing.place);
        for missing in missing {
            let place = missing.place.min(deployments.len());
            deployments.insert(place, missing.saved.clone());
            active = active.map(|active| active + usize::from(place <= active));
        }
        let pin = |pin: &Pin| SavedPin {
            name: pin.name.clone(),
            shown: pin.shown,
            result: (*pin.summary).clone(),
        };
        Session {
            deployments,
            active: active.unwrap_or(0),
            view: SavedView {
                colouring: self.scene.colouring,
                units: self.workspace.units,
                plots: self.time.plots.clone(),
                visibility: self.scene.visibility,
                scene: self.scene.options,
                study: self.results.studies.options,
            },
            layout: Some(self.workspace.layout.describe()),
            pins: self.results.pins.iter().map(pin).collect(),
            plan: self.planning.touched.then(|| self.planning.plan.clone().into()),
        }
    }

    fn saved(&self, open: &OpenDeployment, source: Source) -> SavedDeployment {
        let timeline = &open.timeline;
        SavedDeployment {
            source,
            settings: open.settings,
            cursor_s: timeline.cursor_s,
            window_s: (timeline.window_s != timeline.whole_s).then_some(timeline.window_s),
            selection_s: timeline.selection_s,
            files: self.session.files.get(&open.id).cloned().unwrap_or_default(),
            estimates: open.judging.saved(),
        }
    }

    /// Remembers a deployment that the user closes, with its settings and its evaluated trajectories.
    pub(super) fn keep_closed(&mut self, id: u64) {
        let Some(open) = self.deployments.get(id).filter(|open| !open.placeholder) else { return };
        let Some(source) = open.source.clone() else { return };
        let saved = self.saved(open, source);
        let closed = &mut self.session.closed;
        closed.push(saved);
        if closed.len() > MOST_CLOSED {
            closed.remove(0);
        }
        if let Some(name) = self.name_of(id) {
            self.toasts.done(format!("{name} closed; File › Reopen {name} brings it back"));
        }
    }

    /// Opens the deployment that was closed last, as it was.
    pub(super) fn reopen_closed(&mut self) {
        let Some(saved) = self.session.closed.pop() else { return };
        let place = self.deployments.open.len() + self.session.waiting.len();
        self.session.waiting.push_back(Waiting { saved, shown: true, place });
        self.restore_next();
    }

    /// Opens a session's deployments in turn, and applies its view.
    pub fn restore(&mut self, session: Session) {
        self.scene.visibility = session.view.visibility;
        self.scene.colouring = session.view.colouring;
        self.scene.options = session.view.scene;
        self.workspace.units = session.view.units;
        self.time.plots = session.view.plots.valid();
        self.results.studies.options = session.view.study.within_bounds();
        if let Some(plan) = session.plan {
            self.planning.set(*plan);
        }
        if let Some(description) = &session.layout {
            let (layout, findings) = Layout::of_description(description);
            self.workspace.layout = layout;
            self.tell(&findings);
        }
        for saved in session.pins {
            let id = self.results.pin(Arc::new(saved.result), None);
            if let Some(pin) = self.results.pins.iter_mut().find(|pin| pin.id == id) {
                pin.name = saved.name;
                pin.shown = saved.shown;
            }
        }
        let deployments = session.deployments.into_iter().enumerate();
        self.session.waiting.extend(deployments.map(|(place, saved)| Waiting {
            saved,
            shown: place == session.active,
            place,
        }));
        self.restore_next();
    }

    /// Reads a session's file, whose content then replaces everything that is open.
    pub fn open_session(&mut self, path: PathBuf) {
        let from = path.clone();
        let number = self.jobs.start(
            move || session_file::load(&from),
            move |state: &mut Self, number, result| state.take_session(number, path, result),
        );
        self.session.reading.push(number);
    }

    /// Reopens the previous session; the present one can then be reopened likewise.
    pub(super) fn reopen_last(&mut self) {
        if let Some(path) = self.session.last.as_ref().and_then(LastSession::path) {
            self.open_session(path.to_owned());
        }
    }

    pub(super) fn take_session(
        &mut self,
        number: u64,
        path: PathBuf,
        result: Result<(Session, Vec<Finding>), SessionError>,
    ) {
        self.session.done(number);
        match result {
            Ok((session, findings)) => {
                let unsaved = self.is_unsaved();
                self.clear();
                if unsaved {
                    let kept = "the previous session had unsaved changes; reopen it with File › Reopen the last session";
                    self.toasts.warning(kept);
                }
                // The file of the last session belongs to the program. Saving asks for another path.
                let last = self.session.last.as_ref().and_then(LastSession::path);
                self.session.path = (last != Some(path.as_path())).then_some(path);
                self.session.kept = Some(session.clone());
                self.tell(&findings);
                self.restore(session);
            }
            Err(error) => self.toasts.error(&error.to_string()),
        }
    }

    /// Closes everything, so that it can be reopened.
    pub(super) fn clear(&mut self) {
        let replaced = self.session();
        if !replaced.is_empty() {
            self.session.replaced.get_or_insert(replaced);
        }
        let ids: Vec<u64> = self.deployments.open.iter().map(|open| open.id).collect();
        for id in ids {
            self.close(id);
        }
        self.results.pins.clear();
        self.results.runs.clear();
        self.give_up_restoring();
        let session = &mut self.session;
        session.missing.clear();
        session.waiting.clear();
        (session.restoring, session.shown) = (None, None);
        (session.path, session.kept) = (None, None);
        session.opened += 1;
        session.recovered = false;
        self.toasts.withdraw_offer();
    }

    /// Saves the replaced session for reopening.
    pub fn keep_replaced(&mut self) {
        let Some(replaced) = self.session.replaced.take() else { return };
        let Some(last) = self.session.last.clone() else { return };
        let number = self.jobs.start(
            move || last.write(&replaced).map_err(|error| error.to_string()),
            Self::take_replaced_kept,
        );
        self.session.writing.push((number, self.session.opened));
    }

    pub(super) fn take_replaced_kept(&mut self, number: u64, result: Result<(), String>) {
        self.session.done(number);
        match (result, &mut self.session.last) {
            (Ok(()), Some(last)) => last.written(),
            (Ok(()), None) => {}
            (Err(line), _) => self.toasts.error(&line),
        }
    }

    /// Saves to the session's file; asks for a path if there is none, or if `ask` is true.
    pub fn save_session(&mut self, ask: bool) {
        let (session, which) = (self.session(), self.session.opened);
        match self.session.path.clone().filter(|_| !ask) {
            Some(path) => self.write_session(path, session, which),
            None => {
                let answer = self.ask_where("Save the session", EXTENSION);
                self.jobs.start_unnumbered(
                    move || answer.wait(),
                    move |state: &mut Self, path| state.write_session(path, session, which),
                );
            }
        }
    }

    /// Writes a session; `which` is its number among the opened sessions.
    pub(super) fn write_session(&mut self, path: PathBuf, session: Session, which: u64) {
        let cache = Arc::clone(&self.session.cache);
        let to = path.clone();
        let job = move || {
            session.save(&to, &cache).map_err(|error| error.to_string())?;
            Ok(session)
        };
        let number = self.jobs.start(job, move |state: &mut Self, number, result| {
            state.take_session_saved(number, path, result);
        });
        self.session.writing.push((number, which));
    }

    pub(super) fn take_session_saved(
        &mut self,
        number: u64,
        path: PathBuf,
        result: Result<Session, String>,
    ) {
        let which = self.session.done(number);
        match result {
            Ok(session) => {
                self.toasts.done(format!("session saved to {}", path.display()));
                // Another session, with its own file, may have been opened in the meantime.
                if which == Some(self.session.opened) {
                    (self.session.path, self.session.kept) = (Some(path), Some(session));
                }
            }
            Err(line) => self.toasts.error(&line),
        }
    }

    /// Waits for running writes before the window closes.
    pub fn finish(&mut self) {
        self.take_outcomes();
        self.finish_live();
        while !self.session.writing.is_empty() {
            match self.jobs.wait() {
                Some(outcome) => outcome(self),
                None => break,
            }
        }
    }

    /// Shows findings as warnings.
    pub fn tell(&mut self, findings: &[Finding]) {
        for finding in findings {
            self.toasts.warning(&finding.to_string());
        }
    }
}

#[cfg(test)]
#[path = "sessions_tests.rs"]
mod tests;
