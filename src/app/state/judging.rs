//! Computations on results in the background: the vehicle's trajectory, those of other runs in its frame, and the evaluation
//! of estimated trajectories.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::PathBuf;
use std::sync::Arc;

use super::State;
use crate::app::file_dialog::{Question, Wanted};
use crate::app::model::judging::change_in_words;
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{Added, JudgingCommand, OpenDeployment, Pane, SavedEstimate};
use crate::app::prepared::beside::RunBeside;
use crate::app::prepared::way::Way;
use resect_io::error::OpenError;
use resect_io::estimate_file;
use resect_io::source::Place;
use resect_tools::estimates::{
    EstimatedTrajectory, EstimatesJudgement, GroundTruth, TruthReason, judge,
};
use resect_tools::extrinsics::extrinsics_with_truth;

impl State {
    pub(super) fn handle_judging(&mut self, command: JudgingCommand, moment: Moment) {
        match command {
            JudgingCommand::Add(paths) => self.add_estimates(paths),
            JudgingCommand::AddDialog => self.add_estimate_dialog(),
            JudgingCommand::Set(added) => self.judge(added, moment),
            JudgingCommand::ReadGroundTruth(file) => self.read_ground_truth(file),
            JudgingCommand::ShowExtrinsics(shows) => {
                if let Some(open) = self.deployments.active_mut() {
                    open.judging.shows_extrinsics = shows;
                }
            }
            JudgingCommand::UseAsGroundTruth(colour) => self.use_as_ground_truth(colour),
        }
    }

    /// Starts missing computations for visible panes; called in every frame.
    pub(super) fn make_what_is_looked_at(&mut self) {
        let shows_scene = self.workspace.layout.place(Pane::Scene).is_some();
        let shows_tube = self.scene.visibility.tube && shows_scene;
        let shows_way = shows_tube || self.workspace.layout.place(Pane::Channels).is_some();
        if self.scene.visibility.runs_beside && shows_scene {
            self.make_beside();
        }
        let Some(open) = self.deployments.active_mut().filter(|open| open.analysing.is_none())
        else {
            return;
        };
        let Some(analysis) = open.analysis.clone() else { return };
        let (id, of) = (open.id, (open.analysis_run, 0));
        // The scene shows the uncertainty of the pose at the cursor, but not while a live deployment grows, as its next
        // result comes too soon.
        let is_motion = analysis.answer.as_ref().is_ok_and(|a| a.calibration.joint().is_some());
        let grows = self.live.id == Some(open.id) && self.live.is_running();
        let shows_pose = shows_scene && is_motion && !grows && open.timeline.cursor_s.is_some();
        if (shows_way || shows_pose) && open.way.is_wanted(of) {
            let (deployment, analysis) = (Arc::clone(&open.deployment), Arc::clone(&analysis));
            let number = self.jobs.start(
                move || Way::of(&deployment, &analysis),
                move |state: &mut Self, number, way| {
                    state.with_open(id, |open| open.way.take(number, way));
                },
            );
            open.way.start(number, of);
        }
        let of = (open.analysis_run, open.judging.version);
        let any = !open.judging.added.is_empty()
            && (analysis.answer.is_ok() || !GroundTruth::needs_answer(&open.deployment));
        if any && open.judging.judgement.is_wanted(of) {
            let deployment = Arc::clone(&open.deployment);
            let added = open.judging.added.clone();
            let number = self.jobs.start(
                move || {
                    let own =
                        |one: &Added| (EstimatedTrajectory::clone(&one.estimate), one.options);
                    let truth = GroundTruth::of(&deployment, &analysis, None);
                    judge(&truth, added.iter().map(own).collect())
                },
                move |state: &mut Self, number, judgement: EstimatesJudgement| {
                    state.with_open(id, |open| open.judging.judgement.take(number, judgement));
                },
            );
            open.judging.judgement.start(number, of);
        }
        self.make_extrinsics();
    }

