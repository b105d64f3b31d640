//! Playback in the scene: the rig at the time cursor or its ghosts, the trail behind it, and the camera that follows it.

use egui::accesskit::Role;
use egui::{Context, Event, Key, Modifiers, PointerButton, Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use nalgebra::Vector3;
use resect::app::{Camera, Pane, SceneCommand, SceneOptions, TimeCommand, ViewPreset};

use crate::harness::{
    LARGE, Part, SMALL, Window, click, double_click, press, send, settle, snapshot_of, window,
};
use crate::scene::picture;

fn strip(harness: &Window) -> String {
    let strip = harness.get_by_role(Role::Status);
    strip.accesskit_node().label().expect("it says something")
}

fn scene(harness: &Window) -> SceneOptions {
    harness.state().state.scene.options
}

fn follows(harness: &Window) -> bool {
    scene(harness).follow
}

fn camera(harness: &Window) -> Camera {
    harness.state().state.scene.view.camera
}

/// Runs frames until the camera has arrived.
fn arrive(harness: &mut Window) {
    harness.run_steps(200);
}

/// Returns start and end of the longest time without triplets (s).
fn gap_s(harness: &Window) -> [f64; 2] {
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let times_s = &analysis.triplets().time_s;
    let gaps = times_s.windows(2).map(|two| [two[0], two[1]]);
    gaps.max_by(|a, b| (a[1] - a[0]).total_cmp(&(b[1] - b[0]))).expect("triplets")
}

/// Returns prism 1 of a triplet (m, station 1's frame), which is half a metre from the middle of the rig.
fn prism_m(harness: &Window, time_s: f64) -> Vector3<f32> {
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let index = analysis.triplets().nearest(time_s).expect("a triplet");
    analysis.triplets().points_m[0][index].cast::<f32>()
}

fn drag(harness: &mut Window, button: PointerButton, by: Vec2) {
    let from = picture(harness).center();
    let press =
        |pos, pressed| Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE };
    harness.event(Event::PointerMoved(from));
    harness.event(press(from, true));
    for step in 1..=4 {
        harness.event(Event::PointerMoved(from + by * step as f32 / 4.0));
        harness.run_steps(1);
    }
    harness.event(press(from + by, false));
    settle(harness);
}

/// Returns a window whose camera follows the rig, at the last triplet before the longest gap.
fn following() -> Window {
    let mut harness = window(LARGE, Theme::Dark);
    let [gap_start_s, _] = gap_s(&harness);
    send(&mut harness, TimeCommand::MoveCursor(gap_start_s));
    press(&mut harness, Modifiers::NONE, Key::C);
    arrive(&mut harness);
    assert!(follows(&harness));
    harness
}

#[test]
fn the_camera_goes_with_the_rig_and_only_turns_and_zooms_beside() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = camera(&harness);
    let [gap_start_s, gap_end_s] = gap_s(&harness);
    send(&mut harness, TimeCommand::MoveCursor(gap_start_s));
    click(&mut harness, "Follow");
    arrive(&mut harness);
    let there = camera(&harness);
    let away_m = (there.target_m - prism_m(&harness, gap_start_s)).norm();
    assert!(away_m < 1.5, "{away_m} m");
    assert_eq!(there, Camera { target_m: there.target_m, ..before });

    drag(&mut harness, PointerButton::Primary, Vec2::new(60.0, 20.0));
    let beside = picture(&harness).center() + Vec2::new(100.0, 50.0);
    harness.hover_at(beside);
    harness.event(Event::MouseWheel {
        unit: egui::MouseWheelUnit::Line,
        delta: Vec2::new(0.0, 8.0),
        phase: egui::TouchPhase::Move,
        source: egui::MouseWheelSource::Unknown,
        modifiers: Modifiers::NONE,
    });
    arrive(&mut harness);
    let near = camera(&harness);
    assert!(follows(&harness));
    assert!(near.distance_m < 0.8 * there.distance_m && near.yaw_rad != there.yaw_rad, "{near:?}");
    assert!((near.target_m - there.target_m).norm() < 1e-3, "{near:?}");
    send(&mut harness, SceneCommand::Look(ViewPreset::Top));
    assert!(follows(&harness) && camera(&harness).parallel);
    assert_eq!(camera(&harness).distance_m, near.distance_m);

    // After the gap the rig is elsewhere: the camera glides there.
    harness.state_mut().state.handle(TimeCommand::MoveCursor(gap_end_s), &Context::default());
    let mut last_m = camera(&harness).target_m;
    let whole_m = (prism_m(&harness, gap_end_s) - last_m).norm();
    for _ in 0..200 {
        harness.run_steps(1);
        let now_m = camera(&harness).target_m;
        assert!((now_m - last_m).norm() < 0.3 * whole_m, "a jump");
        last_m = now_m;
    }
    let away_m = (last_m - prism_m(&harness, gap_end_s)).norm();
    assert!(away_m < 1.5, "{away_m} m");
}

#[test]
fn who_looks_elsewhere_leaves_the_rig() {
    let mut harness = following();
    let there = camera(&harness);
    drag(&mut harness, PointerButton::Secondary, Vec2::new(80.0, 0.0));
    arrive(&mut harness);
    assert!(!follows(&harness));
    assert!((camera(&harness).target_m - there.target_m).norm() > 1.0, "it does not come back");

    press(&mut harness, Modifiers::NONE, Key::C);
    arrive(&mut harness);
    assert!((camera(&harness).target_m - there.target_m).norm() < 1e-3);
    press(&mut harness, Modifiers::NONE, Key::F);
    assert!(!follows(&harness));
    let whole = camera(&harness);

    press(&mut harness, Modifiers::NONE, Key::C);
    arrive(&mut harness);
    let corner = picture(&harness).right_bottom() - Vec2::splat(8.0);
    double_click(&mut harness, corner);
    assert!(!follows(&harness), "a double-click beside everything fits all in");
    let back = camera(&harness);
    assert!((back.target_m - whole.target_m).norm() < 1e-3, "{back:?} {whole:?}");
}

#[test]
fn ghosts_and_a_trail_are_seen_where_the_rig_is_not() {
    let mut harness = window(SMALL, Theme::Dark);
    let [gap_start_s, _] = gap_s(&harness);
    let options = SceneOptions { trail_s: 30, follow: true, ..scene(&harness) };
    send(&mut harness, SceneCommand::SetOptions(options));
    send(&mut harness, TimeCommand::MoveCursor(gap_start_s));
    assert!(strip(&harness).contains("heading"), "there is a pose: {}", strip(&harness));
    send(&mut harness, TimeCommand::MoveCursor(gap_start_s + 1.0));
    let said = strip(&harness);
    assert!(said.contains("no triplet; prisms 1, 2, 3 read"), "{said}");
    assert!(!said.contains("heading"), "{said}");
    harness.state_mut().state.scene.view.camera.distance_m = 20.0;
    arrive(&mut harness);
    snapshot_of(&mut harness, Part::Pane(Pane::Scene), "playback");
}
