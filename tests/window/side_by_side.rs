//! Comparison of results: open deployments and pinned results, their differences, and incomparable ones.

use egui::Theme;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, Pane, WorkspaceCommand};
use resect_core::calibration::Method;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{
    LARGE, Part, SMALL, Window, click, open, send, set, settings, snapshot_of, window,
};

/// Returns a window with the sample's pinned joint estimate, beside method D.
fn pinned(size: egui::Vec2, theme: Theme) -> Window {
    let mut harness = window(size, theme);
    click(&mut harness, "Pin");
    set(&mut harness, |s| {
        s.calibration.method = Some(Method::InterPrism);
        s.pipeline.thresholds.tau_l_seconds = 20.0;
    });
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::SideBySide));
    harness
}

#[test]
fn a_pinned_result_stands_beside_the_present_one_with_what_differs() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "pinned-beside-dark"),
        (SMALL, Theme::Light, "pinned-beside-small-light"),
    ] {
        let mut harness = pinned(size, theme);
        assert!(harness.query_by_label("Pinned E").is_some());
        // Eight parameters of the transforms, in their units and in σ.
        let told = |unit| harness.query_all_by_label_contains(unit).count();
        assert!(told(" mm (") >= 6 && told(" mrad (") >= 2, "{name}");
        snapshot_of(&mut harness, Part::Pane(Pane::SideBySide), name);
    }
}

#[test]
fn the_settings_of_a_pinned_result_are_taken_and_given_back() {
    let mut harness = pinned(LARGE, Theme::Dark);
    let changed = settings(&harness);
    let buttons: Vec<_> =
        harness.get_all_by_role_and_label(Role::Button, "Use the settings of E").collect();
    buttons[0].click_accesskit();
    crate::harness::settle(&mut harness);
    assert_eq!(settings(&harness), resect_core::analysis::Settings::default());
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(settings(&harness), changed);
}

#[test]
fn points_that_are_not_the_same_stand_in_rows_of_their_own() {
    let mut harness = window(LARGE, Theme::Dark);
    set(&mut harness, |s| s.pipeline.rate_hz = 5.0);
    click(&mut harness, "Pin");
    set(&mut harness, |s| s.pipeline.rate_hz = 10.0);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::SideBySide));
    let rows = |harness: &Window| harness.query_all_by_label("GCP_raw_1.txt").count();
    let only = rows(&harness);
    // Another set-up with files of the same names.
    let mut other =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 7)).expect("valid");
    let here = Sample::Warthog.open().expect("built in").control_points;
    assert_ne!(other.control_points, here);
    for (set, known) in other.control_points.iter_mut().zip(&here) {
        set.file.clone_from(&known.file);
    }
    "another".clone_into(&mut other.name);
    open(&mut harness, other);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::SideBySide));
    assert_eq!(rows(&harness), only + 1);
    assert!(harness.query_all_by_label("of another").count() > 0, "whose points they are");
}
