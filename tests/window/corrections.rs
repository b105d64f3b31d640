//! Corrections of the readings: each changes the calibration, undo reverts it, the session stores it, and `deployment.toml` contains it.

use std::path::{Path, PathBuf};

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, Theme};
use egui_kittest::kittest::Queryable;
use resect::app::persist::hashes::HashCache;
use resect::app::persist::session_file;
use resect::app::{
    DeploymentCommand, LayoutPreset, Pane, Picked, TimeCommand, Units, WorkspaceCommand,
};
use resect_core::deployment::{AzimuthSense, Overrides, PrismConstants};
use resect_io::simulation_files::write_folder;
use resect_io::source::{Extras, Source};
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{
    LARGE, Part, SMALL, Window, press, send, settle, shown, snapshot_of, triplets, window,
};

/// Clicks a widget by its name, at any scroll position.
fn click(harness: &mut Window, name: &str) {
    harness.get_by_label(name).click_accesskit();
    settle(harness);
}

/// Replaces the number in a field.
fn enter(harness: &mut Window, name: &str, number: &str) {
    harness.get_by_role_and_label(Role::SpinButton, name).focus();
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(1);
    harness.event(Event::Text(number.to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(harness);
}

/// Returns a window with a simulated deployment in a folder of its own, with the rows of the corrections in view.
fn opened(folder: &Path) -> (Window, PathBuf) {
    let path = folder.join("drive");
    write_folder(&simulate(Preset::UnevenGround, 1), &path).expect("written");
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    click(&mut harness, "Corrections");
    (harness, path)
}

fn corrections(harness: &Window) -> Overrides {
    shown(harness).source.as_ref().expect("a source").extras.corrections.clone()
}

/// Returns station 3's position (m, station 1's frame); `None` without a calibration.
fn station3(harness: &Window) -> Option<[f64; 3]> {
    let answer = harness.state().state.analysed()?.1.answer.as_ref().ok()?;
    Some(answer.calibration.station1_from_station[2].translation_m.into())
}

fn undo_name(harness: &Window) -> String {
    harness.state().state.deployments.undo.undo_name(Units::default())
}

/// Applies a correction, expects another calibration, undoes it, and expects the first.
fn changes_and_comes_back(
    harness: &mut Window,
    name: &str,
    corrections_by: impl FnOnce(&mut Window),
    holds: impl Fn(&Overrides) -> bool,
) {
    let before = station3(harness);
    let (cursor_s, settings) = (shown(harness).timeline.cursor_s, shown(harness).settings);
    corrections_by(harness);
    assert!(holds(&corrections(harness)), "{name}: {:?}", corrections(harness));
    let after = station3(harness);
    assert_ne!(before, after, "{name}");
    assert!(undo_name(harness).starts_with(&format!("Undo {name}")), "{}", undo_name(harness));
    assert_eq!(shown(harness).settings, settings);
    assert_eq!(shown(harness).timeline.cursor_s, cursor_s);
    send(harness, DeploymentCommand::Undo);
    assert_eq!(station3(harness), before, "{name} is taken back");
    send(harness, DeploymentCommand::Redo);
    assert_eq!(station3(harness), after, "{name} is done again");
    click(harness, &format!("Reset: {}", line_of(name)));
    assert!(corrections(harness).is_empty(), "{:?}", corrections(harness));
    assert_eq!(station3(harness), before);
}

/// Returns the row of the pane for a name in the Edit menu.
fn line_of(name: &str) -> &'static str {
    match name {
        "prism constant" => "Prism constant",
        "inter-prism distances" => "Inter-prism distances",
        "station numbers" => "Station numbers",
        "azimuth" => "Azimuth turns",
        "span of time" => "Times that are used",
        _ => "Left out by hand",
    }
}

#[test]
fn each_correction_changes_the_answer_and_can_be_taken_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = opened(folder.path());
    let harness = &mut harness;
    changes_and_comes_back(
        harness,
        "prism constant",
        |harness| enter(harness, "Prism constant of all stations", "-34.5"),
        |own| own.prism_constant_m == Some(PrismConstants::All(-0.0345)),
    );
    changes_and_comes_back(
        harness,
        "inter-prism distances",
        |harness| enter(harness, "Distance of prisms 1–2", "0.9"),
        |own| own.inter_prism_m.as_ref().is_some_and(|all| all[0] == 0.9),
    );
    changes_and_comes_back(
        harness,
        "station numbers",
        |harness| click(harness, "Exchange stations 2 and 3"),
        |own| own.stations == Some([1, 3, 2].into()),
    );
    changes_and_comes_back(
        harness,
        "azimuth",
        |harness| click(harness, "counter-clockwise"),
        |own| own.azimuth == Some(AzimuthSense::CounterClockwise),
    );
    let [start_s, end_s] = shown(harness).timeline.whole_s;
    let half = [start_s, 0.5 * (start_s + end_s)];
    send(harness, TimeCommand::Select(Some(half)));
    let all = triplets(harness);
    changes_and_comes_back(
        harness,
        "span of time",
        |harness| {
            click(harness, "Use only the selection");
            assert!(triplets(harness) < all * 3 / 4);
        },
        |own| own.span_s == Some(half),
    );
    changes_and_comes_back(
        harness,
        "readings left out",
        |harness| click(harness, "Leave out the selection of station 2"),
        |own| own.masked.as_ref().is_some_and(|masked| masked.len() > 50),
    );
}

#[test]
fn a_constant_for_each_station_is_entered() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = opened(folder.path());
    click(&mut harness, "each its own");
    enter(&mut harness, "Prism constant of station 2", "0");
    let constants = PrismConstants::Each([0.010, 0.0, 0.010].into());
    assert_eq!(corrections(&harness).prism_constant_m, Some(constants));
    let tracks = &shown(&harness).deployment.tracks;
    assert_eq!(tracks.map(|track| track.prism_constant_m), [0.010, 0.0, 0.010].into());
}