    /// Starts the extrinsic calibrations against a ground truth that is a trajectory, if they are shown.
    fn make_extrinsics(&mut self) {
        let Some(open) = self.deployments.active_mut() else { return };
        let (id, of) = (open.id, (open.analysis_run, open.judging.version));
        let Some(truth) = open.deployment.ground_truth.clone() else { return };
        let judging = &mut open.judging;
        if !judging.shows_extrinsics
            || judging.added.is_empty()
            || !judging.extrinsics.is_wanted(of)
        {
            return;
        }
        let added = judging.added.clone();
        let number = self.jobs.start(
            move || {
                let with = |one: &Added| extrinsics_with_truth(&truth, &one.estimate, &one.options);
                added.iter().map(with).collect::<Vec<_>>()
            },
            move |state: &mut Self, number, extrinsics| {
                state.with_open(id, |open| open.judging.extrinsics.take(number, extrinsics));
            },
        );
        judging.extrinsics.start(number, of);
    }

    /// Starts to transform the other open runs to the frame of the active one, once all of them have results.
    fn make_beside(&mut self) {
        if self.deployments.open.iter().any(|open| open.analysing.is_some()) {
            return;
        }
        let active = self.deployments.active;
        let others: Vec<_> = (self.deployments.open.iter().enumerate())
            .filter(|(index, _)| *index != active)
            .filter_map(|(_, open)| {
                let name = self.name_of(open.id)?;
                Some((
                    name,
                    Arc::clone(&open.deployment),
                    open.analysis.clone()?,
                    open.analysis_run,
                ))
            })
            .collect();
        let Some(open) = self.deployments.open.get_mut(active) else { return };
        let Some(Ok(answer)) = open.analysis.as_ref().map(|analysis| analysis.answer.clone())
        else {
            return;
        };
        let mut hasher = DefaultHasher::new();
        for (name, _, _, run) in &others {
            (name, run).hash(&mut hasher);
        }
        let of = (open.analysis_run, hasher.finish());
        if !open.beside.is_wanted(of) {
            return;
        }
        let (id, deployment) = (open.id, Arc::clone(&open.deployment));
        let number = self.jobs.start(
            move || {
                let own = (&*deployment, &*answer);
                let beside = |(name, other, analysis, _): (String, Arc<_>, Arc<_>, u64)| {
                    RunBeside::of(own, name, (&other, &analysis))
                };
                others.into_iter().map(beside).collect::<Vec<_>>()
            },
            move |state: &mut Self, number, runs| {
                state.with_open(id, |open| open.beside.take(number, runs));
            },
        );
        self.deployments.open[active].beside.start(number, of);
    }

    pub(super) fn with_open(&mut self, id: u64, change: impl FnOnce(&mut OpenDeployment)) {
        if let Some(open) = self.deployments.get_mut(id) {
            change(open);
        }
    }

    /// Reads trajectories in the background and adds them to the active deployment. Without one they are evaluated against each other.
    pub(super) fn add_estimates(&mut self, paths: Vec<PathBuf>) {
        match self.active().map(|open| open.id) {
            Some(id) => self.read_estimates(id, paths),
            None => self.read_evaluation(paths),
        }
    }

    /// Reads trajectories and adds them to an open deployment as an undoable step.
    fn read_estimates(&mut self, id: u64, paths: Vec<PathBuf>) {
        self.start_reading(paths, move |state, read, _| state.take_estimates(id, read));
    }

    /// Reads a bag without readings of stations as trajectories; if it has none either, shows why it is no deployment.
    pub(super) fn read_bag_of_estimates(&mut self, path: PathBuf, why: OpenError) {
        let bag = path.clone();
        let number = self.jobs.start(
            move || estimate_file::read(&bag).ok(),
            move |state: &mut Self, number, read| {
                state.path_requests.retain(|looking| *looking != number);
                let active = state.active().map(|open| open.id);
                match (read, active) {
                    (None, _) => state.toasts.not_opened(&Place::Path(path), &why.to_string()),
                    (Some(read), Some(id)) => {
                        state.take_estimates(id, read.into_iter().map(Arc::new).collect());
                    }
                    (Some(read), None) => {
                        state.choose_truth(read.into_iter().map(Arc::new).collect());
                    }
                }
            },
        );
        self.path_requests.push(number);
    }

