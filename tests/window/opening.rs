//! Opening and saving in the window, driven by the names of its widgets.

use egui::accesskit::Role;
use egui::{Event, HoveredFile, Key, Modifiers, Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::file_dialog::PromptCommand;
use resect::app::{DeploymentCommand, DialogCommand, ResultsCommand, SessionCommand};
use resect_io::source::Source;

use crate::common::sample_folder;
use crate::harness::{
    Part, Window, click, press, send, settle, shown, snapshot, snapshot_of, type_and_enter_at_once,
    window,
};

const SIZE: Vec2 = Vec2::new(1280.0, 800.0);
const THEMES: [(Theme, &str); 2] = [(Theme::Dark, "dark"), (Theme::Light, "light")];

/// Replaces the text of the prompt.
fn type_path(harness: &mut Window, text: &str) {
    harness.get_by_label("Path").focus();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(1);
    harness.event(Event::Text(text.to_owned()));
    settle(harness);
}

/// Waits until the window reports a text, however slow the disk is.
#[track_caller]
fn wait_until_told(harness: &mut Window, what: &str) {
    let told = |harness: &Window| {
        let toasts = &harness.state().state.toasts;
        assert_eq!(toasts.errors().next(), None);
        toasts.shown().iter().any(|toast| toast.text.contains(what))
    };
    while !told(harness) {
        assert!(harness.state_mut().state.wait_for_outcome(), "nothing more comes, and not {what}");
    }
}

#[test]
fn a_deployment_is_opened_by_typing_its_path() {
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenFolderDialog);
    let folder = sample_folder("hd2-tunnel");
    let above = folder.parent().expect("in assets").display().to_string();
    type_path(&mut harness, &format!("{above}/"));
    harness.get_by_label("warthog/");
    let can_open = |harness: &Window| {
        let button = harness.get_by_role_and_label(Role::Button, "Open");
        !button.accesskit_node().is_disabled()
    };
    assert!(!can_open(&harness), "nothing is named");
    type_path(&mut harness, &format!("{above}/HD"));
    assert!(harness.query_by_label("warthog/").is_none());
    assert!(can_open(&harness), "as Enter does");
    // Enter opens the one folder that is left, and then selects it.
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.get_by_label("inter_prism.csv deployment");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert!(harness.state().state.dialogs.prompt.is_none());
    assert_eq!(shown(&harness).deployment.name, "hd2-tunnel (simulated)");
}

#[test]
fn a_file_is_found_by_arrows_alone() {
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenFileDialog);
    type_path(&mut harness, &format!("{}/", sample_folder("hd2-tunnel").display()));
    let line = |harness: &Window, name: &str| {
        let shown = &harness.state().state.dialogs.prompt.as_ref().expect("asked").shown;
        shown.shown().iter().position(|entry| entry.name == name).expect("there")
    };
    let wanted = line(&harness, "inter_prism.csv");
    for _ in 0..=wanted {
        press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    }
    press(&mut harness, Modifiers::NONE, Key::Enter);
    settle(&mut harness);
    assert_eq!(shown(&harness).deployment.name, "hd2-tunnel (simulated)");
}

#[test]
fn a_file_is_written_where_it_is_asked_for_and_not_over_another_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("old.tum");
    std::fs::write(&path, "mine\n").expect("written");
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, ResultsCommand::SaveTrajectoryDialog);
    let proposed = harness.state().state.dialogs.prompt.as_ref().expect("asked").shown.text.clone();
    assert!(proposed.ends_with("warthog (simulated).tum"), "{proposed}");
    type_path(&mut harness, &path.display().to_string());
    press(&mut harness, Modifiers::NONE, Key::Enter);
    // Enter keeps the file.
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(std::fs::read_to_string(&path).expect("there"), "mine\n");
    harness.get_by_label("Cancel").click();
    settle(&mut harness);
    assert!(harness.state().state.dialogs.prompt.is_none());
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, ResultsCommand::SaveTrajectoryDialog);
    type_path(&mut harness, &path.display().to_string());
    harness.get_by_label("Save").click();
    settle(&mut harness);
    harness.get_by_label("Replace").click();
    settle(&mut harness);
    wait_until_told(&mut harness, "old.tum written");
    assert_ne!(std::fs::read_to_string(&path).expect("there"), "mine\n");
}