#[test]
fn a_sample_can_be_corrections_and_nonsense_is_refused() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = station3(&harness);
    click(&mut harness, "Corrections");
    click(&mut harness, "Exchange stations 1 and 2");
    assert_ne!(station3(&harness), before);
    assert!(!shown(&harness).placeholder);
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(station3(&harness), before);
    let mut extras = Extras::default();
    extras.corrections.prism_constant_m = Some(PrismConstants::All(f64::NAN));
    send(&mut harness, DeploymentCommand::Correct(extras));
    let (text, _) = harness.state().state.toasts.errors().next().expect("refused");
    assert!(text.contains("prism_constant_m is NaN"), "{text}");
    assert!(corrections(&harness).is_empty());
    assert_eq!(undo_name(&harness), "Undo");
}

#[test]
fn a_reading_is_left_out_and_used_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = opened(folder.path());
    let picked = Picked { station: 1, index: 40 };
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Reading));
    send(&mut harness, TimeCommand::PickInPlot(picked));
    let before = triplets(&harness);
    click(&mut harness, "Leave this reading out");
    assert!(shown(&harness).deployment.tracks[1].is_left_out(40));
    assert_eq!(shown(&harness).timeline.picked, Some(picked));
    harness.get_by_label("left out by hand");
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Pipeline));
    harness.get_by_label_contains("(1 left out by hand)");
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Reading));
    assert_eq!(triplets(&harness), before);
    // By its key, too.
    press(&mut harness, Modifiers::NONE, Key::X);
    assert!(!shown(&harness).deployment.tracks[1].is_left_out(40));
    press(&mut harness, Modifiers::NONE, Key::X);
    assert!(shown(&harness).deployment.tracks[1].is_left_out(40));
    click(&mut harness, "Use it again");
    assert!(corrections(&harness).is_empty());
    // After renumbering, the same reading is excluded.
    click(&mut harness, "Leave this reading out");
    click(&mut harness, "Exchange stations 2 and 3");
    assert!(shown(&harness).deployment.tracks[2].is_left_out(40));
}

#[test]
fn the_session_keeps_what_was_corrections() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = opened(folder.path());
    click(&mut harness, "counter-clockwise");
    enter(&mut harness, "Distance of prisms 2–3", "0.95");
    let (expected, answer) = (corrections(&harness), station3(&harness));
    let state = &harness.state().state;
    let saved = state.session();
    let path = folder.path().join("x.resect.toml");
    saved.save(&path, &HashCache::default()).expect("written");
    let (session, findings) = session_file::load(&path).expect("own file");
    assert!(findings.is_empty(), "{findings:?}");
    assert_eq!(session.deployments[0].source.extras.corrections, expected);
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![path]));
    assert_eq!(corrections(&harness), expected);
    assert_eq!(station3(&harness), answer);
}

#[test]
fn it_is_written_to_the_folder_which_then_says_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, path) = opened(folder.path());
    let file = path.join("deployment.toml");
    let old = std::fs::read_to_string(&file).unwrap_or_default() + "# measured twice\n";
    std::fs::write(&file, &old).expect("written");
    click(&mut harness, "Exchange stations 2 and 3");
    click(&mut harness, "counter-clockwise");
    let answer = station3(&harness);
    click(&mut harness, "Write to deployment.toml…");
    harness.get_by_label_contains("station numbers 1 2 3 → 1 3 2");
    click(&mut harness, "Cancel");
    assert_eq!(std::fs::read_to_string(&file).expect("there"), old);
    click(&mut harness, "Write to deployment.toml…");
    click(&mut harness, "Write");
    let text = std::fs::read_to_string(&file).expect("there");
    assert!(text.contains("stations = [1, 3, 2]") && text.contains("# measured twice"), "{text}");
    assert!(corrections(&harness).is_empty());
    assert_eq!(station3(&harness), answer);
    // Undo cannot revert the content of the file.
    assert_eq!(undo_name(&harness), "Undo");
    // A second exchange overrides the numbers in the file.
    click(&mut harness, "Exchange stations 2 and 3");
    assert_eq!(corrections(&harness).stations, Some([1, 2, 3].into()));
    // Another window reads it automatically.
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    assert_eq!(station3(&harness), answer);
}

#[test]
fn a_failed_correction_changes_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let (mut harness, _) = opened(folder.path());
    let before = station3(&harness);
    // Not the sides of a triangle.
    enter(&mut harness, "Distance of prisms 1–2", "4");
    assert_eq!(harness.state().state.toasts.errors().count(), 1);
    assert_eq!((station3(&harness), undo_name(&harness)), (before, "Undo".to_owned()));
    assert!(corrections(&harness).is_empty());
}

#[test]
fn the_lines_are_drawn() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drive");
    write_folder(&simulate(Preset::UnevenGround, 1), &path).expect("written");
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "put-right-dark"),
        (LARGE, Theme::Light, "put-right-light"),
        (SMALL, Theme::Dark, "put-right-small-dark"),
    ] {
        let mut harness = window(size, theme);
        send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
        let mut extras = Extras::default();
        extras.corrections.azimuth = Some(AzimuthSense::CounterClockwise);
        extras.corrections.prism_constant_m =
            Some(PrismConstants::Each([0.010, 0.0, -0.0345].into()));
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path).with(extras)));
        click(&mut harness, "Corrections (2)");
        harness.get_by_label("Station numbers").scroll_to_me();
        settle(&mut harness);
        snapshot_of(&mut harness, Part::Pane(Pane::Deployment), name);
    }
}
