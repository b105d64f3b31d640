//! The vehicle's own trajectory, and dropped trajectories of other systems.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector3;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use resect::app::{
    Channel, ChannelPlots, DeploymentCommand, JudgingCommand, Pane, SceneCommand, TimeCommand,
    Visibility, WorkspaceCommand,
};
use resect_core::calibration::Method;
use resect_core::evaluation::trajectory::Trajectory;
use resect_core::evaluation::vehicle::{Instants, PoseLimits, trajectory_by};
use resect_io::sample::Sample;
use resect_io::simulation_files::write_folder;
use resect_io::source::Place;
use resect_tools::estimates::{Body, Options, TrajectoryAlignment};
use resect_tools::simulation::{Preset, simulate};
use resect_tools::validation::one_frame::PlacedBy;

use crate::common::slam::{SLAM, Slam, write_tum};
use crate::common::{knock, two_runs};
use crate::harness::{
    LARGE, Part, SMALL, Window, click, open, press, send, set, settle, shown, snapshot_of,
    type_and_enter_at_once, window,
};

/// Returns the ground truth of the open deployment, ten poses a second.
fn own(harness: &Window) -> Trajectory {
    let open = shown(harness);
    let analysis = open.analysis.as_ref().expect("analysed");
    let answer = analysis.answer.as_ref().expect("an answer");
    let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
    let wanted = Instants::Rate(10.0);
    let calibration = &answer.calibration;
    trajectory_by(&open.deployment, triplets, followed, calibration, wanted, &PoseLimits::NONE)
        .expect("poses")
        .0
}

/// Writes it in the form of another system's estimate: noisy, and with a large error for five seconds in the middle.
fn write_slam(harness: &Window, folder: &Path, name: &str, noise_m: f64, jump_m: f64) -> PathBuf {
    let mut rng = ChaCha8Rng::seed_from_u64(name.len() as u64);
    let poses = own(harness).poses;
    let middle_s = poses[poses.len() / 2].time_s;
    let mut text = "# timestamp tx ty tz qx qy qz qw\n".to_owned();
    for pose in &poses {
        let noise_m: Vector3<f64> = Vector3::from_fn(|_, _| noise_m * rng_normal(&mut rng));
        let is_off = (middle_s..middle_s + 5.0).contains(&pose.time_s);
        let at =
            pose.position_m + noise_m + Vector3::new(if is_off { jump_m } else { 0.0 }, 0.0, 0.0);
        let q = pose.orientation;
        _ = writeln!(
            text,
            "{:.6} {} {} {} {} {} {} {}",
            pose.time_s, at.x, at.y, at.z, q.i, q.j, q.k, q.w
        );
    }
    let path = folder.join(name);
    std::fs::write(&path, text).expect("written");
    path
}

fn rng_normal(rng: &mut ChaCha8Rng) -> f64 {
    StandardNormal.sample(rng)
}

#[test]
fn the_vehicles_way_is_plotted_with_its_sigma() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Channels));
    for name in ["height over time", "heading over time", "σ position over time"] {
        harness.get_by_label(name);
    }
    assert!(harness.query_by_label("roll over time").is_none());
    harness.get_all_by_label_contains(" ± ").next().expect("a value at the cursor with its σ");
    let way = shown(&harness).way.newest.clone().expect("made");
    assert!(way.instants.len() > 2000);
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "trajectory-dark");
    let all = ChannelPlots::of(&Channel::ALL[..Channel::OF_VEHICLE]);
    send(&mut harness, TimeCommand::Plot(all.clone()));
    for channel in all.channels() {
        harness.get_by_label(&format!("{} over time", channel.name()));
    }
    // Another calibration gives another path; by the paper's D it has no speed.
    set(&mut harness, |settings| {
        settings.calibration = settings.calibration.with_method(Method::InterPrism);
    });
    let by_d = shown(&harness).way.newest.clone().expect("made");
    assert!(by_d.instants.iter().all(|at| at.speed_m_per_s.is_none()));
    harness.get_by_label("Not determined by this result.");
}

