//! A live deployment in the window: connected, growing, stopped, and saved.

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, LiveCommand, LiveForm, Pane, TimeCommand, WorkspaceCommand};
use resect_core::calibration::Method;
use resect_core::network::PerStation;

use crate::common::sample_folder;
use crate::harness::{LARGE, SMALL, Window, click, send, settle, shown, window};

fn form(record: Option<std::path::PathBuf>) -> LiveForm {
    LiveForm {
        replay: Some(sample_folder("hd2-tunnel")),
        speed: 40.0,
        record,
        ..LiveForm::default()
    }
}

/// Begins a replay by the button, and runs frames until it has begun.
fn replay(harness: &mut Window, record: Option<std::path::PathBuf>) {
    send(harness, LiveCommand::Show);
    send(harness, LiveCommand::Edit(form(record)));
    click(harness, "Replay");
    until(harness, |window| window.state().state.live.is_running());
}

fn until(harness: &mut Window, is: impl Fn(&Window) -> bool) {
    while !is(harness) {
        harness.run_steps(1);
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
}

fn has_answer(harness: &Window) -> bool {
    harness
        .state()
        .state
        .live
        .view
        .as_ref()
        .is_some_and(|view| view.answer.as_ref().is_some_and(|judged| judged.far_end.is_some()))
}

#[test]
fn a_replay_grows_in_the_window_and_stays_when_it_is_stopped() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    let mut harness = window(LARGE, Theme::Dark);
    replay(&mut harness, Some(file.clone()));
    assert!(harness.state().layout().holds(Pane::Live));
    until(&mut harness, has_answer);
    let id = shown(&harness).id;
    let before: usize = shown(&harness).deployment.tracks[0].measurements.len();
    // The tracks grow in the open deployment, and the calibration uses them.
    until(&mut harness, |window| shown(window).deployment.tracks[0].measurements.len() > before);
    assert_eq!(shown(&harness).id, id);
    let analysis = shown(&harness).analysis.clone().expect("never without an answer");
    let fates = analysis.pipeline.fates.map(|fates| fates.each.len());
    let tracks = shown(&harness).deployment.tracks.map(|t| t.measurements.len());
    assert_eq!(fates, tracks, "answer and readings belong together");
    assert!(harness.query_all_by_label_contains(" (live)").count() > 0, "named as what it is");
    // Beside σ, and in the legend of its curve.
    harness.get_by_label_contains("target 2.0 mm");
    harness.get_by_label_contains("target\u{a0}2.0\u{a0}mm");
    click(&mut harness, "Stop");
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    let open = shown(&harness);
    assert_eq!((open.id, open.source.as_ref().and_then(|s| s.path())), (id, Some(&*file)));
    assert!(open.analysis.is_some() && open.analysing.is_none());
    // The last report covers all readings, as the shown deployment does.
    let last = harness.state().state.live.view.as_ref().and_then(|view| view.answer.clone());
    let answer = open.analysis.as_ref().and_then(|analysis| analysis.answer.clone().ok());
    let [last, answer] = [
        last.map(|judged| judged.station1_from_station.clone()),
        answer.map(|answer| answer.calibration.station1_from_station.clone()),
    ];
    assert_eq!(last.expect("judged"), answer.expect("calibrated"));
    // The recording equals the shown deployment.
    let recorded = open.source.clone().expect("recorded").open(&Default::default()).expect("opens");
    assert_eq!(recorded.tracks, open.deployment.tracks);
}

/// The paper's calibration of each snapshot comes first; drawn for a moment it would contradict the sentence beside it.
#[test]
fn what_is_drawn_while_it_grows_is_of_the_answer_that_is_told() {
    let mut harness = window(LARGE, Theme::Dark);
    replay(&mut harness, None);
    until(&mut harness, |window| has_answer(window) && shown(window).answered);
    let readings = |window: &Window| shown(window).deployment.tracks[0].measurements.len();
    let before = readings(&harness);
    until(&mut harness, |window| {
        let analysis = shown(window).analysis.as_ref().expect("answered");
        let method = analysis.answer.as_ref().map(|answer| answer.calibration.method);
        assert_eq!(method.ok(), Some(Method::Joint));
        readings(window) > before + 60
    });
    let view = harness.state().state.live.view.clone().expect("live");
    assert!(view.first.is_some(), "the paper's answers are followed all the same");
}

#[test]
fn the_cursor_goes_with_what_comes_until_it_is_moved() {
    let mut harness = window(LARGE, Theme::Dark);
    replay(&mut harness, None);
    until(&mut harness, has_answer);
    let cursor_s = |window: &Window| shown(window).timeline.cursor_s.expect("a cursor");
    let now_s = |window: &Window| shown(window).now_s();
    let before_s = now_s(&harness);
    until(&mut harness, |window| now_s(window) > before_s + 5.0);
    assert_eq!(cursor_s(&harness), now_s(&harness));
    let early_s = shown(&harness).start_s() + 3.0;
    send(&mut harness, TimeCommand::MoveCursor(early_s));
    let before_s = now_s(&harness);
    until(&mut harness, |window| now_s(window) > before_s + 5.0);
    assert_eq!(cursor_s(&harness), early_s, "who looks back is left alone");
    click(&mut harness, "Now");
    let before_s = now_s(&harness);
    until(&mut harness, |window| now_s(window) > before_s + 5.0);
    assert_eq!(cursor_s(&harness), now_s(&harness));
}

