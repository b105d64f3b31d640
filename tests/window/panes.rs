//! Each pane in its main states, dark and light.

use egui::{Event, Key, Modifiers, Theme, Vec2};
use resect::app::{
    Colouring, DeploymentCommand, LayoutPreset, Pane, Picked, PictureTo, ResultsCommand, Ruler,
    RulerEnd, SceneCommand, TimeCommand, ViewPreset, WorkspaceCommand,
};
use resect_core::pipeline::{OutlierReason, SampleFate};

use crate::harness::{
    LARGE, Part, SMALL, Window, press, send, set, settle, snapshot, snapshot_of, window,
};

const THEMES: [(Theme, &str); 2] = [(Theme::Dark, "dark"), (Theme::Light, "light")];

/// Draws a state in both themes: the first part in the dark, the second in the light.
fn both(name: &str, size: Vec2, parts: [Part; 2], prepare: impl Fn(&mut Window)) {
    for ((theme, suffix), part) in THEMES.into_iter().zip(parts) {
        let mut harness = window(size, theme);
        prepare(&mut harness);
        snapshot_of(&mut harness, part, &format!("{name}-{suffix}"));
    }
}

/// The first reading that was rejected for its azimuth rate.
fn rejected(harness: &Window) -> Picked {
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let wanted = SampleFate::Rejected(OutlierReason::Azimuth);
    let find = |station: usize| {
        let each = &analysis.pipeline.fates[station].each;
        each.iter().position(|fate| *fate == wanted).map(|index| Picked { station, index })
    };
    (0..3).find_map(find).expect("the sample has outliers")
}

#[test]
fn inspect_explains_the_picked_reading() {
    both("inspect", LARGE, [Part::Window, Part::Pane(Pane::Reading)], |harness| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
        let picked = rejected(harness);
        send(harness, TimeCommand::PickInScene(picked));
    });
}

#[test]
fn tune_has_rates_and_intervals_with_a_part_of_them_selected() {
    both("tune", LARGE, [Part::Window, Part::Pane(Pane::Rates)], |harness| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
        let start_s = crate::harness::shown(harness).start_s();
        send(harness, TimeCommand::ShowTimes([start_s + 60.0, start_s + 300.0]));
        send(harness, TimeCommand::Select(Some([start_s + 120.0, start_s + 180.0])));
    });
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
    snapshot(&mut harness, "tune-small-light");
}

#[test]
fn compare_has_deployments_runs_and_what_is_pinned() {
    both("compare", LARGE, [Part::Window, Part::Pane(Pane::SideBySide)], |harness| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Compare));
        send(harness, ResultsCommand::Pin);
        set(harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 15.0);
    });
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Compare));
    snapshot(&mut harness, "compare-small-dark");
}

#[test]
fn findings_are_listed() {
    both("findings", SMALL, [Part::Pane(Pane::Findings), Part::Pane(Pane::Findings)], |harness| {
        set(harness, |settings| settings.pipeline.outlier_filter = false);
        send(harness, WorkspaceCommand::ShowPane(Pane::Findings));
    });
}

#[test]
fn the_scene_measures_and_colours_by_numbers() {
    both("scene-residual", SMALL, [Part::Pane(Pane::Scene), Part::Pane(Pane::Scene)], |harness| {
        send(harness, SceneCommand::Colour(Colouring::Residual));
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        let at = &analysis.triplets().points_m[0];
        let end = |index: usize| RulerEnd {
            position_m: at[index],
            what: "track 1".to_owned(),
            prism: None,
        };
        let ends = vec![end(0), end(at.len() / 3)];
        send(harness, SceneCommand::Measure(Ruler { active: true, ends }));
        send(harness, SceneCommand::Look(ViewPreset::Top));
    });
}

#[test]
fn the_palette_and_the_sheet_of_shortcuts() {
    both(
        "palette",
        SMALL,
        [Part::Middle(Vec2::new(600.0, 240.0)), Part::Middle(Vec2::new(600.0, 240.0))],
        |harness| {
            press(harness, Modifiers::COMMAND, Key::P);
            harness.event(Event::Text("lay".to_owned()));
            settle(harness);
        },
    );
    both(
        "shortcuts",
        SMALL,
        [Part::Middle(Vec2::new(1060.0, 640.0)), Part::Middle(Vec2::new(1060.0, 640.0))],
        |harness| press(harness, Modifiers::NONE, Key::Questionmark),
    );
}

#[test]
fn paths_are_asked_for_in_the_window() {
    let temporary = tempfile::tempdir().expect("a folder");
    let folder = temporary.path();
    std::fs::create_dir_all(folder.join("2024-05-03")).expect("writable");
    let tracks = "timestamp,id,distance,ha,va\n1,1,2,3,1.5\n";
    std::fs::write(folder.join("tracks.csv"), tracks).expect("writable");
    std::fs::write(folder.join("notes.txt"), "it rained\n").expect("writable");
    both(
        "prompt",
        SMALL,
        [Part::Middle(Vec2::new(760.0, 660.0)), Part::Middle(Vec2::new(760.0, 660.0))],
        |harness| {
            send(harness, DeploymentCommand::OpenFileDialog);
            press(harness, Modifiers::COMMAND, Key::A);
            harness.event(Event::Text(format!("{}/", folder.display())));
            settle(harness);
            // Its name is another each time: what is in it stays in sight without it.
            press(harness, Modifiers::COMMAND, Key::A);
            press(harness, Modifiers::NONE, Key::Delete);
        },
    );
}

#[test]
fn a_picture_of_the_scene_has_no_buttons() {
    let mut harness = window(SMALL, Theme::Dark);
    let ctx = harness.ctx.clone();
    harness.state_mut().send(SceneCommand::Picture(PictureTo::Clipboard), &ctx);
    harness.run_steps(1);
    assert!(harness.state().state.scene.picturing);
    use egui_kittest::kittest::Queryable;
    assert!(harness.query_by_label("Colour by").is_none());
    harness.run_steps(1);
    assert!(harness.query_by_label("Colour by").is_some());
}

/// A tab can be dragged to be as small as a border lets it, and egui's own checks see widths below nothing.
#[test]
fn a_pane_of_any_size_breaks_nothing() {
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, ResultsCommand::Pin);
    for preset in LayoutPreset::ALL {
        send(&mut harness, WorkspaceCommand::UseLayout(preset));
        for pane in Pane::ALL {
            send(&mut harness, WorkspaceCommand::ShowPane(pane));
            for side in [300.0, 180.0, 120.0, 90.0, 60.0, 30.0] {
                harness.set_size(Vec2::splat(side));
                harness.run_steps(1);
            }
            harness.set_size(SMALL);
        }
    }
}
