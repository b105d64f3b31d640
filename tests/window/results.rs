//! Results in the window, driven by the names of the widgets: copying, pinning, the history of runs, and the picked reading.

use egui::{OutputCommand, Theme, accesskit::Role};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    AngleUnit, DeploymentCommand, LengthUnit, Pane, Picked, TimeCommand, Units, WorkspaceCommand,
};
use resect_core::calibration::{Method, PriorMethod};
use resect_core::deployment::Deployment;
use resect_core::pipeline::{Interpolation, OutlierReason, SampleFate};
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{
    LARGE, Part, SMALL, Window, click, open, send, set, settings, settle, shown, snapshot_of,
    window,
};

/// Clicks an entry of the Copy menu and returns the clipboard's text.
fn copy(harness: &mut Window, entry: &str) -> String {
    harness.get_by_label("Copy…").scroll_to_me();
    harness.run_steps(60);
    harness.get_by_label("Copy…").click();
    harness.run_steps(3);
    harness.get_by_label(entry).click();
    harness.run_steps(1);
    let commands = harness.output().platform_output.commands.clone();
    let copied = commands.into_iter().find_map(|command| match command {
        OutputCommand::CopyText(text) => Some(text),
        _ => None,
    });
    harness.run_steps(3);
    copied.unwrap_or_else(|| panic!("{entry} copied nothing"))
}

#[test]
fn the_copy_menu_gives_each_form() {
    let mut harness = window(LARGE, Theme::Dark);
    let toml: toml::Table = copy(&mut harness, "TOML").parse().expect("TOML");
    assert_eq!(toml["transforms"].as_array().map(Vec::len), Some(2));
    let json: serde_json::Value = serde_json::from_str(&copy(&mut harness, "JSON")).expect("JSON");
    let summary = harness.state().state.active().and_then(|o| o.summary.clone()).expect("one");
    assert_eq!(json["transforms"][0]["translation_m"][0], summary.stations[0].translation_m[0]);
    assert!(copy(&mut harness, "numpy").contains("T13 = np.array(["));
    let ros = copy(&mut harness, "ROS 2 static_transform_publisher");
    assert!(ros.contains("--child-frame-id station2") && ros.contains("station3"), "{ros}");

    // One transform alone: the menu stays open while it is chosen, and remembers the choice.
    harness.get_by_label("Copy…").click();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, "T13").click();
    harness.run_steps(3);
    harness.get_by_label("4×4 matrix").click();
    harness.run_steps(3);
    let ros = copy(&mut harness, "ROS 1 static_transform_publisher");
    assert!(!ros.contains("station2") && ros.contains("station3"), "{ros}");
}

#[test]
fn a_pinned_result_is_what_later_ones_are_seen_against() {
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "against-pinned-dark"),
        (SMALL, Theme::Light, "against-pinned-small-light"),
    ] {
        let mut harness = window(size, theme);
        assert!(harness.query_by_label("Compared with pinned result E").is_none());
        click(&mut harness, "Pin");
        assert_eq!(harness.state().state.results.pins.len(), 1);
        assert!(harness.query_by_label("This is the pinned result.").is_some());
        // A pinned result cannot be pinned again.
        click(&mut harness, "Pin");
        assert_eq!(harness.state().state.results.pins.len(), 1);

        set(&mut harness, |s| {
            s.calibration.method = Some(Method::InterPrism);
            s.calibration.prior = PriorMethod::Search;
        });
        set(&mut harness, |s| s.pipeline.thresholds.tau_a_deg_per_s = 0.5);
        assert!(harness.query_by_label("This is the pinned result.").is_none());
        assert!(harness.query_by_label("prior closed form → search").is_some());
        let method = "method joint estimate → D (inter-prism distances)";
        assert!(harness.query_by_label(method).is_some());
        assert!(harness.query_by_label("τ_a 1 → 0.5 °/s").is_some());
        snapshot_of(&mut harness, Part::Pane(Pane::Result), name);

        harness.get_by_label("Unpin E").scroll_to_me();
        harness.run_steps(3);
        click(&mut harness, "Unpin E");
        assert!(harness.state().state.results.pins.is_empty());
        assert!(harness.query_by_label("Compared with pinned result E").is_none());
    }
}

