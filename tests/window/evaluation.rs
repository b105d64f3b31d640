//! Trajectories without a deployment: the choice of the ground truth, the layout, and the scene.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui::{OutputCommand, Theme};
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, LayoutPreset, Pane, Start, WorkspaceCommand};
use resect_io::estimate_file;
use resect_io::evaluation_files::EvaluationFiles;
use resect_io::sample::Sample;
use resect_tools::simulation::{EPOCH_S, Preset, Simulated, simulate};

use crate::common::slam::{SLAM, Slam, span_s, true_pose, write_tum};
use crate::harness::{
    LARGE, SMALL, Window, click, send, settle, shown, type_and_enter_at_once, window, window_from,
};

const FIRST_PANES: [Pane; 3] = [Pane::Scene, Pane::Pipeline, Pane::Result];

/// Writes an estimate and positions of a ground truth at this rate; the names share words.
fn write_pair(simulated: &Simulated, folder: &Path, rate_hz: f64) -> [PathBuf; 2] {
    let names = ["handheld_room00_fastlio2.tum", "handheld_room00_prism.tum"];
    let [slam, truth] = names.map(|name| folder.join(name));
    write_tum(&Slam { drift_m: 0.0, ..SLAM }.drive(simulated), &slam);
    let count = (span_s(simulated) * rate_hz) as usize;
    let line = |index: usize| {
        let time_s = EPOCH_S + index as f64 / rate_hz;
        let position_m = true_pose(simulated, time_s).0;
        format!("{time_s:.6} {} {} {} 0 0 0 1\n", position_m.x, position_m.y, position_m.z)
    };
    let lines: String = (1..count).map(line).collect();
    std::fs::write(&truth, lines).expect("written");
    [slam, truth]
}

fn start(paths: &[PathBuf]) -> Start {
    let read = paths.iter().flat_map(|path| estimate_file::read(path).expect("a trajectory"));
    let files = EvaluationFiles::of(read.collect()).expect("readable").expect("some");
    Start::Evaluation(Box::new(files), Vec::new())
}

fn names(harness: &Window) -> (String, Vec<String>) {
    let open = shown(harness);
    let added = open.judging.added.iter().map(|one| one.estimate.name.clone());
    (open.deployment.name.clone(), added.collect())
}

#[test]
fn two_trajectories_open_as_ground_truth_and_estimate_and_can_be_exchanged() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    // The order of the arguments does not matter: one has positions only, and its name says so.
    for order in [[0, 1], [1, 0]] {
        let paths = order.map(|index| pair[index].clone());
        let mut harness = window_from(LARGE, Theme::Dark, &start(&paths), None);
        settle(&mut harness);
        assert_eq!(names(&harness), ("handheld_room00_prism".into(), vec!["fastlio2".into()]));
        let rmse_m = shown(&harness).judging.judged().next().expect("evaluated").1.position.rmse;
        assert!((0.005..0.03).contains(&rmse_m), "{rmse_m}");
        harness.get_by_label_contains("positions, by its name");
        harness.get_by_label("Ground truth handheld_room00_prism");
        assert!(harness.query_by_label("Show station 1").is_none(), "a trajectory has no stations");
        harness.get_by_label_contains("fastlio2: ");
        let layout = harness.state().layout();
        assert!([Pane::Scene, Pane::Channels, Pane::Evaluation].iter().all(|it| layout.holds(*it)));
        assert!(!layout.holds(Pane::Pipeline), "the layout Evaluate");
        click(&mut harness, "exchange");
        settle(&mut harness);
        assert_eq!(names(&harness), ("handheld_room00_fastlio2".into(), vec!["prism".into()]));
        harness.get_by_label_contains("poses, as chosen");
        click(&mut harness, "exchange");
        settle(&mut harness);
        assert_eq!(names(&harness).1, ["fastlio2"]);
    }
}

#[test]
fn the_convention_of_a_file_is_entered_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    let mut harness = window_from(LARGE, Theme::Dark, &start(&pair), None);
    settle(&mut harness);
    let convention = |harness: &Window| shown(harness).judging.added[0].options.convention;
    let enter = |harness: &mut Window, text: &str| {
        let field = "file's convention is";
        harness.get_by_role_and_label(Role::TextInput, field).focus();
        settle(harness);
        type_and_enter_at_once(harness, text);
        settle(harness);
    };
    enter(&mut harness, "held");
    assert_eq!(convention(&harness).to_string(), "held");
    assert_eq!(shown(&harness).judging.judged().count(), 1, "evaluated again");
    enter(&mut harness, "held, sideways");
    harness.get_by_label_contains("`sideways` is no convention");
    assert_eq!(convention(&harness).to_string(), "held");
    enter(&mut harness, "xyzw");
    assert!(convention(&harness).is_as_read());
    assert!(harness.query_by_label_contains("is no convention").is_none());
}

