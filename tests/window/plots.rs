//! The plots over time, driven by the names of their widgets.

use egui::{
    Event, Key, Modifiers, MouseWheelUnit, PointerButton, Pos2, Rect, Theme, TouchPhase, Vec2,
};
use egui_kittest::kittest::Queryable;
use resect::app::{
    DeploymentCommand, Pane, ResultsCommand, SceneCommand, TimeCommand, TimeUnit, Units,
    WorkspaceCommand,
};
use resect_core::calibration::Method;
use resect_core::pipeline::{OutlierReason, SampleFate, Thresholds};
use resect_tools::simulation::{Preset, simulate_scenario};

use crate::harness::{LARGE, Window, double_click, open, send, set, settle, shown, triplets};

/// Returns a window with a pane in front.
fn window(size: Vec2, theme: Theme, pane: Pane) -> Window {
    let mut harness = crate::harness::window(size, theme);
    send(&mut harness, WorkspaceCommand::ShowPane(pane));
    harness
}

fn thresholds(harness: &Window) -> Thresholds {
    harness.state().state.settings().pipeline.thresholds
}

/// Returns the shown span of time (s since the first measurement).
fn window_s(harness: &Window) -> [f64; 2] {
    let open = shown(harness);
    open.timeline.window_s.map(|t| t - open.start_s())
}

fn press(harness: &mut Window, pos: Pos2, button: PointerButton, pressed: bool) {
    harness.event(Event::PointerButton { pos, button, pressed, modifiers: Modifiers::NONE });
    harness.run_steps(1);
}

fn move_to(harness: &mut Window, pos: Pos2) {
    harness.hover_at(pos);
    harness.run_steps(2);
}

fn drag(harness: &mut Window, from: Pos2, to: Pos2, button: PointerButton) {
    move_to(harness, from);
    press(harness, from, button, true);
    for step in 1..=4 {
        move_to(harness, from + (to - from) * (step as f32 / 4.0));
    }
    press(harness, to, button, false);
    settle(harness);
}

fn click(harness: &mut Window, at: Pos2) {
    move_to(harness, at);
    press(harness, at, PointerButton::Primary, true);
    press(harness, at, PointerButton::Primary, false);
    settle(harness);
}

fn scroll(harness: &mut Window, at: Pos2, points: f32, modifiers: Modifiers) {
    move_to(harness, at);
    harness.event_modifiers(
        Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            source: egui::MouseWheelSource::Wheel,
            delta: Vec2::new(0.0, points),
            phase: TouchPhase::Move,
            modifiers,
        },
        modifiers,
    );
    // Scrolling is smoothed over some frames.
    harness.run_steps(20);
    settle(harness);
}

fn rect(harness: &Window, name: &str) -> Rect {
    harness.get_by_label(name).rect()
}

#[test]
fn a_threshold_is_set_by_dragging_its_line() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Rates);
    let before = triplets(&harness);
    let at = rect(&harness, "τ_r line").center();
    // Down to the rates of the drive.
    drag(&mut harness, at, at + Vec2::new(0.0, 14.0), PointerButton::Primary);
    let set = thresholds(&harness);
    assert!((0.2..1.0).contains(&set.tau_r_m_per_s), "{set:?}");
    assert_eq!([set.tau_a_deg_per_s, set.tau_e_deg_per_s], [1.0, 1.0]);
    assert!(triplets(&harness) < before);
    // The plot agrees with the pipeline, and the drag selected nothing.
    let (open, analysis) = harness.state().state.analysed().expect("an answer");
    let fate = SampleFate::Rejected(OutlierReason::Range);
    let [a, b, c] = [0, 1, 2].map(|station| analysis.pipeline.count(station, fate));
    assert!(a > 100 && open.timeline.selection_s.is_none());
    harness.get_by_label_contains(&format!("rejects {a} / {b} / {c} of"));
    // The line is at its new position, and a click with the right button restores the paper's value.
    let line = rect(&harness, "τ_r line");
    assert!((line.center().y - at.y - 14.0).abs() < 3.0, "{line} {at}");
    harness.get_by_label("τ_r line").click_secondary();
    settle(&mut harness);
    assert_eq!(thresholds(&harness), Thresholds::default());
    assert_eq!(triplets(&harness), before);
}

