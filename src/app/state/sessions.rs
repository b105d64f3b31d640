//! The window's state as a session, and a session as the window's state.

use std::collections::VecDeque;
use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use crate::app::layout::LayoutDescription;
use crate::app::open_deployment::OpenDeployment;
use crate::app::persist::hashes::HashCache;
use crate::app::persist::preferences::{Recent, remember};
use crate::app::persist::session::{
    self, EXTENSION, SavedDeployment, SavedPin, SavedView, Session, SessionError,
};
use crate::app::worker::Reply;
use crate::deployment::{Deployment, Finding, Source};

/// What belongs to the session beside what is open.
#[derive(Default)]
pub struct SessionState {
    /// Its file, once it was saved or opened.
    pub path: Option<PathBuf>,
    /// Deployments that could not be opened, and why. They stay in the session, whose next save keeps them.
    pub missing: Vec<(SavedDeployment, String)>,
    /// Opened before, in this window or another; the newest first.
    pub recent: Vec<Recent>,
    /// Those yet to be opened, in order, and which of them is to be shown.
    waiting: VecDeque<(SavedDeployment, bool)>,
    /// The one that is being opened.
    restoring: Option<(SavedDeployment, bool)>,
    /// Id of the deployment that was shown, once it is open.
    shown: Option<u64>,
    /// The layout of an opened session, until the window takes it.
    layout: Option<LayoutDescription>,
    cache: Arc<HashCache>,
}

impl SessionState {
    /// The layout of the session that was just opened, once.
    pub fn take_layout(&mut self) -> Option<LayoutDescription> {
        self.layout.take()
    }

    /// Uses the hashes of files that were computed already.
    pub fn share(&mut self, cache: Arc<HashCache>) {
        self.cache = cache;
    }

    /// A deployment was opened that can be opened again.
    pub(super) fn opened(&mut self, source: &Source) {
        remember(&mut self.recent, source);
    }
}

