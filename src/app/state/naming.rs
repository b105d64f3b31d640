//! Unique names of the open deployments, and the window's title.

use super::State;
use super::session_state::title_of_each;
use crate::app::persist::session::SavedDeployment;
use resect_core::analysis::Settings;
use resect_core::deployment::names::told_apart;
use resect_io::source::Source;

impl State {
    /// Returns unique names of the open deployments.
    pub fn names(&self) -> Vec<String> {
        let named = self.deployments.open.iter().map(|open| {
            let name = &open.deployment.name;
            // The replayed deployment may be open as well.
            let name = match self.live.id == Some(open.id) {
                true => format!("{name} (live)"),
                false => name.clone(),
            };
            (name, open.source.as_ref().and_then(Source::path))
        });
        told_apart(&named.collect::<Vec<_>>())
    }

    /// Returns the unique name of an open deployment, by its id.
    pub fn name_of(&self, id: u64) -> Option<String> {
        let index = self.deployments.index_of(id)?;
        self.names().into_iter().nth(index)
    }

    /// Returns unique names of the deployments that are being read.
    pub fn opening_names(&self) -> Vec<String> {
        title_of_each(self.deployments.opening.iter().map(|opening| &opening.source))
    }

    /// Returns true if the window must ask before it closes.
    pub fn must_ask_before_closing(&self) -> bool {
        self.workspace.asks_before_closing && !self.workspace.closes && self.is_unsaved()
    }

    /// Returns true if closing would lose work: settings, pins or drives that no session's file contains.
    pub(super) fn is_unsaved(&self) -> bool {
        let now = self.session();
        match &self.session.kept {
            Some(kept) => !kept.is_same_work(&now),
            // Data that the program opens by itself can be reopened at any time.
            None => {
                let is_tuned = |saved: &SavedDeployment| {
                    saved.settings != Settings::default() || !saved.estimates.is_empty()
                };
                !now.pins.is_empty() || now.deployments.iter().any(is_tuned)
            }
        }
    }

    /// Returns the window's title: active deployment, session, and if the session was changed since it was saved.
    pub fn title(&self) -> String {
        let now = self.session();
        let path = self.session.path.as_ref();
        let file = path.and_then(|path| Some(path.file_name()?.to_string_lossy().into_owned()));
        let saved = self.session.kept.as_ref().is_some_and(|kept| kept.is_same_work(&now));
        let session = match file {
            Some(file) if saved => Some(file),
            Some(file) => Some(format!("{file} (changed since it was saved)")),
            None if now.is_empty() => None,
            None => Some("session not saved".to_owned()),
        };
        let name = self.active().and_then(|open| self.name_of(open.id));
        let parts = [name, session, Some("resect".to_owned())];
        parts.into_iter().flatten().collect::<Vec<_>>().join(" – ")
    }
}