#[test]
fn of_two_dropped_trajectories_the_window_says_which_is_better_and_where_one_is_wrong() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let vio = write_slam(&harness, folder.path(), "vio.tum", 0.03, 0.4);
    let before = shown(&harness).analysis_run;
    send(&mut harness, DeploymentCommand::OpenPaths(vec![vio.clone(), lio.clone()]));
    // Reading, evaluation and drawing are sequential.
    settle(&mut harness);
    assert_eq!(shown(&harness).analysis_run, before, "the deployment itself is as it was");
    harness.get_by_label_contains("lio is better in position");
    assert!(harness.query_all_by_label_contains("lio better, ").count() > 1);
    harness.get_by_label("position errors of lio over time");
    harness.get_by_label_contains("the estimate is wrong: the readings agree with the rig");
    let judged: Vec<&str> =
        shown(&harness).judging.judged().map(|(_, one)| &*one.estimate.name).collect();
    assert_eq!(judged, ["lio", "vio"], "by name, whatever the order in which they were dropped");
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "estimates-errors-dark");
    snapshot_of(&mut harness, Part::Pane(Pane::Evaluation), "estimates-evaluation-dark");
    // The span's button leads there.
    let span = {
        let label = "Look at vio";
        harness.get_by_label_contains(label).click();
        settle(&mut harness);
        shown(&harness).timeline.selection_s.expect("selected")
    };
    assert!((4.0..6.5).contains(&(span[1] - span[0])), "{span:?}");
    // Other options give another evaluation.
    let similarity = Options { alignment: TrajectoryAlignment::Similarity, ..Options::default() };
    click(&mut harness, "scale too");
    assert!(shown(&harness).judging.added.iter().all(|one| one.options == similarity));
    harness.get_by_label("scale");
    click(&mut harness, "Remove vio");
    settle(&mut harness);
    assert!(harness.query_by_label("position errors of vio over time").is_none());
    click(&mut harness, "Remove lio");
    assert!(shown(&harness).judging.judgement.newest.is_none());
}

#[test]
fn trajectories_are_drawn_in_the_scene_and_kept_by_sessions() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Light);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    send(&mut harness, JudgingCommand::Add(vec![lio.clone()]));
    settle(&mut harness);
    harness.get_by_label("Show trajectories of other systems");
    snapshot_of(&mut harness, Part::Window, "estimates-light");
    let hidden = Visibility { estimates: false, ..harness.state().state.scene.visibility };
    send(&mut harness, SceneCommand::Show(hidden));
    harness.get_by_label_contains("hidden: trajectories");
    let session = harness.state().state.session();
    assert_eq!(session.deployments[0].estimates.len(), 1);
    assert_eq!(session.deployments[0].estimates[0].path, lio);
    let mut again = window(SMALL, Theme::Light);
    again.state_mut().state.restore(session);
    settle(&mut again);
    settle(&mut again);
    assert_eq!(shown(&again).judging.judged().count(), 1);
}

#[test]
fn what_cannot_be_judged_says_why() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Light);
    // The user opens the sample: it does not give way to trajectories of another time.
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Warthog));
    let elsewhere = folder.path().join("elsewhere.tum");
    let line = |i: u32| {
        format!(
            "{} {} {} 0 0 0 0 1\n",
            1e3 + 0.1 * f64::from(i),
            0.1 * f64::from(i),
            f64::from(i % 7)
        )
    };
    std::fs::write(&elsewhere, (0..500).map(line).collect::<String>()).expect("written");
    send(&mut harness, DeploymentCommand::OpenPaths(vec![elsewhere]));
    settle(&mut harness);
    harness.get_by_label_contains("not judged: elsewhere: ");
}

/// The tube is computed on request, with the enlargement of the ellipsoids.
#[test]
fn a_tube_tells_how_well_the_way_is_known() {
    let mut harness = window(LARGE, Theme::Dark);
    click(&mut harness, "Show the tube of the vehicle");
    assert!(harness.state().state.scene.visibility.tube);
    assert!(shown(&harness).way.newest.is_some());
    let alone = Visibility {
        raw: false,
        tracks: false,
        poses: false,
        control_points: false,
        ..harness.state().state.scene.visibility
    };
    send(&mut harness, SceneCommand::Show(alone));
    snapshot_of(&mut harness, Part::Pane(Pane::Scene), "tube-dark");
}

/// The pose at the cursor comes from the joint estimate, with its σ; the paper's comes from one triplet, without a path.
#[test]
fn the_pose_in_the_scene_says_what_it_is_from_and_how_well_it_is_known() {
    let mut harness = window(LARGE, Theme::Light);
    assert!(shown(&harness).timeline.cursor_s.is_some() && shown(&harness).way.newest.is_some());
    let said = |harness: &Window, by: &str| {
        harness.get_by_label_contains(by).accesskit_node().label().expect("the strip")
    };
    let strip = said(&harness, "pose by the joint estimate");
    let of = |what: &str| strip.split(" · ").find(|part| part.contains(what)).expect("told");
    assert!(of(" x ").contains("± ") && of("heading").contains("± "), "{strip}");

    set(&mut harness, |settings| settings.calibration.method = Some(Method::InterPrism));
    let strip = said(&harness, "pose by one triplet");
    assert!(!strip.contains('±'), "{strip}");
}

