//! The open deployments and those that are being read, and the steps that can be undone.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use crate::app::model::{OpenDeployment, UndoStack};
use resect_core::analysis::Settings;
use resect_core::progress::Progress;
use resect_io::source::Source;

#[derive(Default)]
pub struct Deployments {
    /// The open deployments, in the order they were opened.
    pub open: Vec<OpenDeployment>,
    /// Index of the open deployment that the panes show.
    pub(super) active: usize,
    pub(super) newest_id: u64,
    /// Settings of the next deployment that is opened.
    pub start_settings: Settings,
    /// Deployments that are being read.
    pub opening: Vec<Opening>,
    /// Trajectories that came with the deployment that is being opened.
    pub(super) estimates_to_come: Vec<PathBuf>,
    pub undo: UndoStack,
}

impl Deployments {
    /// The open deployment that the panes show.
    pub fn active(&self) -> Option<&OpenDeployment> {
        self.open.get(self.active)
    }

    pub(super) fn active_mut(&mut self) -> Option<&mut OpenDeployment> {
        self.open.get_mut(self.active)
    }

    /// The open deployment with this id.
    pub fn get(&self, id: u64) -> Option<&OpenDeployment> {
        self.open.iter().find(|open| open.id == id)
    }

    pub(super) fn get_mut(&mut self, id: u64) -> Option<&mut OpenDeployment> {
        self.open.iter_mut().find(|open| open.id == id)
    }

    /// Index of the open deployment with this id.
    pub(super) fn index_of(&self, id: u64) -> Option<usize> {
        self.open.iter().position(|open| open.id == id)
    }

    /// The settings of the active deployment, or those of the next one.
    pub fn settings(&self) -> &Settings {
        self.active().map_or(&self.start_settings, |open| &open.settings)
    }
}

/// A deployment that is being read.
pub struct Opening {
    pub number: u64,
    pub since: Instant,
    /// How much of it is read, in bytes.
    pub progress: Arc<Progress>,
    pub(super) source: Source,
    pub(super) then: Then,
}

impl Opening {
    /// Id of the deployment whose place it takes.
    pub(super) fn replaces(&self) -> Option<u64> {
        match self.then {
            Then::Replace { id, .. } => Some(id),
            _ => None,
        }
    }

    /// Whether it is a change of this deployment that can be undone once it is read.
    pub(super) fn is_step_of(&self, id: u64) -> bool {
        self.then == Then::Replace { id, step: true }
    }
}

/// What becomes of a deployment once it is read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Then {
    /// The deployment is shown, with these settings.
    Show(Settings),
    /// The deployment is shown, and gives way to the first that the user opens.
    Placeholder,
    /// The deployment takes the place of an open one, whose id this is: the same data, read with other extras.
    Replace {
        id: u64,
        /// Whether that is a step that can be undone.
        step: bool,
    },
    /// The deployment is shown as the session has it that is being restored.
    Restore,
}
