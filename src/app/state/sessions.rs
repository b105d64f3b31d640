//! The window's state as a session, and a session as the window's state.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use crate::app::layout::Layout;
use crate::app::model::OpenDeployment;
use crate::app::persist::hashes::HashCache;
use crate::app::persist::last::LastSession;
use crate::app::persist::preferences::{Recent, remember};
use crate::app::persist::session::{
    EXTENSION, Files, SavedDeployment, SavedPin, SavedView, Session, SessionError,
};
use crate::app::persist::session_file;
use resect_core::deployment::Finding;
use resect_core::deployment::names::told_apart;
use resect_io::source::Source;

/// What belongs to the session beside what is open.
#[derive(Default)]
pub struct SessionState {
    /// The session's file, once it was saved or opened.
    pub path: Option<PathBuf>,
    /// What is in that file.
    pub(super) kept: Option<Session>,
    /// Whether what is open was restored after a crash, and the user has not decided about it.
    pub recovered: bool,
    /// Deployments that could not be opened; they stay in the session, whose next save keeps them.
    pub missing: Vec<Missing>,
    /// Opened before, in this window or another; the newest first.
    pub recent: Vec<Recent>,
    /// What was open before, in this window or another; none of windows that keep nothing.
    pub last: Option<LastSession>,
    /// Deployments yet to be opened, in order.
    pub(super) waiting: VecDeque<Waiting>,
    /// The one that is being opened.
    pub(super) restoring: Option<Waiting>,
    /// Id of the deployment that stays shown while others are opened.
    pub(super) shown: Option<u64>,
    /// What the session that was just opened took the place of, until the window has it kept.
    replaced: Option<Session>,
    /// How many sessions were opened; tells the present one from those before it.
    opened: u64,
    /// Requests that read a session's file.
    reading: Vec<u64>,
    /// Requests that write a session, and which of those that were opened it is.
    writing: Vec<(u64, u64)>,
    pub(super) cache: Arc<HashCache>,
    /// What each open deployment was read from, by its id.
    pub(super) files: BTreeMap<u64, Files>,
}

/// A deployment of the session that could not be opened.
pub struct Missing {
    pub saved: SavedDeployment,
    pub why: String,
    /// The deployment's place among the session's deployments, from 0.
    pub(super) place: usize,
}

/// A deployment of the session that is yet to be opened.
pub(super) struct Waiting {
    pub saved: SavedDeployment,
    /// Whether it is the one to be shown.
    pub shown: bool,
    /// The deployment's place among the session's deployments, from 0.
    pub place: usize,
}

impl SessionState {
    /// Uses the hashes of files that were computed already.
    pub fn share(&mut self, cache: Arc<HashCache>) {
        self.cache = cache;
    }

    /// Whether a session is being read or written.
    pub(super) fn is_busy(&self) -> bool {
        !self.reading.is_empty() || !self.writing.is_empty()
    }

    /// A request has ended; gives which of the opened sessions it wrote, if it wrote one.
    pub(super) fn done(&mut self, number: u64) -> Option<u64> {
        self.reading.retain(|reading| *reading != number);
        let index = self.writing.iter().position(|(writing, _)| *writing == number)?;
        Some(self.writing.swap_remove(index).1)
    }

    /// The user chose what is shown: what is still being opened does not take its place.
    pub(super) fn keep_shown(&mut self, id: u64) {
        for waiting in self.restoring.iter_mut().chain(&mut self.waiting) {
            waiting.shown = false;
            self.shown = Some(id);
        }
    }

    /// The names of what was opened before, which tell them apart.
    pub fn recent_names(&self) -> Vec<String> {
        title_of_each(self.recent.iter().map(|recent| &recent.source))
    }

    /// The names of what could not be opened, which tell them apart.
    pub fn missing_names(&self) -> Vec<String> {
        title_of_each(self.missing.iter().map(|missing| &missing.saved.source))
    }

    /// A deployment was opened that can be opened again.
    pub(super) fn opened(&mut self, source: &Source) {
        remember(&mut self.recent, source);
    }
}

impl State {
    /// All that is open, still to be restored or missing, and how it is looked at. What the user has just asked to open
    /// is not part of it before it is read.
    pub fn session(&self) -> Session {
        let shown = self.active().map(|open| open.id);
        let mut active = None;
        let mut deployments = Vec::new();
        for open in self.open.iter().filter(|open| !open.placeholder) {
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
        let pin = |pin: &crate::app::model::Pin| SavedPin {
            name: pin.name.clone(),
            shown: pin.shown,
            result: (*pin.summary).clone(),
        };
        Session {
            deployments,
            active: active.unwrap_or(0),
            view: SavedView {
                colouring: self.colouring,
                units: self.units,
                plotted: self.plotted,
                visibility: self.visibility,
                scene: self.scene,
                study: self.studies.options,
                way: self.way_plots,
            },
            layout: Some(self.layout.describe()),
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
        self.visibility = session.view.visibility;
        self.colouring = session.view.colouring;
        self.scene = session.view.scene;
        self.units = session.view.units;
        self.plotted = session.view.plotted;
        self.studies.options = session.view.study.within_bounds();
        self.way_plots = session.view.way;
        if let Some(plan) = session.plan {
            self.planning.set(*plan);
        }
        if let Some(description) = &session.layout {
            let (layout, findings) = Layout::of_description(description);
            self.layout = layout;
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
        let ids: Vec<u64> = self.open.iter().map(|open| open.id).collect();
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

/// The names of deployments that are not open, which tell them apart.
pub(super) fn title_of_each<'a>(sources: impl Iterator<Item = &'a Source>) -> Vec<String> {
    told_apart(&sources.map(|source| (source.title(), source.path())).collect::<Vec<_>>())
}

#[cfg(test)]
#[path = "sessions_tests.rs"]
mod tests;
