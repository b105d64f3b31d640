//! Opening and saving in the window, driven by the names of its widgets.
//!
//! `PICTURES=FOLDER cargo test --test opening_ui` writes what was seen into a folder.

mod common;

use std::path::Path;

use common::sample_folder;
use eframe::egui::{Event, HoveredFile, Key, Modifiers, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use resect::analysis::Settings;
use resect::app::{Command, ResectWindow, Start, offscreen_renderer};
use resect::deployment::{Sample, Source};

const THEMES: [(Theme, &str); 2] = [(Theme::Dark, "dark"), (Theme::Light, "light")];

/// The window with a sample, asking for paths by itself.
fn window(theme: Theme) -> Harness<'static, ResectWindow> {
    let mut harness = Harness::builder()
        .with_size(Vec2::new(1280.0, 800.0))
        .with_theme(theme)
        .with_render_cursor(false)
        .renderer(offscreen_renderer().expect("Mesa is installed by tests/run"))
        .build_eframe(|creation| {
            ResectWindow::new(creation, &Start::Sample(Sample::Warthog), Settings::default())
        });
    harness.state_mut().state.fixed_elapsed_ms = Some(1.0);
    harness.state_mut().state.asks_in_window = true;
    settle(&mut harness);
    harness
}

fn settle(harness: &mut Harness<'_, ResectWindow>) {
    for _ in 0..2 {
        harness.run_steps(2);
        harness.state_mut().settle();
    }
    harness.run_steps(3);
}

fn picture(harness: &mut Harness<'_, ResectWindow>, name: &str) {
    if let Some(folder) = std::env::var_os("PICTURES") {
        let image = harness.render().expect("a picture");
        image.save(Path::new(&folder).join(format!("{name}.png"))).expect("written");
    }
}

fn send(harness: &mut Harness<'_, ResectWindow>, command: Command) {
    let ctx = harness.ctx.clone();
    harness.state_mut().send(command, &ctx);
    settle(harness);
}

/// Types over what is in the prompt.
fn type_path(harness: &mut Harness<'_, ResectWindow>, text: &str) {
    harness.get_by_label("Path").focus();
    harness.key_press_modifiers(Modifiers::COMMAND, Key::A);
    harness.run_steps(1);
    harness.event(Event::Text(text.to_owned()));
    settle(harness);
}

fn press(harness: &mut Harness<'_, ResectWindow>, key: Key) {
    harness.key_press(key);
    settle(harness);
}

fn active(harness: &Harness<'_, ResectWindow>) -> String {
    harness.state().state.active().expect("open").deployment.name.clone()
}

#[test]
fn a_deployment_is_opened_by_typing_its_path() {
    for (theme, name) in THEMES {
        let mut harness = window(theme);
        send(&mut harness, Command::OpenFolderDialog);
        let folder = sample_folder("hd2-tunnel");
        let above = folder.parent().expect("in assets").display().to_string();
        type_path(&mut harness, &format!("{above}/"));
        harness.get_by_label("warthog/");
        picture(&mut harness, &format!("prompt-folders-{name}"));
        type_path(&mut harness, &format!("{above}/HD"));
        assert!(harness.query_by_label("warthog/").is_none());
        // The one folder that is left is entered, and then taken.
        press(&mut harness, Key::Enter);
        harness.get_by_label("inter_prism.csv deployment");
        picture(&mut harness, &format!("prompt-files-{name}"));
        press(&mut harness, Key::Enter);
        settle(&mut harness);
        assert!(harness.state().state.prompt.is_none());
        assert_eq!(active(&harness), "hd2-tunnel (simulated)");
    }
}

#[test]
fn a_file_is_found_by_arrows_alone() {
    let mut harness = window(Theme::Dark);
    send(&mut harness, Command::OpenFileDialog);
    type_path(&mut harness, &format!("{}/", sample_folder("hd2-tunnel").display()));
    let line = |harness: &Harness<'_, ResectWindow>, name: &str| {
        let shown = &harness.state().state.prompt.as_ref().expect("asked").shown;
        shown.shown().iter().position(|entry| entry.name == name).expect("there")
    };
    let wanted = line(&harness, "inter_prism.csv");
    for _ in 0..=wanted {
        press(&mut harness, Key::ArrowDown);
    }
    picture(&mut harness, "prompt-chosen-dark");
    press(&mut harness, Key::Enter);
    settle(&mut harness);
    assert_eq!(active(&harness), "hd2-tunnel (simulated)");
}

