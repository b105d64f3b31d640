//! Trajectories without a deployment: the choice of the ground truth among them, and its change.

use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use crate::app::model::{Added, OpenDeployment};
use resect_io::error::OpenError;
use resect_io::evaluation_files::EvaluationFiles;
use resect_io::source::TrajectoryFile;
use resect_tools::estimates::{EstimatedTrajectory, Options, TruthReason, choose_truth};

impl State {
    /// Reads trajectories in the background, and evaluates them against the one that is the ground truth.
    pub(super) fn read_evaluation(&mut self, paths: Vec<PathBuf>) {
        self.start_reading(paths, |state, read, _| state.choose_truth(read));
    }

    /// Evaluates trajectories against the one that is the ground truth.
    pub(super) fn choose_truth(&mut self, read: Vec<Arc<EstimatedTrajectory>>) {
        let all = read.into_iter().map(Arc::unwrap_or_clone).collect();
        self.choose_in_background(move || EvaluationFiles::of(all), Self::evaluate_files);
    }

    /// Chooses the ground truth in the background, because its file may be read again.
    fn choose_in_background(
        &mut self,
        choose: impl FnOnce() -> Result<Option<EvaluationFiles>, OpenError> + Send + 'static,
        take: impl FnOnce(&mut Self, EvaluationFiles) + Send + 'static,
    ) {
        let number = self.jobs.start(choose, move |state: &mut Self, number, chosen| {
            state.path_requests.retain(|request| *request != number);
            match chosen {
                Ok(files) => {
                    if let Some(files) = files {
                        take(state, files);
                    }
                }
                Err(why) => state.toasts.error(&why.to_string()),
            }
        });
        self.path_requests.push(number);
    }

    /// Opens the ground truth, adds the other trajectories, and shows the panes of the evaluation.
    pub fn evaluate_files(&mut self, files: EvaluationFiles) {
        let EvaluationFiles { truth, source, estimates, reason } = files;
        self.add(truth, Some(source));
        if let Some(open) = self.deployments.active_mut() {
            open.judging.truth_reason = Some(reason);
            open.judging.set(open.judging.with(estimates.into_iter().map(Arc::new).collect()));
        }
        self.time.plots = self.time.plots.only_errors();
        self.workspace.show_evaluation();
    }

    /// Adds trajectories to the active deployment, and shows the panes of the evaluation; nothing without any.
    pub fn evaluate_estimates(&mut self, estimates: Vec<(Arc<EstimatedTrajectory>, Options)>) {
        if estimates.is_empty() {
            return;
        }
        let Some(open) = self.deployments.active_mut() else { return };
        let (estimates, options): (Vec<_>, Vec<_>) = estimates.into_iter().unzip();
        let mut added = open.judging.with(estimates);
        for (one, options) in added.iter_mut().zip(options) {
            one.options = options;
        }
        open.judging.set(added);
        open.placeholder = false;
        self.time.plots = self.time.plots.only_errors();
        self.workspace.show_evaluation();
    }

    /// Adds trajectories to one that was alone, and chooses the ground truth among all.
    pub(super) fn choose_truth_again(&mut self, id: u64, read: &[Arc<EstimatedTrajectory>]) {
        let Some(open) = self.deployments.get(id) else { return };
        let alone = open.deployment.ground_truth.iter().filter(|alone| {
            // A file that is read again replaces its earlier reading.
            !read.iter().any(|other| other.is_same(alone))
        });
        let all =
            alone.chain(read).map(|trajectory| EstimatedTrajectory::clone(trajectory)).collect();
        self.replace_evaluation(id, Vec::new(), move || EvaluationFiles::of(all));
    }

    /// Makes a trajectory of the active deployment the ground truth, and evaluates the others against it. An earlier ground truth that is a
    /// trajectory becomes one of them; a deployment with readings stays open.
    pub(super) fn use_as_ground_truth(&mut self, colour: usize) {
        let Some(open) = self.active() else { return };
        let Some(index) = open.judging.added.iter().position(|added| added.colour == colour) else {
            return;
        };
        let added = open.judging.added.clone();
        let mut all: Vec<EstimatedTrajectory> = added.iter().map(Added::under_full_name).collect();
        all.extend(open.deployment.ground_truth.iter().map(|truth| truth.as_ref().clone()));
        let id = open.id;
        self.replace_evaluation(id, added, move || {
            EvaluationFiles::with_truth(all, index, TruthReason::Chosen).map(Some)
        });
    }

    /// Reads the ground truth of the active deployment again, with other options of its file.
    pub(super) fn read_ground_truth(&mut self, file: TrajectoryFile) {
        let Some(open) = self.active() else { return };
        let (id, added) = (open.id, open.judging.added.clone());
        let all: Vec<EstimatedTrajectory> = added.iter().map(Added::under_full_name).collect();
        self.replace_evaluation(id, added, move || EvaluationFiles::with_file(file, all).map(Some));
    }

    /// Opens an evaluation in place of another one. Trajectories keep the options that they had there (`before`).
    fn replace_evaluation(
        &mut self,
        id: u64,
        before: Vec<Added>,
        choose: impl FnOnce() -> Result<Option<EvaluationFiles>, OpenError> + Send + 'static,
    ) {
        self.choose_in_background(choose, move |state, files| {
            let Some(open) = state.deployments.get_mut(id) else { return };
            match open.deployment.ground_truth {
                Some(_) => state.close(id),
                None => open.judging.set(Vec::new()),
            }
            state.evaluate_files(files);
            let Some(open) = state.deployments.active_mut() else { return };
            let mut added = open.judging.added.clone();
            for one in &mut added {
                if let Some(earlier) = before.iter().find(|it| it.estimate.is_same(&one.estimate)) {
                    (one.options, one.shown) = (earlier.options, earlier.shown);
                }
            }
            open.judging.set(added);
        });
    }

    /// Returns true if trajectories are to be evaluated against the built-in sample that is shown until the user opens something: they are of its
    /// time, and none of them is a ground truth.
    pub(super) fn are_of_sample(open: &OpenDeployment, read: &[Arc<EstimatedTrajectory>]) -> bool {
        let all: Vec<&EstimatedTrajectory> = read.iter().map(|trajectory| &**trajectory).collect();
        let is_undecided = choose_truth(&all)
            .is_none_or(|(_, reason)| matches!(reason, TruthReason::Alone | TruthReason::Last));
        let [from_s, to_s] = open.timeline.whole_s;
        let overlaps = |one: &&EstimatedTrajectory| {
            one.poses.iter().any(|pose| (from_s..=to_s).contains(&pose.time_s))
        };
        is_undecided && all.iter().any(overlaps)
    }
}