#[test]
fn a_session_is_named_over_what_is_proposed_and_looked_for_where_it_was_saved() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, SessionCommand::SaveAs);
    send(&mut harness, DialogCommand::Prompt(PromptCommand::GoTo(folder.path().to_owned())));
    harness.event(Event::Text("monday".to_owned()));
    settle(&mut harness);
    let text = harness.state().state.dialogs.prompt.as_ref().expect("asked").shown.text.clone();
    assert_eq!(text, folder.path().join("monday.resect.toml").display().to_string());
    press(&mut harness, Modifiers::NONE, Key::Enter);
    wait_until_told(&mut harness, "monday");
    send(&mut harness, SessionCommand::OpenDialog);
    let asked = harness.state().state.dialogs.prompt.as_ref().expect("asked");
    assert_eq!(asked.shown.folder(), folder.path());
    assert!(harness.query_by_label("Open this folder").is_none(), "a session is a file");
    // Data is looked for in the folder of the last data.
    press(&mut harness, Modifiers::NONE, Key::Escape);
    send(&mut harness, DeploymentCommand::OpenFolderDialog);
    let asked = harness.state().state.dialogs.prompt.as_ref().expect("asked");
    assert_ne!(asked.shown.folder(), folder.path());
    harness.get_by_label("Open this folder");
}

#[test]
fn escape_cancels_and_a_wrong_path_is_said() {
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenFileDialog);
    type_path(&mut harness, "/nowhere/at/all");
    press(&mut harness, Modifiers::NONE, Key::Enter);
    harness.get_by_label_contains("there is no such file or folder");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(harness.state().state.dialogs.prompt.is_none());
}

#[test]
fn who_has_nothing_open_is_told_what_to_do() {
    for (theme, name) in THEMES {
        let mut harness = window(SIZE, theme);
        let id = harness.state().state.deployments.open[0].id;
        send(&mut harness, DeploymentCommand::Close(id));
        // Opened and closed again, it is among the recent ones.
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(sample_folder("warthog"))));
        let id = harness.state().state.deployments.open[0].id;
        send(&mut harness, DeploymentCommand::Close(id));
        snapshot(&mut harness, &format!("empty-{name}"));
        harness.get_by_label("Open file…");
        harness.get_by_label("warthog").click();
        settle(&mut harness);
        assert_eq!(shown(&harness).deployment.name, "warthog (simulated)");
        let id = harness.state().state.deployments.open[0].id;
        send(&mut harness, DeploymentCommand::Close(id));
        harness.get_by_label("Try HD2 in a tunnel").click();
        settle(&mut harness);
        assert_eq!(shown(&harness).deployment.name, "hd2-tunnel (simulated)");
    }
}

#[test]
fn warnings_are_told_once_and_errors_until_they_are_dismissed() {
    let folder = tempfile::tempdir().expect("a folder");
    let tracks = std::fs::read_to_string(sample_folder("warthog").join("inter_prism.csv"));
    let tracks = tracks.expect("readable") + "0,1,10,0.1,1.5\n0,7,10,0.1,1.5\n";
    std::fs::write(folder.path().join("day 1.csv"), tracks).expect("written");
    let broken = folder.path().join("broken.csv");
    std::fs::write(&broken, "timestamp,id,distance,ha,va\n0,1,10,x,1.5\n").expect("written");
    for (theme, name) in THEMES {
        let mut harness = window(SIZE, theme);
        send(&mut harness, DeploymentCommand::OpenPaths(vec![folder.path().join("day 1.csv")]));
        send(&mut harness, DeploymentCommand::OpenPaths(vec![broken.clone()]));
        let done = "warthog.tum written";
        harness.state_mut().state.toasts.done(done);
        harness.run_steps(2);
        snapshot_of(&mut harness, Part::Bottom(140.0), &format!("toasts-{name}"));
        let texts = |harness: &Window| -> Vec<String> {
            harness.state().state.toasts.shown().iter().map(|toast| toast.text.clone()).collect()
        };
        assert_eq!(texts(&harness).len(), 3, "{:?}", texts(&harness));
        assert!(texts(&harness)[0].contains("warnings about day 1"), "{:?}", texts(&harness));
        harness.get_by_label("Show findings").click();
        settle(&mut harness);
        assert_eq!(texts(&harness).len(), 2);
        // Half a minute later only the error is left.
        harness.run_steps(120);
        assert_eq!(texts(&harness).len(), 1);
        harness.get_by_label("Dismiss").click();
        harness.run_steps(2);
        assert!(texts(&harness).is_empty());
    }
}

