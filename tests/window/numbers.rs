//! Invalid text in a field for a number: it stays there, with the reason.

use egui::accesskit::Role;
use egui::{Event, Key, Theme};
use egui_kittest::kittest::Queryable;

use crate::harness::{
    LARGE, SMALL, Window, press, send, settings, settle, type_and_enter_at_once, window,
};
use resect::app::DialogCommand;

fn type_garbage(harness: &mut Window) {
    harness.get_by_role_and_label(Role::SpinButton, "τ_l  length").click();
    harness.run_steps(2);
    harness.event(Event::Text("soon".to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(harness);
}

fn left_in_the_field(harness: &Window) -> Option<String> {
    harness.query_by_role_and_label(Role::TextInput, "τ_l  length")?.value()
}

#[test]
fn garbage_stays_in_its_field_until_it_is_mended() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = settings(&harness);
    type_garbage(&mut harness);
    assert_eq!(settings(&harness), before);
    assert_eq!(left_in_the_field(&harness).as_deref(), Some("soon"));
    harness.get_by_role_and_label(Role::TextInput, "τ_l  length").hover();
    harness.run_steps(60);
    harness.get_by_label_contains("“soon” is not a number; the value is still 6 s");
    harness.get_by_role_and_label(Role::TextInput, "τ_l  length").focus();
    harness.run_steps(2);
    type_and_enter_at_once(&mut harness, "20 s");
    assert_eq!(settings(&harness).pipeline.thresholds.tau_l_seconds, 20.0);
    assert_eq!(left_in_the_field(&harness), None);
}

#[test]
fn escape_gives_garbage_up() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = settings(&harness);
    type_garbage(&mut harness);
    press(&mut harness, egui::Modifiers::NONE, Key::Escape);
    assert_eq!((settings(&harness), left_in_the_field(&harness)), (before, None));
}

#[test]
fn who_enters_garbage_types_on_in_the_same_place() {
    let mut harness = window(LARGE, Theme::Dark);
    let place = |harness: &Window, role| harness.get_by_role_and_label(role, "τ_l  length").rect();
    let below = |harness: &Window| harness.get_by_label_contains("triplets").rect();
    let (number, next) = (place(&harness, Role::SpinButton), below(&harness));
    type_garbage(&mut harness);
    assert_eq!(below(&harness), next, "nothing moves");
    assert!(place(&harness, Role::TextInput).contains_rect(number.shrink(1.0)));
    // T would be the top view, and digits belong to no other widget.
    let camera = harness.state().state.scene.view.camera;
    harness.event(Event::Text("T".to_owned()));
    press(&mut harness, egui::Modifiers::NONE, Key::T);
    assert_eq!(left_in_the_field(&harness).as_deref(), Some("soonT"));
    assert_eq!(harness.state().state.scene.view.camera, camera);
    type_and_enter_at_once(&mut harness, "20 s");
    assert_eq!(settings(&harness).pipeline.thresholds.tau_l_seconds, 20.0);
}

#[test]
fn a_number_that_the_palette_finds_takes_what_is_typed() {
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, DialogCommand::ShowPalette);
    harness.event(Event::Text("tau_l".to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    // Its field takes what is typed.
    harness.event(Event::Text("12".to_owned()));
    harness.run_steps(2);
    harness.key_press(Key::Enter);
    settle(&mut harness);
    assert_eq!(settings(&harness).pipeline.thresholds.tau_l_seconds, 12.0);
}