/// A bag is opened as a deployment first; without readings of stations its poses are trajectories.
#[test]
fn a_dropped_bag_of_poses_is_a_trajectory() {
    let bag = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../shared/datasets/others/evo/nav2_turtlebot.mcap");
    if !bag.is_file() {
        return;
    }
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![bag]));
    settle(&mut harness);
    settle(&mut harness);
    let open = shown(&harness);
    assert!(open.deployment.ground_truth.is_some(), "{}", open.deployment.name);
    assert!(!open.judging.added.is_empty(), "the bag has several topics of poses");
}

#[test]
fn the_convention_of_the_ground_truth_is_entered_in_words() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    let mut harness = window_from(LARGE, Theme::Dark, &start(&pair), None);
    settle(&mut harness);
    let enter = |harness: &mut Window, text: &str| {
        let field = "ground truth's convention is";
        harness.get_by_role_and_label(Role::TextInput, field).focus();
        settle(harness);
        type_and_enter_at_once(harness, text);
        settle(harness);
    };
    enter(&mut harness, "mm");
    assert_eq!(names(&harness).1, ["fastlio2"]);
    harness.get_by_label_contains("its distances are ");
    let session = harness.state().state.session();
    let mut again = window(SMALL, Theme::Light);
    again.state_mut().state.restore(session);
    settle(&mut again);
    settle(&mut again);
    again.get_by_label_contains("its distances are ");
    enter(&mut harness, "xyzw");
    let rmse_m = shown(&harness).judging.judged().next().expect("evaluated").1.position.rmse;
    assert!((0.005..0.03).contains(&rmse_m), "{rmse_m}");
}

#[test]
fn the_pose_of_the_prism_in_the_body_has_sigma_and_can_be_copied() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    let mut harness = window_from(LARGE, Theme::Dark, &start(&pair), None);
    settle(&mut harness);
    assert!(shown(&harness).judging.extrinsics.newest.is_none(), "only if it is looked at");
    let click_below = |harness: &mut Window, label: &str| {
        harness.get_by_label(label).scroll_to_me();
        harness.run_steps(60);
        harness.get_by_label(label).click();
        harness.run_steps(3);
    };
    click_below(&mut harness, "Extrinsic calibration");
    settle(&mut harness);
    harness.get_by_label_contains("pose of handheld_room00_prism").scroll_to_me();
    harness.run_steps(60);
    click_below(&mut harness, "Copy as…");
    harness.get_by_label("URDF joints").click();
    harness.run_steps(1);
    let commands = harness.output().platform_output.commands.clone();
    let copied = commands.into_iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text),
        _ => None,
    });
    let copied = copied.expect("something was copied");
    assert!(copied.contains("<origin xyz="), "{copied}");
}

#[test]
fn dropped_trajectories_replace_the_sample_and_a_deployment_brings_the_layout_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    let mut harness = window(LARGE, Theme::Light);
    send(&mut harness, DeploymentCommand::OpenPaths(pair.to_vec()));
    settle(&mut harness);
    assert_eq!(harness.state().state.deployments.open.len(), 1, "the sample gave way");
    assert_eq!(names(&harness), ("handheld_room00_prism".into(), vec!["fastlio2".into()]));
    assert!(harness.state().layout().holds(Pane::Evaluation));
    assert!(!harness.state().layout().holds(Pane::Pipeline));
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Warthog));
    settle(&mut harness);
    assert!(FIRST_PANES.iter().all(|pane| harness.state().layout().holds(*pane)));
    // A layout that the user chose stays.
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Evaluate));
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Hd2Tunnel));
    settle(&mut harness);
    assert!(!harness.state().layout().holds(Pane::Pipeline));
}

#[test]
fn a_trajectory_alone_has_its_facts_and_waits_for_a_ground_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let pair = write_pair(&simulate(Preset::FigureEight, 4), folder.path(), 20.0);
    let mut harness = window_from(SMALL, Theme::Dark, &start(&pair[..1]), None);
    settle(&mut harness);
    harness.get_by_label_contains(" Hz), ");
    harness.get_by_label_contains("One trajectory alone cannot be evaluated");
    send(&mut harness, DeploymentCommand::OpenPaths(pair[1..].to_vec()));
    settle(&mut harness);
    settle(&mut harness);
    assert_eq!(names(&harness), ("handheld_room00_prism".into(), vec!["fastlio2".into()]));
    assert_eq!(harness.state().state.deployments.open.len(), 1);
    assert_eq!(shown(&harness).judging.judged().count(), 1);
}
