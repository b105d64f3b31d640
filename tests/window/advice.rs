//! Advice of findings: each can be followed by a button beside it, or from the command palette, and never needs a flag.

use egui::Theme;
use egui::accesskit::Role;
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    AngleUnit, DeploymentCommand, DialogCommand, Pane, SceneCommand, TimeCommand, Units,
    ViewPreset, WorkspaceCommand,
};
use resect_core::calibration::Method;
use resect_core::deployment::Remedy;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate, simulate_scenario};

use crate::harness::{LARGE, SMALL, Window, open, send, set, settle, shown, window};

fn method(harness: &Window) -> Method {
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    analysis.answer.as_ref().expect("an answer").calibration.method
}

/// Presses the first button of this name at any scroll position: several findings may give the same advice.
fn press_first(harness: &mut Window, name: &str) {
    let buttons: Vec<_> = harness.get_all_by_label(name).collect();
    buttons[0].click_accesskit();
    settle(harness);
}

fn is_said(harness: &Window, words: &str) -> bool {
    harness.query_all_by_label_contains(words).next().is_some()
}

/// Returns a window with method D, where a station tracked another prism at times.
fn pulled() -> Window {
    let mut harness = window(LARGE, Theme::Dark);
    let mut scenario = Preset::Warthog.scenario();
    scenario.noise.wrong_targets_per_minute = 0.3;
    open(
        &mut harness,
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 21)).expect("valid"),
    );
    set(&mut harness, |s| s.calibration.method = Some(Method::InterPrism));
    harness
}

#[test]
fn the_joint_estimate_is_taken_where_a_finding_advises_it_and_given_back() {
    let mut harness = pulled();
    assert_eq!(method(&harness), Method::InterPrism);
    assert!(is_said(&harness, "the joint estimate leaves them out"));
    press_first(&mut harness, "Use the joint estimate");
    assert_eq!(method(&harness), Method::Joint);
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(method(&harness), Method::InterPrism);

    // The palette has the advice as well.
    send(&mut harness, DialogCommand::ShowPalette);
    harness.event(egui::Event::Text("advice joint".to_owned()));
    settle(&mut harness);
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    assert_eq!(method(&harness), Method::Joint);
}

#[test]
fn no_finding_shows_a_flag() {
    let mut harness = pulled();
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Findings));
    assert!(!is_said(&harness, "--"));
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let findings = &analysis.answer.as_ref().expect("an answer").calibration.findings;
    assert!(findings.iter().any(|one| one.remedies.contains(&Remedy::JointEstimate)));

    // Missing data shows no flag either.
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::FigureEight, 1)).expect("valid");
    deployment.rig = None;
    open(&mut harness, deployment);
    for pane in [Pane::Result, Pane::Findings, Pane::Runs] {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        assert!(!is_said(&harness, "--"), "{pane:?}");
    }
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Result));
    // The deployment came from no file, so it cannot be read again with one.
    let mut choose = harness.get_all_by_role_and_label(Role::Button, "Choose a rig file…");
    assert!(choose.all(|button| button.accesskit_node().is_disabled()));
}

#[test]
fn exchanged_stations_are_exchanged_back_by_the_finding_that_sees_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drive");
    write_folder(&simulate(Preset::UnevenGround, 1), &path).expect("written");
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    let stations = |harness: &Window| {
        let source = shown(harness).source.as_ref().expect("a source");
        source.extras.corrections.stations.clone()
    };
    let mut extras = shown(&harness).source.as_ref().expect("a source").extras.clone();
    extras.corrections.stations = Some([1, 3, 2].into());
    send(&mut harness, DeploymentCommand::Correct(extras));
    assert_eq!(stations(&harness), Some([1, 3, 2].into()));

    let back = "Correct: station numbers 1 3 2 → 1 2 3";
    press_first(&mut harness, back);
    assert_eq!(stations(&harness), None);
    assert!(!is_said(&harness, back));
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(stations(&harness), Some([1, 3, 2].into()));
}

#[test]
fn a_point_and_a_time_that_a_finding_names_are_shown() {
    let mut harness = window(LARGE, Theme::Dark);
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 1)).expect("valid");
    let point = &mut deployment.control_points[0].points[2];
    let name = format!("Show point {}", point.marker);
    point.readings[1].as_mut().expect("measured").range_m += 0.3;
    open(&mut harness, deployment);
    set(&mut harness, |s| s.calibration.method = Some(Method::StaticGcp));
    let mut visibility = harness.state().state.scene.visibility;
    visibility.control_points = false;
    send(&mut harness, SceneCommand::Show(visibility));
    press_first(&mut harness, &name);
    assert!(harness.state().state.scene.visibility.control_points);
    let point = harness.state().state.scene.shown_point.as_ref().map(|point| point.marker);
    assert_eq!(point.map(|marker| format!("Show point {marker}")), Some(name));
    send(&mut harness, SceneCommand::Look(ViewPreset::Fit));
    assert!(harness.state().state.scene.shown_point.is_none());

    let [start_s, _] = shown(&harness).timeline.whole_s;
    send(&mut harness, TimeCommand::LookAtTimes([start_s + 20.0, start_s + 40.0]));
    let timeline = &shown(&harness).timeline;
    assert_eq!(timeline.selection_s, Some([start_s + 20.0, start_s + 40.0]));
    assert!(timeline.window_s[0] < start_s + 20.0 && timeline.window_s[1] > start_s + 40.0);
}

#[test]
fn what_can_be_corrections_unfolds_on_request() {
    let mut harness = window(LARGE, Theme::Dark);
    let station_numbers = "Exchange stations 2 and 3";
    assert!(harness.query_by_label(station_numbers).is_none());
    send(&mut harness, DeploymentCommand::ShowCorrections);
    assert!(harness.query_by_label(station_numbers).is_some());
}

#[test]
fn findings_tell_angles_in_the_users_unit() {
    let mut harness = window(SMALL, Theme::Light);
    open(
        &mut harness,
        resect_io::simulation_files::open(&simulate(Preset::LShape, 1)).expect("valid"),
    );
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Findings));
    assert!(is_said(&harness, "one corner of 90°"));
    let units = Units { angle: AngleUnit::Gon, ..Units::default() };
    send(&mut harness, WorkspaceCommand::SetUnits(units));
    assert!(
        is_said(&harness, "one corner of 100\u{a0}gon") && !is_said(&harness, "one corner of 90°")
    );
    assert!(is_said(&harness, "\u{a0}mgon in vertical angles"), "how the readings scatter");
}
