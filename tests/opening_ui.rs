//! Opening and saving in the window, driven by the names of its widgets.
//!
//! `PICTURES=FOLDER cargo test --test opening_ui` writes what was seen into a folder.

mod common;

use std::path::Path;

use common::sample_folder;
use eframe::egui::{Event, Key, Modifiers, Theme, Vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;
use resect::analysis::Settings;
use resect::app::{Command, ResectWindow, Start, offscreen_renderer};
use resect::deployment::Sample;

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
        harness.get_by_label_contains("inter_prism.csv");
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
