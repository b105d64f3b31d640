//! Pictures of the window.

use egui::{Theme, Vec2};
use egui_kittest::kittest::Queryable;
use resect::app::{DeploymentCommand, Pane, ResultsCommand, StudyKind, WorkspaceCommand};
use resect_core::analysis::Settings;
use resect_core::calibration::Method;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate};

use crate::common;
use crate::harness::{
    LARGE, Part, SMALL, Window, set, settle, snapshot, snapshot_of, triplets, window,
};

fn cursor_s(harness: &Window) -> f64 {
    harness.state().state.active().and_then(|open| open.timeline.cursor_s).expect("a cursor")
}

#[test]
fn the_window_after_opening_the_sample() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "sample-dark"),
        (LARGE, Theme::Light, "sample-light"),
        (SMALL, Theme::Dark, "sample-small-dark"),
        (SMALL, Theme::Light, "sample-small-light"),
    ] {
        let mut harness = window(size, theme);
        snapshot(&mut harness, name);
    }
}

#[test]
fn switching_the_outlier_filter_off_lets_more_through() {
    for (theme, name) in
        [(Theme::Dark, "no-outlier-filter-dark"), (Theme::Light, "no-outlier-filter-light")]
    {
        let mut harness = window(LARGE, theme);
        let before = triplets(&harness);
        harness.get_by_label("1  Outlier filter").click();
        settle(&mut harness);
        assert!(!harness.state().state.settings().pipeline.outlier_filter);
        assert!(triplets(&harness) > before);
        snapshot_of(&mut harness, Part::Pane(Pane::Pipeline), name);
        harness.get_by_label("Reset to the defaults").click();
        settle(&mut harness);
        assert_eq!(triplets(&harness), before);
    }
}

#[test]
fn an_error_is_shown_and_what_was_open_stays() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("broken.csv");
    std::fs::write(&file, "timestamp,id,distance,ha,va\n0,1,10,x,1.5\n").expect("writable");
    for (theme, name) in [(Theme::Dark, "error-dark"), (Theme::Light, "error-light")] {
        let mut harness = window(SMALL, theme);
        let before = triplets(&harness);
        let ctx = harness.ctx.clone();
        harness.state_mut().send(DeploymentCommand::OpenPaths(vec![file.clone()]), &ctx);
        settle(&mut harness);
        let (text, remedy) = harness.state().state.toasts.errors().next().expect("an error");
        assert!(text.contains("broken.csv:2") && text.contains("is not a number"), "{text}");
        assert_eq!(remedy, "correct or delete the line");
        assert_eq!(triplets(&harness), before);
        snapshot_of(&mut harness, Part::Bottom(70.0), name);
        harness.get_by_label("Dismiss").click();
        settle(&mut harness);
        assert!(harness.state().state.toasts.shown().is_empty());
    }
}

#[test]
fn the_other_sample_opens_from_the_menu() {
    let mut harness = window(LARGE, Theme::Dark);
    harness.get_by_label("File").click();
    harness.run_steps(3);
    harness.get_by_label("Sample: HD2 in a tunnel").click();
    settle(&mut harness);
    let deployment = harness.state().state.active().expect("open").deployment.clone();
    assert_eq!(deployment.name, "hd2-tunnel (simulated)");
    snapshot_of(&mut harness, Part::Pane(Pane::Scene), "tunnel-dark");
}

#[test]
fn a_threshold_can_be_typed() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = triplets(&harness);
    // A click on the number turns it into a text field with everything selected.
    harness.get_by_role_and_label(egui::accesskit::Role::SpinButton, "τ_l  length").click();
    harness.run_steps(2);
    harness.event(egui::Event::Text("25".to_owned()));
    harness.run_steps(2);
    harness.key_press(egui::Key::Enter);
    settle(&mut harness);
    assert_eq!(harness.state().state.settings().pipeline.thresholds.tau_l_seconds, 25.0);
    assert!(triplets(&harness) < before);
}

