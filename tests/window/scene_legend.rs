//! Effects of the legend's switches on the scene, the strip and the camera.

use egui::accesskit::Role;
use egui::{Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    LayoutPreset, SceneCommand, SceneOptions, ViewPreset, Visibility, WorkspaceCommand,
};
use resect_core::pipeline::SampleFate;

use crate::harness::{LARGE, SMALL, Window, click, send, set, window};

fn visibility(harness: &Window) -> Visibility {
    harness.state().state.scene.visibility
}

/// Returns true if the strip under the scene has this text.
fn says(harness: &Window, text: &str) -> bool {
    harness
        .query_all_by_role(Role::Status)
        .any(|strip| strip.accesskit_node().label().is_some_and(|label| label.contains(text)))
}

#[test]
fn the_legend_starts_folded_where_there_is_no_room_and_stays_as_it_was_chosen() {
    let unfolded = |harness: &Window| harness.query_by_label("Show station 2").is_some();
    let mut harness = window(LARGE, Theme::Dark);
    assert!(unfolded(&harness));
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
    assert!(!unfolded(&harness));
    click(&mut harness, "Legend");
    assert!(unfolded(&harness));
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
    click(&mut harness, "Legend");
    send(&mut harness, WorkspaceCommand::ResetLayout);
    assert!(!unfolded(&harness), "folded by hand");
    assert!(!unfolded(&window(SMALL, Theme::Light)));
}

#[test]
fn a_click_on_a_row_hides_what_it_names_and_the_strip_says_so() {
    let mut harness = window(LARGE, Theme::Dark);
    assert!(!says(&harness, "hidden"));
    let shown = harness.render().expect("a picture");
    for (row, text) in [
        ("Show readings: in no interval", "readings (in no interval)"),
        ("Show the track of prism 3", "track 3"),
        ("Show station 2", "station 2"),
    ] {
        click(&mut harness, row);
        assert!(says(&harness, text), "{row}");
    }
    let place = SampleFate::ALL.iter().position(|fate| *fate == SampleFate::InNoInterval);
    let now = visibility(&harness);
    assert!(!now.fates[place.expect("a fate")] && !now.prisms[2] && !now.stations[1]);
    let hidden = harness.render().expect("a picture");
    assert_ne!(shown, hidden);
    click(&mut harness, "Show everything");
    assert_eq!(visibility(&harness), Visibility::default());
    assert!(!says(&harness, "hidden"));
    // Twice, so that the second click reverts the first.
    click(&mut harness, "Show readings: in no interval");
    click(&mut harness, "Show readings: in no interval");
    assert_eq!(visibility(&harness), Visibility::default());
}

#[test]
fn fit_looks_at_what_is_shown() {
    let mut harness = window(LARGE, Theme::Dark);
    let camera = |harness: &Window| harness.state().state.scene.view.camera;
    let all = camera(&harness);
    // The stations are within a few metres of each other, far from the drive.
    let hidden =
        Visibility { raw: false, tracks: false, control_points: false, ..Visibility::default() };
    send(&mut harness, SceneCommand::Show(hidden));
    assert_eq!(camera(&harness), all, "hiding moves nothing");
    send(&mut harness, SceneCommand::Look(ViewPreset::Fit));
    let stations = camera(&harness);
    assert!(stations.distance_m < 0.5 * all.distance_m, "{stations:?}");
    assert!(stations.target_m.norm() < 15.0, "{stations:?}");
    send(&mut harness, SceneCommand::Show(Visibility::default()));
    send(&mut harness, SceneCommand::Look(ViewPreset::Fit));
    let again = camera(&harness);
    assert!((again.distance_m - all.distance_m).abs() < 1e-2 * all.distance_m);
    // An open legend takes room from the picture: the fitted content is smaller beside it.
    click(&mut harness, "Legend");
    assert!(camera(&harness).distance_m < 0.99 * all.distance_m);
}

#[test]
fn ellipsoids_keep_their_scale_whatever_the_answer() {
    let mut harness = window(LARGE, Theme::Dark);
    assert!(says(&harness, "ellipsoids ×100"));
    set(&mut harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 30.0);
    assert!(says(&harness, "ellipsoids ×100"));
    let before = harness.render().expect("a picture");
    harness.get_by_role_and_label(Role::ComboBox, "Scale of the ellipsoids").click();
    harness.run_steps(3);
    click(&mut harness, "×1000");
    assert_eq!(harness.state().state.scene.options.ellipsoid_scale, 1000);
    assert!(says(&harness, "ellipsoids ×1000"));
    assert_ne!(before, harness.render().expect("a picture"));
    let options = SceneOptions { ellipsoid_scale: 1, ..SceneOptions::default() };
    send(&mut harness, SceneCommand::SetOptions(options));
    assert!(says(&harness, "ellipsoids ×1:"));
}

#[test]
fn the_strip_is_as_high_whatever_it_says() {
    for size in [LARGE, SMALL, Vec2::new(1600.0, 1200.0)] {
        let mut harness = window(size, Theme::Light);
        let picture =
            |harness: &Window| harness.get_by_role_and_label(Role::Image, "Scene").rect().size();
        let before = picture(&harness);
        send(&mut harness, SceneCommand::Show(Visibility { raw: false, ..Visibility::default() }));
        send(
            &mut harness,
            SceneCommand::Measure(resect::app::Ruler { active: true, ends: vec![] }),
        );
        assert!(
            says(&harness, "ruler: click the first point") && says(&harness, "hidden: readings")
        );
        assert_eq!(picture(&harness), before);
    }
}
