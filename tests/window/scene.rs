//! The scene, driven by mouse and keyboard.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Pos2, Rect, Theme, Vec2};
use egui_kittest::kittest::Queryable;
use resect::app::{
    Colouring, Picked, Ruler, RulerEnd, SceneCommand, TimeCommand, Timeline, ViewPreset,
};
use resect_core::network::{Number, Prism};

use crate::harness::{LARGE, Window, send, window};

fn timeline(harness: &Window) -> Timeline {
    harness.state().state.active().expect("open").timeline
}

fn click_at(harness: &mut Window, at: Pos2) {
    harness.hover_at(at);
    harness.run_steps(1);
    harness.drag_at(at);
    harness.run_steps(1);
    harness.drop_at(at);
    harness.run_steps(2);
}

/// Returns the rectangle of the picture, above the strip.
pub fn picture(harness: &Window) -> Rect {
    harness.get_by_role_and_label(Role::Image, "Scene").rect()
}

/// Returns an empty position in the scene.
fn empty(harness: &Window) -> Pos2 {
    picture(harness).right_bottom() - Vec2::splat(8.0)
}

/// Returns the screen position of a reading; `None` outside of the picture.
pub fn seen(harness: &Window, picked: Picked) -> Option<Pos2> {
    let (open, analysis) = harness.state().state.analysed().expect("an answer");
    let place_m = picked.place_m(&open.deployment, analysis).expect("placed").cast::<f32>();
    let rect = picture(harness);
    let camera = &harness.state().state.scene.view.camera;
    let clip = camera.clip_from_world(rect.width() / rect.height()) * place_m.push(1.0);
    let at = Vec2::new(clip.x / clip.w, -clip.y / clip.w) * 0.5 * rect.size();
    Some(rect.center() + at).filter(|at| rect.contains(*at))
}

/// Returns the first position, from a reading of station 1 on, with an item under the pointer whose time is not `not_s`.
fn find(harness: &mut Window, from: usize, not_s: Option<f64>) -> (Pos2, f64) {
    for index in (from..900).step_by(10) {
        let Some(at) = seen(harness, Picked { station: 0, index }) else { continue };
        harness.hover_at(at);
        harness.run_steps(2);
        let hovered_s = harness.state().state.time.hover_s;
        if let Some(time_s) = hovered_s.filter(|time_s| Some(*time_s) != not_s) {
            return (at, time_s);
        }
    }
    panic!("nothing under the pointer from reading {from} on");
}

/// Counts the pixels that differ in the middle of the scene, without its legend and its buttons.
fn differing(scene: Rect, a: &image::RgbaImage, b: &image::RgbaImage) -> usize {
    let top = scene.top() + 0.3 * scene.height();
    let middle = Rect::from_min_max(Pos2::new(scene.left(), top), scene.max - Vec2::splat(20.0));
    (a.enumerate_pixels())
        .filter(|(x, y, _)| middle.contains(Pos2::new(*x as f32, *y as f32)))
        .filter(|(x, y, pixel)| b.get_pixel(*x, *y) != *pixel)
        .count()
}

/// Asserts that every two of these pictures differ in the scene.
#[track_caller]
fn assert_all_differ(scene: Rect, pictures: &[(String, image::RgbaImage)]) {
    for (index, (one, picture)) in pictures.iter().enumerate() {
        for (other, earlier) in &pictures[..index] {
            let count = differing(scene, picture, earlier);
            assert!(count > 1000, "{one} and {other}: {count} pixels differ");
        }
    }
}

#[test]
fn a_click_on_a_reading_picks_it_and_one_beside_everything_lets_go() {
    let mut harness = window(LARGE, Theme::Dark);
    let (at, hovered_s) = find(&mut harness, 300, None);
    click_at(&mut harness, at);
    let picked = timeline(&harness).picked.expect("a reading");
    let deployment = harness.state().state.active().expect("open").deployment.clone();
    assert_eq!(picked.time_s(&deployment), Some(hovered_s));
    assert_eq!(timeline(&harness).cursor_s, Some(hovered_s));
    let beside = empty(&harness);
    click_at(&mut harness, beside);
    assert_eq!(timeline(&harness).picked, None);
    assert_eq!(timeline(&harness).cursor_s, Some(hovered_s));
}

#[test]
fn what_is_not_shown_is_not_under_the_pointer() {
    let mut harness = window(LARGE, Theme::Dark);
    let (at, _) = find(&mut harness, 300, None);
    let mut visibility = harness.state().state.scene.visibility;
    (visibility.raw, visibility.tracks) = (false, false);
    send(&mut harness, SceneCommand::Show(visibility));
    harness.hover_at(at);
    harness.run_steps(2);
    assert_eq!(harness.state().state.time.hover_s, None);
    // With tracks alone a click moves the cursor, and picks nothing.
    visibility.tracks = true;
    send(&mut harness, SceneCommand::Show(visibility));
    let before_s = timeline(&harness).cursor_s;
    let (at, hovered_s) = find(&mut harness, 500, before_s);
    click_at(&mut harness, at);
    assert_eq!(timeline(&harness).picked, None);
    assert_eq!(timeline(&harness).cursor_s, Some(hovered_s));
}

