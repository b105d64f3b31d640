//! The workspace driven by the names of its widgets: actions of a user, and their effects.

use egui::accesskit::Role;
use egui::{Key, Modifiers, Theme, Vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use resect::app::{
    DeploymentCommand, DialogCommand, Overlay, Pane, ResultsCommand, Ruler, RulerEnd, SceneCommand,
    StudyResult, TimeCommand, Units, WorkspaceCommand,
};
use resect_core::calibration::Evidence;
use resect_core::network::Prism;
use resect_tools::simulation::{Preset, simulate};

use crate::harness::{
    LARGE, SMALL, Window, click, open, press, send, set, settings, settle, shown,
    type_and_enter_at_once, window,
};

fn cursor_s(harness: &Window) -> f64 {
    let open = harness.state().state.active().expect("open");
    open.timeline.cursor_s.expect("a cursor") - open.start_s()
}

#[test]
fn unused_readings_and_changed_settings_stand_beside_the_verdict() {
    let mut harness = window(LARGE, Theme::Dark);
    assert!(harness.query_by_label("2971 of 2996 readings used").is_some());
    assert!(harness.query_by_label_contains("other than the defaults").is_none());
    let mut changed = settings(&harness);
    changed.pipeline.thresholds.tau_l_seconds = 7.0;
    send(&mut harness, DeploymentCommand::Set(changed));
    harness.get_by_label("Settings other than the defaults: τ_l 6 → 7 s");
}

#[test]
fn every_setting_can_be_taken_back_and_done_again() {
    let mut harness = window(LARGE, Theme::Dark);
    let at_first = settings(&harness);
    harness.get_by_label("1  Outlier filter").click();
    settle(&mut harness);
    harness.get_by_label("B  static control points").click();
    settle(&mut harness);
    let changed = settings(&harness);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(settings(&harness).calibration, at_first.calibration);
    assert!(!settings(&harness).pipeline.outlier_filter);
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(settings(&harness), at_first);
    // The shown calibration belongs to the shown settings.
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    assert_eq!(analysis.settings, at_first);
    for _ in 0..2 {
        press(&mut harness, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    }
    assert_eq!(settings(&harness), changed);
}

#[test]
fn evidence_is_switched_by_group_and_one_group_stays() {
    let mut harness = window(LARGE, Theme::Dark);
    let toggle = |harness: &mut Window, name: &str| {
        // At any scroll position.
        harness.get_by_role_and_label(Role::CheckBox, name).click_accesskit();
        settle(harness);
    };
    let is_locked = |harness: &Window, name: &str| {
        harness.get_by_role_and_label(Role::CheckBox, name).accesskit_node().is_disabled()
    };
    toggle(&mut harness, "evidence: control points");
    let without_points = Evidence { control_points: false, ..Evidence::ALL };
    assert_eq!(settings(&harness).calibration.evidence, without_points);
    assert!(is_locked(&harness, "evidence: drive"));

    toggle(&mut harness, "evidence: rig distances");
    let drive_alone = Evidence { drive: true, ..Evidence::NONE };
    assert_eq!(settings(&harness).calibration.evidence, drive_alone);
    assert!(is_locked(&harness, "evidence: drive"));
    assert!(!is_locked(&harness, "evidence: rig distances"));

    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(settings(&harness).calibration.evidence, without_points);
    // This sample has a rig, and no control points.
    send(&mut harness, DeploymentCommand::OpenSample(resect_io::sample::Sample::Hd2Tunnel));
    assert!(is_locked(&harness, "evidence: control points"));
    assert!(!is_locked(&harness, "evidence: rig distances"));
}

#[test]
fn a_drag_of_a_slider_is_one_step() {
    let mut harness = window(LARGE, Theme::Dark);
    let at_first = settings(&harness);
    let slider = harness.get_by_role_and_label(Role::Slider, "τ_l  length").rect();
    harness.hover_at(slider.center());
    harness.run_steps(1);
    harness.drag_at(slider.center());
    for step in 1..=8 {
        harness.hover_at(slider.center() + Vec2::new(4.0 * step as f32, 0.0));
        harness.run_steps(2);
    }
    harness.drop_at(slider.center() + Vec2::new(32.0, 0.0));
    settle(&mut harness);
    assert!(settings(&harness).pipeline.thresholds.tau_l_seconds > 6.5);
    let step = harness.state().state.deployments.undo.undo_name(Units::default());
    assert!(step.starts_with("Undo τ_l 6 → "), "{step}");
    press(&mut harness, Modifiers::COMMAND, Key::Z);
    assert_eq!(settings(&harness), at_first);
}

#[test]
fn the_palette_does_what_is_typed() {
    let mut harness = window(LARGE, Theme::Dark);
    press(&mut harness, Modifiers::COMMAND, Key::P);
    assert!(matches!(harness.state().state.dialogs.overlay, Overlay::Palette(_)));
    harness.event(egui::Event::Text("method b".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let method = analysis.answer.as_ref().expect("an answer").calibration.method;
    assert_eq!(method, resect_core::calibration::Method::StaticGcp);
    // Escape closes it without effect.
    let before = settings(&harness);
    press(&mut harness, Modifiers::COMMAND, Key::P);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(
        (&harness.state().state.dialogs.overlay, settings(&harness)),
        (&Overlay::None, before)
    );
}

#[test]
fn the_palette_is_walked_with_the_arrows() {
    let mut harness = window(LARGE, Theme::Dark);
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.event(egui::Event::Text("sample".to_owned()));
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::ArrowDown);
    press(&mut harness, Modifiers::NONE, Key::Enter);
    let name = harness.state().state.active().expect("open").deployment.name.clone();
    assert_eq!(name, "hd2-tunnel (simulated)");
}

#[test]
fn the_sheet_of_shortcuts_opens_by_its_key_and_names_them() {
    let mut harness = window(LARGE, Theme::Dark);
    press(&mut harness, Modifiers::NONE, Key::Questionmark);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::Shortcuts);
    assert!(harness.query_by_label("Ctrl+P").is_some());
    harness.get_by_label("Close").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
}

#[test]
fn the_licences_are_shown_and_scrolled() {
    let mut harness = window(SMALL, Theme::Light);
    send(&mut harness, DialogCommand::ShowLicences);
    assert!(harness.query_by_label("MIT License").is_some());
    let first = harness.get_by_label("MIT License").rect();
    harness.hover_at(first.center());
    harness.event(egui::Event::MouseWheel {
        unit: egui::MouseWheelUnit::Point,
        delta: egui::vec2(0.0, -2000.0),
        phase: egui::TouchPhase::Move,
        modifiers: Modifiers::NONE,
        source: egui::MouseWheelSource::Unknown,
    });
    settle(&mut harness);
    assert!(harness.query_by_label("MIT License").is_none(), "it is further up");
    harness.get_by_label("Close").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.dialogs.overlay, Overlay::None);
}

#[test]
fn the_sheet_of_shortcuts_is_seen_whole_in_a_small_window() {
    let mut harness = window(SMALL, Theme::Dark);
    send(&mut harness, DialogCommand::ShowShortcuts);
    let lowest = |name: &str| harness.get_by_label(name).rect().bottom();
    // The sheet is in the middle.
    let end = SMALL.y - (harness.get_by_label("Close").rect().top() - 8.0);
    for last in ["Reset layout", "Glossary", "zoom in mm; double-click: all"] {
        assert!(lowest(last) < end, "{last}: {} of {end}", lowest(last));
    }
}

#[test]
fn the_tab_of_a_pane_that_comes_to_the_front_is_in_sight() {
    let mut harness = window(SMALL, Theme::Dark);
    for pane in [Pane::ControlPoints, Pane::Histogram, Pane::PriorSearch, Pane::Residuals] {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        let place = harness.state().layout().place(pane).expect("shown");
        let tab = harness.get_by_role_and_label(Role::Button, pane.title()).rect();
        assert!(place.x_range().contains(tab.left() + 1.0), "{pane:?}: {tab:?} in {place:?}");
        assert!(place.x_range().contains(tab.right() - 1.0), "{pane:?}: {tab:?} in {place:?}");
    }
}

#[test]
fn a_study_of_deployments_of_one_name_tells_them_apart() {
    let mut harness = window(SMALL, Theme::Dark);
    for seed in [1, 2] {
        open(
            &mut harness,
            resect_io::simulation_files::open(&simulate(Preset::FigureEight, seed)).expect("valid"),
        );
    }
    send(&mut harness, ResultsCommand::RunStudy);
    let Some(result) = &harness.state().state.results.studies.result else { panic!("it ran") };
    let StudyResult::Comparison(comparison) = &**result else { panic!("a comparison") };
    let names: Vec<&str> = comparison.deployments.iter().map(|c| c.deployment.as_str()).collect();
    let [first, second] = names[..] else { panic!("{names:?}") };
    assert_eq!(second, format!("{first} (2)"));
}

#[test]
fn undo_shows_what_it_acts_on_and_the_menu_says_which() {
    let mut harness = window(LARGE, Theme::Dark);
    set(&mut harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 12.0);
    send(&mut harness, DeploymentCommand::OpenSample(resect_io::sample::Sample::Hd2Tunnel));
    harness.get_by_label("Edit").click();
    harness.run_steps(3);
    harness.get_by_label_contains("Undo τ_l 6 → 12 s in warthog (simulated)").click();
    settle(&mut harness);
    assert_eq!(shown(&harness).deployment.name, "warthog (simulated)");
    assert_eq!(settings(&harness).pipeline.thresholds.tau_l_seconds, 6.0);
}

#[test]
fn the_sheet_of_shortcuts_keeps_its_width_whatever_can_be_undone() {
    let mut harness = window(LARGE, Theme::Dark);
    let width = |harness: &mut Window| {
        send(harness, DialogCommand::ShowShortcuts);
        let width = harness.get_by_label("Plots over time").rect().left();
        send(harness, DialogCommand::CloseOverlay);
        width
    };
    let before = width(&mut harness);
    set(&mut harness, |settings| {
        let thresholds = &mut settings.pipeline.thresholds;
        (thresholds.tau_l_seconds, thresholds.tau_s_seconds) = (12.0, 2.0);
        (thresholds.tau_r_m_per_s, thresholds.tau_a_deg_per_s) = (3.0, 4.0);
        settings.pipeline.rate_hz = 5.0;
    });
    assert_eq!(width(&mut harness), before);
}

#[test]
fn the_palette_reopens_at_its_full_size() {
    let mut harness = window(LARGE, Theme::Dark);
    let lines_in_sight = |harness: &mut Window| {
        press(harness, Modifiers::COMMAND, Key::P);
        harness.run_steps(3);
        let screen = harness.ctx.content_rect();
        let lines = harness.query_all_by_label_contains("Layout");
        let field = harness.get_by_label("Command").rect();
        (lines.filter(|line| screen.contains_rect(line.rect())).count(), field)
    };
    let before = lines_in_sight(&mut harness);
    harness.event(egui::Event::Text("method b".to_owned()));
    harness.run_steps(6);
    press(&mut harness, Modifiers::NONE, Key::Escape);
    harness.run_steps(3);
    assert_eq!(lines_in_sight(&mut harness), before);
}

#[test]
fn keys_move_through_time_unless_a_widget_has_them() {
    let mut harness = window(LARGE, Theme::Dark);
    let before = cursor_s(&harness);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert!((cursor_s(&harness) - before - 0.1).abs() < 1e-6);
    press(&mut harness, Modifiers::SHIFT, Key::ArrowLeft);
    assert!((cursor_s(&harness) - before + 0.9).abs() < 1e-6);
    press(&mut harness, Modifiers::NONE, Key::Home);
    assert_eq!(cursor_s(&harness), 0.0);
    // A focused slider keeps the arrow keys.
    harness.get_by_role_and_label(Role::Slider, "τ_s  gap").focus();
    harness.run_steps(2);
    press(&mut harness, Modifiers::NONE, Key::ArrowRight);
    assert_eq!(cursor_s(&harness), 0.0);
    assert_ne!(settings(&harness).pipeline.thresholds.tau_s_seconds, 1.0);
}

#[test]
fn escape_closes_an_open_menu_and_leaves_what_is_selected() {
    let mut harness = window(LARGE, Theme::Dark);
    let start_s = shown(&harness).start_s();
    send(&mut harness, TimeCommand::Select(Some([start_s + 60.0, start_s + 120.0])));
    let is_open = |harness: &Window| egui::Popup::is_any_open(&harness.ctx);
    click(&mut harness, "Edit");
    assert!(is_open(&harness));
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert!(!is_open(&harness));
    assert!(shown(&harness).timeline.selection_s.is_some());
    press(&mut harness, Modifiers::NONE, Key::Escape);
    assert_eq!(shown(&harness).timeline.selection_s, None);
    // A dialog that a key opens is not behind the menu.
    click(&mut harness, "Edit");
    press(&mut harness, Modifiers::COMMAND, Key::P);
    assert!(!is_open(&harness));
}

#[test]
fn playing_moves_the_cursor_at_the_chosen_speed() {
    let mut harness = window(LARGE, Theme::Dark);
    press(&mut harness, Modifiers::NONE, Key::Home);
    harness.get_by_label("Play (Space)").click();
    harness.run_steps(2);
    let (from_s, at) = (cursor_s(&harness), harness.ctx.input(|input| input.time));
    harness.run_steps(20);
    let (to_s, then) = (cursor_s(&harness), harness.ctx.input(|input| input.time));
    let speed = (to_s - from_s) / (then - at);
    assert!((speed - 4.0).abs() < 0.3, "{speed}");
    harness.get_by_label("Pause (Space)").click();
    harness.run_steps(3);
    let rest_s = cursor_s(&harness);
    harness.run_steps(10);
    assert_eq!(cursor_s(&harness), rest_s);
}

#[test]
fn the_strip_of_time_scrubs() {
    let mut harness = window(LARGE, Theme::Dark);
    let strip = harness.get_by_label("Time cursor").rect();
    for (share, expected) in [(0.25, 0.25), (0.8, 0.8)] {
        let at = strip.left_center() + Vec2::new(share * strip.width(), 0.0);
        harness.hover_at(at);
        harness.run_steps(1);
        harness.drag_at(at);
        harness.run_steps(1);
        harness.drop_at(at);
        settle(&mut harness);
        let whole_s = harness.state().state.active().expect("open").timeline.whole_s;
        let got = cursor_s(&harness) / (whole_s[1] - whole_s[0]);
        assert!((got - expected).abs() < 0.01, "{got}");
    }
}

#[test]
fn the_scene_is_copied_as_a_picture_of_its_own_size() {
    let mut harness = window(LARGE, Theme::Dark);
    // With the strip below it.
    let scene = harness.state().layout().place(Pane::Scene).expect("shown");
    let ctx = harness.ctx.clone();
    harness.state_mut().send(WorkspaceCommand::CopyPicture(Pane::Scene), &ctx);
    harness.run_steps(1);
    let commands = &harness.output().platform_output.commands;
    let copied = commands.iter().find_map(|command| match command {
        egui::OutputCommand::CopyImage(image) => Some(image.size),
        _ => None,
    });
    let [width, height] = copied.expect("a picture was copied");
    assert!((width as f32 - 2.0 * scene.width()).abs() <= 2.0, "{width} {scene:?}");
    assert!((height as f32 - 2.0 * scene.height()).abs() <= 2.0, "{height} {scene:?}");
}

#[test]
fn runs_are_remembered_and_one_can_be_gone_back_to() {
    let mut harness = window(LARGE, Theme::Dark);
    let at_first = settings(&harness);
    harness.get_by_label("1  Outlier filter").click();
    settle(&mut harness);
    harness.get_by_label("3  Interval filter").click();
    settle(&mut harness);
    let results = &harness.state().state.results;
    assert_eq!(results.runs.len(), 3);
    let changes: Vec<_> =
        results.runs.iter().map(|run| harness.state().state.run_change(run)).collect();
    assert_eq!(changes[0], None);
    assert_eq!(changes[2].as_deref(), Some("interval filter on → off"));
    let first = results.runs[0].id;
    send(&mut harness, ResultsCommand::RestoreRun(first));
    assert_eq!(settings(&harness), at_first);
}

#[test]
fn what_was_measured_in_one_deployment_is_not_shown_in_another() {
    let mut harness = window(LARGE, Theme::Dark);
    let end = |z: f64, prism| RulerEnd {
        position_m: nalgebra::Vector3::new(0.0, 0.0, z),
        what: String::new(),
        prism,
    };
    let measure = |harness: &mut Window| {
        let ends = vec![end(1.0, None), end(2.0, Some(Prism::default()))];
        send(harness, SceneCommand::Measure(Ruler { active: true, ends }));
    };
    measure(&mut harness);
    // Another calibration moves everything but the prisms.
    set(&mut harness, |settings| settings.pipeline.thresholds.tau_l_seconds = 12.0);
    let kept: Vec<_> = harness.state().state.scene.ruler.ends.iter().map(|end| end.prism).collect();
    assert_eq!(kept, [Some(Prism::default())]);
    measure(&mut harness);
    send(&mut harness, DeploymentCommand::OpenSample(resect_io::sample::Sample::Hd2Tunnel));
    assert!(harness.state().state.scene.ruler.ends.is_empty());
}

#[test]
fn settings_without_a_deployment_are_those_of_the_next() {
    let mut harness = window(LARGE, Theme::Dark);
    let id = harness.state().state.deployments.open[0].id;
    send(&mut harness, DeploymentCommand::Close(id));
    set(&mut harness, |settings| settings.pipeline.thresholds.tau_s_seconds = 1.7);
    send(&mut harness, DeploymentCommand::OpenSample(resect_io::sample::Sample::Hd2Tunnel));
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    assert_eq!(analysis.settings.pipeline.thresholds.tau_s_seconds, 1.7);
}

#[test]
fn a_picture_of_a_pane_in_the_background_changes_no_layout() {
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, WorkspaceCommand::ShowPane(Pane::Studies));
    let scene = |harness: &Window| harness.query_by_role_and_label(Role::Image, "Scene").is_some();
    assert!(!scene(&harness));
    send(&mut harness, WorkspaceCommand::CopyPicture(Pane::Scene));
    harness.get_by_label_contains("picture of Scene copied");
    assert!(!scene(&harness));
}

#[test]
fn the_palette_heeds_what_is_typed_in_the_same_frame_as_enter() {
    let mut harness = window(LARGE, Theme::Dark);
    press(&mut harness, Modifiers::COMMAND, Key::P);
    type_and_enter_at_once(&mut harness, "method b");
    let method = settings(&harness).calibration.method;
    assert_eq!(method, Some(resect_core::calibration::Method::StaticGcp));
}

/// egui keeps a tooltip for as long as the pointer rests: it covered the dialog that a key had opened.
#[test]
fn a_tooltip_that_is_open_goes_when_a_dialog_opens() {
    let mut harness = window(LARGE, Theme::Dark);
    harness.get_by_role_and_label(Role::Slider, "τ_r  range").hover();
    harness.run_steps(60);
    harness.get_by_label_contains("right click");
    press(&mut harness, Modifiers::COMMAND, Key::P);
    harness.run_steps(60);
    assert!(harness.query_by_label_contains("right click").is_none());
    // Tooltips of other widgets appear again.
    press(&mut harness, Modifiers::NONE, Key::Escape);
    harness.get_by_role_and_label(Role::Slider, "τ_s  gap").hover();
    harness.run_steps(60);
    harness.get_by_label_contains("right click");
}
