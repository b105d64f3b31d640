//! Views of the scene: from the sides, near and far, and back.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    LayoutPreset, Pane, Picked, SceneCommand, SceneOptions, TimeCommand, ViewPreset,
    WorkspaceCommand,
};

use crate::harness::{
    LARGE, SMALL, Window, click, double_click, open, press, send, settle, shown, window,
};
use crate::scene::{picture, seen};
use resect_tools::simulation::{Preset, simulate};

fn strip(harness: &Window) -> String {
    let strip = harness.get_by_role(Role::Status);
    strip.accesskit_node().label().expect("it says something")
}

#[test]
fn readings_are_found_where_they_are_drawn_from_every_side_and_however_high() {
    let mut harness = window(LARGE, Theme::Dark);
    for (preset, height_scale) in [
        (ViewPreset::Top, 1),
        (ViewPreset::Front, 5),
        (ViewPreset::Side, 10),
        (ViewPreset::Slanted, 5),
    ] {
        let options = SceneOptions { height_scale, ..SceneOptions::default() };
        send(&mut harness, SceneCommand::SetOptions(options));
        send(&mut harness, SceneCommand::Look(preset));
        assert_eq!(strip(&harness).contains("heights drawn"), height_scale != 1);
        let mut found = 0;
        for index in (0..900).step_by(45) {
            let Some(at) = seen(&harness, Picked { station: 0, index }) else { continue };
            harness.hover_at(at);
            harness.run_steps(2);
            found += usize::from(harness.state().state.time.hover_s.is_some());
        }
        // A few are under the legend, or are distant outliers.
        assert!(found >= 14, "{preset:?} ×{height_scale}: {found}");
    }
    assert!(strip(&harness).contains("heights drawn ×5"));
}

#[test]
fn a_double_click_comes_to_a_point_and_beside_everything_goes_back() {
    let mut harness = window(LARGE, Theme::Dark);
    let camera = |harness: &Window| harness.state().state.scene.view.camera;
    let all = camera(&harness);
    let found = (300..900).step_by(10).find_map(|index| {
        let picked = Picked { station: 0, index };
        let at = seen(&harness, picked)?;
        harness.hover_at(at);
        harness.run_steps(2);
        harness.state().state.time.hover_s.map(|_| (picked, at))
    });
    let (picked, at) = found.expect("a reading that can be seen");
    double_click(&mut harness, at);
    let near = camera(&harness);
    assert!(near.distance_m < 0.5 * all.distance_m, "{near:?}");
    let (open, analysis) = harness.state().state.analysed().expect("an answer");
    let place_m = picked.place_m(&open.deployment, analysis).expect("placed");
    assert!((near.target_m.cast::<f64>() - place_m).norm() < 3.0, "{near:?} {place_m}");
    // The camera can go to the picked reading without a mouse.
    send(&mut harness, TimeCommand::PickInPlot(picked));
    send(&mut harness, SceneCommand::Look(ViewPreset::Fit));
    press(&mut harness, Modifiers::NONE, Key::G);
    assert!((camera(&harness).distance_m - near.distance_m).abs() < 1e-3);
    let nothing = |harness: &mut Window| {
        let edge = picture(harness);
        (1..40).map(|step| edge.right_bottom() - egui::vec2(20.0 * step as f32, 8.0)).find(|at| {
            harness.hover_at(*at);
            harness.run_steps(2);
            harness.state().state.time.hover_s.is_none()
        })
    };
    let beside = nothing(&mut harness).expect("a place beside everything");
    double_click(&mut harness, beside);
    assert!((camera(&harness).distance_m - all.distance_m).abs() < 0.05 * all.distance_m);
}

/// Returns the strip's text on the grid.
fn grid(harness: &Window) -> String {
    let strip = strip(harness);
    let grid = strip.split(" · ").find(|item| item.starts_with("grid "));
    grid.expect("there is a grid").to_owned()
}