#[test]
fn each_colouring_is_another_picture_and_a_selection_dims_the_rest() {
    let mut harness = window(LARGE, Theme::Dark);
    let scene = picture(&harness);
    let mut pictures = Vec::new();
    for colouring in Colouring::ALL {
        send(&mut harness, SceneCommand::Colour(colouring));
        pictures.push((format!("{colouring:?}"), harness.render().expect("a picture")));
    }
    assert_all_differ(scene, &pictures);
    let (_, last) = &pictures[pictures.len() - 1];
    let [start_s, end_s] = timeline(&harness).whole_s;
    let third_s = (end_s - start_s) / 3.0;
    send(&mut harness, TimeCommand::Select(Some([start_s + third_s, end_s - third_s])));
    let selected = harness.render().expect("a picture");
    assert!(differing(scene, &selected, last) > 1000);
    send(&mut harness, TimeCommand::Select(None));
    assert_eq!(differing(scene, &harness.render().expect("a picture"), last), 0);
}

#[test]
fn the_colouring_is_chosen_in_the_scene() {
    let mut harness = window(LARGE, Theme::Dark);
    harness.get_by_role_and_label(Role::ComboBox, "Colour by").click();
    harness.run_steps(3);
    harness.get_by_label("Residual").click();
    harness.run_steps(3);
    assert_eq!(harness.state().state.scene.colouring, Colouring::Residual);
}

#[test]
fn keys_turn_the_scene_that_has_the_focus_and_leave_time_alone() {
    let mut harness = window(LARGE, Theme::Dark);
    let scene = picture(&harness);
    let beside = empty(&harness);
    click_at(&mut harness, beside);
    let cursor_s = timeline(&harness).cursor_s;
    let mut last = harness.render().expect("a picture");
    for (modifiers, key) in [
        (Modifiers::NONE, Key::ArrowLeft),
        (Modifiers::NONE, Key::ArrowUp),
        (Modifiers::SHIFT, Key::ArrowRight),
        (Modifiers::NONE, Key::Plus),
        (Modifiers::NONE, Key::Minus),
    ] {
        harness.key_press_modifiers(modifiers, key);
        harness.run_steps(2);
        let next = harness.render().expect("a picture");
        assert!(differing(scene, &last, &next) > 500, "{key:?}");
        last = next;
    }
    assert_eq!(timeline(&harness).cursor_s, cursor_s);
}

#[test]
fn stations_can_be_stood_at() {
    let mut harness = window(LARGE, Theme::Dark);
    let scene = picture(&harness);
    let mut pictures = vec![("at first".to_owned(), harness.render().expect("a picture"))];
    for name in ["From station 1", "From station 2", "From station 3", "Front", "Side", "Top"] {
        harness.get_by_label(name).click();
        harness.run_steps(3);
        pictures.push((name.to_owned(), harness.render().expect("a picture")));
    }
    assert_all_differ(scene, &pictures);
    // The palette's command equals the button's.
    send(&mut harness, SceneCommand::Look(ViewPreset::Fit));
    send(&mut harness, SceneCommand::Look(ViewPreset::Top));
    let (_, top) = &pictures[pictures.len() - 1];
    assert_eq!(differing(scene, top, &harness.render().expect("a picture")), 0);
}

#[test]
fn the_camera_flies_to_what_is_picked_in_a_plot() {
    let mut harness = window(LARGE, Theme::Dark);
    let scene = picture(&harness);
    let before = harness.render().expect("a picture");
    send(&mut harness, TimeCommand::PickInPlot(Picked { station: 1, index: 300 }));
    harness.run_steps(4);
    let near = harness.render().expect("a picture");
    assert!(differing(scene, &before, &near) > 1000);
    // The camera has arrived, and requests no more frames.
    harness.run_steps(2);
    assert_eq!(differing(scene, &near, &harness.render().expect("a picture")), 0);
}

#[test]
fn the_ruler_snaps_to_what_is_clicked_and_esc_clears_it() {
    let mut harness = window(LARGE, Theme::Dark);
    harness.get_by_label("Ruler").click();
    harness.run_steps(2);
    assert!(harness.state().state.scene.ruler.active);
    let (first, first_s) = find(&mut harness, 300, None);
    click_at(&mut harness, first);
    let (second, _) = find(&mut harness, 600, Some(first_s));
    click_at(&mut harness, second);
    let beside = empty(&harness);
    click_at(&mut harness, beside);
    let ends = harness.state().state.scene.ruler.ends.clone();
    assert_eq!(ends.len(), 2, "{ends:?}");
    assert!((ends[0].position_m - ends[1].position_m).norm() > 1.0);
    assert!(ends[0].what.contains("reading") && !ends[1].what.is_empty(), "{ends:?}");
    // Nothing was picked, and the cursor stayed.
    assert_eq!(timeline(&harness).picked, None);
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    let ruler = &harness.state().state.scene.ruler;
    assert!(ruler.active && ruler.ends.is_empty());
    harness.key_press(Key::Escape);
    harness.run_steps(2);
    assert!(!harness.state().state.scene.ruler.active);
}

#[test]
fn a_ruler_between_prisms_goes_with_the_cursor() {
    let mut harness = window(LARGE, Theme::Dark);
    let scene = picture(&harness);
    let end = |prism: usize| RulerEnd {
        position_m: Default::default(),
        what: format!("prism {}", prism + 1),
        prism: Some(Prism::at(prism)),
    };
    let ruler = Ruler { active: true, ends: vec![end(0), end(1)] };
    // Near enough for the motion to be visible.
    send(&mut harness, TimeCommand::PickInPlot(Picked { station: 0, index: 500 }));
    harness.run_steps(4);
    send(&mut harness, SceneCommand::Measure(ruler));
    let here = harness.render().expect("a picture");
    let cursor_s = timeline(&harness).cursor_s.expect("where it was picked");
    send(&mut harness, TimeCommand::MoveCursor(cursor_s + 2.0));
    assert!(differing(scene, &here, &harness.render().expect("a picture")) > 300);
}
