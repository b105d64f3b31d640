//! Drives of one set-up, solved together in the window.

use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::Queryable as _;
use resect::app::{DeploymentCommand, Pane, WorkspaceCommand};
use resect_core::calibration::Verdict;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate};

use crate::common::{answer, two_runs};
use crate::harness::{LARGE, Window, click, press, send, shown, type_and_enter_at_once, window};

fn sigma_m(harness: &Window) -> f64 {
    let analysis = shown(harness).analysis.clone().expect("analysed");
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);
    calibration.sigma.as_ref().expect("σ")[1].translation_m.x
}

#[test]
fn the_palette_solves_two_drives_together_and_undo_parts_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let runs = two_runs(Preset::Warthog.scenario(), 3, &[]);
    for (name, run) in ["morning", "noon"].iter().zip(&runs) {
        write_folder(run, &folder.path().join(name)).expect("written");
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(folder.path().join(name))));
    }
    let (alone_m, readings) = (sigma_m(&harness), crate::harness::triplets(&harness));
    press(&mut harness, Modifiers::COMMAND, Key::P);
    type_and_enter_at_once(&mut harness, "solve together");
    assert_eq!(harness.state().state.deployments.open.len(), 2);
    assert_eq!(shown(&harness).deployment.restarts_s.len(), 1);
    assert!(crate::harness::triplets(&harness) > readings * 3 / 2);
    // Control points make each drive nearly as sure as both.
    assert!(sigma_m(&harness) < 1.05 * alone_m);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(shown(&harness).deployment.restarts_s.len(), 0);
    assert_eq!(sigma_m(&harness), alone_m);
}

#[test]
fn a_drive_with_the_same_control_points_is_offered_and_another_is_not() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let runs = two_runs(Preset::Warthog.scenario(), 3, &[]);
    let other = simulate(Preset::Warthog, 5);
    for (name, run) in [("other", &other), ("morning", &runs[0]), ("noon", &runs[1])] {
        write_folder(run, &folder.path().join(name)).expect("written");
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(folder.path().join(name))));
    }
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Deployment));
    assert!(harness.query_by_label("Solve together: warthog (simulated), other").is_none());
    click(&mut harness, "Solve together: warthog (simulated), morning");
    assert_eq!(shown(&harness).deployment.restarts_s.len(), 1);
    assert!(harness.query_by_label("Solve together: warthog (simulated), morning").is_none());
}
