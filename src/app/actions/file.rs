//! Actions for opening, sessions, and export.

use egui::{Key, Modifiers};

use super::{Action, Menu};
use crate::app::model::{
    Command, DeploymentCommand, DialogCommand, JudgingCommand, LiveCommand, OpenDeployment, Pane,
    PlanCommand, ResultsCommand, SessionCommand, TimeCommand, WorkspaceCommand,
};
use crate::app::state::State;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_report::copy::{CopiedTransforms, CopyFormat};

fn file(section: &'static str, name: &str, command: impl Into<Command>) -> Action {
    Action::new(Menu::File, section, name, command)
}

pub fn actions(state: &State) -> Vec<Action> {
    let mut actions = vec![
        file("", "Open folder…", DeploymentCommand::OpenFolderDialog)
            .hint("A deployment's folder: tracks, control points, rig, GNSS")
            .ctrl(Key::O),
        file("", "Open bag or CSV…", DeploymentCommand::OpenFileDialog)
            .hint("A file of tracks, with the files beside it")
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::O),
    ];
    let (live, running) = (LiveCommand::Show, state.live.is_running());
    actions.push(
        file("", "Connect…", live)
            .hint("To a network stream or a replay: results during the drive"),
    );
    if running {
        let stop = LiveCommand::Stop;
        actions.push(file("", "Stop the live deployment", stop).hint("The recording is kept"));
    }
    if state.active().is_some() {
        actions.push(
            file("", "Evaluate a trajectory…", JudgingCommand::AddDialog).hint(
                "SLAM or odometry (TUM, EuRoC, KITTI, CSV), compared with the shown deployment",
            ),
        );
    }
    actions.extend([
        file("Plan", "Open a plan…", PlanCommand::OpenDialog)
            .hint("Stations, path, rig and instruments of a future drive (TOML)"),
        file("Plan", "Save the plan…", PlanCommand::SaveDialog),
        file("Plan", "Plan from this drive", PlanCommand::FromDeployment)
            .hint("Stations, path, rig and noise of the shown deployment")
            .possible(state.analysed().is_some()),
    ]);
    actions.extend(sessions(state));
    for (recent, name) in state.session.recent.iter().zip(state.session.recent_names()) {
        let name = format!("Open {name}");
        if !actions.iter().any(|action: &Action| action.name == name) {
            actions.push(file(
                "Recent",
                &name,
                DeploymentCommand::OpenSource(recent.source.clone()),
            ));
        }
    }
    for sample in Sample::ALL {
        let name = format!("Sample: {}", sample.title());
        actions.push(file("Samples", &name, DeploymentCommand::OpenSample(sample)));
    }
    actions.extend(deployments(state));
    actions
}

fn sessions(state: &State) -> Vec<Action> {
    let mut actions = vec![
        file("Session", "Open session…", SessionCommand::OpenDialog)
            .hint("Deployments with their settings, view and pinned results"),
        file("Session", "Save session", SessionCommand::Save)
            .hint("All open deployments, with settings, view and pinned results")
            .ctrl(Key::S),
        file("Session", "Save session as…", SessionCommand::SaveAs)
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::S),
    ];
    if state.session.last.as_ref().is_some_and(|last| last.path().is_some()) {
        actions
            .push(file("Session", "Reopen the last session", SessionCommand::ReopenLast).hint(
                "The session that another one replaced, or that closed with the last window",
            ));
    }
    if state.session.recovered {
        actions.push(
            file("Session", "Discard the restored session", SessionCommand::DiscardRecovered)
                .hint("The session from before the crash; it can be reopened"),
        );
    }
    if !state.session.missing.is_empty() {
        let hint = "Deployments of the session that could not be opened";
        actions.push(
            file("Session", "Try missing deployments again", SessionCommand::RetryMissing)
                .hint(hint),
        );
    }
    actions
}

/// Joint solution of the active deployment with another, and closing.
fn deployments(state: &State) -> Vec<Action> {
    let mut actions: Vec<Action> = Vec::new();
    if let Some(active) = state.active() {
        for (other, other_name) in state.deployments.open.iter().zip(state.names()) {
            if let Some(together) = solved_together(active, other) {
                let name = format!("Solve together with {other_name}");
                let hint =
                    "As drives of one set-up: unmoved stations, separate clocks for each drive";
                actions.push(
                    file("Deployment", &name, DeploymentCommand::OpenSource(together)).hint(hint),
                );
            }
        }
    }
    if let Some(open) = state.active() {
        let name = format!("Close {}", state.name_of(open.id).unwrap_or_default());
        let close = file("Deployment", &name, DeploymentCommand::Close(open.id)).ctrl(Key::W);
        actions.push(close.in_general("Close the deployment"));
    }
    if let Some(name) = state.session.last_closed() {
        let name = format!("Reopen {name}");
        let reopen = file("Deployment", &name, DeploymentCommand::ReopenClosed)
            .hint("With its settings and its evaluated trajectories")
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::T);
        actions.push(reopen.in_general("Reopen the closed deployment"));
    }
    actions
}

/// Returns the source of the active deployment with another open one as a further drive; `None` if it has it, or if one has no file.
pub fn solved_together(active: &OpenDeployment, other: &OpenDeployment) -> Option<Source> {
    let (source, other_source) = (active.source.as_ref()?, other.source.as_ref()?);
    let path = other_source.path().filter(|_| other.id != active.id)?;
    let drives = vec![path.to_owned()];
    let mut together = source.clone();
    together.extras.add(Extras { drives, ..Extras::default() });
    let is_new = together != *source
        && !other_source.extras.drives.iter().any(|drive| Some(&**drive) == source.path());
    is_new.then_some(together)
}

pub fn exports(state: &State) -> Vec<Action> {
    let there = state.analysed().is_some();
    // Only the joint estimate is exported, not the preliminary result.
    let last = state.active().is_some_and(|open| !open.joint_follows());
    let answered = last && state.active().is_some_and(|open| open.summary.is_some());
    let copies = CopyFormat::ALL.into_iter().map(|format| {
        let name = format!("Copy as {}", format.title());
        let command = ResultsCommand::CopyTransforms(format, CopiedTransforms::All);
        Action::new(Menu::Export, "Copy all transforms", name, command).possible(answered)
    });
    let export = |section, name: &str, command: Command| {
        let possible = there && (last || section == "Picture");
        Action::new(Menu::Export, section, name, command).possible(possible)
    };
    let mut actions = vec![
        export("Picture", "Picture of a pane…", DialogCommand::ShowPicture(Pane::Scene).into())
            .hint("Any pane without its controls: PNG at one to four pixels per point, or SVG")
            .ctrl(Key::E),
        export("Picture", "Copy picture of the scene", WorkspaceCommand::CopyPicture(Pane::Scene).into())
            .keys(Modifiers::COMMAND | Modifiers::SHIFT, Key::E),
        export("Files", "Report (HTML)…", ResultsCommand::SaveReportDialog.into())
            .hint("Verdict, transforms, residuals and data as one page"),
        export("Files", "Trajectory…", ResultsCommand::SaveTrajectoryDialog.into())
            .hint("The vehicle's poses in six degrees of freedom: TUM, or CSV, PLY, MCAP or ROS 1 bag by file extension"),
        export("Files", "Plotted channels (CSV)…", TimeCommand::SaveChannelsDialog.into())
            .hint("All values of the channels in the Channels pane"),
        export("Rerun", "Open in Rerun", ResultsCommand::OpenInRerun.into()),
        export("Rerun", "Recording for Rerun (.rrd)…", ResultsCommand::SaveRecordingDialog.into()),
    ];
    actions.extend(copies);
    actions
}