impl State {
    /// All that is open, being opened or missing, and how it is looked at.
    pub fn session(&self, layout: LayoutDescription) -> Session {
        let shown = self.active().map(|open| open.id);
        let mut active = None;
        let mut deployments = Vec::new();
        for open in self.open.iter().filter(|open| !open.placeholder) {
            let Some(source) = open.source.clone() else { continue };
            if Some(open.id) == shown {
                active = Some(deployments.len());
            }
            deployments.push(saved(open, source));
        }
        for (waiting, is_shown) in self.session.restoring.iter().chain(&self.session.waiting) {
            if *is_shown {
                active = Some(deployments.len());
            }
            deployments.push(waiting.clone());
        }
        deployments.extend(self.session.missing.iter().map(|(missing, _)| missing.clone()));
        let pin = |pin: &super::Pin| SavedPin {
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
                visibility: self.visibility,
            },
            layout: Some(layout),
            pins: self.results.pins.iter().map(pin).collect(),
        }
    }

    /// Opens a session's deployments one after the other, and sets what it has set.
    pub fn restore(&mut self, session: Session) {
        self.visibility = session.view.visibility;
        self.colouring = session.view.colouring;
        self.units = session.view.units;
        self.session.layout = session.layout;
        for saved in session.pins {
            let id = self.results.pin(Arc::new(saved.result), None);
            if let Some(pin) = self.results.pins.iter_mut().find(|pin| pin.id == id) {
                pin.name = saved.name;
                pin.shown = saved.shown;
            }
        }
        let deployments = session.deployments.into_iter().enumerate();
        self.session.waiting.extend(deployments.map(|(at, saved)| (saved, at == session.active)));
        self.restore_next();
    }

    /// Reads a session's file, which then takes the place of everything that is open.
    pub fn open_session(&mut self, path: PathBuf) {
        self.worker.beside(move || {
            let session =
                session::load(&path).map(|(session, findings)| (Box::new(session), findings));
            Some(Reply::SessionRead(path, session))
        });
    }

    pub(super) fn take_session(
        &mut self,
        path: PathBuf,
        result: Result<(Box<Session>, Vec<Finding>), SessionError>,
    ) {
        match result {
            Ok((session, findings)) => {
                let ids: Vec<u64> = self.open.iter().map(|open| open.id).collect();
                for id in ids {
                    self.close(id);
                }
                self.results.pins.clear();
                self.session.missing.clear();
                self.session.waiting.clear();
                self.session.restoring = None;
                self.give_up_restoring();
                self.session.path = Some(path);
                self.tell(&findings);
                self.restore(*session);
            }
            Err(error) => self.toasts.error(&error.to_string()),
        }
    }

    /// Saves to the session's file, or asks for one where there is none yet or another is wanted.
    pub fn save_session(&mut self, layout: LayoutDescription, ask: bool) {
        let session = self.session(layout);
        let cache = Arc::clone(&self.session.cache);
        let save = move |path: PathBuf| {
            let saved = session.save(&path, &cache).map_err(|error| error.to_string());
            Some(Reply::SessionSaved(path, saved))
        };
        match self.session.path.clone().filter(|_| !ask) {
            Some(path) => self.worker.beside(move || save(path)),
            None => {
                let answer = self.ask_where("Save the session", EXTENSION);
                self.worker.beside(move || save(answer.wait()?));
            }
        }
    }

    pub(super) fn take_session_saved(&mut self, path: PathBuf, result: Result<(), String>) {
        match result {
            Ok(()) => {
                self.toasts.done(format!("session saved to {}", path.display()));
                self.session.path = Some(path);
            }
            Err(line) => self.toasts.error(&line),
        }
    }

    /// The next deployment of the session that is being restored.
    pub(super) fn restore_next(&mut self) {
        if self.session.restoring.is_none()
            && let Some((saved, shown)) = self.session.waiting.pop_front()
        {
            let cache = Arc::clone(&self.session.cache);
            self.read_again(&saved, cache);
            self.session.restoring = Some((saved, shown));
        } else if self.session.waiting.is_empty() && self.session.restoring.is_none() {
            self.session.shown = None;
        }
    }

    /// A deployment of the session is open: back to where the user was in it.
    pub(super) fn restored(&mut self, deployment: Arc<Deployment>) {
        let Some((saved, shown)) = self.session.restoring.take() else { return };
        self.add_with(deployment, Some(saved.source), saved.settings);
        if let Some(open) = self.open.last_mut() {
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
        self.tell_of_reading(self.open.len() - 1);
        let shown = self.session.shown;
        if let Some(index) = self.open.iter().position(|open| Some(open.id) == shown) {
            self.active = index;
        }
        self.restore_next();
    }

    /// A deployment of the session cannot be opened; it stays in it.
    pub(super) fn not_restored(&mut self, why: &str) {
        let Some((saved, _)) = self.session.restoring.take() else { return };
        self.toasts.error(&format!("{why} (it stays in the session)"));
        self.session.missing.push((saved, why.to_owned()));
        self.restore_next();
    }

    /// Tries those that could not be opened once more.
    pub fn retry_missing(&mut self) {
        let missing = std::mem::take(&mut self.session.missing);
        self.session.waiting.extend(missing.into_iter().map(|(saved, _)| (saved, false)));
        self.restore_next();
    }

    /// Says what was found on the way, where that is anything.
    pub fn tell(&mut self, findings: &[Finding]) {
        for finding in findings {
            self.toasts.warning(&finding.message);
        }
    }
}

fn saved(open: &OpenDeployment, source: Source) -> SavedDeployment {
    let timeline = &open.timeline;
    SavedDeployment {
        source,
        settings: open.settings,
        cursor_s: timeline.cursor_s,
        window_s: (timeline.window_s != timeline.whole_s).then_some(timeline.window_s),
        selection_s: timeline.selection_s,
        files: open.files.clone(),
    }
}
