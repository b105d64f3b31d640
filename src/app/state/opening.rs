//! Opening deployments: each beside the worker, so that a large one holds up nothing, and with its progress.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::State;
use super::put_right::use_rig;
use crate::app::model::OpenDeployment;
use crate::app::model::undo::Moment;
use crate::app::persist::hashes::HashCache;
use crate::app::persist::session::{Files, SavedDeployment};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_io::what_is::{Sorted, sort};

/// A deployment that is being read.
pub struct Opening {
    pub number: u64,
    pub since: Instant,
    /// How much of it is read, in bytes.
    pub progress: Arc<Progress>,
    pub(super) source: Source,
    then: Then,
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

impl State {
    /// Shows a deployment and calibrates it; `source` is where it can be read again.
    pub fn add(&mut self, deployment: Arc<Deployment>, source: Option<Source>) {
        self.add_with(deployment, source, self.start_settings);
    }

    pub(super) fn add_with(
        &mut self,
        deployment: Arc<Deployment>,
        source: Option<Source>,
        settings: Settings,
    ) {
        let placeholders = self.open.iter().filter(|open| open.placeholder).map(|open| open.id);
        for id in placeholders.collect::<Vec<_>>() {
            self.close(id);
        }
        if let Some(source) = &source {
            self.session.opened(source);
        }
        self.newest_id += 1;
        self.session.files.insert(self.newest_id, Files::of(&deployment));
        self.open.push(OpenDeployment::new(self.newest_id, deployment, source, settings));
        let index = self.open.len() - 1;
        self.show(index);
        self.analyse(index);
        self.draw_pins();
    }

    /// Opens the sample that is there until the user opens something.
    pub fn open_placeholder(&mut self, sample: Sample) {
        self.read(Source::sample(sample), Then::Placeholder);
    }

    /// Opens what is at a place, with the settings that the next deployment starts with.
    pub(super) fn open_source(&mut self, source: Source) {
        let same = |open: &OpenDeployment| {
            !open.placeholder && open.source.as_ref().is_some_and(|own| own.place == source.place)
        };
        match self.open.iter().position(same) {
            // Read again, it keeps its settings and its place.
            Some(index) => {
                self.show(index);
                let id = self.open[index].id;
                // What the user named and put right before still holds.
                let mut extras =
                    self.wanted_source(id).map_or_else(Extras::default, |own| own.extras.clone());
                extras.add(source.extras);
                self.give_up_replacing(id);
                self.replace_by(id, Source { place: source.place, extras }, true);
            }
            None => self.read(source, Then::Show(self.start_settings)),
        }
    }

    /// Reads an open deployment again, for its own place.
    pub(super) fn replace_by(&mut self, id: u64, source: Source, step: bool) {
        self.read(source, Then::Replace { id, step });
    }

    /// A newer reading of a deployment takes the place of one that is under way; tells whether there was one.
    pub(super) fn give_up_replacing(&mut self, id: u64) -> bool {
        let before = self.opening.len();
        for opening in self.opening.iter().filter(|opening| opening.replaces() == Some(id)) {
            opening.progress.cancel();
        }
        self.opening.retain(|opening| opening.replaces() != Some(id));
        self.opening.len() < before
    }

    pub(super) fn read(&mut self, source: Source, then: Then) {
        let progress = Arc::new(Progress::default());
        let (from, shared) = (source.clone(), Arc::clone(&progress));
        let number = self.jobs.start(move || from.open(&shared).map(Arc::new), Self::take_opened);
        let since = Instant::now();
        self.opening.push(Opening { number, since, progress, source, then });
    }

    /// Opens a deployment of a session, and finds out which of its files changed since.
    pub(super) fn read_again(&mut self, saved: &SavedDeployment, cache: Arc<HashCache>) {
        let progress = Arc::new(Progress::default());
        let (again, shared) = (saved.clone(), Arc::clone(&progress));
        let number =
            self.jobs.start(move || again.open(&cache, &shared).map(Arc::new), Self::take_opened);
        let (source, since, then) = (saved.source.clone(), Instant::now(), Then::Restore);
        self.opening.push(Opening { number, since, progress, source, then });
    }

    /// What a session has opened until now is no longer wanted.
    pub(super) fn give_up_restoring(&mut self) {
        let (restoring, others) = std::mem::take(&mut self.opening)
            .into_iter()
            .partition::<Vec<_>, _>(|opening| opening.then == Then::Restore);
        restoring.iter().for_each(|opening| opening.progress.cancel());
        self.opening = others;
        self.ask_nothing_of_restoring();
    }

    /// A bug stopped the reading.
    pub(super) fn opening_failed(&mut self, number: u64) {
        let failed = |opening: &Opening| opening.number == number;
        let restoring = |opening: &Opening| failed(opening) && opening.then == Then::Restore;
        let was_restoring = self.opening.iter().any(restoring);
        self.opening.retain(|opening| !failed(opening));
        if was_restoring {
            self.not_restored("a bug in resect stopped the reading");
        }
    }

