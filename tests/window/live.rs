//! A live deployment in the window: connected, grown, stopped, and kept.

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::{Command, LiveCommand, LiveForm, Pane};

use crate::common::sample_folder;
use crate::harness::{LARGE, SMALL, Window, click, send, settle, shown, window};

fn form(record: Option<std::path::PathBuf>) -> LiveForm {
    LiveForm {
        replay: Some(sample_folder("hd2-tunnel")),
        speed: 40.0,
        records: record.is_some(),
        record,
        ..LiveForm::default()
    }
}

/// Begins a replay by the button, and lets frames pass until something is the case.
fn replay(harness: &mut Window, record: Option<std::path::PathBuf>) {
    send(harness, Command::Live(LiveCommand::Show));
    send(harness, Command::Live(LiveCommand::Edit(form(record))));
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
    // The tracks grow where they are open, and the answer is of them.
    until(&mut harness, |window| shown(window).deployment.tracks[0].measurements.len() > before);
    assert_eq!(shown(&harness).id, id);
    let analysis = shown(&harness).analysis.clone().expect("never without an answer");
    let fates = analysis.pipeline.fates.each_ref().map(|fates| fates.each.len());
    let tracks = shown(&harness).deployment.tracks.each_ref().map(|t| t.measurements.len());
    assert_eq!(fates, tracks, "answer and readings belong together");
    harness.get_by_label_contains("target 2.0 mm");
    click(&mut harness, "Stop");
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    let open = shown(&harness);
    assert_eq!((open.id, open.source.as_ref().and_then(|s| s.path())), (id, Some(&*file)));
    assert!(open.analysis.is_some() && open.analysing.is_none());
    // What was recorded is what is shown.
    let recorded = open.source.clone().expect("recorded").open(&Default::default()).expect("opens");
    assert_eq!(recorded.tracks, open.deployment.tracks);
}

#[test]
fn a_replay_that_ends_by_itself_is_the_whole_deployment() {
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, Command::Live(LiveCommand::Edit(LiveForm { speed: 1000.0, ..form(None) })));
    send(&mut harness, Command::Live(LiveCommand::Connect));
    until(&mut harness, |window| window.state().state.live.is_running());
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    let whole = resect::deployment::Sample::Hd2Tunnel.open().expect("built in");
    assert_eq!(shown(&harness).deployment.tracks, whole.tracks);
}

#[test]
fn what_cannot_be_connected_is_said_where_it_is_asked() {
    let mut harness = window(LARGE, Theme::Light);
    send(&mut harness, Command::Live(LiveCommand::Show));
    let address = "http://robot".to_owned();
    send(
        &mut harness,
        Command::Live(LiveCommand::Edit(LiveForm {
            address,
            records: false,
            ..LiveForm::default()
        })),
    );
    click(&mut harness, "Connect");
    until(&mut harness, |window| window.state().state.live.trouble.is_some());
    harness.run_steps(2);
    harness.get_by_label_contains("it begins with ws://");
    assert!(!harness.state().state.live.is_running());
}

#[test]
fn in_the_sun_type_is_large_and_back_again() {
    let mut harness = window(LARGE, Theme::Light);
    send(&mut harness, Command::ReadInTheSun(true));
    assert!(harness.ctx.zoom_factor() > 1.2);
    let ink = harness.ctx.style_of(Theme::Light).visuals.override_text_color;
    assert_eq!(ink, Some(egui::Color32::BLACK));
    send(&mut harness, Command::ReadInTheSun(false));
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
    let others = harness.state().state.open.len() - 1;
    send(&mut harness, Command::Close(id));
    until(&mut harness, |window| {
        let live = &window.state().state.live;
        !live.is_running() && !live.is_changing
    });
    settle(&mut harness);
    assert_eq!(harness.state().state.open.len(), others);
    assert!(resect::deployment::open(&file).is_ok());
}