#[test]
fn the_camera_cannot_be_lost_and_the_grid_goes_with_it() {
    let mut harness = window(LARGE, Theme::Dark);
    let all = harness.state().state.scene.view.camera;
    let at_first = grid(&harness);
    let middle = picture(&harness).center();
    harness.hover_at(middle);
    for zoom in [40.0, -40.0] {
        for _ in 0..40 {
            harness.event(egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Line,
                delta: egui::vec2(0.0, zoom),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Unknown,
                modifiers: Modifiers::NONE,
            });
            harness.run_steps(2);
        }
        settle(&mut harness);
        let camera = harness.state().state.scene.view.camera;
        assert!(camera.distance_m > 0.01 && camera.distance_m < 5000.0, "{camera:?}");
        assert_ne!(grid(&harness), at_first);
    }
    press(&mut harness, Modifiers::NONE, Key::F);
    let back = harness.state().state.scene.view.camera;
    assert!((back.distance_m - all.distance_m).abs() < 0.05 * all.distance_m, "{back:?}");
    assert_eq!(grid(&harness), at_first);
}

#[test]
fn under_the_pointer_the_strip_says_what_has_no_room_and_nothing_else() {
    let said = |size: Vec2| {
        let mut harness = window(size, Theme::Dark);
        send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
        let at = harness.get_by_role(Role::Status).rect().center();
        harness.hover_at(at);
        harness.run_steps(8);
        let count = |words: &str| harness.query_all_by_label_contains(words).count();
        // The strip itself has the whole text for screen readers.
        ["ellipsoids ×100", "frame of station 1"].map(|words| count(words) - 1)
    };
    assert_eq!(said(SMALL), [0, 1]);
    assert_eq!(said(Vec2::new(2560.0, 1440.0)), [0, 0]);
}

#[test]
fn control_points_are_named_by_their_set_and_listed_with_what_is_left_at_them() {
    let mut harness = window(LARGE, Theme::Dark);
    assert!(strip(&harness).contains("residuals ×1000"));
    let sets = &shown(&harness).deployment.control_points;
    assert!(sets.len() > 1, "the sample has several");
    let (file, marker) = (sets[0].file.clone(), sets[0].points[0].marker);
    assert!(harness.query_by_label_contains(&format!("P  {file}")).is_some());
    let with = harness.render().expect("a picture");
    click(&mut harness, "Show residuals at control points");
    assert!(!harness.state().state.scene.visibility.residuals);
    assert_ne!(with, harness.render().expect("a picture"));
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::ControlPoints));
    let far = harness.state().state.scene.view.camera;
    click(&mut harness, &format!("Go to control point P{marker}"));
    assert!(harness.state().state.scene.view.camera.distance_m < far.distance_m);
}

#[test]
fn arrows_fit_the_scene_until_the_user_chooses_their_scale() {
    let mut harness = window(LARGE, Theme::Dark);
    let scale = |harness: &Window| {
        let text = strip(harness);
        let (_, after) = text.split_once("residuals ×").expect("it says so");
        after.split(|c: char| !c.is_ascii_digit()).next().map(str::to_owned)
    };
    let automatic = scale(&harness);
    let mut deployment =
        resect_io::simulation_files::open(&simulate(Preset::Warthog, 1)).expect("valid");
    // Ten times as large residuals have a tenth of the scale, or a little more.
    for set in &mut deployment.control_points {
        for (number, point) in set.points.iter_mut().enumerate() {
            let sign = if number % 2 == 0 { 1.0 } else { -1.0 };
            point.readings[1].as_mut().expect("measured").range_m += sign * 0.03;
        }
    }
    open(&mut harness, deployment);
    let larger = scale(&harness);
    let number = |text: &Option<String>| text.as_ref().and_then(|text| text.parse::<u32>().ok());
    assert!(number(&larger) < number(&automatic), "{larger:?} {automatic:?}");
    let options =
        SceneOptions { residual_scale: Some(10_000), ..harness.state().state.scene.options };
    send(&mut harness, SceneCommand::SetOptions(options));
    assert_eq!(scale(&harness).as_deref(), Some("10000"));
}