    pub(super) fn take_opened(&mut self, number: u64, result: Result<Arc<Deployment>, OpenError>) {
        let Some(index) = self.opening.iter().position(|opening| opening.number == number) else {
            return;
        };
        let Opening { source, then, .. } = self.opening.remove(index);
        let deployment = match result {
            Ok(deployment) => deployment,
            Err(OpenError::Cancelled) if then == Then::Restore => {
                self.not_restored(&format!("{}: reading was cancelled", source.title()));
                return;
            }
            Err(OpenError::Question(question)) => {
                self.ask_and_read(*question, source, then);
                return;
            }
            Err(error) if then == Then::Restore => {
                self.not_restored(&error.to_string());
                return;
            }
            Err(OpenError::Cancelled) => return,
            Err(error) => {
                self.toasts.not_opened(&source.place, &error.to_string());
                return;
            }
        };
        self.toasts.settled(&source.place);
        match then {
            Then::Show(settings) => {
                self.add_with(deployment, Some(source), settings);
                self.session.keep_shown(self.newest_id);
                let estimates = std::mem::take(&mut self.estimates_to_come);
                if !estimates.is_empty() {
                    self.add_estimates(estimates);
                }
                self.tell_of_reading(self.active);
            }
            // What the user opened meanwhile has no need of it.
            Then::Placeholder if !self.open.is_empty() => {}
            Then::Placeholder => {
                self.add(deployment, Some(source));
                self.open[self.active].placeholder = true;
            }
            Then::Replace { id, step } => self.replace(id, deployment, source, step),
            Then::Restore => self.restored(deployment),
        }
    }

    fn replace(&mut self, id: u64, deployment: Arc<Deployment>, source: Source, step: bool) {
        let Some(index) = self.open.iter().position(|open| open.id == id) else { return };
        let after = source.extras.clone();
        let before = self.open[index].source.as_ref().map(|source| source.extras.clone());
        self.session.files.insert(id, Files::of(&deployment));
        self.open[index].replace(deployment, source);
        if let Some(before) = before.filter(|_| step) {
            self.record_extras(id, before, after);
        }
        // What is remembered of the old data must not answer for the new.
        self.analyser.forget(id);
        self.analyse(index);
        self.tell_of_reading(index);
    }

    /// What the readers noticed and the user was not told yet.
    pub(super) fn tell_of_reading(&mut self, index: usize) {
        let Some(name) = self.names().into_iter().nth(index) else { return };
        let open = &mut self.open[index];
        let findings = &open.deployment.findings;
        self.toasts.findings((open.id, &name), findings, &mut open.told);
    }

    /// Finds out what paths are, beside the worker: a folder may lie on a slow disk.
    pub(super) fn look_at(&mut self, paths: Vec<PathBuf>) {
        let number = self.jobs.start(
            move || sort(paths.iter().map(PathBuf::as_path)),
            |state: &mut Self, number, sorted| {
                if state.is_of_hovering(number) {
                    state.take_hovering(number, sorted);
                } else {
                    state.take_sorted(number, sorted);
                }
            },
        );
        self.looking.push(number);
    }

    /// Opens what the user dropped or chose: deployments with what came with them, else additions to the active one.
    pub(super) fn take_sorted(&mut self, number: u64, sorted: Sorted) {
        self.looking.retain(|looking| *looking != number);
        let Sorted { deployments, extras, folders, sessions, settings, estimates, unknown } =
            sorted;
        for line in unknown {
            self.toasts.error(&line);
        }
        if !estimates.is_empty() {
            if deployments.is_empty() {
                self.add_estimates(estimates);
            } else {
                self.estimates_to_come = estimates;
            }
        }
        if deployments.is_empty() && !extras.is_empty() {
            self.ask_what_for(extras, folders);
        } else {
            for path in deployments {
                self.open_source(Source::at(path).with(extras.clone()));
            }
        }
        if let Some(path) = sessions.into_iter().next_back() {
            self.open_session(path);
        }
        if let Some(path) = settings.last() {
            match read_settings(path) {
                Ok(settings) => {
                    self.change_active(settings, Moment::NEVER);
                }
                Err(line) => self.toasts.error(&line),
            }
        }
    }

    /// Reads a deployment again, with further files. Those that are still being added are not forgotten.
    pub(super) fn add_files(&mut self, id: u64, added: Extras) {
        let mut extras =
            self.wanted_source(id).map_or_else(Extras::default, |source| source.extras.clone());
        if let Some(rig) = &added.rig {
            use_rig(&mut extras, rig.clone());
        }
        extras.add(added);
        self.read_with(id, extras, true);
    }

    /// Stops reading a deployment, by its request's number.
    pub(super) fn cancel_opening(&mut self, number: u64) {
        if let Some(opening) = self.opening.iter().find(|opening| opening.number == number) {
            opening.progress.cancel();
        }
    }
}

/// Settings as `--config` reads them, or why not.
fn read_settings(path: &Path) -> Result<Settings, String> {
    let settings = resect_io::settings_file::read(path).map_err(|error| error.to_string())?;
    settings.check().map_err(|what| format!("{}: {what}", path.display()))?;
    Ok(settings)
}
