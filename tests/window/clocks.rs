//! The clocks pane.

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::{Pane, WorkspaceCommand};
use resect_core::calibration::Method;
use resect_core::deployment::TimeCorrection;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{LARGE, Part, SMALL, Window, open, send, set, shown, snapshot_of, window};

/// Returns a drive whose stations have clocks of their own, as in bags.
fn with_clocks() -> resect_core::deployment::Deployment {
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::UnevenGround, 1)).expect("readable");
    let start_s = deployment.start_s().expect("readings");
    for (station, track) in deployment.tracks.iter_mut().enumerate() {
        let own = |time_s: f64| {
            let drift = 20e-6 * (station as f64 + 1.0) * (time_s - start_s);
            time_s + [0.3, -0.2, 3600.0][station] + drift
        };
        track.own_clock_s = track.measurements.iter().map(|m| own(m.time_s)).collect();
    }
    deployment.time_corrections[1] = (0..20)
        .map(|i| TimeCorrection { time_s: start_s + 10.0 * f64::from(i), offset_s: -0.199 })
        .collect();
    deployment
}

fn show_clocks(harness: &mut Window) {
    send(harness, WorkspaceCommand::ShowPane(Pane::Clocks));
}

#[test]
fn clocks_are_drawn_with_what_the_calibration_estimates() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "clocks-dark"),
        (LARGE, Theme::Light, "clocks-light"),
        (SMALL, Theme::Dark, "clocks-small-dark"),
    ] {
        let mut harness = window(size, theme);
        open(&mut harness, with_clocks());
        show_clocks(&mut harness);
        harness.get_by_label_contains("1: own clock − stamp +3");
        harness.get_by_label_contains("3: own clock − stamp +3600.0");
        harness.get_by_label_contains("2: estimated");
        snapshot_of(&mut harness, Part::Pane(Pane::Clocks), name);
        // The same time as in all plots.
        let at = harness.get_by_label("clocks over time").rect().center();
        let before = shown(&harness).timeline.cursor_s;
        harness.hover_at(at);
        harness.run_steps(1);
        harness.drag_at(at);
        harness.run_steps(1);
        harness.drop_at(at);
        harness.run_steps(2);
        assert_ne!(shown(&harness).timeline.cursor_s, before);
    }
}

#[test]
fn what_no_file_tells_is_said() {
    let mut harness = window(SMALL, Theme::Light);
    // The joint estimate would have clocks to draw.
    set(&mut harness, |settings| settings.calibration.method = Some(Method::InterPrism));
    show_clocks(&mut harness);
    harness.get_by_label("No station clocks in these files.");
    snapshot_of(&mut harness, Part::Pane(Pane::Clocks), "clocks-none-light");
}
