//! The window through crashes and session files: the session is restored, and nothing of it is lost.

use resect::app::kinds;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::persist::hashes::HashCache;
use resect::app::persist::{Folders, session_file};
use resect::app::saved_state::SavedState;
use resect::app::{
    Colouring, DeploymentCommand, LayoutPreset, Overlay, Pane, ResultsCommand, SceneCommand,
    SessionCommand, Start, TimeCommand, WorkspaceCommand,
};
use resect_core::analysis::Settings;
use resect_io::sample::Sample;
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{SMALL, Window, click, send, settle, window_from};

/// Returns a window that saves its session in this folder, or does not save it.
fn window(start: &Start, kept_in: Option<&Path>) -> Window {
    // Saves in every frame, so that no test has to wait.
    let keeping = kept_in
        .map(|folder| SavedState::start(&Folders::inside(folder)).every(std::time::Duration::ZERO));
    let mut harness = window_from(SMALL, Theme::Dark, start, keeping);
    // A session opens its deployments, and then calibrates them.
    settle(&mut harness);
    harness
}

/// A simulated deployment in a folder of its own.
fn data(folder: &Path, name: &str) -> PathBuf {
    let path = folder.join(name);
    write_folder(&simulate(Preset::FigureEight, 1), &path).expect("written");
    path
}

fn names(harness: &Window) -> Vec<String> {
    harness.state().state.deployments.open.iter().map(|open| open.deployment.name.clone()).collect()
}

/// Opens two deployments; the first is shown, with changed settings, a pinned result and a changed view.
fn prepare(harness: &mut Window, path: &Path) -> Settings {
    send(harness, DeploymentCommand::OpenPaths(vec![path.to_owned()]));
    send(harness, DeploymentCommand::OpenSample(Sample::Hd2Tunnel));
    let first = harness.state().state.deployments.open[0].id;
    send(harness, DeploymentCommand::Activate(first));
    let mut settings = Settings::default();
    settings.pipeline.thresholds.tau_s_seconds = 1.5;
    send(harness, DeploymentCommand::Set(settings));
    send(harness, ResultsCommand::Pin);
    send(harness, SceneCommand::Colour(Colouring::Speed));
    send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
    settings
}

fn assert_is_back(harness: &Window, expected: &[String], settings: Settings) {
    let state = &harness.state().state;
    assert_eq!(names(harness), expected);
    assert_eq!(
        state.active().map(|open| open.id),
        Some(state.deployments.open[0].id),
        "the first is shown"
    );
    assert_eq!(state.deployments.open[0].settings, settings);
    assert_eq!(state.deployments.open[1].settings, Settings::default());
    assert!(state.deployments.open.iter().all(|open| open.summary.is_some()), "all are calibrated");
    assert_eq!(state.results.pins.len(), 1);
    assert_eq!(state.results.pins[0].summary.settings, settings);
    assert_eq!(state.scene.colouring, Colouring::Speed);
    let now = harness.state().layout();
    assert!(now.holds(Pane::Rates) && !now.holds(Pane::SideBySide), "the layout for tuning");
}

#[test]
fn what_was_open_comes_back_after_a_crash_and_not_after_a_clean_exit() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = Some(folder.path());
    let path = data(folder.path(), "figure-eight");
    let sample = Start::Sample(Sample::Warthog);
    let mut harness = window(&sample, kept);
    let settings = prepare(&mut harness, &path);
    let expected = names(&harness);
    // Dropped without an exit, as by a crash.
    drop(harness);

    let mut harness = window(&sample, kept);
    assert_is_back(&harness, &expected, settings);
    let toasts = harness.state().state.toasts.shown();
    let said = toasts.iter().find(|toast| toast.text.contains("restored")).expect("said");
    assert!(said.text.contains("figure-eight, HD2 in a tunnel"), "{}", said.text);
    assert!(said.detail.contains("UTC"), "{}", said.detail);
    let recent = &harness.state().state.session.recent;
    assert_eq!(recent.len(), 1);
    eframe::App::on_exit(harness.state_mut());
    drop(harness);
    let left = std::fs::read_dir(folder.path().join("autosave")).expect("a folder").count();
    assert_eq!(left, 0);

    let harness = window(&sample, kept);
    assert_eq!(harness.state().state.deployments.open.len(), 1, "only the sample");
    assert_eq!(harness.state().state.session.recent.len(), 1, "preferences stay");
    assert!(!harness.state().layout().holds(Pane::SideBySide), "the layout stays");
}