#[test]
fn the_newest_request_wins() {
    let mut harness = window(SMALL, Theme::Dark);
    let ctx = harness.ctx.clone();
    for tau_l in [8.0, 12.0, 16.0, 20.0, 30.0] {
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_l_seconds = tau_l;
        harness.state_mut().send(DeploymentCommand::Set(settings), &ctx);
    }
    settle(&mut harness);
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    assert_eq!(analysis.settings.pipeline.thresholds.tau_l_seconds, 30.0);
    assert!(!harness.state().state.is_busy());
}

#[test]
fn copy_gives_the_text_of_the_command_line() {
    let mut harness = window(LARGE, Theme::Dark);
    harness.get_by_label("Copy as text").click();
    harness.run_steps(1);
    let copied =
        harness.output().platform_output.commands.iter().find_map(|command| match command {
            egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        });
    let copied = copied.expect("something was copied");
    assert!(copied.contains("verdict: GOOD") && copied.contains("T13"), "{copied}");
}

#[test]
fn a_click_in_the_residuals_moves_the_cursor() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = cursor_s(&harness);
    let plot = harness.get_by_label("distance errors 1–2 over time").rect();
    let (at, share) = (plot.left_center() + Vec2::new(0.75 * plot.width(), 0.0), 0.75);
    harness.hover_at(at);
    harness.run_steps(1);
    harness.drag_at(at);
    harness.run_steps(1);
    harness.drop_at(at);
    settle(&mut harness);
    let after = cursor_s(&harness);
    let [start_s, end_s] = harness.state().state.active().expect("open").timeline.window_s;
    let expected = start_s + share * (end_s - start_s);
    assert!((after - expected).abs() < 2.0, "{before} {after} {expected}");
}

/// A file as the window system passes it.
#[derive(Debug)]
struct Dropped(std::path::PathBuf);

impl egui::DroppedFile for Dropped {
    fn path(&self) -> &std::path::Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|error| error.to_string())
    }
}

#[test]
fn a_dropped_folder_opens() {
    let mut harness = window(SMALL, Theme::Dark);
    let folder = common::sample_folder("hd2-tunnel");
    harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(folder)));
    settle(&mut harness);
    let deployment = harness.state().state.active().expect("open").deployment.clone();
    assert_eq!(deployment.name, "hd2-tunnel (simulated)");
}

#[test]
fn hiding_a_station_takes_it_out_of_the_scene_and_back() {
    let mut harness = window(SMALL, Theme::Dark);
    let shown = harness.render().expect("a picture");
    harness.get_by_label("Station 2").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.scene.visibility.stations[..3], [true, false, true]);
    let hidden = harness.render().expect("a picture");
    harness.get_by_label("Station 2").click();
    settle(&mut harness);
    let again = harness.render().expect("a picture");
    // Inside the scene, away from the clicked switch.
    let differ = |a: &image::RgbaImage, b: &image::RgbaImage| {
        a.enumerate_pixels()
            .filter(|(x, y, _)| (300..740).contains(x) && (230..480).contains(y))
            .filter(|(x, y, pixel)| b.get_pixel(*x, *y) != *pixel)
            .count()
    };
    assert!(differ(&shown, &hidden) > 100, "{}", differ(&shown, &hidden));
    assert_eq!(differ(&shown, &again), 0);
}

fn open_sample(harness: &mut Window, sample: Sample) {
    let ctx = harness.ctx.clone();
    harness.state_mut().send(DeploymentCommand::OpenSample(sample), &ctx);
    settle(harness);
}

fn show(harness: &mut Window, pane: Pane) {
    let ctx = harness.ctx.clone();
    harness.state_mut().send(WorkspaceCommand::ShowPane(pane), &ctx);
    settle(harness);
}

#[test]
fn a_comparison_is_run_and_drawn() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "studies-dark"),
        (LARGE, Theme::Light, "studies-light"),
        (SMALL, Theme::Light, "studies-small-light"),
    ] {
        let mut harness = window(size, theme);
        harness.get_by_label("Studies").click();
        harness.run_steps(3);
        harness.get_by_label("Run").click();
        settle(&mut harness);
        let result = harness.state().state.results.studies.result.clone().expect("it ran");
        assert_eq!(result.study().groups.len(), 5);
        // The README shows the whole window.
        let part = if name == "studies-light" { Part::Window } else { Part::Pane(Pane::Studies) };
        snapshot_of(&mut harness, part, name);
    }
}

