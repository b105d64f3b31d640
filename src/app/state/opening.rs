//! Opening of deployments: each in the background with its progress, so that a large one blocks nothing.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::State;
use super::corrections::use_rig;
use super::deployments::{Opening, Then};
use crate::app::model::undo::Moment;
use crate::app::model::{OpenDeployment, Pane};
use crate::app::persist::hashes::HashCache;
use crate::app::persist::session::{Files, SavedDeployment};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::error::OpenError;
use resect_io::estimate_file::is_bag;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_io::what_is::{Sorted, sort};

impl State {
    /// Adds a deployment and starts its calibration; `source` is where it can be read again.
    pub fn add(&mut self, deployment: Arc<Deployment>, source: Option<Source>) {
        self.add_with(deployment, source, self.deployments.start_settings);
    }

    pub(super) fn add_with(
        &mut self,
        deployment: Arc<Deployment>,
        source: Option<Source>,
        settings: Settings,
    ) {
        let placeholders =
            self.deployments.open.iter().filter(|open| open.placeholder).map(|open| open.id);
        for id in placeholders.collect::<Vec<_>>() {
            self.close(id);
        }
        if let Some(source) = &source {
            self.session.opened(source);
        }
        self.deployments.newest_id += 1;
        self.session.files.insert(self.deployments.newest_id, Files::of(&deployment));
        self.deployments.open.push(OpenDeployment::new(
            self.deployments.newest_id,
            deployment,
            source,
            settings,
        ));
        let index = self.deployments.open.len() - 1;
        self.show(index);
        self.analyse(index);
        self.draw_pins();
    }

    /// Opens the sample that is shown until the user opens something.
    pub fn open_placeholder(&mut self, sample: Sample) {
        self.read(Source::sample(sample), Then::Placeholder);
    }

    /// Opens a source with the settings of the next deployment, or reads it again if it is open.
    pub(super) fn open_source(&mut self, source: Source) {
        let same = |open: &OpenDeployment| {
            !open.placeholder && open.source.as_ref().is_some_and(|own| own.place == source.place)
        };
        match self.deployments.open.iter().position(same) {
            // Reading again keeps its settings and its position.
            Some(index) => {
                self.show(index);
                let id = self.deployments.open[index].id;
                // Earlier extras and corrections of the user are kept.
                let mut extras =
                    self.wanted_source(id).map_or_else(Extras::default, |own| own.extras.clone());
                extras.add(source.extras);
                self.give_up_replacing(id);
                self.replace_by(id, Source { place: source.place, extras }, true);
            }
            None => self.read(source, Then::Show(self.deployments.start_settings)),
        }
    }

    /// Reads an open deployment again and replaces it.
    pub(super) fn replace_by(&mut self, id: u64, source: Source, step: bool) {
        self.read(source, Then::Replace { id, step });
    }

    /// Cancels the running readings that would replace a deployment; returns true if there were any.
    pub(super) fn give_up_replacing(&mut self, id: u64) -> bool {
        let before = self.deployments.opening.len();
        for opening in
            self.deployments.opening.iter().filter(|opening| opening.replaces() == Some(id))
        {
            opening.progress.cancel();
        }
        self.deployments.opening.retain(|opening| opening.replaces() != Some(id));
        self.deployments.opening.len() < before
    }

    pub(super) fn read(&mut self, source: Source, then: Then) {
        let progress = Arc::new(Progress::default());
        let (from, shared) = (source.clone(), Arc::clone(&progress));
        let number = self.jobs.start(move || from.open(&shared).map(Arc::new), Self::take_opened);
        let since = Instant::now();
        self.deployments.opening.push(Opening { number, since, progress, source, then });
    }

    /// Opens a deployment of a session, and determines which of its files have changed since.
    pub(super) fn read_again(&mut self, saved: &SavedDeployment, cache: Arc<HashCache>) {
        let progress = Arc::new(Progress::default());
        let (again, shared) = (saved.clone(), Arc::clone(&progress));
        let number =
            self.jobs.start(move || again.open(&cache, &shared).map(Arc::new), Self::take_opened);
        let (source, since, then) = (saved.source.clone(), Instant::now(), Then::Restore);
        self.deployments.opening.push(Opening { number, since, progress, source, then });
    }

    /// Cancels the restoring of a session.
    pub(super) fn give_up_restoring(&mut self) {
        let (restoring, others) = std::mem::take(&mut self.deployments.opening)
            .into_iter()
            .partition::<Vec<_>, _>(|opening| opening.then == Then::Restore);
        restoring.iter().for_each(|opening| opening.progress.cancel());
        self.deployments.opening = others;
        self.ask_nothing_of_restoring();
    }

    /// Ends a reading that failed because of a bug.
    pub(super) fn opening_failed(&mut self, number: u64) {
        let failed = |opening: &Opening| opening.number == number;
        let restoring = |opening: &Opening| failed(opening) && opening.then == Then::Restore;
        let was_restoring = self.deployments.opening.iter().any(restoring);
        self.deployments.opening.retain(|opening| !failed(opening));
        if was_restoring {
            self.not_restored("a bug in resect stopped the reading");
        }
    }