#[test]
fn what_a_crash_left_can_be_discarded_and_that_taken_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = Some(folder.path());
    let path = data(folder.path(), "figure-eight");
    let sample = Start::Sample(Sample::Warthog);
    let mut harness = window(&sample, kept);
    let settings = prepare(&mut harness, &path);
    let expected = names(&harness);
    drop(harness);

    let mut harness = window(&sample, kept);
    // The message does not disappear by itself.
    harness.run_steps(200);
    harness.get_by_label("Discard").click();
    settle(&mut harness);
    assert!(names(&harness).is_empty() && harness.state().state.results.pins.is_empty());
    assert!(harness.query_by_label("Discard").is_none());
    send(&mut harness, SessionCommand::ReopenLast);
    assert_is_back(&harness, &expected, settings);
}

#[test]
fn the_title_says_what_is_shown_in_which_session_and_whether_that_is_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(&Start::Sample(Sample::Warthog), None);
    let title = |harness: &Window| harness.state().state.title();
    assert_eq!(title(&harness), "warthog (simulated) – resect");
    send(&mut harness, DeploymentCommand::OpenPaths(vec![data(folder.path(), "figure-eight")]));
    assert_eq!(title(&harness), "figure-eight (simulated) – session not saved – resect");
    harness.state_mut().state.session.path = Some(folder.path().join("a.resect.toml"));
    send(&mut harness, SessionCommand::Save);
    let saved = "figure-eight (simulated) – a.resect.toml – resect";
    assert_eq!(title(&harness), saved);
    send(&mut harness, TimeCommand::StepCursor(5));
    assert_eq!(title(&harness), saved, "looking about changes nothing");
    let mut settings = Settings::default();
    settings.pipeline.thresholds.tau_s_seconds = 1.5;
    send(&mut harness, DeploymentCommand::Set(settings));
    assert!(title(&harness).contains("changed since it was saved"));
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(title(&harness), saved);
}

#[test]
fn a_session_keeps_what_cannot_be_opened_and_names_what_changed() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = data(folder.path(), "figure-eight");
    let file = folder.path().join("a.resect.toml");
    let mut harness = window(&Start::Sample(Sample::Warthog), None);
    let settings = prepare(&mut harness, &path);
    let expected = names(&harness);
    let save = |harness: &Window| {
        harness.state().state.session().save(&file, &HashCache::default()).expect("saved");
    };
    save(&harness);
    let start = Start::Session(file.clone());
    let harness = window(&start, None);
    assert_is_back(&harness, &expected, settings);
    drop(harness);

    // A finding names a changed file.
    let tracks = path.join("inter_prism.csv");
    let text = std::fs::read_to_string(&tracks).expect("simulated");
    let shorter = text.trim_end().rsplit_once('\n').expect("lines").0;
    std::fs::write(&tracks, shorter).expect("written");
    let harness = window(&start, None);
    let findings = &harness.state().state.deployments.open[0].deployment.findings;
    assert_eq!(findings[0].kind, kinds::SESSION_FILE_CHANGED, "{findings:?}");
    drop(harness);

    // A missing deployment stays in the session, through a save, until it is available again.
    let away = folder.path().join("away");
    std::fs::rename(&path, &away).expect("moved");
    let harness = window(&start, None);
    assert_eq!(names(&harness), expected[1..]);
    let state = &harness.state().state;
    let stays = |(text, remedy): (&str, &str)| (text.to_owned() + remedy).contains("stays in the");
    assert!(state.toasts.errors().any(stays));
    assert_eq!(state.session.missing.len(), 1);
    save(&harness);
    drop(harness);
    let (saved, _) = session_file::load(&file).expect("whole");
    assert_eq!(saved.deployments.len(), 2);
    std::fs::rename(&away, &path).expect("moved");
    let mut harness = window(&start, None);
    assert_eq!(names(&harness).len(), 2);
    let back = harness.state().state.deployments.open.iter().find(|open| open.settings == settings);
    assert!(back.is_some(), "with its settings");
    send(&mut harness, SessionCommand::RetryMissing);
    assert_eq!(names(&harness).len(), 2, "nothing is missing any more");
}