#[test]
fn an_ablation_can_be_chosen_and_judged_by_d() {
    let mut harness = window(LARGE, Theme::Dark);
    show(&mut harness, Pane::Studies);
    harness.get_by_label("Ablate the pipeline").click();
    harness.run_steps(3);
    harness.get_by_label("Run").click();
    settle(&mut harness);
    let result = harness.state().state.results.studies.result.clone().expect("it ran");
    assert_eq!(result.study().name, "ablation");
    assert_eq!(result.study().series.len(), 3);
    snapshot_of(&mut harness, Part::Pane(Pane::Studies), "ablation-dark");
}

#[test]
fn a_study_can_be_cancelled() {
    let mut harness = window(SMALL, Theme::Dark);
    let ctx = harness.ctx.clone();
    let mut options = harness.state().state.results.studies.options;
    options.kind = StudyKind::Ablation;
    harness.state_mut().send(ResultsCommand::SetStudy(options), &ctx);
    harness.state_mut().send(ResultsCommand::RunStudy, &ctx);
    assert!(harness.state().state.results.studies.running.is_some());
    harness.state_mut().send(ResultsCommand::CancelStudy, &ctx);
    settle(&mut harness);
    let studies = &harness.state().state.results.studies;
    assert!(studies.running.is_none() && studies.result.is_none());
    assert!(harness.state().state.toasts.shown().is_empty());
}

#[test]
fn each_open_deployment_keeps_its_settings() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "side-by-side-dark"),
        (SMALL, Theme::Light, "side-by-side-small-light"),
    ] {
        let mut harness = window(size, theme);
        // A change makes the sample the user's own; an unchanged sample would be replaced.
        set(&mut harness, |s| s.calibration.method = Some(Method::StaticGcp));
        open_sample(&mut harness, Sample::Hd2Tunnel);
        set(&mut harness, |s| s.pipeline.thresholds.tau_l_seconds = 20.0);
        assert_eq!(harness.state().state.deployments.open.len(), 2);
        show(&mut harness, Pane::SideBySide);
        assert!(harness.query_by_label_contains("set up elsewhere").is_some());
        assert_eq!(
            harness.query_all_by_label_contains(" σ)").count(),
            0,
            "two places are no error"
        );
        snapshot_of(&mut harness, Part::Pane(Pane::SideBySide), name);
        harness.get_all_by_label("warthog (simulated)").next().expect("listed").click();
        settle(&mut harness);
        let settings = *harness.state().state.settings();
        assert_eq!(settings.calibration.method, Some(Method::StaticGcp));
        assert_eq!(settings.pipeline.thresholds.tau_l_seconds, 6.0);
        // At any scroll position.
        harness.get_by_label("Copy these settings to all runs").click_accesskit();
        settle(&mut harness);
        assert!(
            harness.state().state.deployments.open.iter().all(|open| open.settings == settings)
        );
    }
}

#[test]
fn the_sample_gives_way_to_what_the_user_opens() {
    let mut harness = window(SMALL, Theme::Dark);
    open_sample(&mut harness, Sample::Hd2Tunnel);
    let names: Vec<_> = harness
        .state()
        .state
        .deployments
        .open
        .iter()
        .map(|open| open.deployment.name.clone())
        .collect();
    assert_eq!(names, ["hd2-tunnel (simulated)"]);
    let id = harness.state().state.deployments.open[0].id;
    let ctx = harness.ctx.clone();
    harness.state_mut().send(DeploymentCommand::Close(id), &ctx);
    settle(&mut harness);
    assert!(harness.state().state.active().is_none());
    snapshot(&mut harness, "nothing-open-dark");
}