#[test]
fn a_threshold_is_set_by_keys_and_by_screen_readers() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Rates);
    harness.get_by_label("τ_a line").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowUp);
    settle(&mut harness);
    assert_eq!(thresholds(&harness).tau_a_deg_per_s, 1.03);
    harness.key_press(Key::ArrowDown);
    harness.run_steps(2);
    harness.key_press_modifiers(Modifiers::SHIFT, Key::ArrowDown);
    settle(&mut harness);
    assert_eq!(thresholds(&harness).tau_a_deg_per_s, 0.833);
    assert!(harness.get_by_label("τ_a line").is_focused());
    harness.get_by_label("τ_e line").set_value_accesskit(0.25);
    settle(&mut harness);
    assert_eq!(thresholds(&harness).tau_e_deg_per_s, 0.25);
}

#[test]
fn without_the_filter_the_lines_rest_and_say_so() {
    let mut harness = window(LARGE, Theme::Light, Pane::Rates);
    let mut settings = *harness.state().state.settings();
    settings.pipeline.outlier_filter = false;
    send(&mut harness, DeploymentCommand::Set(settings));
    let at = rect(&harness, "τ_r line").center();
    drag(&mut harness, at, at + Vec2::new(0.0, 20.0), PointerButton::Primary);
    assert_eq!(thresholds(&harness), Thresholds::default());
    assert!(harness.query_by_label_contains("rejects").is_none());
    harness.get_by_label("Switch it on").click();
    settle(&mut harness);
    assert!(harness.state().state.settings().pipeline.outlier_filter);
    harness.get_by_label_contains("rejects 2 / 4 / 2");
}

#[test]
fn zoom_in_one_plot_is_zoom_in_all() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Rates);
    let whole = window_s(&harness);
    let frame = rect(&harness, "azimuth rate over time");
    let quarter = frame.left_top() + Vec2::new(0.25 * frame.width(), 8.0);
    scroll(&mut harness, quarter, 120.0, Modifiers::NONE);
    let [from, to] = window_s(&harness);
    let about = whole[0] + 0.25 * (whole[1] - whole[0]);
    assert!(to - from < 0.7 * (whole[1] - whole[0]), "{from} {to}");
    assert!((from + 0.25 * (to - from) - about).abs() < 2.0, "{from} {to} {about}");
    // With shift the window moves and keeps its length.
    scroll(&mut harness, quarter, -60.0, Modifiers::SHIFT);
    let moved = window_s(&harness);
    assert!(
        moved[0] > from + 5.0 && ((moved[1] - moved[0]) - (to - from)).abs() < 1e-5,
        "{moved:?}"
    );
    // The same with the right button.
    drag(&mut harness, quarter, quarter + Vec2::new(100.0, 0.0), PointerButton::Secondary);
    let expected = moved[0] - 100.0 * (to - from) / f64::from(frame.width());
    assert!((window_s(&harness)[0] - expected).abs() < 0.5, "{:?} {expected}", window_s(&harness));
    assert!(shown(&harness).timeline.selection_s.is_none());
    // The other plots show the same window; a double click there shows everything again.
    let zoomed = window_s(&harness);
    for (pane, name) in [
        (Pane::Intervals, "readings, silences and intervals over time"),
        (Pane::Residuals, "distance errors 1–2 over time"),
    ] {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        let frame = rect(&harness, name);
        let at = frame.left_center() + Vec2::new(0.5 * frame.width(), 4.0);
        click(&mut harness, at);
        let open = shown(&harness);
        let cursor_s = open.timeline.cursor_s.expect("a cursor") - open.start_s();
        let middle = (zoomed[0] + zoomed[1]) / 2.0;
        assert!((cursor_s - middle).abs() < 0.5, "{name}: {cursor_s} {middle}");
    }
    let pos = rect(&harness, "distance errors 1–2 over time").center();
    double_click(&mut harness, pos);
    assert_eq!(window_s(&harness), whole);
}