#[test]
fn the_papers_answer_is_one_click_away_and_the_joint_estimate_one_back() {
    let mut harness = window(LARGE, Theme::Dark);
    let method = |harness: &Window| {
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        analysis.answer.as_ref().expect("an answer").calibration.method
    };
    assert_eq!(method(&harness), Method::Joint);
    assert!(harness.query_by_label("Difference from the paper's D").is_some());

    click(&mut harness, "Show the paper's D");
    assert_eq!(method(&harness), Method::InterPrism);
    assert!(harness.query_by_label("Difference from the paper's D").is_none());

    click(&mut harness, "Reset to the defaults");
    assert_eq!(method(&harness), Method::Joint);
}

/// A drive without control points, which leaves directions open.
fn straight_drive() -> Deployment {
    let simulated = simulate(Preset::StraightLine, 1);
    let mut deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    deployment.control_points.clear();
    deployment
}

#[test]
fn the_result_begins_with_the_answer_to_use() {
    let mut harness = window(LARGE, Theme::Dark);
    let conclusion = harness.get_by_label("Use the joint estimate for this drive.").rect();
    let table = harness.get_by_label("Transforms into station 1").rect();
    assert!(conclusion.bottom() < table.top());
    open(&mut harness, straight_drive());
    assert!(harness.query_by_label_contains("Use no answer from this drive: ").is_some());
    assert!(harness.query_by_label_contains(" of 8 directions are not determined: ").is_some());
}

/// The paper's calibration is visible first, marked as preliminary.
#[test]
fn the_joint_estimate_is_said_to_follow() {
    let mut harness = window(LARGE, Theme::Dark);
    let ctx = harness.ctx.clone();
    let seen = (0..20).any(|step| {
        let mut settings = *harness.state().state.settings();
        settings.pipeline.thresholds.tau_l_seconds = 5.0 + 0.1 * f64::from(step);
        harness.state_mut().send(DeploymentCommand::Set(settings), &ctx);
        harness.run_steps(2);
        let follows = |harness: &Window| harness.state().state.deployments.open[0].joint_follows();
        while !follows(&harness) && harness.state().state.is_busy() {
            harness.state_mut().state.take_outcomes();
            std::thread::yield_now();
        }
        harness.run_steps(1);
        let said = harness.query_by_label("the joint estimate follows…").is_some()
            && harness.query_by_role_and_label(Role::Label, "D  inter-prism distances").is_some();
        settle(&mut harness);
        said
    });
    assert!(seen, "in none of twenty changes");
    assert!(harness.query_by_label("the joint estimate follows…").is_none());
}

#[test]
fn the_result_follows_the_units() {
    let mut harness = window(LARGE, Theme::Dark);
    let has =
        |harness: &Window, text: &str| harness.query_all_by_label_contains(text).next().is_some();
    assert!(has(&harness, " rad") && !has(&harness, " gon"));
    let units = Units { length: LengthUnit::Millimetre, angle: AngleUnit::Gon, ..Units::default() };
    send(&mut harness, WorkspaceCommand::SetUnits(units));
    assert!(has(&harness, " gon") && !has(&harness, " rad"));
    let summary = harness.state().state.active().and_then(|o| o.summary.clone()).expect("one");
    // As many decimals as σ, which has two digits.
    let sigma_mm = summary.stations[0].sigma.expect("held")[2] * 1e3;
    assert!((0.995..9.95).contains(&sigma_mm), "{sigma_mm}");
    let z = format!("{:.1} ", summary.stations[0].translation_m[2].abs() * 1e3);
    assert!(has(&harness, &z) && has(&harness, &format!(" ± {sigma_mm:.1}")), "{z}");
    set(&mut harness, |s| s.pipeline.rate_hz = 5.0);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Result));
    snapshot_of(&mut harness, Part::Pane(Pane::Result), "gon");
}

