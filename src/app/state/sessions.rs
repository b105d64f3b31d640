//! The window's state as a session, and a session as the window's state.

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

    /// All that is open, still to be restored or missing, and how it is looked at. What the user has just asked to open
    /// is not part of it before it is read.
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
        // The first comes first: the places of the others count it.
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
                plots: self.time.plots,
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

    /// Opens a session's deployments one after the other, and sets what it has set.
    pub fn restore(&mut self, session: Session) {
        self.scene.visibility = session.view.visibility;
        self.scene.colouring = session.view.colouring;
        self.scene.options = session.view.scene;
        self.workspace.units = session.view.units;
        self.time.plots = session.view.plots;
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

    /// Reads a session's file, which then takes the place of everything that is open.
    pub fn open_session(&mut self, path: PathBuf) {
        let from = path.clone();
        let number = self.jobs.start(
            move || session_file::load(&from),
            move |state: &mut Self, number, result| state.take_session(number, path, result),
        );
        self.session.reading.push(number);
    }

    /// Opens what was open before; what is open now can be opened again in the same way.
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
                    let kept = "what was open had changes that were not saved; File › Reopen what was open last brings it back";
                    self.toasts.warning(kept);
                }
                // The program's own file is not where the user saves.
                let last = self.session.last.as_ref().and_then(LastSession::path);
                self.session.path = (last != Some(path.as_path())).then_some(path);
                self.session.kept = Some(session.clone());
                self.tell(&findings);
                self.restore(session);
            }
            Err(error) => self.toasts.error(&error.to_string()),
        }
    }

    /// Closes everything; it can be opened again.
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

    /// Keeps what a session took the place of, to be opened again.
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

    /// Saves to the session's file, or asks for one where there is none yet or another is wanted.
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

    /// Writes a session; `which` tells which of those that were opened it is.
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
                // Another may have been opened meanwhile, which has a file of its own.
                if which == Some(self.session.opened) {
                    (self.session.path, self.session.kept) = (Some(path), Some(session));
                }
            }
            Err(line) => self.toasts.error(&line),
        }
    }

    /// Waits for what is being written: the window is closed.
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

    /// Says what was found on the way, where that is anything.
    pub fn tell(&mut self, findings: &[Finding]) {
        for finding in findings {
            self.toasts.warning(&finding.to_string());
        }
    }
}

#[cfg(test)]
#[path = "sessions_tests.rs"]
mod tests;