#[test]
fn a_hovering_file_says_what_it_would_do() {
    let path = sample_folder("warthog").join("GCP_raw_1.txt");
    let mut harness = window(SIZE, Theme::Dark);
    let hovered = HoveredFile { path: Some(path.clone()), ..HoveredFile::default() };
    harness.input_mut().hovered_files.push(hovered);
    settle(&mut harness);
    harness.get_by_label("Add the control points GCP_raw_1.txt to warthog (simulated)");
    harness.input_mut().hovered_files.clear();
    harness.run_steps(1);
    assert!(harness.query_by_label_contains("Add the control points").is_none());
    // A dropped file is added to the open deployment once the user confirms.
    let before = harness.state().state.active().expect("open").deployment.control_points.len();
    send(&mut harness, DeploymentCommand::OpenPaths(vec![path]));
    click(&mut harness, "Use for warthog (simulated)");
    let deployment = harness.state().state.active().expect("open").deployment.clone();
    assert_eq!(harness.state().state.deployments.open.len(), 1);
    assert_eq!(deployment.control_points.len(), before + 1);
}

#[test]
fn files_that_are_added_one_after_the_other_are_all_kept() {
    let mut harness = window(SIZE, Theme::Dark);
    let folder = tempfile::tempdir().expect("a folder");
    let add = |harness: &mut Window, name: &str| {
        let path = folder.path().join(name);
        std::fs::copy(sample_folder("warthog").join("GCP_raw_1.txt"), &path).expect("copied");
        let ctx = harness.ctx.clone();
        harness.state_mut().send(DeploymentCommand::OpenPaths(vec![path]), &ctx);
    };
    let before = shown(&harness).deployment.control_points.len();
    add(&mut harness, "more 1.txt");
    add(&mut harness, "more 2.txt");
    settle(&mut harness);
    click(&mut harness, "Use for warthog (simulated)");
    assert_eq!(shown(&harness).deployment.control_points.len(), before + 2);
    assert_eq!(harness.state().state.deployments.open.len(), 1);
}

#[test]
fn a_folder_is_made_in_the_dialog_that_saves() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, ResultsCommand::SaveTrajectoryDialog);
    send(&mut harness, DialogCommand::Prompt(PromptCommand::GoTo(folder.path().to_owned())));
    click(&mut harness, "New folder…");
    type_and_enter_at_once(&mut harness, "results");
    assert!(folder.path().join("results").is_dir());
    let prompt = &harness.state().state.dialogs.prompt.as_ref().expect("still asked").shown;
    assert_eq!(prompt.folder(), folder.path().join("results"));
    assert!(prompt.text.ends_with("warthog (simulated).tum"), "{}", prompt.text);
    // A dialog for opening cannot create folders.
    send(&mut harness, DeploymentCommand::OpenFolderDialog);
    assert!(harness.query_by_label("New folder…").is_none());
}

#[test]
fn the_first_window_fits_a_small_screen() {
    let mut harness = window(SIZE, Theme::Dark);
    let tell = |harness: &mut Window, screen: Vec2| {
        let viewports = &mut harness.input_mut().viewports;
        let viewport = viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.monitor_size = Some(screen);
        viewport.inner_rect = Some(egui::Rect::from_min_size(egui::Pos2::ZERO, screen));
        harness.run_steps(1);
        let told = &harness.output().viewport_output[&egui::ViewportId::ROOT].commands;
        told.contains(&egui::ViewportCommand::Maximized(true))
    };
    assert!(tell(&mut harness, Vec2::new(1280.0, 720.0)));
    assert!(!tell(&mut harness, Vec2::new(1280.0, 720.0)), "later the size is the user's");
}

#[test]
fn what_is_typed_in_the_same_frame_as_enter_counts() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("here.tum");
    let mut harness = window(SIZE, Theme::Dark);
    send(&mut harness, ResultsCommand::SaveTrajectoryDialog);
    type_and_enter_at_once(&mut harness, &path.display().to_string());
    assert!(harness.state().state.dialogs.prompt.is_none());
    wait_until_told(&mut harness, "here.tum written");
    assert!(path.exists(), "it was written where it was asked for");
}