#[test]
fn dragging_selects_and_the_selection_can_be_zoomed_to_and_cleared() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Residuals);
    let [from, to] = window_s(&harness);
    let frame = rect(&harness, "distance errors 1–2 over time");
    let at = |share: f32| frame.left_top() + Vec2::new(share * frame.width(), 30.0);
    // From right to left, beyond the edge.
    drag(&mut harness, at(0.5), at(-0.3), PointerButton::Primary);
    let open = shown(&harness);
    let span = open.timeline.selection_s.expect("selected").map(|t| t - open.start_s());
    assert!((span[0] - from).abs() < 1.0 && (span[1] - (from + to) / 2.0).abs() < 1.0, "{span:?}");
    assert_eq!(window_s(&harness), [from, to]);
    harness.get_by_label("Zoom to the selection").click();
    settle(&mut harness);
    assert!((window_s(&harness)[1] - span[1]).abs() < 1e-5);
    harness.get_by_label("Clear the selection").click();
    settle(&mut harness);
    assert!(shown(&harness).timeline.selection_s.is_none());
}

#[test]
fn where_the_pointer_is_is_known_to_all_panes() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Rates);
    let line = rect(&harness, "τ_e line");
    // Over a line, too.
    move_to(&mut harness, line.center());
    let open = shown(&harness);
    let hover_s = harness.state().state.time.hover_s.expect("hovered") - open.start_s();
    let [from, to] = window_s(&harness);
    assert!((hover_s - (from + to) / 2.0).abs() < 1.0, "{hover_s}");
    harness.input_mut().events.push(Event::PointerGone);
    harness.run_steps(2);
    assert!(harness.state().state.time.hover_s.is_none());
}

#[test]
fn a_click_on_a_reading_picks_it() {
    for pane in [Pane::Intervals, Pane::Rates] {
        let mut harness = window(LARGE, Theme::Dark, pane);
        let open = shown(&harness);
        let index = 300;
        let time_s = open.deployment.tracks[0].measurements[index].time_s;
        let mut visibility = harness.state().state.scene.visibility;
        visibility.stations[..3].copy_from_slice(&[true, false, false]);
        send(&mut harness, SceneCommand::Show(visibility));
        send(&mut harness, TimeCommand::ShowTimes([time_s - 3.0, time_s + 3.0]));
        let name = if pane == Pane::Rates {
            "range rate over time"
        } else {
            "readings, silences and intervals over time"
        };
        let frame = rect(&harness, name);
        // The rate is somewhere above its time.
        for step in 1..8 {
            if shown(&harness).timeline.picked.is_some() {
                break;
            }
            let at = frame.center_top() + Vec2::new(0.5, step as f32 * frame.height() / 8.0);
            click(&mut harness, at);
        }
        let timeline = &shown(&harness).timeline;
        let picked = timeline.picked.expect("picked");
        assert_eq!((picked.station, picked.index), (0, index), "{name}");
        assert!((timeline.cursor_s.expect("a cursor") - time_s).abs() < 1e-6);
    }
}

#[test]
fn gaps_and_lengths_are_set_where_they_are_seen() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Intervals);
    let intervals = |harness: &Window| {
        let (_, analysis) = harness.state().state.analysed().expect("an answer");
        [analysis.pipeline.intervals.len(), analysis.pipeline.kept_intervals.len()]
    };
    let before = intervals(&harness);
    let at = rect(&harness, "τ_s line").center();
    drag(&mut harness, at, at + Vec2::new(25.0, 0.0), PointerButton::Primary);
    assert!(thresholds(&harness).tau_s_seconds > 1.5, "{:?}", thresholds(&harness));
    assert!(intervals(&harness)[0] < before[0]);
    harness.get_by_label("τ_s line").click_secondary();
    settle(&mut harness);
    assert_eq!(intervals(&harness), before);
    // The bar of τ_l is as long as six seconds of the chart; twice the length is twelve.
    let start_s = shown(&harness).start_s();
    send(&mut harness, TimeCommand::ShowTimes([start_s, start_s + 60.0]));
    let bar = rect(&harness, "τ_l bar");
    let frame = rect(&harness, "readings, silences and intervals over time");
    let points = frame.width() / 10.0;
    let end = Pos2::new(bar.right() - 4.0, bar.center().y);
    assert!((bar.width() - 8.0 - points).abs() < 3.0, "{bar} {points}");
    drag(&mut harness, end, end + Vec2::new(points, 0.0), PointerButton::Primary);
    assert!((thresholds(&harness).tau_l_seconds - 12.0).abs() < 0.5, "{:?}", thresholds(&harness));
    assert!(intervals(&harness)[1] < before[1]);
    harness.get_by_label("τ_l line").focus();
    harness.run_steps(2);
    harness.key_press(Key::ArrowRight);
    settle(&mut harness);
    assert!((thresholds(&harness).tau_l_seconds - 12.36).abs() < 0.5);
}

