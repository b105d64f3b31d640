//! Readings and gaps of the stations, and the intervals left for the calibration. Beside them are the distributions of gaps and intervals,
//! with handles for τ_s and τ_l.

mod chart;
mod distributions;
mod gap_thresholds;

use egui::Rect;

use self::gap_thresholds::GapThresholds;
use super::time_plot;
use super::times::Times;
use super::{in_the_middle, station_switches, strips};
use crate::app::model::{Commands, DeploymentCommand};
use crate::app::state::State;
use resect_core::pipeline::Interval;

/// Share of a pane's width for the distributions, if there is no room beside the plots.
const SHARE: f32 = 0.4;
/// Height of the bars above the chart (points).
const BARS: f32 = 14.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis)) = state.analysed() else {
        in_the_middle(ui, "No readings to plot.");
        return;
    };
    let times = Times::of(open, state);
    time_plot::head(ui, |ui| {
        station_switches(ui, state, commands);
        time_plot::selection(ui, state, &times, commands);
        let (kept, short) = (open.plots.gaps.kept.len(), open.plots.gaps.short.len());
        let kept_s: f64 = analysis.pipeline.kept_intervals.iter().map(Interval::length_s).sum();
        let text = format!("{kept} intervals kept ({kept_s:.0} s), {short} too short");
        ui.add(egui::Label::new(egui::RichText::new(text).small()).truncate());
        time_plot::hint(ui, state, "");
    });
    let whole = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(whole);
    let thresholds = GapThresholds::of(state.settings());
    let mut wanted = [None; 2];
    let (above, below) = whole.split_top_bottom_at_y(whole.top() + BARS);
    let mut strip = strips::in_rect(below, 1, 1)[0];
    if whole.width() < strips::NARROW {
        // The distributions show numbers and lengths, so the text above the chart is omitted.
        strip.plot =
            below.with_min_x(strip.plot.left()).with_max_x(below.right() - SHARE * below.width());
    }
    let left = above.with_max_x(strip.plot.right()).with_min_x(strip.plot.left() + strips::GUTTER);
    let bars = bars(ui, left, &times, &thresholds);
    chart::ui(ui, &strip, (open, analysis), state, &times, commands);
    let right =
        Rect::from_x_y_ranges(strip.plot.right() + 8.0..=whole.right() - 10.0, whole.y_range());
    let mut side = ui.new_child(egui::UiBuilder::new().id_salt("side").max_rect(right));
    let lines = distributions::ui(&mut side, open, state, &thresholds);
    for (wanted, (bar, line)) in wanted.iter_mut().zip(bars.into_iter().zip(lines)) {
        *wanted = bar.or(line);
    }
    if wanted != [None; 2] {
        let mut settings = *state.settings();
        let set = &mut settings.pipeline.thresholds;
        set.tau_s_seconds = wanted[0].unwrap_or(set.tau_s_seconds);
        set.tau_l_seconds = wanted[1].unwrap_or(set.tau_l_seconds);
        commands.push(DeploymentCommand::Set(settings).into());
    }
}

/// Draws the thresholds as bars above the chart, in the scale of its time axis.
fn bars(
    ui: &mut egui::Ui,
    rect: Rect,
    times: &Times,
    thresholds: &GapThresholds,
) -> [Option<f64>; 2] {
    let width_s = (times.window_s[1] - times.window_s[0]) as f32;
    let points_per_s = rect.width() / width_s;
    // Each bar has one half of the width.
    let (first, second) = rect.split_left_right_at_fraction(0.5);
    let [tau_s, tau_l] = &thresholds.0;
    [tau_s.bar(ui, first, points_per_s), tau_l.bar(ui, second, points_per_s)]
}
