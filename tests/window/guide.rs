//! Explanations of terms beside their use, and the guide.

use egui::accesskit::Role;
use egui::{Event, Key, Modifiers, OutputCommand, Theme, Vec2};
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, DialogCommand, Overlay, Pane, WorkspaceCommand};
use resect_report::glossary;
use resect_report::glossary::Term;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{
    LARGE, Part, SMALL, Window, click, open, press, send, settle, shown, snapshot_of, window,
};

/// Returns the terms that F1 explains now.
fn explained(harness: &mut Window) -> Vec<&'static Term> {
    press(harness, Modifiers::NONE, Key::F1);
    let of = match &harness.state().state.dialogs.overlay {
        Overlay::Glossary(lookup) => lookup.of.clone(),
        other => panic!("F1 opened {other:?}"),
    };
    press(harness, Modifiers::NONE, Key::Escape);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
    of
}

fn hover(harness: &mut Window, role: Role, name: &str) {
    harness.get_by_role_and_label(role, name).hover();
    harness.run_steps(3);
}

fn leave(harness: &mut Window) {
    harness.input_mut().events.push(Event::PointerGone);
    harness.run_steps(2);
}

#[test]
fn f1_explains_what_is_under_the_pointer_or_else_has_the_focus() {
    let mut harness = window(LARGE, Theme::Dark);
    hover(&mut harness, Role::Label, "τ_s  gap");
    assert_eq!(explained(&mut harness), [&glossary::TAU_S]);
    hover(&mut harness, Role::Label, "yaw of T12");
    assert_eq!(explained(&mut harness), [&glossary::YAW]);
    hover(&mut harness, Role::Button, "Prior search");
    assert_eq!(explained(&mut harness), [&glossary::PRIOR, &glossary::TAU_V]);
    hover(&mut harness, Role::Label, "joint − D");
    assert_eq!(explained(&mut harness), [&glossary::JOINT, &glossary::INTER_PRISM]);
    leave(&mut harness);
    harness.get_by_role_and_label(Role::Slider, "τ_l  length").focus();
    harness.run_steps(2);
    assert_eq!(explained(&mut harness), [&glossary::TAU_L]);
    // Also while a number is typed.
    harness.get_by_role_and_label(Role::SpinButton, "τ_s  gap").click();
    harness.run_steps(2);
    assert!(harness.ctx.text_edit_focused());
    hover(&mut harness, Role::RadioButton, "D  inter-prism distances");
    assert_eq!(explained(&mut harness), [&glossary::INTER_PRISM]);
}

#[test]
fn a_threshold_in_a_plot_is_explained_too() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Rates));
    leave(&mut harness);
    harness.get_by_label("τ_e line").focus();
    harness.run_steps(2);
    assert_eq!(explained(&mut harness), [&glossary::TAU_E]);
}

#[test]
fn a_word_says_what_it_means_while_the_pointer_rests_on_it() {
    let mut harness = window(LARGE, Theme::Dark);
    let means = glossary::TAU_S.means;
    assert!(harness.query_by_label(means).is_none());
    hover(&mut harness, Role::Label, "τ_s  gap");
    harness.run_steps(60);
    harness.get_by_label(means);
    harness.get_by_label(&glossary::TAU_S.source().expect("the paper has it"));
}

#[test]
fn words_are_found_by_what_is_typed() {
    let mut harness = window(SMALL, Theme::Light);
    leave(&mut harness);
    assert_eq!(explained(&mut harness), [] as [&Term; 0], "nothing is pointed at: all words");
    send(&mut harness, DialogCommand::Explain);
    harness.event(Event::Text("twice the height".to_owned()));
    settle(&mut harness);
    harness.get_by_label(glossary::MIRROR_TWIN.means);
    assert!(harness.query_by_label(glossary::TAU_S.means).is_none());
    let part = Part::Middle(Vec2::new(640.0, 700.0));
    press(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("clock".to_owned()));
    settle(&mut harness);
    // More matches than before make the list longer again.
    harness.get_by_label(glossary::CLOCK_OFFSET.means);
    snapshot_of(&mut harness, part, "glossary-small-light");
}

#[test]
fn the_guide_does_what_it_says() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Guide));
    harness.get_by_label_contains("Open now: warthog (simulated)");
    click(&mut harness, "3  Tune");
    let runs = harness.state().state.results.pins.len();
    click(&mut harness, "Pin the result");
    assert_eq!(harness.state().state.results.pins.len(), runs + 1);
    click(&mut harness, "Show Rates");
    harness.get_by_label("τ_e line");
    click(&mut harness, "5  Save and repeat");
    harness.get_by_label("Copy the command").click();
    harness.run_steps(1);
    let commands = harness.output().platform_output.commands.clone();
    let copied = commands.into_iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text),
        _ => None,
    });
    assert_eq!(copied.as_deref(), Some("resect calibrate FOLDER --json > calibration.json"));
}

#[test]
fn the_guide_is_searched_together_with_the_words() {
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Guide));
    harness.get_by_label("Search the guide").focus();
    harness.run_steps(2);
    harness.event(Event::Text("millisecond".to_owned()));
    settle(&mut harness);
    harness.get_by_label_contains("a millisecond between stations is a millimetre");
    harness.get_by_label("Show Clocks");
    harness.get_by_label(glossary::OWN_CLOCK.means);
    assert!(harness.query_by_label_contains("Drop a deployment's folder").is_none());
    press(&mut harness, Modifiers::COMMAND, Key::A);
    harness.event(Event::Text("xyzzy".to_owned()));
    settle(&mut harness);
    harness.get_by_label_contains("No match in the guide or the glossary");
}

#[test]
fn who_has_nothing_open_is_led_to_the_guide() {
    let mut harness = window(SMALL, Theme::Dark);
    let id = shown(&harness).id;
    send(&mut harness, DeploymentCommand::Close(id));
    harness.get_by_label("Show the guide").click();
    settle(&mut harness);
    harness.get_by_label("Nothing is open.");
    click(&mut harness, "4  Trust it?");
    harness.get_by_label("No result yet.");
}

#[test]
fn the_guide_explains_the_doubts_that_there_are() {
    for (size, theme, name) in
        [(LARGE, Theme::Dark, "guide-dark"), (SMALL, Theme::Light, "guide-small-light")]
    {
        let mut harness = window(size, theme);
        let mut straight =
            resect_io::simulation_files::open(&simulate(Preset::StraightLine, 1)).expect("valid");
        straight.control_points.clear();
        open(&mut harness, straight);
        send(&mut harness, WorkspaceCommand::ShowPane(Pane::Guide));
        click(&mut harness, "4  Trust it?");
        harness.get_by_label("⚠ A direction is unobservable or weakly observable, here");
        click(&mut harness, "2  Is it right?");
        snapshot_of(&mut harness, Part::Pane(Pane::Guide), name);
    }
}
