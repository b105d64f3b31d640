//! The session: its file, and the deployments that are not opened yet or missing.

use std::collections::{BTreeMap, VecDeque};
use std::path::PathBuf;
use std::sync::Arc;

use crate::app::persist::hashes::HashCache;
use crate::app::persist::last::LastSession;
use crate::app::persist::preferences::{Recent, remember};
use crate::app::persist::session::{Files, SavedDeployment, Session};
use resect_core::deployment::names::told_apart;
use resect_io::source::Source;

#[derive(Default)]
pub struct SessionState {
    /// The session's file; `None` until it is saved or opened.
    pub path: Option<PathBuf>,
    /// Content of that file.
    pub(super) kept: Option<Session>,
    /// True if the open deployments were restored after a crash, and the user has not decided about them.
    pub recovered: bool,
    /// Deployments that could not be opened; the next save keeps them.
    pub missing: Vec<Missing>,
    /// Deployments opened earlier, in this window or another; the newest first.
    pub recent: Vec<Recent>,
    /// The previous session, of this window or another; `None` for windows that save nothing.
    pub last: Option<LastSession>,
    /// Deployments still to be opened, in order.
    pub(super) waiting: VecDeque<Waiting>,
    /// The deployment that is being opened.
    pub(super) restoring: Option<Waiting>,
    /// Id of the deployment that stays active while others are opened.
    pub(super) shown: Option<u64>,
    /// The session that the present one replaced, until it is saved.
    pub(super) replaced: Option<Session>,
    /// Number of opened sessions; identifies the present one.
    pub(super) opened: u64,
    /// Requests that read a session's file.
    pub(super) reading: Vec<u64>,
    /// Requests that write a session, each with the number of that session.
    pub(super) writing: Vec<(u64, u64)>,
    /// Deployments that the user closed, the newest last.
    pub(super) closed: Vec<SavedDeployment>,
    pub(super) cache: Arc<HashCache>,
    /// Files of each open deployment, by its id.
    pub(super) files: BTreeMap<u64, Files>,
}

/// A deployment of the session that could not be opened.
pub struct Missing {
    pub saved: SavedDeployment,
    pub why: String,
    /// Index in the session's deployments, from 0.
    pub(super) place: usize,
}

/// A deployment of the session that is yet to be opened.
pub(super) struct Waiting {
    pub saved: SavedDeployment,
    /// True if it becomes the active one.
    pub shown: bool,
    /// Index in the session's deployments, from 0.
    pub place: usize,
}

impl SessionState {
    /// Shares a cache of file hashes.
    pub fn share(&mut self, cache: Arc<HashCache>) {
        self.cache = cache;
    }

    /// Returns true while a session is read or written.
    pub(super) fn is_busy(&self) -> bool {
        !self.reading.is_empty() || !self.writing.is_empty()
    }

    /// Ends a request; returns the number of the session that it wrote, if it wrote one.
    pub(super) fn done(&mut self, number: u64) -> Option<u64> {
        self.reading.retain(|reading| *reading != number);
        let index = self.writing.iter().position(|(writing, _)| *writing == number)?;
        Some(self.writing.swap_remove(index).1)
    }

    /// Keeps the deployment that the user selected active while others are opened.
    pub(super) fn keep_shown(&mut self, id: u64) {
        for waiting in self.restoring.iter_mut().chain(&mut self.waiting) {
            waiting.shown = false;
            self.shown = Some(id);
        }
    }

    /// Returns unique names of the deployments opened earlier.
    pub fn recent_names(&self) -> Vec<String> {
        title_of_each(self.recent.iter().map(|recent| &recent.source))
    }

    /// Returns unique names of the deployments that could not be opened.
    pub fn missing_names(&self) -> Vec<String> {
        title_of_each(self.missing.iter().map(|missing| &missing.saved.source))
    }

    /// Returns the name of the deployment that was closed last.
    pub fn last_closed(&self) -> Option<String> {
        self.closed.last().map(|saved| saved.source.title())
    }

    /// Adds a deployment to those opened earlier.
    pub(super) fn opened(&mut self, source: &Source) {
        remember(&mut self.recent, source);
    }
}

/// Returns unique names of deployments that are not open.
pub(super) fn title_of_each<'a>(sources: impl Iterator<Item = &'a Source>) -> Vec<String> {
    told_apart(&sources.map(|source| (source.title(), source.path())).collect::<Vec<_>>())
}