#[test]
fn the_history_names_what_changed_and_brings_it_back() {
    for (size, theme, name) in
        [(LARGE, Theme::Dark, "runs-dark"), (SMALL, Theme::Light, "runs-small-light")]
    {
        let mut harness = window(size, theme);
        set(&mut harness, |s| s.pipeline.thresholds.tau_l_seconds = 20.0);
        set(&mut harness, |s| {
            s.calibration.method = Some(Method::InterPrism);
            s.calibration.prior = PriorMethod::Search;
        });
        set(&mut harness, |s| s.pipeline.outlier_filter = false);
        send(&mut harness, WorkspaceCommand::ShowPane(Pane::Runs));
        assert_eq!(harness.state().state.results.runs.len(), 4);
        click(&mut harness, "Pin run 1");
        click(&mut harness, "Pin run 3");
        let names: Vec<_> =
            harness.state().state.results.pins.iter().map(|pin| pin.name.clone()).collect();
        assert_eq!(names, ["E", "F"]);
        snapshot_of(&mut harness, Part::Pane(Pane::Runs), name);

        let run = harness.get_by_role_and_label(Role::Button, "Run 2, good: τ_l 6 → 20 s");
        // By the keyboard, as by the mouse.
        run.focus();
        harness.run_steps(2);
        harness.key_press(egui::Key::Enter);
        settle(&mut harness);
        let settings = *harness.state().state.settings();
        assert_eq!(settings.pipeline.thresholds.tau_l_seconds, 20.0);
        assert_eq!(settings.calibration.prior, PriorMethod::ClosedForm);
        assert_eq!(settings.calibration.method, None);
        assert!(settings.pipeline.outlier_filter);

        let shown = |harness: &Window| {
            harness.state().state.results.pins.iter().map(|pin| pin.shown).collect::<Vec<_>>()
        };
        harness.get_by_label("E  warthog (simulated)").click();
        settle(&mut harness);
        assert_eq!(shown(&harness), [false, true]);
        click(&mut harness, "Unpin E");
        assert_eq!(shown(&harness), [true]);
    }
}

#[test]
fn another_deployment_and_a_doubtful_answer_are_named_as_such() {
    let mut harness = window(LARGE, Theme::Dark);
    // A change makes the sample the user's own; an unchanged sample would be replaced.
    set(&mut harness, |s| s.pipeline.rate_hz = 5.0);
    click(&mut harness, "Pin");
    open(&mut harness, straight_drive());
    assert!(harness.query_by_label_contains("is other data").is_some());
    assert!(harness.query_by_label("verdict good → degenerate").is_some());
    let text = copy(&mut harness, "x y z qx qy qz qw");
    assert!(text.contains("WARNING: verdict DEGENERATE"), "{text}");
    snapshot_of(&mut harness, Part::Pane(Pane::Result), "other-data-dark");
    // Runs of several deployments have the deployments' names.
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Runs));
    let first = harness.get_by_role_and_label(Role::Button, "Run 1, good: warthog (simulated)");
    first.click();
    settle(&mut harness);
    assert_eq!(harness.state().state.settings().pipeline.rate_hz, 10.0);
}

/// Returns the first reading with this fate.
fn find(harness: &Window, wanted: SampleFate) -> Picked {
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    (0..3)
        .find_map(|station| {
            let each = &analysis.pipeline.fates[station].each;
            let index = each.iter().position(|fate| *fate == wanted)?;
            Some(Picked { station, index })
        })
        .unwrap_or_else(|| panic!("no reading is {wanted:?}"))
}

