//! The open deployments, those that are being read, and the undo stack.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::app::model::{OpenDeployment, UndoStack};
use resect_core::analysis::Settings;
use resect_core::progress::Progress;
use resect_io::source::Source;

#[derive(Default)]
pub struct Deployments {
    /// The open deployments, in the order in which they were opened.
    pub open: Vec<OpenDeployment>,
    /// Index of the active deployment.
    pub(super) active: usize,
    pub(super) newest_id: u64,
    /// Settings of the next deployment that is opened.
    pub start_settings: Settings,
    /// Deployments that are being read.
    pub opening: Vec<Opening>,
    /// Estimated trajectories for the deployment that is being opened.
    pub(super) estimates_to_come: Vec<PathBuf>,
    pub undo: UndoStack,
}

impl Deployments {
    /// Returns the active deployment.
    pub fn active(&self) -> Option<&OpenDeployment> {
        self.open.get(self.active)
    }

    pub(super) fn active_mut(&mut self) -> Option<&mut OpenDeployment> {
        self.open.get_mut(self.active)
    }

    /// Returns the open deployment with this id.
    pub fn get(&self, id: u64) -> Option<&OpenDeployment> {
        self.open.iter().find(|open| open.id == id)
    }

    pub(super) fn get_mut(&mut self, id: u64) -> Option<&mut OpenDeployment> {
        self.open.iter_mut().find(|open| open.id == id)
    }

    /// Returns the index of the open deployment with this id.
    pub(super) fn index_of(&self, id: u64) -> Option<usize> {
        self.open.iter().position(|open| open.id == id)
    }

    /// Returns the settings of the active deployment, or those of the next one.
    pub fn settings(&self) -> &Settings {
        self.active().map_or(&self.start_settings, |open| &open.settings)
    }
}

/// A deployment that is being read.
pub struct Opening {
    pub number: u64,
    pub since: Instant,
    /// Progress of the reading (bytes).
    pub progress: Arc<Progress>,
    pub(super) source: Source,
    pub(super) then: Then,
}

impl Opening {
    /// Returns the id of the deployment that it replaces; `None` for a new one.
    pub(super) fn replaces(&self) -> Option<u64> {
        match self.then {
            Then::Replace { id, .. } => Some(id),
            _ => None,
        }
    }

    /// Returns true if it changes this deployment as an undoable step.
    pub(super) fn is_step_of(&self, id: u64) -> bool {
        self.then == Then::Replace { id, step: true }
    }
}

/// Use of a deployment once it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// Shows it with these settings.
    Show(Settings),
    /// Shows it until the user opens another one, which replaces it.
    Placeholder,
    /// Replaces the open deployment with this id by the same data, read with other extras.
    Replace {
        id: u64,
        /// True for an undoable step.
        step: bool,
    },
    /// Shows it as saved in the session that is being restored.
    Restore,
}