    fn take_estimates(&mut self, id: u64, read: Vec<Arc<EstimatedTrajectory>>) {
        let Some(open) = self.deployments.get(id) else { return };
        if read.is_empty() {
            return;
        }
        // The ground truth of a trajectory alone is chosen once there are others.
        if open.judging.truth_reason == Some(TruthReason::Alone) {
            self.choose_truth_again(id, &read);
            return;
        }
        if open.placeholder && !Self::are_of_sample(open, &read) {
            self.choose_truth(read);
            return;
        }
        let added = open.judging.with(read);
        self.time.plots = self.time.plots.only_errors();
        self.workspace.layout.show(Pane::Channels);
        self.workspace.layout.show(Pane::Evaluation);
        self.judge_by(id, added, Moment::NEVER);
    }

    /// Reads the trajectories of a session without changing the panes; the session keeps those that could not be read.
    pub(super) fn read_saved_estimates(&mut self, id: u64, saved: Vec<SavedEstimate>) {
        let mut paths: Vec<PathBuf> = Vec::new();
        for one in &saved {
            if !paths.contains(&one.path) {
                paths.push(one.path.clone());
            }
        }
        self.start_reading(paths, move |state, read, missing| {
            state.with_open(id, |open| {
                let lost = saved.iter().filter(|one| missing.contains(&one.path)).cloned();
                open.judging.missing.extend(lost);
                open.judging.set(open.judging.with_saved(&read, &saved));
            });
        });
    }

    /// Reads trajectories in the background. `take` receives them and the unreadable paths, which are also reported.
    pub(super) fn start_reading(
        &mut self,
        paths: Vec<PathBuf>,
        take: impl FnOnce(&mut Self, Vec<Arc<EstimatedTrajectory>>, Vec<PathBuf>) + Send + 'static,
    ) {
        let number = self.jobs.start(
            move || {
                let read = paths.into_iter().map(|path| (estimate_file::read(&path), path));
                read.collect::<Vec<_>>()
            },
            move |state: &mut Self, number, found| {
                state.path_requests.retain(|looking| *looking != number);
                let (mut read, mut missing) = (Vec::new(), Vec::new());
                for (estimate, path) in found {
                    match estimate {
                        Ok(estimates) => read.extend(estimates.into_iter().map(Arc::new)),
                        Err(why) => {
                            state.toasts.error(&why.to_string());
                            missing.push(path);
                        }
                    }
                }
                take(state, read, missing);
            },
        );
        self.path_requests.push(number);
    }

    /// Replaces the trajectories of the active deployment.
    pub(super) fn judge(&mut self, added: Vec<Added>, moment: Moment) {
        if let Some(id) = self.active().map(|open| open.id) {
            self.judge_by(id, added, moment);
        }
    }

    pub(super) fn judge_by(&mut self, id: u64, added: Vec<Added>, moment: Moment) {
        let Some(open) = self.deployments.get_mut(id) else { return };
        if open.judging.added == added {
            return;
        }
        let words = change_in_words(&open.judging.added, &added);
        let both = Box::new([open.judging.added.clone(), added.clone()]);
        open.judging.set(added);
        // A deployment used for evaluation is no placeholder any more.
        open.placeholder = false;
        let what = Changed::Judged { both, words };
        self.deployments.undo.record(vec![Change { id, what }], moment);
    }

    pub(super) fn add_estimate_dialog(&mut self) {
        let Some(id) = self.active().map(|open| open.id) else { return };
        let title = "Choose a trajectory to evaluate (TUM, EuRoC, KITTI, CSV, bag)";
        let answer = self.ask(Question::new(title, Wanted::ToOpen { folder: false }));
        self.jobs.start_unnumbered(
            move || answer.wait(),
            move |state: &mut Self, path| state.read_estimates(id, vec![path]),
        );
    }
}