#[test]
fn pinned_results_stand_behind_the_present_one() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Residuals);
    send(&mut harness, ResultsCommand::Pin);
    let pin = harness.state().state.results.pins[0].clone();
    harness.get_by_label(&format!("○ {}", pin.name));
    let mut settings = *harness.state().state.settings();
    settings.pipeline.thresholds.tau_l_seconds = 40.0;
    send(&mut harness, DeploymentCommand::Set(settings));
    let frame = rect(&harness, "distance errors 1–2 over time");
    let coloured = |harness: &mut Window| {
        let picture = harness.render().expect("a picture");
        let inside = |x: u32, y: u32| frame.contains(Pos2::new(x as f32, y as f32));
        let colours = |p: &image::Rgba<u8>| {
            let [r, g, b, _] = p.0;
            r.max(g).max(b).abs_diff(r.min(g).min(b)) > 20
        };
        picture.enumerate_pixels().filter(|(x, y, p)| inside(*x, *y) && colours(p)).count()
    };
    let with = coloured(&mut harness);
    send(&mut harness, ResultsCommand::Unpin(pin.id));
    assert!(harness.query_by_label(&format!("○ {}", pin.name)).is_none());
    let without = coloured(&mut harness);
    assert!(with > without + 200, "{with} {without}");
}

#[test]
fn each_pair_has_a_strip_of_its_own_and_all_have_one_time_axis() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Residuals);
    let strips = |harness: &Window| -> Vec<Rect> {
        let names = ["1–2", "1–3", "2–3"].map(|pair| format!("distance errors {pair} over time"));
        let found = names.iter().filter_map(|name| harness.query_by_label(name));
        found.map(|strip| strip.rect()).collect()
    };
    let all = strips(&harness);
    assert_eq!(all.len(), 3);
    for pair in all.windows(2) {
        assert!(pair[0].bottom() < pair[1].top(), "{pair:?}");
        assert_eq!(pair[0].x_range(), pair[1].x_range());
        assert!((pair[0].height() - pair[1].height()).abs() < 1.0, "{pair:?}");
    }
    // A hidden pair leaves its room to the others.
    let mut visibility = harness.state().state.scene.visibility;
    visibility.pairs[1] = false;
    send(&mut harness, SceneCommand::Show(visibility));
    let two = strips(&harness);
    assert_eq!(two.len(), 2);
    assert!(two[0].height() > 1.3 * all[0].height());
}

#[test]
fn one_time_is_at_one_place_in_all_panes_of_a_width() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Rates);
    let first = rect(&harness, "range rate over time");
    for (pane, name) in [
        (Pane::Intervals, "readings, silences and intervals over time"),
        (Pane::Residuals, "distance errors 2–3 over time"),
        (Pane::Clocks, "clocks over time"),
    ] {
        send(&mut harness, WorkspaceCommand::ShowPane(pane));
        let other = rect(&harness, name);
        assert_eq!(other.x_range(), first.x_range(), "{name}");
    }
}