#[test]
fn a_file_is_written_where_it_is_asked_for_and_not_over_another_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("old.tum");
    std::fs::write(&path, "mine\n").expect("written");
    for (theme, name) in THEMES {
        let mut harness = window(theme);
        send(&mut harness, Command::SaveTrajectoryDialog);
        let proposed = harness.state().state.prompt.as_ref().expect("asked").shown.text.clone();
        assert!(proposed.ends_with("warthog (simulated).tum"), "{proposed}");
        picture(&mut harness, &format!("prompt-save-{name}"));
        type_path(&mut harness, &path.display().to_string());
        press(&mut harness, Key::Enter);
        picture(&mut harness, &format!("prompt-overwrite-{name}"));
        // Enter keeps it.
        press(&mut harness, Key::Enter);
        assert_eq!(std::fs::read_to_string(&path).expect("there"), "mine\n");
        harness.get_by_label("Cancel").click();
        settle(&mut harness);
        assert!(harness.state().state.prompt.is_none());
    }
    let mut harness = window(Theme::Dark);
    send(&mut harness, Command::SaveTrajectoryDialog);
    type_path(&mut harness, &path.display().to_string());
    harness.get_by_label("Save").click();
    settle(&mut harness);
    harness.get_by_label("Replace").click();
    settle(&mut harness);
    for _ in 0..50 {
        std::thread::sleep(std::time::Duration::from_millis(20));
        if std::fs::read_to_string(&path).expect("there") != "mine\n" {
            return;
        }
    }
    panic!("the trajectory was not written");
}

#[test]
fn escape_cancels_and_a_wrong_path_is_said() {
    let mut harness = window(Theme::Dark);
    send(&mut harness, Command::OpenFileDialog);
    type_path(&mut harness, "/nowhere/at/all");
    press(&mut harness, Key::Enter);
    harness.get_by_label_contains("there is no such file or folder");
    picture(&mut harness, "prompt-wrong-dark");
    press(&mut harness, Key::Escape);
    assert!(harness.state().state.prompt.is_none());
}

#[test]
fn who_has_nothing_open_is_told_what_to_do() {
    for (theme, name) in THEMES {
        let mut harness = window(theme);
        let id = harness.state().state.open[0].id;
        send(&mut harness, Command::Close(id));
        // Opened and closed again, it is among the recent ones.
        send(&mut harness, Command::OpenSource(Source::at(sample_folder("warthog"))));
        let id = harness.state().state.open[0].id;
        send(&mut harness, Command::Close(id));
        picture(&mut harness, &format!("empty-{name}"));
        harness.get_by_label("Open file…");
        harness.get_by_label("warthog").click();
        settle(&mut harness);
        assert_eq!(active(&harness), "warthog (simulated)");
        let id = harness.state().state.open[0].id;
        send(&mut harness, Command::Close(id));
        harness.get_by_label("Try HD2 in a tunnel").click();
        settle(&mut harness);
        assert_eq!(active(&harness), "hd2-tunnel (simulated)");
    }
}

#[test]
fn warnings_are_told_once_and_errors_until_they_are_dismissed() {
    let folder = tempfile::tempdir().expect("a folder");
    let tracks = std::fs::read_to_string(sample_folder("warthog").join("inter_prism.csv"));
    let tracks = tracks.expect("readable") + "0,1,10,0.1,1.5\n0,7,10,0.1,1.5\n";
    std::fs::write(folder.path().join("day 1.csv"), tracks).expect("written");
    let broken = folder.path().join("broken.csv");
    std::fs::write(&broken, "timestamp;id;distance;ha;va\n0;1;10;0.1;1.5\n").expect("written");
    for (theme, name) in THEMES {
        let mut harness = window(theme);
        send(&mut harness, Command::OpenPaths(vec![folder.path().join("day 1.csv")]));
        send(&mut harness, Command::OpenPaths(vec![broken.clone()]));
        let done = "warthog.tum written";
        harness.state_mut().state.toasts.done(done);
        harness.run_steps(2);
        picture(&mut harness, &format!("toasts-{name}"));
        let texts = |harness: &Harness<'_, ResectWindow>| -> Vec<String> {
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
    let mut harness = window(Theme::Dark);
    let hovered = HoveredFile { path: Some(path.clone()), ..HoveredFile::default() };
    harness.input_mut().hovered_files.push(hovered);
    harness.run_steps(1);
    picture(&mut harness, "hovering-dark");
    harness.input_mut().hovered_files.clear();
    // Dropped, it is used with what is open.
    let before = harness.state().state.active().expect("open").deployment.control_points.len();
    send(&mut harness, Command::OpenPaths(vec![path]));
    let deployment = harness.state().state.active().expect("open").deployment.clone();
    assert_eq!(harness.state().state.open.len(), 1);
    assert_eq!(deployment.control_points.len(), before + 1);
}
