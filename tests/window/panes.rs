//! Each pane in its main states, dark and light.

use egui::{Event, Key, Modifiers, Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    Colouring, DeploymentCommand, LayoutPreset, Pane, Picked, ResultsCommand, Ruler, RulerEnd,
    SceneCommand, TimeCommand, ViewPreset, WorkspaceCommand,
};
use resect_core::analysis::Analysis;
use resect_core::calibration::Calibration;
use resect_core::pipeline::{OutlierReason, SampleFate};

use crate::harness::{
    LARGE, Part, SMALL, Window, press, send, set, settle, shown, snapshot, snapshot_of, triplets,
    window,
};

const THEMES: [(Theme, &str); 2] = [(Theme::Dark, "dark"), (Theme::Light, "light")];

/// Draws a state in both themes, the first region in the dark and the second in the light one, and checks its contents.
fn both(
    name: &str,
    size: Vec2,
    parts: [Part; 2],
    prepare: impl Fn(&mut Window),
    check: impl Fn(&Window),
) {
    for ((theme, suffix), part) in THEMES.into_iter().zip(parts) {
        let mut harness = window(size, theme);
        prepare(&mut harness);
        check(&harness);
        snapshot_of(&mut harness, part, &format!("{name}-{suffix}"));
    }
}

/// Asserts that a text is in the window.
#[track_caller]
fn assert_shown(harness: &Window, text: &str) {
    assert!(is_shown(harness, text), "{text} is not shown");
}

fn is_shown(harness: &Window, text: &str) -> bool {
    harness.query_all_by(|_| true).any(|node| {
        let node = node.accesskit_node();
        let texts = [node.label(), node.value()].into_iter().flatten();
        // Long texts have non-breaking spaces between numbers and units.
        texts.into_iter().any(|own| own.replace('\u{a0}', " ").contains(text))
    })
}

fn analysis(harness: &Window) -> &Analysis {
    harness.state().state.analysed().expect("an answer").1
}

fn calibration(harness: &Window) -> &Calibration {
    &analysis(harness).answer.as_ref().expect("an answer").calibration
}

/// Returns the first reading that was rejected for its azimuth rate.
fn rejected(harness: &Window) -> Picked {
    let analysis = analysis(harness);
    let wanted = SampleFate::Rejected(OutlierReason::Azimuth);
    let find = |station: usize| {
        let each = &analysis.pipeline.fates[station].each;
        each.iter().position(|fate| *fate == wanted).map(|index| Picked { station, index })
    };
    (0..3).find_map(find).expect("the sample has outliers")
}

#[test]
fn inspect_explains_the_picked_reading() {
    let prepare = |harness: &mut Window| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Inspect));
        let picked = rejected(harness);
        send(harness, TimeCommand::PickInScene(picked));
    };
    let check = |harness: &Window| {
        let Picked { station, index } = rejected(harness);
        let readings = &shown(harness).deployment.tracks[station].measurements;
        assert_shown(harness, &format!("reading {} of {}", index + 1, readings.len()));
        assert_shown(harness, &format!("{:.4}", readings[index].range_m));
        assert_shown(harness, "rejected: azimuth rate");
        // The excessive rate, and the threshold that would keep the reading.
        assert_shown(harness, "τ_a 1  ✗");
        assert_shown(harness, "Set τ_a 1 → ");
    };
    both("inspect", LARGE, [Part::Window, Part::Pane(Pane::Reading)], prepare, check);
}

#[test]
fn tune_has_rates_and_intervals_with_a_part_of_them_selected() {
    let prepare = |harness: &mut Window| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
        let start_s = shown(harness).start_s();
        send(harness, TimeCommand::ShowTimes([start_s + 60.0, start_s + 300.0]));
        send(harness, TimeCommand::Select(Some([start_s + 120.0, start_s + 180.0])));
    };
    let check = |harness: &Window| {
        for plot in ["range rate", "azimuth rate", "zenith rate"] {
            harness.get_by_label(&format!("{plot} over time"));
        }
        harness.get_by_label("readings, silences and intervals over time");
        assert_shown(harness, "60.0 s selected");
        let triplets = triplets(harness);
        assert_shown(harness, &format!("intervals → {triplets} triplets"));
    };
    both("tune", LARGE, [Part::Window, Part::Pane(Pane::Rates)], prepare, check);
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Tune));
    snapshot(&mut harness, "tune-small-light");
}

#[test]
fn compare_has_deployments_runs_and_what_is_pinned() {
    let prepare = |harness: &mut Window| {
        send(harness, WorkspaceCommand::UseLayout(LayoutPreset::Compare));
        send(harness, ResultsCommand::Pin);
        set(harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 15.0);
    };
    let check = |harness: &Window| {
        // A column each, with the number of its own triplets.
        let pinned = harness.state().state.results.pins[0].summary.triplets;
        let triplets = triplets(harness);
        assert!(triplets < pinned, "{triplets} of {pinned}");
        for count in [pinned, triplets] {
            assert_shown(harness, &count.to_string());
        }
        harness.get_by_label("Run 1, good: warthog (simulated)");
        harness.get_by_label("Run 2, good: τ_l 6 → 15 s");
        assert_shown(harness, "Use the settings of E");
    };
    both("compare", LARGE, [Part::Window, Part::Pane(Pane::SideBySide)], prepare, check);
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, WorkspaceCommand::UseLayout(LayoutPreset::Compare));
    snapshot(&mut harness, "compare-small-dark");
}