/// Crashes a window in this folder with a deployment open; returns its session's names.
fn die_with(folder: &Path, path: &Path) -> Vec<String> {
    let mut harness = window(&Start::Sample(Sample::Warthog), Some(folder));
    send(&mut harness, DeploymentCommand::OpenPaths(vec![path.to_owned()]));
    names(&harness)
}

fn warnings(harness: &Window) -> String {
    let toasts = harness.state().state.toasts.shown().iter();
    toasts.map(|toast| format!("{}; {}\n", toast.text, toast.detail)).collect()
}

#[test]
fn what_a_dead_window_had_open_waits_while_the_user_asks_for_something_else() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = Some(folder.path());
    let before = die_with(folder.path(), &data(folder.path(), "figure-eight"));
    let file = folder.path().join("other.resect.toml");
    let mut other = window(&Start::Sample(Sample::Warthog), None);
    send(&mut other, DeploymentCommand::OpenSample(Sample::Hd2Tunnel));
    other.state().state.session().save(&file, &HashCache::default()).expect("saved");
    let tunnel = Arc::new(Sample::Hd2Tunnel.open().expect("built in"));
    let named = vec![(Arc::clone(&tunnel), Source::sample(Sample::Hd2Tunnel))];
    for start in [Start::Session(file), Start::Deployments(named)] {
        let mut harness = window(&start, kept);
        assert_eq!(names(&harness), std::slice::from_ref(&tunnel.name));
        let said = warnings(&harness);
        assert!(said.contains("the next window that opens without a file"), "{said}");
        eframe::App::on_exit(harness.state_mut());
    }
    assert_eq!(names(&window(&Start::Sample(Sample::Warthog), kept)), before);
}

#[test]
fn what_was_open_at_a_clean_exit_can_be_opened_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let kept = Some(folder.path());
    let path = data(folder.path(), "figure-eight");
    let sample = Start::Sample(Sample::Warthog);
    let mut harness = window(&sample, kept);
    let has_entry = |harness: &mut Window| {
        harness.get_by_label("File").click();
        harness.run_steps(2);
        let has = harness.query_by_label("Reopen the last session").is_some();
        harness.get_by_label("File").click();
        harness.run_steps(2);
        has
    };
    assert!(!has_entry(&mut harness), "nothing was open before");
    let settings = prepare(&mut harness, &path);
    let expected = names(&harness);
    eframe::App::on_exit(harness.state_mut());
    drop(harness);

    // A window that shows only the sample does not change the saved session.
    let mut harness = window(&sample, kept);
    eframe::App::on_exit(harness.state_mut());
    drop(harness);

    let mut harness = window(&sample, kept);
    assert!(has_entry(&mut harness));
    send(&mut harness, SessionCommand::ReopenLast);
    assert_is_back(&harness, &expected, settings);
    assert_eq!(harness.state().state.session.path, None, "the user saves elsewhere");
}

#[test]
fn what_a_session_takes_the_place_of_can_be_opened_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("other.resect.toml");
    let mut harness = window(&Start::Sample(Sample::Warthog), Some(folder.path()));
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Hd2Tunnel));
    let other = names(&harness);
    harness.state().state.session().save(&file, &HashCache::default()).expect("saved");
    let id = harness.state().state.deployments.open[0].id;
    send(&mut harness, DeploymentCommand::Close(id));
    let settings = prepare(&mut harness, &data(folder.path(), "figure-eight"));
    let expected = names(&harness);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![file.clone()]));
    assert_eq!(names(&harness), other);
    let state = &harness.state().state;
    assert!(state.results.pins.is_empty());
    let here = |run: &resect::app::Run| {
        state.deployments.open.iter().any(|open| open.id == run.deployment)
    };
    assert!(state.results.runs.iter().all(here), "no run of what is gone");
    send(&mut harness, SessionCommand::ReopenLast);
    assert_is_back(&harness, &expected, settings);
    // Reopening again restores the other session.
    send(&mut harness, SessionCommand::ReopenLast);
    assert_eq!(names(&harness), other);
}