/// An evaluation is no more reliable than its ground truth, whose verdict is shown above it.
#[test]
fn a_doubtful_ground_truth_is_said_above_what_it_judges() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Warthog));
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let mut deployment = Sample::Warthog.open().expect("built in");
    // Station 3 is rotated by 3 mrad halfway.
    let readings = &mut deployment.tracks[2].measurements;
    let half = readings.len() / 2;
    readings[half..].iter_mut().for_each(|reading| reading.azimuth_rad += 3e-3);
    open(&mut harness, deployment);
    send(&mut harness, JudgingCommand::Add(vec![lio]));
    settle(&mut harness);
    harness.get_by_label_contains("so these results are no more reliable");
}

/// Known clock offsets and lever arms are entered like any other number, and errors can be plotted over the distance driven.
#[test]
fn what_is_known_of_an_estimate_can_be_given_and_its_errors_shown_by_distance() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let vio = write_slam(&harness, folder.path(), "vio.tum", 0.03, 0.4);
    send(&mut harness, JudgingCommand::Add(vec![lio, vio]));
    settle(&mut harness);
    click(&mut harness, "off by");
    click(&mut harness, "at");
    let options = |harness: &Window| shown(harness).judging.added[0].options;
    let given = options(&harness);
    assert_eq!(given.time_offset_s, Some(0.0));
    assert_eq!(given.body, Body::Lever(Vector3::zeros()));
    let fit =
        |harness: &Window| shown(harness).judging.judged().next().expect("judged").1.fit.clone();
    assert!(
        fit(&harness).lever_arm_sigma_m.is_none() && fit(&harness).time_offset_sigma_s.is_none()
    );
    harness.get_by_role_and_label(Role::SpinButton, "x").click();
    harness.run_steps(2);
    type_and_enter_at_once(&mut harness, "0,25");
    settle(&mut harness);
    let lever_m = Vector3::new(0.25, 0.0, 0.0);
    assert_eq!(options(&harness).body, Body::Lever(lever_m));
    assert_eq!(fit(&harness).lever_arm_m, Some(lever_m));

    click(&mut harness, "Show…");
    click(&mut harness, "by distance");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.query_by_label("position errors of lio over time").is_none());
    let driven = "position errors of lio over the driven way";
    let place = harness.get_by_label(driven).rect();
    let before_s = shown(&harness).timeline.cursor_s;
    harness.get_by_label(driven).click();
    settle(&mut harness);
    assert!(place.height() > 50.0 && shown(&harness).timeline.cursor_s != before_s);
    click(&mut harness, "Show…");
    click(&mut harness, "one scale");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().state.time.plots.one_scale);
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "estimates-by-distance-dark");
}