#[test]
fn the_picked_reading_is_explained_and_can_be_let_in() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Reading));
    click(&mut harness, "First rejected reading");
    let picked = |harness: &Window| {
        harness.state().state.active().and_then(|open| open.timeline.picked).expect("picked")
    };
    let first = picked(&harness);
    click(&mut harness, "Next rejected");
    let second = picked(&harness);
    assert!(second.station == first.station && second.index > first.index);
    click(&mut harness, "Previous rejected");
    assert_eq!(picked(&harness), first);
    click(&mut harness, "Next reading");
    assert_eq!(picked(&harness).index, first.index + 1);
    click(&mut harness, "Previous reading");

    let azimuth = find(&harness, SampleFate::Rejected(OutlierReason::Azimuth));
    send(&mut harness, TimeCommand::PickInPlot(azimuth));
    assert!(harness.query_by_label_contains("Rejected by the azimuth rate").is_some());
    snapshot_of(&mut harness, Part::Pane(Pane::Reading), "reading-rejected-dark");
    let remedy = harness.get_by_label_contains("Set τ_a");
    assert!(remedy.accesskit_node().role() == Role::Button);
    remedy.click();
    settle(&mut harness);
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    assert_eq!(analysis.pipeline.filtered[azimuth.station].rejected[azimuth.index], None);
}

#[test]
fn every_fate_has_its_explanation_in_the_pane() {
    for (size, theme, name) in
        [(LARGE, Theme::Light, "reading-light"), (SMALL, Theme::Dark, "reading-small-dark")]
    {
        let mut harness = window(size, theme);
        send(&mut harness, WorkspaceCommand::ShowPane(Pane::Reading));
        for (fate, words) in [
            (SampleFate::Kept, "Kept: "),
            (SampleFate::InNoInterval, "In no interval: "),
            (SampleFate::IntervalTooShort, "τ_l requires more than"),
        ] {
            let picked = find(&harness, fate);
            send(&mut harness, TimeCommand::PickInScene(picked));
            assert!(harness.query_by_label_contains(words).is_some(), "{words}");
            snapshot_of(
                &mut harness,
                Part::Pane(Pane::Reading),
                &format!("{name}-{}", fate.label().replace(' ', "-")),
            );
        }
    }
}

#[test]
fn a_calibration_that_is_stopped_leaves_the_answer_and_its_settings() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = settings(&harness);
    let id = shown(&harness).id;
    let ctx = harness.ctx.clone();
    let mut slow = before;
    slow.pipeline.interpolation = Interpolation::Gp;
    harness.state_mut().send(DeploymentCommand::Set(slow), &ctx);
    harness.state_mut().send(DeploymentCommand::CancelAnalysis(id), &ctx);
    settle(&mut harness);
    assert_eq!(settings(&harness), before);
    let (_, analysis) = harness.state().state.analysed().expect("the answer from before");
    assert_eq!(analysis.settings, before);
    assert!(!harness.state().state.is_stale() && !harness.state().state.is_busy());
}

#[test]
fn what_was_estimated_besides_stands_in_a_table_and_not_in_sentences() {
    let mut harness = window(LARGE, Theme::Dark);
    assert!(harness.query_by_label_contains("stamps are").is_none());
    harness.get_by_label_contains("Other estimates").click_accesskit();
    settle(&mut harness);
    for row in ["station 3", "prisms 1–2", "  clock offset", "  range offset", "  collimation"] {
        assert!(harness.query_all_by_label(row).next().is_some(), "{row}");
    }
    harness.get_by_label("Sources of σ").click_accesskit();
    settle(&mut harness);
    assert!(harness.query_by_label("σ of T13").is_some());
    snapshot_of(&mut harness, Part::Pane(Pane::Result), "extras-dark");
    // The findings pane has the significant ones in words: none of the clocks of this drive.
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Findings));
    assert!(harness.query_all_by_label_contains("noise of the readings").next().is_some());
    assert!(harness.query_all_by_label_contains("stamps are").next().is_none());
}