#[test]
fn a_replay_that_ends_by_itself_is_the_whole_deployment() {
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, LiveCommand::Edit(LiveForm { speed: 1000.0, ..form(None) }));
    send(&mut harness, LiveCommand::Connect);
    until(&mut harness, |window| window.state().state.live.is_running());
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    let whole = resect_io::sample::Sample::Hd2Tunnel.open().expect("built in");
    assert_eq!(shown(&harness).deployment.tracks, whole.tracks);
    // A session reopens the replayed deployment, because a replay is not recorded.
    let source = shown(&harness).source.clone().expect("on disk");
    assert_eq!(source.path(), Some(&*sample_folder("hd2-tunnel")));
}

#[test]
fn what_cannot_be_connected_is_said_where_it_is_asked() {
    let mut harness = window(LARGE, Theme::Light);
    send(&mut harness, LiveCommand::Show);
    let address = "http://robot".to_owned();
    send(&mut harness, LiveCommand::Edit(LiveForm { address, ..LiveForm::default() }));
    click(&mut harness, "Connect");
    until(&mut harness, |window| window.state().state.live.trouble.is_some());
    harness.run_steps(2);
    harness.get_by_label_contains("it begins with ws://");
    assert!(!harness.state().state.live.is_running());
}

#[test]
fn in_the_sun_type_is_large_and_back_again() {
    let mut harness = window(LARGE, Theme::Light);
    send(&mut harness, WorkspaceCommand::ReadInTheSun(true));
    assert!(harness.ctx.zoom_factor() > 1.2);
    let ink = harness.ctx.style_of(Theme::Light).visuals.override_text_color;
    assert_eq!(ink, Some(egui::Color32::BLACK));
    send(&mut harness, WorkspaceCommand::ReadInTheSun(false));
    assert_eq!(harness.ctx.zoom_factor(), 1.0);
    assert_ne!(harness.ctx.style_of(Theme::Light).visuals.override_text_color, ink);
}

#[test]
fn who_closes_what_grows_ends_it_and_keeps_what_was_recorded() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    let mut harness = window(SMALL, Theme::Dark);
    replay(&mut harness, Some(file.clone()));
    until(&mut harness, |window| window.state().state.live.id.is_some());
    let id = shown(&harness).id;
    let others = harness.state().state.deployments.open.len() - 1;
    send(&mut harness, DeploymentCommand::Close(id));
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    assert_eq!(harness.state().state.deployments.open.len(), others);
    assert!(resect_io::open::open(&file).is_ok());
}

/// Last bytes of every completed MCAP file.
const END_OF_MCAP: &[u8] = b"\x89MCAP0\r\n";

fn is_whole(file: &std::path::Path) -> bool {
    std::fs::read(file).expect("there").ends_with(END_OF_MCAP)
}

#[test]
fn a_window_that_is_closed_leaves_a_whole_recording() {
    let folder = tempfile::tempdir().expect("a folder");
    // During the recording, and while it is being completed.
    for stops_first in [false, true] {
        let file = folder.path().join(format!("{stops_first}.mcap"));
        let mut harness = window(SMALL, Theme::Dark);
        replay(&mut harness, Some(file.clone()));
        until(&mut harness, |window| window.state().state.live.id.is_some());
        assert!(!is_whole(&file), "it is still written");
        if stops_first {
            let ctx = harness.ctx.clone();
            harness.state_mut().send(LiveCommand::Stop, &ctx);
        }
        eframe::App::on_exit(harness.state_mut());
        assert!(is_whole(&file), "stopped first: {stops_first}");
        assert!(!harness.state().state.live.is_running());
        let tracks = resect_io::open::open(&file).expect("opens").tracks;
        assert!(tracks.iter().all(|track| !track.measurements.is_empty()));
    }
}

#[test]
fn what_is_corrections_while_it_is_live_holds_for_what_comes() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    let mut harness = window(SMALL, Theme::Dark);
    replay(&mut harness, Some(file.clone()));
    until(&mut harness, has_answer);
    let firsts =
        |window: &Window| shown(window).deployment.tracks.map(|track| track.measurements[0]);
    let lengths =
        |window: &Window| shown(window).deployment.tracks.map(|track| track.measurements.len());
    let before = firsts(&harness);
    let exchanged = PerStation::from([before[0], before[2], before[1]]);
    let mut extras = harness.state().state.extras().expect("recorded").clone();
    extras.corrections.stations = Some([1, 3, 2].into());
    send(&mut harness, DeploymentCommand::Correct(extras.clone()));
    // A second change comes before the first one is read.
    extras.corrections.inter_prism_m = Some([0.4, 0.4, 0.4].into());
    send(&mut harness, DeploymentCommand::Correct(extras.clone()));
    let rig_m =
        |window: &Window| shown(window).deployment.rig.clone().expect("a rig").inter_prism_m;
    until(&mut harness, |window| firsts(window) == exchanged && rig_m(window) == [0.4; 3].into());
    let then = lengths(&harness);
    // The correction applies to later snapshots and at the end.
    until(&mut harness, |window| lengths(window)[0] > then[0] + 20);
    assert_eq!((firsts(&harness), rig_m(&harness)), (exchanged.clone(), [0.4; 3].into()));
    // It can be undone like any other change.
    send(&mut harness, DeploymentCommand::Undo);
    until(&mut harness, |window| rig_m(window) != [0.4; 3].into());
    assert_eq!(firsts(&harness), exchanged);
    click_stop(&mut harness);
    let open = shown(&harness);
    assert_eq!(firsts(&harness), exchanged);
    let again = open.source.clone().expect("recorded").open(&Default::default()).expect("opens");
    assert_eq!(again.tracks, open.deployment.tracks);
    assert_eq!(again.rig, open.deployment.rig);
}

fn click_stop(harness: &mut Window) {
    send(harness, LiveCommand::Stop);
    until(harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(harness);
}