#[test]
fn findings_are_listed() {
    let prepare = |harness: &mut Window| {
        set(harness, |settings| settings.pipeline.outlier_filter = false);
        send(harness, WorkspaceCommand::ShowPane(Pane::Findings));
    };
    let check = |harness: &Window| {
        let findings = &calibration(harness).findings;
        assert!(!findings.is_empty());
        for finding in shown(harness).deployment.findings.iter().chain(findings) {
            assert_shown(harness, &harness.state().state.workspace.units.message(finding));
        }
    };
    both("findings", SMALL, [Part::Pane(Pane::Findings); 2], prepare, check);
}

#[test]
fn the_scene_measures_and_colours_by_numbers() {
    let prepare = |harness: &mut Window| {
        send(harness, SceneCommand::Colour(Colouring::Residual));
        let at = &analysis(harness).triplets().points_m[0];
        let end = |index: usize| RulerEnd {
            position_m: at[index],
            what: "track 1".to_owned(),
            prism: None,
        };
        let ends = vec![end(0), end(at.len() / 3)];
        send(harness, SceneCommand::Measure(Ruler { active: true, ends }));
        send(harness, SceneCommand::Look(ViewPreset::Top));
    };
    let check = |harness: &Window| {
        let colour = harness.get_by_label("Colour by").accesskit_node().value();
        assert_eq!(colour.as_deref(), Some("Residual"));
        // The key is that of residuals, not that of fates.
        assert!(!is_shown(harness, "rejected: azimuth rate"));
    };
    both("scene-residual", SMALL, [Part::Pane(Pane::Scene); 2], prepare, check);
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
        |harness| {
            let layouts = harness.query_all_by_label_contains("Layout").count();
            assert!(layouts >= LayoutPreset::ALL.len(), "{layouts} layouts");
            // Only lines with the typed text are left.
            assert!(!is_shown(harness, "Method B:"));
        },
    );
    both(
        "shortcuts",
        SMALL,
        [Part::Middle(Vec2::new(1060.0, 640.0)), Part::Middle(Vec2::new(1060.0, 640.0))],
        |harness| press(harness, Modifiers::NONE, Key::Questionmark),
        |harness| {
            for text in ["Keyboard and mouse", "Ctrl+P", "drag a τ line"] {
                assert_shown(harness, text);
            }
        },
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
            // The name differs in each run: without it the content stays in view.
            press(harness, Modifiers::COMMAND, Key::A);
            press(harness, Modifiers::NONE, Key::Delete);
        },
        |harness| {
            // Each file with its kind; text without data is no deployment.
            for entry in ["2024-05-03/", "tracks.csv deployment", "notes.txt"] {
                harness.get_by_label(entry);
            }
        },
    );
}

/// A tab can be dragged to any small size, where egui's own checks detect negative widths.
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
    harness.run_steps(3);
    assert!(shown(&harness).analysis.is_some());
}

#[test]
fn each_pane_shows_numbers_of_the_analysis() {
    let mut harness = window(LARGE, Theme::Dark);
    let triplets = triplets(&harness);
    let evaluation = &analysis(&harness).answer.as_ref().expect("an answer").evaluation;
    let spread = evaluation.inter_prism_mm.expect("three prisms");
    let x_m = calibration(&harness).station1_from_station[1].translation_m.x;
    let readings: Vec<usize> =
        shown(&harness).deployment.tracks.iter().map(|track| track.measurements.len()).collect();
    let point = &shown(&harness).deployment.control_points[0].points[0];
    let panes = [
        (Pane::Deployment, format!("{} readings", readings[0])),
        (Pane::Pipeline, format!("→ {triplets} triplets")),
        (Pane::Result, format!("{x_m:.3}")),
        (Pane::SideBySide, triplets.to_string()),
        (Pane::Runs, "Run 1, good: warthog (simulated)".to_owned()),
        (Pane::Residuals, "distance errors 2–3 over time".to_owned()),
        (Pane::Histogram, "distribution of the errors 1–3".to_owned()),
        (Pane::ControlPoints, format!("Go to control point P{}", point.marker)),
        (Pane::Channels, "σ position over time".to_owned()),
        (Pane::Solver, "solver: the joint estimate converged".to_owned()),
        (Pane::Clocks, "clocks over time".to_owned()),
    ];
    for (pane, text) in panes {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        assert!(is_shown(&harness, &text), "{text} is not shown in {pane:?}");
    }
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Result));
    for value in [spread.median, spread.iqr] {
        assert_shown(&harness, &format!("{value:.2}"));
    }
}