/// Changes of trajectories are undone and redone like any other setting, with any deployment active.
#[test]
fn what_is_done_with_trajectories_can_be_undone() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let vio = write_slam(&harness, folder.path(), "vio.tum", 0.03, 0.4);
    let names = |harness: &Window| -> Vec<String> {
        let judged = shown(harness).judging.judged();
        judged.map(|(colour, one)| format!("{} {colour}", one.estimate.name)).collect()
    };
    let next = |harness: &Window| {
        let state = &harness.state().state;
        state.deployments.undo.undo_name(state.workspace.units)
    };
    send(&mut harness, DeploymentCommand::OpenPaths(vec![lio, vio]));
    settle(&mut harness);
    assert_eq!(next(&harness), "Undo trajectory added: lio, vio");
    click(&mut harness, "Remove lio");
    assert_eq!(names(&harness), ["vio 1"]);
    // A free colour number is given to the next trajectory, and returns with its owner.
    send(&mut harness, DeploymentCommand::Undo);
    settle(&mut harness);
    assert_eq!(names(&harness), ["lio 0", "vio 1"]);

    click(&mut harness, "Show the trajectory vio");
    assert_eq!(next(&harness), "Undo trajectory hidden: vio");
    harness.get_by_label_contains("hidden: trajectory vio");
    let run = shown(&harness).judging.version;
    send(&mut harness, DeploymentCommand::Undo);
    assert!(harness.query_by_label_contains("hidden: trajectory vio").is_none());
    assert_eq!(shown(&harness).judging.version, run, "what is hidden is judged as it was");

    click(&mut harness, "off by");
    assert_eq!(next(&harness), "Undo clock: lio, vio");
    click(&mut harness, "scale too");
    send(&mut harness, DeploymentCommand::Undo);
    let judging = &shown(&harness).judging;
    assert!(judging.added.iter().all(|one| one.options.alignment == TrajectoryAlignment::Rigid));
    assert!(judging.judged().all(|(_, one)| one.fit.time_offset_sigma_s.is_none()));
    send(&mut harness, DeploymentCommand::Undo);
    settle(&mut harness);
    let judging = &shown(&harness).judging;
    assert!(judging.judged().all(|(_, one)| one.fit.time_offset_sigma_s.is_some()));

    send(&mut harness, DeploymentCommand::Undo);
    assert!(shown(&harness).judging.added.is_empty());
    assert!(harness.query_by_label("position errors of lio over time").is_none());
    for _ in 0..3 {
        send(&mut harness, DeploymentCommand::Redo);
    }
    settle(&mut harness);
    let judging = &shown(&harness).judging;
    assert!(judging.added.iter().all(|one| one.options.time_offset_s == Some(0.0)));
    assert!(
        judging.added.iter().all(|one| one.options.alignment == TrajectoryAlignment::Similarity)
    );
    assert_eq!(names(&harness), ["lio 0", "vio 1"]);
}

/// Two systems have two clocks and two bodies; a session stores the known values of each.
#[test]
fn each_trajectory_has_a_clock_and_a_body_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Light);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let vio = write_slam(&harness, folder.path(), "vio.tum", 0.03, 0.4);
    send(&mut harness, JudgingCommand::Add(vec![lio, vio]));
    settle(&mut harness);
    click(&mut harness, "Options of vio only");
    click(&mut harness, "scale too");
    click(&mut harness, "the vehicle's frame");
    let wanted = Options {
        alignment: TrajectoryAlignment::Similarity,
        time_offset_s: None,
        body: Body::Same,
        ..Options::default()
    };
    let options = |harness: &Window| -> Vec<Options> {
        shown(harness).judging.added.iter().map(|one| one.options).collect()
    };
    assert_eq!(options(&harness), [Options::default(), wanted]);
    let fits = |harness: &Window| -> Vec<bool> {
        shown(harness)
            .judging
            .judged()
            .map(|(_, one)| one.fit.lever_arm_sigma_m.is_some())
            .collect()
    };
    assert_eq!(fits(&harness), [true, false], "the one has its lever arm found, the other given");
    harness.get_all_by_label("aligned by").nth(1).expect("a line of the table says so");
    // The common settings show no choice where the trajectories differ; a new choice applies to all.
    click(&mut harness, "Options of all trajectories");
    click(&mut harness, "nothing");
    assert!(options(&harness).iter().all(|one| one.alignment == TrajectoryAlignment::None));
    assert_eq!(options(&harness)[1].body, Body::Same);
    send(&mut harness, DeploymentCommand::Undo);

    click(&mut harness, "Show the trajectory lio");
    let session = harness.state().state.session();
    let mut again = window(SMALL, Theme::Light);
    again.state_mut().state.restore(session);
    settle(&mut again);
    settle(&mut again);
    assert_eq!(options(&again), [Options::default(), wanted]);
    let drawn: Vec<bool> = shown(&again).judging.added.iter().map(|one| one.shown).collect();
    assert_eq!(drawn, [false, true]);
}

/// One prism has a position and no heading: undetermined quantities have no values, for the vehicle and for the evaluated trajectories.
#[test]
fn one_prism_judges_positions_and_claims_no_heading() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let simulated = simulate(Preset::SinglePrism, 2);
    open(&mut harness, resect_io::simulation_files::open(&simulated).expect("valid"));
    let [lio, vio] = ["lio.tum", "vio.tum"].map(|name| folder.path().join(name));
    write_tum(&Slam { drift_m: 0.0, ..SLAM }.drive(&simulated), &lio);
    write_tum(&Slam { noise_m: 0.04, drift_m: 0.0, seed: 2, ..SLAM }.drive(&simulated), &vio);
    send(&mut harness, JudgingCommand::Add(vec![lio, vio]));
    settle(&mut harness);
    harness.get_by_label_contains("lio is better in position");
    harness.get_by_label("lever arm, z (mm)");
    // The row stays, with the reason of its empty cells.
    harness.get_by_label_contains("APE rotation");
    for (_, one) in shown(&harness).judging.judged() {
        assert!(one.rotation.is_none());
        let off_m = one.fit.lever_arm_m.expect("found") - simulated.truth.prisms_m[0];
        let sigma_m = one.fit.lever_arm_sigma_m.expect("found");
        assert!(off_m.component_div(&sigma_m).amax() < 4.0, "{off_m} {sigma_m}");
    }
    let all = ChannelPlots::of(&Channel::ALL[..Channel::OF_VEHICLE]);
    send(&mut harness, TimeCommand::Plot(all));
    let unknown = harness.get_all_by_label("Not determined by this result.").count();
    assert_eq!(unknown, 4, "heading, roll, pitch and their σ");
}

