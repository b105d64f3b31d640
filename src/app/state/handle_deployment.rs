//! Opening and closing deployments, changes of their settings and data, and undo.

use std::sync::Arc;
use std::time::Instant;

use super::State;
use super::corrections::{self, Extra};
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{Analysing, DeploymentCommand, Pane, Timeline};
use resect_core::analysis::Settings;
use resect_core::deployment::Deployment;
use resect_io::source::Source;

impl State {
    pub(super) fn handle_deployment(&mut self, command: DeploymentCommand, ctx: &egui::Context) {
        use DeploymentCommand as Command;
        let moment = Moment::now(ctx);
        match command {
            Command::OpenPaths(paths) => self.look_at(paths),
            Command::OpenSource(source) => self.open_source(source),
            Command::OpenSample(sample) => self.open_source(Source::sample(sample)),
            Command::CancelOpening(number) => self.cancel_opening(number),
            Command::OpenFolderDialog => self.open_folder_dialog(),
            Command::OpenFileDialog => self.open_file_dialog(),
            Command::Activate(id) => self.activate(id),
            Command::Close(id) => {
                self.keep_closed(id);
                self.close(id);
            }
            Command::ReopenClosed => self.reopen_closed(),
            Command::Set(settings) => self.change_active(settings, moment),
            Command::SetAll => {
                let ids: Vec<u64> = self.deployments.open.iter().map(|open| open.id).collect();
                self.change(&ids, *self.settings(), moment);
            }
            Command::CancelAnalysis(id) => self.cancel_analysis(id),
            Command::Undo => self.undo(),
            Command::Redo => {
                let step = self.deployments.undo.redo().cloned();
                self.go(step.map_or_else(Vec::new, |step| step.changes), 1);
            }
            Command::Correct(extras) => self.apply_corrections(extras),
            Command::ShowCorrections => {
                self.workspace.layout.show(Pane::Deployment);
                corrections::unfold(ctx);
            }
            Command::ChooseRigDialog => self.choose_extra_dialog(Extra::Rig),
            Command::AddControlPointsDialog => self.choose_extra_dialog(Extra::ControlPoints),
            Command::WriteDeploymentToml => self.propose_deployment_toml(),
        }
    }

    fn activate(&mut self, id: u64) {
        if let Some(index) = self.deployments.index_of(id) {
            self.show(index);
            self.session.keep_shown(id);
        }
    }

    fn undo(&mut self) {
        // Undo first cancels a change whose reading is still running.
        if self.take_back_pending() {
            return;
        }
        let step = self.deployments.undo.undo().cloned();
        self.go(step.map_or_else(Vec::new, |step| step.changes), 0);
    }

    /// Activates an open deployment. Stops the playback and clears the ruler, which belong to the previous one.
    pub(super) fn show(&mut self, index: usize) {
        self.deployments.active = index;
        self.time.playback.playing = false;
        self.scene.ruler.ends.clear();
    }

    /// Changes the settings of the active deployment; without one, those of the next.
    pub(super) fn change_active(&mut self, settings: Settings, moment: Moment) {
        match self.active().map(|open| open.id) {
            Some(id) => self.change(&[id], settings, moment),
            None => self.deployments.start_settings = settings,
        }
    }

    /// Changes the settings of deployments as one undoable step.
    pub(super) fn change(&mut self, ids: &[u64], settings: Settings, moment: Moment) {
        let changes: Vec<Change> = ids
            .iter()
            .filter_map(|&id| {
                let before = self.deployments.get(id)?.settings;
                let what = Changed::Settings([before, settings]);
                (before != settings).then_some(Change { id, what })
            })
            .collect();
        for change in &changes {
            self.set(change.id, settings);
        }
        self.deployments.undo.record(changes, moment);
    }

    /// Applies one side of a step's changes: 0 is before them, 1 is after.
    fn go(&mut self, changes: Vec<Change>, side: usize) {
        // Activates the changed deployment, so that the change is visible.
        let shown = self.active().map(|open| open.id);
        let first = changes.first().map(|change| change.id);
        let unseen = changes.iter().all(|change| Some(change.id) != shown);
        for change in changes {
            match change.what {
                Changed::Settings(both) => self.set(change.id, both[side]),
                Changed::Extras { both, .. } => {
                    self.read_with(change.id, both[side].clone(), false);
                }
                Changed::Judged { both, .. } => {
                    let [before, after] = *both;
                    let (from, to) = if side == 0 { (after, before) } else { (before, after) };
                    self.with_open(change.id, |open| {
                        open.judging.set(open.judging.after_step(&from, to));
                    });
                }
                Changed::Plan { both, .. } => self.planning.set(both[side].clone()),
            }
        }
        if let Some(id) = first.filter(|_| unseen)
            && let Some(index) = self.deployments.index_of(id)
        {
            self.show(index);
        }
    }

    fn set(&mut self, id: u64, settings: Settings) {
        let Some(index) = self.deployments.index_of(id) else { return };
        let open = &mut self.deployments.open[index];
        if open.settings != settings {
            open.settings = settings;
            open.placeholder = false;
            self.analyse(index);
        }
    }

    pub(super) fn close(&mut self, id: u64) {
        let Some(index) = self.deployments.index_of(id) else { return };
        self.deployments.open.remove(index);
        self.analyser.forget(id);
        self.session.files.remove(&id);
        self.deployments.undo.forget(id);
        self.toasts.closed(id);
        // The active deployment does not change; if it was closed, its neighbour becomes active.
        if index == self.deployments.active {
            self.show(index.min(self.deployments.open.len().saturating_sub(1)));
        } else if index < self.deployments.active {
            self.deployments.active -= 1;
        }
    }

    pub(super) fn with_timeline(&mut self, change: impl FnOnce(&mut Timeline, &Deployment)) {
        if let Some(open) = self.deployments.active_mut() {
            change(&mut open.timeline, &open.deployment);
        }
    }

    pub(super) fn analyse(&mut self, index: usize) {
        let Some(open) = self.deployments.open.get_mut(index) else { return };
        let number = self.jobs.next_number();
        self.analyser.analyse(number, open.id, Arc::clone(&open.deployment), open.settings);
        // The time of the first request counts until a result is shown, even if newer requests replace it.
        let awaited = open.analysing.filter(|analysing| !analysing.joint_follows);
        let since = awaited.map_or_else(Instant::now, |analysing| analysing.since);
        open.analysing = Some(Analysing { number, since, joint_follows: false });
    }
}
