//! By which names the open deployments are told apart, and what the window's title says.

use super::State;
use super::session_state::title_of_each;
use crate::app::persist::session::SavedDeployment;
use resect_core::analysis::Settings;
use resect_core::deployment::names::told_apart;
use resect_io::source::Source;

impl State {
    /// The names of the open deployments, which tell them apart.
    pub fn names(&self) -> Vec<String> {
        let named = self.deployments.open.iter().map(|open| {
            let name = &open.deployment.name;
            // What is replayed may be open beside it.
            let name = match self.live.id == Some(open.id) {
                true => format!("{name} (live)"),
                false => name.clone(),
            };
            (name, open.source.as_ref().and_then(Source::path))
        });
        told_apart(&named.collect::<Vec<_>>())
    }

    /// The name of an open deployment among the others, by its id.
    pub fn name_of(&self, id: u64) -> Option<String> {
        let index = self.deployments.index_of(id)?;
        self.names().into_iter().nth(index)
    }

    /// The names of what is being read, which tell them apart.
    pub fn opening_names(&self) -> Vec<String> {
        title_of_each(self.deployments.opening.iter().map(|opening| &opening.source))
    }

    /// Whether anyone would miss what is open: settings, pins or drives that no session's file has.
    pub(super) fn is_unsaved(&self) -> bool {
        let now = self.session();
        match &self.session.kept {
            Some(kept) => !kept.is_same_work(&now),
            // As the program opens data by itself, it is opened again at any time.
            None => {
                let is_tuned = |saved: &SavedDeployment| {
                    saved.settings != Settings::default() || !saved.estimates.is_empty()
                };
                !now.pins.is_empty() || now.deployments.iter().any(is_tuned)
            }
        }
    }

    /// Which deployment is shown, in which session, and whether that is saved as it is.
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
