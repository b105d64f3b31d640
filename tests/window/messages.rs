//! Messages of the window: their position, duration and names.

use egui::{Theme, Vec2};
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, Pane, WorkspaceCommand};
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{LARGE, SMALL, Window, send, set, shown, window};

fn texts(harness: &Window) -> Vec<String> {
    harness.state().state.toasts.shown().iter().map(|toast| toast.text.clone()).collect()
}

#[test]
fn a_message_covers_no_pane() {
    for size in [LARGE, SMALL, Vec2::new(1280.0, 720.0)] {
        let mut harness = window(size, Theme::Dark);
        let folder = tempfile::tempdir().expect("a folder");
        let broken = folder.path().join("broken.csv");
        std::fs::write(&broken, "timestamp,id,distance,ha,va\n0,1,10,x,1.5\n").expect("written");
        send(&mut harness, DeploymentCommand::OpenPaths(vec![broken]));
        harness.run_steps(2);
        let message = harness.get_by_label_contains("is not a number").rect();
        for pane in [Pane::Scene, Pane::Result, Pane::Residuals] {
            let place = harness.state().layout().place(pane).expect("shown");
            assert!(!place.intersects(message), "{pane:?} {place:?} {message:?}");
        }
        assert!(harness.ctx.content_rect().contains_rect(message), "{message:?}");
    }
}

#[test]
fn what_could_not_be_opened_is_said_until_it_is_open() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drive");
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    let toasts = harness.state().state.toasts.shown();
    assert_eq!(toasts.iter().map(|toast| toast.count).collect::<Vec<_>>(), [2], "{toasts:?}");
    harness.get_by_label_contains("(2×)");
    write_folder(&simulate(Preset::FigureEight, 1), &path).expect("written");
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    assert!(harness.state().state.toasts.errors().next().is_none(), "{:?}", texts(&harness));
}

#[test]
fn a_warning_has_the_numbers_of_the_answer_that_is_shown() {
    let mut harness = window(LARGE, Theme::Dark);
    for tau_l in [40.0, 60.0, 90.0, 6.0] {
        set(&mut harness, |settings| settings.pipeline.thresholds.tau_l_seconds = tau_l);
        let (open, analysis) = harness.state().state.analysed().expect("analysed");
        let of_answer = analysis.answer.iter().flat_map(|answer| &answer.calibration.findings);
        let now: Vec<String> =
            (open.deployment.findings.iter().chain(of_answer)).map(ToString::to_string).collect();
        for toast in harness.state().state.toasts.shown() {
            let said = if toast.detail.is_empty() { &toast.text } else { &toast.detail };
            assert!(now.iter().any(|finding| said.contains(finding.as_str())), "{said} of {now:?}");
        }
    }
}

#[test]
fn deployments_of_one_name_are_told_apart_wherever_they_are_listed() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    for run in ["run1", "run2"] {
        let path = folder.path().join(run).join("data");
        write_folder(&simulate(Preset::FigureEight, 1), &path).expect("written");
        // Named after its folder.
        let toml = path.join("deployment.toml");
        let text = std::fs::read_to_string(&toml).expect("simulated");
        let lines = text.lines().filter(|line| !line.starts_with("name"));
        std::fs::write(&toml, lines.map(|line| format!("{line}\n")).collect::<String>())
            .expect("written");
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(path)));
    }
    assert_eq!(shown(&harness).deployment.name, "data");
    assert_eq!(harness.state().state.names(), ["run1/data", "run2/data"]);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::SideBySide));
    for name in ["run1/data", "run2/data"] {
        assert!(harness.query_all_by_label(name).count() >= 2, "{name}: list and table");
    }
    assert!(harness.query_all_by_label("data").next().is_none());
    harness.get_by_label("File").click();
    harness.run_steps(3);
    harness.get_by_label("Open run1/data");
    harness.get_by_label("Solve together with run1/data");
    assert!(harness.query_all_by_label_contains("Close run2/data").count() >= 2, "list and menu");
}