#[test]
fn the_search_of_the_prior_is_shown() {
    for (theme, name) in [(Theme::Dark, "prior-search-dark"), (Theme::Light, "prior-search-light")]
    {
        let mut harness = window(LARGE, theme);
        show(&mut harness, Pane::PriorSearch);
        harness.get_by_label("Search as published").click();
        settle(&mut harness);
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        let answer = analysis.answer.as_ref().expect("an answer");
        assert!(answer.calibration.inter_prism().expect("method D").prior_search.is_some());
        snapshot_of(&mut harness, Part::Pane(Pane::PriorSearch), name);
    }
}

#[test]
fn the_motion_model_shows_its_uncertainty() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "motion-model-dark"),
        (SMALL, Theme::Light, "motion-model-small-light"),
    ] {
        let mut harness = window(size, theme);
        harness.get_by_label("GP, motion model").click();
        settle(&mut harness);
        let (open, analysis) = harness.state().state.analysed().expect("an answer");
        assert!(analysis.pipeline.triplets.sigma_m.is_some());
        assert!(open.plots.bands.iter().all(|bands| !bands.is_empty()));
        let pane = if size == LARGE { Pane::Residuals } else { Pane::Scene };
        snapshot_of(&mut harness, Part::Pane(pane), name);
    }
}

#[test]
fn only_the_methods_that_the_data_allows_can_be_chosen() {
    for (theme, name) in [(Theme::Dark, "single-prism-dark"), (Theme::Light, "two-point-light")] {
        let mut harness = window(LARGE, theme);
        if theme == Theme::Dark {
            let deployment = resect_io::simulation_files::open(&simulate(Preset::SinglePrism, 1))
                .expect("valid");
            harness.state_mut().state.add(deployment.into(), None);
            settle(&mut harness);
        } else {
            harness.get_by_label("A  two-point resection").click();
            settle(&mut harness);
        }
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        let method = analysis.answer.as_ref().expect("an answer").calibration.method;
        let expected = if theme == Theme::Dark { Method::Joint } else { Method::TwoPoint };
        assert_eq!(method, expected);
        let pane = if theme == Theme::Dark { Pane::Pipeline } else { Pane::Result };
        snapshot_of(&mut harness, Part::Pane(pane), name);
        // A click on a disabled widget changes nothing.
        let refused = if theme == Theme::Dark {
            "D  inter-prism distances"
        } else {
            "C  dynamic control points"
        };
        harness.get_by_label(refused).click();
        settle(&mut harness);
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        assert_eq!(analysis.answer.as_ref().expect("an answer").calibration.method, expected);
    }
}

/// Tall enough for the whole result with the observability of the drive and the correlations of the errors.
#[test]
fn what_the_drive_does_not_hold_is_shown_at_the_stations_and_in_the_result() {
    for (preset, theme, size, name) in [
        (Preset::LShape, Theme::Dark, Vec2::new(1600.0, 1450.0), "l-shape-dark"),
        (Preset::StraightLine, Theme::Light, SMALL, "straight-line-small-light"),
    ] {
        let mut harness = window(size, theme);
        let simulated = simulate(preset, 1);
        let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        deployment.control_points.clear();
        harness.state_mut().state.add(deployment.into(), None);
        settle(&mut harness);
        if preset == Preset::LShape {
            harness.get_by_label("Correlations").click();
            settle(&mut harness);
        }
        let pane = if size == SMALL { Pane::Scene } else { Pane::Result };
        snapshot_of(&mut harness, Part::Pane(pane), name);
        // Without the arrows the picture differs.
        let shown = harness.render().expect("a picture");
        harness.get_by_label("weak directions").click();
        settle(&mut harness);
        assert!(!harness.state().state.scene.visibility.weak_directions);
        let hidden = harness.render().expect("a picture");
        // Below the legend, where the stations are.
        let bottom = (0.66 * size.y) as u32;
        let scene = |x: u32, y: u32| (300..740).contains(&x) && (240..bottom).contains(&y);
        let differ = (shown.enumerate_pixels())
            .filter(|(x, y, pixel)| scene(*x, *y) && hidden.get_pixel(*x, *y) != *pixel)
            .count();
        assert!(differ > 100, "{differ}");
    }
}