/// The typical first action with a drive and two systems: all of them dropped at once.
#[test]
fn a_deployment_and_two_trajectories_are_dropped_together_and_judged() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let simulated = simulate(Preset::FigureEight, 4);
    let [drive, lio, vio] = ["drive", "lio.txt", "vio.tum"].map(|name| folder.path().join(name));
    write_folder(&simulated, &drive).expect("written");
    write_tum(&Slam { drift_m: 0.0, clock_s: 0.4, ..SLAM }.drive(&simulated), &lio);
    write_tum(&Slam { noise_m: 0.04, drift_m: 0.0, seed: 2, ..SLAM }.drive(&simulated), &vio);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![vio, drive, lio]));
    settle(&mut harness);
    settle(&mut harness);
    assert_eq!(shown(&harness).deployment.name, "figure-eight (simulated)");
    harness.get_by_label_contains("lio is better in position");
    assert!(harness.query_all_by_label_contains("lio better, ").count() > 1);
    let judging = &shown(&harness).judging;
    let (_, lio) = judging.judged().find(|(_, one)| one.estimate.name == "lio").expect("judged");
    let off_s = lio.fit.time_offset_s + 0.4;
    assert!(off_s.abs() < 4.0 * lio.fit.time_offset_sigma_s.expect("found"), "{off_s}");
}

/// Without a deployment: one of the dropped trajectories is the ground truth of the others.
#[test]
fn one_of_the_dropped_trajectories_becomes_the_ground_truth() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let simulated = simulate(Preset::FigureEight, 4);
    let files = ["truth.txt", "lio.txt", "vio.tum"].map(|name| folder.path().join(name));
    let exact = Slam { noise_m: 0.001, drift_m: 0.0, rate_hz: 100.0, ..SLAM };
    write_tum(&exact.drive(&simulated), &files[0]);
    write_tum(&Slam { drift_m: 0.0, clock_s: 0.4, ..SLAM }.drive(&simulated), &files[1]);
    let vio = Slam { noise_m: 0.04, drift_m: 0.0, seed: 2, ..SLAM };
    write_tum(&vio.drive(&simulated), &files[2]);
    send(&mut harness, DeploymentCommand::OpenPaths(files.to_vec()));
    settle(&mut harness);
    // Its name says that it is the ground truth. Another choice and back.
    for (button, truth) in [
        (None, "truth"),
        (Some("Use vio as the ground truth"), "vio"),
        (Some("Use truth as the ground truth"), "truth"),
    ] {
        if let Some(button) = button {
            click(&mut harness, button);
            settle(&mut harness);
        }
        let open = shown(&harness);
        assert_eq!((&*open.deployment.name, open.judging.added.len()), (truth, 2));
        assert_eq!(harness.state().state.deployments.open.len(), 1, "the sample gave way");
    }
    let (_, lio) = shown(&harness)
        .judging
        .judged()
        .find(|(_, one)| one.estimate.name == "lio")
        .expect("judged");
    assert!((lio.fit.time_offset_s + 0.4).abs() < 0.002, "{:?}", lio.fit);
    harness.get_by_label_contains("lio is better in position");
    harness.get_by_label_contains("poses, as chosen");
    // A session names the file of the ground truth.
    let place = shown(&harness).source.as_ref().map(|source| source.place.clone());
    assert!(matches!(place, Some(Place::GroundTruth(_))), "{place:?}");
}