#[test]
fn closing_the_window_waits_for_the_session_to_be_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.resect.toml");
    let mut harness = window(&Start::Sample(Sample::Warthog), None);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![data(folder.path(), "figure-eight")]));
    harness.state_mut().state.session.path = Some(file.clone());
    let ctx = harness.ctx.clone();
    harness.state_mut().send(SessionCommand::Save, &ctx);
    assert!(harness.state().state.is_busy());
    eframe::App::on_exit(harness.state_mut());
    assert_eq!(session_file::load(&file).expect("saved").0.deployments.len(), 1);
}

#[test]
fn type_that_is_large_in_the_sun_is_large_the_next_time() {
    let folder = tempfile::tempdir().expect("a folder");
    let (start, kept) = (Start::Sample(Sample::Warthog), Some(folder.path()));
    let mut harness = window(&start, kept);
    assert_eq!(harness.ctx.zoom_factor(), 1.0);
    send(&mut harness, WorkspaceCommand::ReadInTheSun(true));
    eframe::App::on_exit(harness.state_mut());
    drop(harness);
    let mut harness = window(&start, kept);
    assert!(harness.state().state.workspace.in_the_sun && harness.ctx.zoom_factor() > 1.2);
    let ink = harness.ctx.style_of(Theme::Light).visuals.override_text_color;
    assert_eq!(ink, Some(egui::Color32::BLACK));
    send(&mut harness, WorkspaceCommand::ReadInTheSun(false));
    eframe::App::on_exit(harness.state_mut());
    drop(harness);
    assert_eq!(window(&start, kept).ctx.zoom_factor(), 1.0);
}

/// Asks the window to close, as the system does.
fn close(harness: &mut Window) {
    let viewport = harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.push(egui::ViewportEvent::Close);
    harness.step();
    let viewport = harness.input_mut().viewports.entry(egui::ViewportId::ROOT).or_default();
    viewport.events.clear();
    settle(harness);
}

#[test]
fn a_window_with_an_unsaved_session_asks_once_before_it_closes() {
    let config = tempfile::tempdir().expect("a folder");
    let mut harness = window(&Start::Sample(Sample::Warthog), Some(config.path()));
    close(&mut harness);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None, "nothing would be lost");
    tune(&mut harness);
    close(&mut harness);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::Closing);
    click(&mut harness, "Cancel");
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
    close(&mut harness);
    click(&mut harness, "Close without saving");
    assert!(!harness.state().state.must_ask_before_closing(), "it was answered");

    // The setting holds for later windows.
    let mut harness = window(&Start::Sample(Sample::Warthog), Some(config.path()));
    send(&mut harness, WorkspaceCommand::AskBeforeClosing(false));
    drop(harness);
    let mut harness = window(&Start::Sample(Sample::Warthog), Some(config.path()));
    tune(&mut harness);
    close(&mut harness);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
}

fn tune(harness: &mut Window) {
    let mut settings = harness.state().state.deployments.open[0].settings;
    settings.pipeline.thresholds.tau_l_seconds += 1.0;
    send(harness, DeploymentCommand::Set(settings));
}

#[test]
fn a_closed_deployment_reopens_as_it_was() {
    let mut harness = window(&Start::Sample(Sample::Warthog), None);
    send(&mut harness, DeploymentCommand::OpenSample(Sample::Hd2Tunnel));
    tune(&mut harness);
    let (before, tuned) = (names(&harness), *harness.state().state.settings());
    let id = harness.state().state.active().expect("open").id;
    send(&mut harness, DeploymentCommand::Close(id));
    assert_ne!(names(&harness), before);
    send(&mut harness, DeploymentCommand::ReopenClosed);
    assert_eq!(names(&harness), before);
    assert_eq!(*harness.state().state.settings(), tuned);
    // Nothing else was closed.
    send(&mut harness, DeploymentCommand::ReopenClosed);
    assert_eq!(names(&harness), before);
}
