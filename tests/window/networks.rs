//! The window with other numbers of stations than three.

use egui::Theme;
use resect::app::{
    DeploymentCommand, LayoutPreset, Pane, PlanCommand, SceneCommand, ViewPreset, WorkspaceCommand,
};
use resect_core::calibration::Verdict;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate_scenario};

use crate::harness::{LARGE, SMALL, Window, send, shown, window};

/// Returns a window with the calibration of a simulated network.
fn opened(stations: usize, prisms: usize, size: egui::Vec2) -> Window {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drive");
    let scenario = Preset::Warthog.scenario().with_network(stations, prisms);
    write_folder(&simulate_scenario(&scenario, 3), &path).expect("written");
    let mut harness = window(size, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    assert_eq!(shown(&harness).deployment.tracks.len(), stations);
    harness
}

fn draw_all_panes(harness: &mut Window) {
    for pane in Pane::ALL {
        send(harness, WorkspaceCommand::ShowPane(pane));
        harness.run_steps(2);
    }
    harness.render().expect("a picture");
}

#[test]
fn every_pane_draws_two_four_and_eight_stations() {
    for (stations, prisms, size) in [(2, 2, SMALL), (2, 1, SMALL), (4, 3, LARGE), (8, 4, LARGE)] {
        let mut harness = opened(stations, prisms, size);
        let analysis = shown(&harness).analysis.clone().expect("analysed");
        let answer = analysis.answer.as_ref().expect("an answer");
        assert_eq!(answer.calibration.station1_from_station.len(), stations);
        if stations > 2 {
            assert_eq!(answer.calibration.verdict, Verdict::Good, "{stations} stations");
        }
        draw_all_panes(&mut harness);
        send(&mut harness, SceneCommand::Look(ViewPreset::Station(stations - 1)));
        send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
        send(&mut harness, PlanCommand::FromDeployment);
        let plan = &harness.state().state.planning.plan;
        if prisms > 2 {
            assert_eq!(plan.stations_m.len(), stations);
        }
        draw_all_panes(&mut harness);
    }
}
