//! The session beside the open deployments: its file, and the deployments that are still to be opened or are missing.

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
    pub(super) replaced: Option<Session>,
    /// How many sessions were opened; tells the present one from those before it.
    pub(super) opened: u64,
    /// Requests that read a session's file.
    pub(super) reading: Vec<u64>,
    /// Requests that write a session, and which of those that were opened it is.
    pub(super) writing: Vec<(u64, u64)>,
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

/// The names of deployments that are not open, which tell them apart.
pub(super) fn title_of_each<'a>(sources: impl Iterator<Item = &'a Source>) -> Vec<String> {
    told_apart(&sources.map(|source| (source.title(), source.path())).collect::<Vec<_>>())
}
