//! Changes of the plan, its files, and its prediction in the background.

use std::path::PathBuf;

use super::State;
use crate::app::file_dialog::{Question, Wanted};
use crate::app::layout::Layout;
use crate::app::model::undo::{Change, Changed, Moment};
use crate::app::model::{LayoutPreset, Pane, PlanCommand};
use resect_core::progress::Progress;
use resect_io::atomic;
use resect_io::plan_file;
use resect_tools::planning::{Plan, improvements, predict};

/// Id for the plan in the undo stack; no deployment has it.
const NO_DEPLOYMENT: u64 = 0;

impl State {
    pub(super) fn handle_plan(&mut self, command: PlanCommand, moment: Moment) {
        match command {
            PlanCommand::Set(plan, words) => self.set_plan(*plan, words, moment),
            PlanCommand::Select(handle) => self.planning.selected = handle,
            PlanCommand::OpenDialog => {
                let question = Question::new("Open a plan", Wanted::Saved);
                let answer = self.ask(question.kinds(&[("Plans (toml)", &["toml"])]));
                self.jobs.start_unnumbered(
                    move || answer.wait(),
                    |state: &mut Self, path| state.open_plan(path),
                );
            }
            PlanCommand::Open(path) => self.open_plan(path),
            PlanCommand::SaveDialog => self.save_plan(),
            PlanCommand::FromDeployment => {
                let Some((open, analysis)) = self.analysed() else {
                    self.toasts.error("there is no drive yet; open a deployment first");
                    return;
                };
                match Plan::from_analysis(&open.deployment, analysis) {
                    Ok(plan) => self.show_plan(plan, None, "plan from the drive"),
                    Err(why) => self.toasts.error(&why.to_string()),
                }
            }
            PlanCommand::FromPreset(preset) => {
                self.show_plan(Plan::from_preset(preset, 1), None, "plan from a preset");
            }
        }
    }

    fn set_plan(&mut self, plan: Plan, words: &'static str, moment: Moment) {
        if plan == self.planning.plan {
            return;
        }
        // An invalid plan is rejected, as a session would not load it either.
        if let Err((what, remedy)) = plan.check() {
            self.toasts.warning(&format!("the plan is unchanged: {what}; {remedy}"));
            return;
        }
        let both = Box::new([self.planning.plan.clone(), plan.clone()]);
        let what = Changed::Plan { both, words };
        self.deployments.undo.record(vec![Change { id: NO_DEPLOYMENT, what }], moment);
        self.planning.set(plan);
    }

    /// Shows another plan, in the layout for planning if the map is not visible.
    fn show_plan(&mut self, plan: Plan, path: Option<PathBuf>, words: &'static str) {
        self.set_plan(plan, words, Moment::NEVER);
        self.planning.path = path;
        if self.workspace.layout.place(Pane::PlanMap).is_none() {
            self.workspace.layout = Layout::from(LayoutPreset::Plan);
        }
    }

    fn open_plan(&mut self, path: PathBuf) {
        let number = self.jobs.start(
            move || (plan_file::read(&path), path),
            |state: &mut Self, number, (read, path)| {
                state.path_requests.retain(|looking| *looking != number);
                match read {
                    Ok(plan) => state.show_plan(plan, Some(path), "plan from a file"),
                    Err(why) => state.toasts.error(&why.to_string()),
                }
            },
        );
        self.path_requests.push(number);
    }

    fn save_plan(&mut self) {
        let planning = &self.planning;
        let name = match &planning.path {
            Some(path) => path.file_stem().map(|name| name.to_string_lossy().into_owned()),
            None => (!planning.plan.name.is_empty()).then(|| planning.plan.name.clone()),
        };
        let name = name.unwrap_or_else(|| "plan".to_owned());
        let answer = self.ask(Question::new_file("Save the plan (TOML)", &name, "toml"));
        let text = plan_file::text(&self.planning.plan);
        self.tell_when_done(move || {
            let path = answer.wait()?;
            let written = atomic::write(&path, text).map_err(|error| error.to_string());
            Some(written.map(|()| format!("{} written", path.display())))
        });
    }

    /// Starts missing predictions for visible panes; called in every frame.
    ///
    /// During a drag, each prediction starts when the last one is finished. The search for improvements takes longer, and
    /// waits until the button is released.
    pub(super) fn foresee(&mut self, hand_is_on: bool) {
        let shown = [Pane::PlanMap, Pane::Prediction]
            .map(|pane| self.workspace.layout.place(pane).is_some());
        if shown == [false; 2] {
            return;
        }
        let of = (self.planning.version, 0);
        if self.planning.foreseen.is_wanted(of) {
            let plan = self.planning.plan.clone();
            let number = self.jobs.start(
                move || predict(&plan),
                |state: &mut Self, number, found| state.planning.foreseen.take(number, found),
            );
            self.planning.foreseen.start(number, of);
        }
        let settled = self.planning.is_foreseen() && !hand_is_on;
        if settled && shown[1] && self.planning.better.is_wanted(of) {
            let plan = self.planning.plan.clone();
            let number = self.jobs.start(
                move || improvements(&plan, &Progress::default()),
                |state: &mut Self, number, found| state.planning.better.take(number, found),
            );
            self.planning.better.start(number, of);
        }
    }
}