#[test]
fn times_are_read_as_the_user_chooses() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Residuals);
    let open = shown(&harness);
    let [start_s, end_s] = open.timeline.whole_s;
    let seconds = format!("{:.1} s", end_s - start_s);
    let minutes = ((end_s - start_s) / 60.0) as u32;
    harness.get_by_label_contains(&format!("/ 0:{minutes:02}:"));
    assert!(harness.query_by_label_contains(&format!("/ {seconds}")).is_none());
    let units = harness.state().state.workspace.units;
    send(&mut harness, WorkspaceCommand::SetUnits(Units { time: TimeUnit::Seconds, ..units }));
    harness.get_by_label_contains(&format!("/ {seconds}"));
    // The sample's stamps are relative to the Unix epoch.
    let day_s = 86_400.0;
    let utc = |time_s: f64| ((time_s % day_s) / 3600.0) as u32;
    send(&mut harness, WorkspaceCommand::SetUnits(Units { time: TimeUnit::Utc, ..units }));
    harness.get_by_label_contains(&format!("/ {:02}:", utc(end_s)));
    // Stamps that begin at zero have no time of day: the menu says so, and an earlier choice falls back to time from the start.
    let mut deployment = (*shown(&harness).deployment).clone();
    for track in &mut deployment.tracks {
        track.measurements.iter_mut().for_each(|reading| reading.time_s -= start_s);
    }
    crate::harness::open(&mut harness, deployment);
    harness.get_by_label_contains(&format!("/ 0:{minutes:02}:"));
    send(&mut harness, WorkspaceCommand::SetUnits(Units { time: TimeUnit::Seconds, ..units }));
    harness.get_by_label("View").click();
    harness.run_steps(3);
    harness.get_by_label("Times in UTC").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.workspace.units.time, TimeUnit::Seconds);
    harness.get_by_label("Times in h:m:s").click();
    settle(&mut harness);
    assert_eq!(harness.state().state.workspace.units.time, TimeUnit::Elapsed);
}

#[test]
fn what_is_selected_is_counted_beside_all() {
    let mut harness = window(LARGE, Theme::Dark, Pane::Histogram);
    assert!(harness.query_by_label_contains("selected: median").is_none());
    let [from_s, to_s] = shown(&harness).timeline.whole_s;
    send(&mut harness, TimeCommand::Select(Some([from_s, (from_s + to_s) / 2.0])));
    let first = harness.get_all_by_label_contains("selected: median").count();
    // All pairs and each, in the histogram and, except for all, beside the errors over time.
    assert_eq!(first, 7);
    let (_, analysis) = harness.state().state.analysed().expect("an answer");
    let all = analysis.answer.as_ref().expect("an answer").evaluation.inter_prism_mm;
    let all = all.expect("a rig").n;
    assert!(harness.query_by_label_contains(&format!("n\u{a0}{all}")).is_some());
    send(&mut harness, TimeCommand::Select(None));
    assert!(harness.query_by_label_contains("selected: median").is_none());
}

fn count_shapes(shape: &egui::Shape) -> usize {
    match shape {
        egui::Shape::Vec(shapes) => shapes.iter().map(count_shapes).sum(),
        _ => 1,
    }
}

/// Returns the number of shapes in a frame, with each plot over time in front.
fn shapes_by_pane(harness: &mut Window) -> Vec<(Pane, usize)> {
    let panes = [Pane::Residuals, Pane::Rates, Pane::Intervals, Pane::Channels].into_iter();
    panes
        .map(|pane| {
            send(harness, WorkspaceCommand::ShowPane(pane));
            let shapes = harness.output().shapes.iter();
            (pane, shapes.map(|clipped| count_shapes(&clipped.shape)).sum())
        })
        .collect()
}

/// Each shape costs frame time: a rectangle for each of 4587 intervals was once a third of it.
#[test]
fn a_long_drive_is_hardly_more_shapes_than_a_short_one() {
    let mut harness = crate::harness::window(LARGE, Theme::Dark);
    let short = shapes_by_pane(&mut harness);
    let mut scenario = Preset::Warthog.scenario();
    scenario.duration_s *= 24.0;
    open(
        &mut harness,
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("simulated"),
    );
    set(&mut harness, |settings| {
        settings.calibration = settings.calibration.with_method(Method::InterPrism);
        settings.pipeline.interval_filter = false;
    });
    let kept = shown(&harness).analysis.as_ref().expect("analysed").pipeline.kept_intervals.len();
    assert!(kept > 450, "{kept} intervals");
    for ((pane, short), (_, long)) in short.into_iter().zip(shapes_by_pane(&mut harness)) {
        assert!(long < short + 300, "{pane:?}: {short} shapes, {long} of the long drive");
    }
}