    pub(super) fn take_opened(&mut self, number: u64, result: Result<Arc<Deployment>, OpenError>) {
        let Some(index) =
            self.deployments.opening.iter().position(|opening| opening.number == number)
        else {
            return;
        };
        let Opening { source, then, .. } = self.deployments.opening.remove(index);
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
                // A bag has tracks, or the poses of another system.
                match source.path().filter(|path| is_bag(path).unwrap_or_default()) {
                    Some(path) if matches!(then, Then::Show(_)) => {
                        self.read_bag_of_estimates(path.to_owned(), error);
                    }
                    _ => self.toasts.not_opened(&source.place, &error.to_string()),
                }
                return;
            }
        };
        self.toasts.settled(&source.place);
        match then {
            Then::Show(settings) => {
                self.workspace.leave_evaluation();
                self.add_with(deployment, Some(source), settings);
                // The verdict is what the user opened it for.
                self.workspace.layout.bring_forward(Pane::Result);
                self.session.keep_shown(self.deployments.newest_id);
                let estimates = std::mem::take(&mut self.deployments.estimates_to_come);
                if !estimates.is_empty() {
                    self.add_estimates(estimates);
                }
                self.tell_of_reading(self.deployments.active);
            }
            // The sample is superseded by what the user opened in the meantime.
            Then::Placeholder if !self.deployments.open.is_empty() => {}
            Then::Placeholder => {
                self.add(deployment, Some(source));
                self.deployments.open[self.deployments.active].placeholder = true;
            }
            Then::Replace { id, step } => self.replace(id, deployment, source, step),
            Then::Restore => self.restored(deployment),
        }
    }

    fn replace(&mut self, id: u64, deployment: Arc<Deployment>, source: Source, step: bool) {
        let Some(index) = self.deployments.index_of(id) else { return };
        let after = source.extras.clone();
        let before =
            self.deployments.open[index].source.as_ref().map(|source| source.extras.clone());
        self.session.files.insert(id, Files::of(&deployment));
        self.deployments.open[index].replace(deployment, source);
        if let Some(before) = before.filter(|_| step) {
            self.record_extras(id, before, after);
        }
        // Cached results of the old data are not valid for the new.
        self.analyser.forget(id);
        self.analyse(index);
        self.tell_of_reading(index);
    }

    /// Shows the readers' findings that were not shown yet.
    pub(super) fn tell_of_reading(&mut self, index: usize) {
        let Some(name) = self.names().into_iter().nth(index) else { return };
        let open = &mut self.deployments.open[index];
        let findings = &open.deployment.findings;
        self.toasts.findings((open.id, &name), findings, &mut open.told);
    }

    /// Determines the kinds of paths in the background, as a folder may be on a slow disk.
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
        self.path_requests.push(number);
    }

    /// Opens dropped or chosen files: deployments with their extras, or else extras for the active one.
    pub(super) fn take_sorted(&mut self, number: u64, sorted: Sorted) {
        self.path_requests.retain(|looking| *looking != number);
        let Sorted { deployments, mut extras, folders, sessions, settings, mut estimates, unknown } =
            sorted;
        for line in unknown {
            self.toasts.error(&line);
        }
        // Without a deployment, a GNSS solution is the ground truth of the trajectories, or one of them.
        let has_readings =
            |open: &OpenDeployment| !open.placeholder && open.deployment.ground_truth.is_none();
        let is_evaluation =
            self.active().is_some_and(|open| open.deployment.ground_truth.is_some());
        let is_for_readings = !deployments.is_empty() || self.active().is_some_and(has_readings);
        if !is_for_readings && (is_evaluation || !estimates.is_empty()) {
            estimates.append(&mut extras.gnss);
        }
        if !estimates.is_empty() {
            if deployments.is_empty() {
                self.add_estimates(estimates);
            } else {
                self.deployments.estimates_to_come = estimates;
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
                Ok(settings) => self.change_active(settings, Moment::NEVER),
                Err(line) => self.toasts.error(&line),
            }
        }
    }

    /// Reads a deployment again with further files, including those of readings that are still running.
    pub(super) fn add_files(&mut self, id: u64, added: Extras) {
        let mut extras =
            self.wanted_source(id).map_or_else(Extras::default, |source| source.extras.clone());
        if let Some(rig) = &added.rig {
            use_rig(&mut extras, rig.clone());
        }
        extras.add(added);
        self.read_with(id, extras, true);
    }

    /// Cancels the reading of a deployment, by the number of its request.
    pub(super) fn cancel_opening(&mut self, number: u64) {
        if let Some(opening) =
            self.deployments.opening.iter().find(|opening| opening.number == number)
        {
            opening.progress.cancel();
        }
    }
}

/// Reads and checks settings as `--config` does.
fn read_settings(path: &Path) -> Result<Settings, String> {
    let settings = resect_io::settings_file::read(path).map_err(|error| error.to_string())?;
    settings.check().map_err(|what| format!("{}: {what}", path.display()))?;
    Ok(settings)
}