/// One station is no calibration, but its readings are shown, and its prism is a ground truth.
#[test]
fn a_deployment_of_one_station_is_shown_and_judges() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(SMALL, Theme::Light);
    let simulated = simulate(Preset::FigureEight, 4);
    write_folder(&simulated, folder.path()).expect("written");
    let tracks = folder.path().join("inter_prism.csv");
    let text = std::fs::read_to_string(&tracks).expect("written");
    let of_station_2 =
        |line: &&str| line.starts_with("timestamp") || line.split(',').nth(1) == Some("2");
    let rows: String = text.lines().filter(of_station_2).map(|row| format!("{row}\n")).collect();
    std::fs::write(&tracks, rows).expect("written");
    let slam = folder.path().join("slam.tum");
    write_tum(&Slam { drift_m: 0.0, ..SLAM }.drive(&simulated), &slam);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![folder.path().to_owned()]));
    settle(&mut harness);
    harness.get_by_label_contains("only station 2 has measurements");
    send(&mut harness, JudgingCommand::Add(vec![slam]));
    settle(&mut harness);
    let (_, one) = shown(&harness).judging.judged().next().expect("judged");
    assert!(one.position.rmse < 0.05 && one.against_sigma.is_some(), "{:?}", one.position);
}

/// Systems often use the same file names: their folders distinguish them.
#[test]
fn trajectories_of_one_name_are_told_apart_by_their_folders() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let [lio, vio] = [("lio", 0.01), ("vio", 0.03)].map(|(system, noise_m)| {
        let own = folder.path().join(system);
        std::fs::create_dir(&own).expect("made");
        write_slam(&harness, &own, "trajectory.tum", noise_m, 0.0)
    });
    send(&mut harness, JudgingCommand::Add(vec![lio.clone()]));
    settle(&mut harness);
    harness.get_by_label("Remove trajectory");
    send(&mut harness, JudgingCommand::Add(vec![vio, lio]));
    settle(&mut harness);
    harness.get_all_by_label("lio/trajectory").next().expect("a column");
    assert!(harness.query_all_by_label_contains("lio/trajectory better, ").count() > 1);
    assert_eq!(shown(&harness).judging.added.len(), 2, "none is there twice");
    click(&mut harness, "Remove vio/trajectory");
    settle(&mut harness);
    assert_eq!(shown(&harness).judging.judged().count(), 1);
}

/// The message offers the remedy that the evaluation needs.
#[test]
fn the_paper_s_answer_has_no_motion_and_leads_to_one_that_has() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let lio = write_slam(&harness, folder.path(), "lio.tum", 0.01, 0.0);
    let vio = write_slam(&harness, folder.path(), "vio.tum", 0.03, 0.0);
    set(&mut harness, |settings| {
        settings.calibration = settings.calibration.with_method(Method::InterPrism);
    });
    send(&mut harness, JudgingCommand::Add(vec![lio, vio]));
    settle(&mut harness);
    click(&mut harness, "Use the joint estimate");
    settle(&mut harness);
    harness.get_by_label_contains("lio is better in position");
}

/// Runs of one set-up are drawn in one frame, and so are runs that share control points; others give the reason.
#[test]
fn other_open_runs_are_drawn_in_the_frame_of_this_one() {
    let mut harness = window(LARGE, Theme::Dark);
    let turned = knock(1, 1e-3, [0.0; 3]);
    let [first, second] = two_runs(Preset::Warthog.scenario(), 3, &[])
        .map(|run| resect_io::simulation_files::open(&run).expect("valid"));
    let [_, knocked] = two_runs(Preset::Warthog.scenario(), 3, &[turned])
        .map(|run| resect_io::simulation_files::open(&run).expect("valid"));
    let mut without_points = knocked.clone();
    without_points.control_points.clear();
    for deployment in [knocked, without_points, second, first] {
        open(&mut harness, deployment);
    }
    assert!(shown(&harness).beside.newest.is_none(), "nobody looks at it");
    click(&mut harness, "Show other open runs in this one's frame");
    let beside = shown(&harness).beside.newest.clone().expect("made");
    let by: Vec<Option<PlacedBy>> =
        beside.iter().map(|run| run.way.as_ref().ok().map(|(_, placed)| placed.by)).collect();
    assert!(matches!(by[0], Some(PlacedBy::ControlPoints { points: 3.., .. })), "{by:?}");
    assert_eq!(by[1..], [None, Some(PlacedBy::SetUp)]);
    harness.get_by_label_contains("not drawn: does not hold for");
    snapshot_of(&mut harness, Part::Pane(Pane::Scene), "runs-beside-dark");
    click(&mut harness, "Show other open runs in this one's frame");
    assert!(harness.query_by_label_contains("not drawn: does not hold for").is_none());
}
