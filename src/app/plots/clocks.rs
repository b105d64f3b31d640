//! Clocks over time: each station's clock against the synchronised time, and the estimated offsets from station 1.

use std::fmt::Write;

use egui::RichText;
use egui_plot::{HoverPosition, Line, LineStyle, MarkerShape, Plot, PlotPoint, PlotPoints, Points};

use super::strips::strips;
use super::time_plot::{self, TimePlot};
use super::times::Times;
use super::{close_marks, in_the_middle, station_switches};
use crate::app::model::{Commands, OpenDeployment};
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::calibration::Estimate;
use resect_core::network::PerStation;
use resect_tools::palette;

/// Least range of the plot (ms), above the noise of drawing.
const LEAST_MS: f64 = 1.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, analysis)) = state.analysed() else {
        in_the_middle(ui, "No clocks to plot.");
        return;
    };
    let times = Times::of(open, state);
    let estimated = Estimated::of(analysis);
    let told = |station: usize| open.plots.readings.clocks[station].median_s.is_some();
    if !(0..state.stations()).any(told) && estimated.is_none() {
        nothing(ui);
        return;
    }
    time_plot::head(ui, |ui| {
        station_switches(ui, state, commands);
        time_plot::selection(ui, state, &times, commands);
        time_plot::hint(ui, state, "");
    });
    let scale = times.scale;
    let plot = Plot::new(("clocks", open.id)).y_grid_spacer(close_marks).label_formatter(
        move |position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => {
                let time = scale.text_and_seconds(position.x, 1);
                Some(format!("{plot_name}\n{time}\n{:+.3} ms", position.y))
            }
            HoverPosition::Elsewhere { .. } => None,
        },
    );
    let caption = caption(open, state, estimated.as_ref(), ui.visuals().dark_mode);
    let strip = strips(ui, 1, caption.len())[0];
    strip.words(ui, &caption, "");
    let bounds_ms = bounds_ms(open, state, estimated.as_ref());
    let columns = strip.plot.width() as usize;
    let (readings, stations) = (&open.plots.readings, state.scene.visibility.stations);
    let time_plot =
        TimePlot { strip: &strip, name: "clocks over time", times: &times, y_bounds: bounds_ms };
    let axis = strip.value_axis("clock", "ms");
    let shown = time_plot.show(ui, plot, axis, commands, |plot_ui| {
        for station in (0..readings.clocks.len()).filter(|station| stations[*station]) {
            let clock = &readings.clocks[station];
            let colour = theme::rgb(palette::station(station));
            let name = |what: &str| format!("station {}, {what}", station + 1);
            let dots = clock.readings.visible(times.window_s, columns);
            let own = Points::new(name("own clock"), PlotPoints::Owned(dots));
            plot_ui.points(own.color(colour).radius(1.4));
            let dots = clock.corrections.visible(times.window_s, columns);
            let told = Points::new(name("recorded correction"), PlotPoints::Owned(dots));
            plot_ui
                .points(told.color(colour).shape(MarkerShape::Diamond).filled(false).radius(3.0));
            if let Some(estimated) = estimated.as_ref().filter(|_| station > 0) {
                let line = PlotPoints::Owned(estimated.ends(station, readings.start_s).to_vec());
                let line = Line::new(name("estimated, relative to station 1"), line);
                plot_ui.line(line.color(colour).width(2.0).style(LineStyle::dashed_loose()));
            }
        }
    });
    shown.paint_times(ui, &times);
    shown.on_click(&times, commands, |_| None);
}

/// Explains why there is no plot.
fn nothing(ui: &mut egui::Ui) {
    egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
        ui.strong("No station clocks in these files.");
        ui.label(
            "Bags contain them (theodolite_time, and time corrections). A CSV contains only the synchronised time.",
        );
        ui.label(
            "The time offsets of the stations from the drive itself are in the joint estimate: Pipeline, \
             Calibration.",
        );
    });
}

/// Clock estimates of the calibration.
struct Estimated {
    /// Delays relative to station 1 in the middle of the drive (s), zero for station 1.
    offsets_s: PerStation<Estimate>,
    /// Drifts of these delays (s per s).
    drifts: PerStation<f64>,
    /// Times of the first and of the last triplet (s).
    span_s: [f64; 2],
}

impl Estimated {
    fn of(analysis: &Analysis) -> Option<Self> {
        let estimates = analysis.answer.as_deref().ok()?.calibration.clock_estimates()?;
        let time_s = &analysis.triplets().time_s;
        Some(Self {
            offsets_s: estimates.map(|(offset_s, _)| *offset_s),
            drifts: estimates.map(|(_, drift)| drift.value),
            span_s: [*time_s.first()?, *time_s.last()?],
        })
    }

    /// Delay of a station at both ends of the drive: s since `start_s`, ms.
    fn ends(&self, station: usize, start_s: f64) -> [PlotPoint; 2] {
        let middle_s = 0.5 * (self.span_s[0] + self.span_s[1]);
        self.span_s.map(|time_s| {
            let late_s = self.offsets_s[station].value + self.drifts[station] * (time_s - middle_s);
            PlotPoint::new(time_s - start_s, late_s * 1e3)
        })
    }
}

/// Range of all values shown, with a margin (ms).
fn bounds_ms(open: &OpenDeployment, state: &State, estimated: Option<&Estimated>) -> [f64; 2] {
    let stations = state.visible_stations();
    let [mut low, mut high] = [-0.5 * LEAST_MS, 0.5 * LEAST_MS];
    let mut widen = |ms: f64| (low, high) = (low.min(ms), high.max(ms));
    for station in stations {
        let clock = &open.plots.readings.clocks[station];
        let ranges = [clock.readings.range_ms, clock.corrections.range_ms];
        ranges.into_iter().flatten().flatten().for_each(&mut widen);
        if let Some(estimated) = estimated.filter(|_| station > 0) {
            estimated.ends(station, 0.0).iter().for_each(|end| widen(end.y));
        }
    }
    let margin = 0.06 * (high - low);
    [low - margin, high + margin]
}

/// Shows the subtracted medians and the estimates.
fn caption(
    open: &OpenDeployment,
    state: &State,
    estimated: Option<&Estimated>,
    dark: bool,
) -> Vec<RichText> {
    let mut lines = Vec::new();
    let in_colour = |station: usize, text: String| {
        RichText::new(text).color(theme::readable(palette::station(station), dark))
    };
    let stations = || state.visible_stations();
    for station in stations() {
        let clock = &open.plots.readings.clocks[station];
        let Some(median_s) = clock.median_s else { continue };
        let mut text = format!("{}: own clock − stamp {} (median)", station + 1, seconds(median_s));
        if let Some(both) = &clock.comparison {
            _ = write!(text, ", {:+.1} ppm", both.drift_ppm);
            match both.jumps.len() {
                0 => {}
                1 => text += ", 1 jump",
                count => _ = write!(text, ", {count} jumps"),
            }
        }
        lines.push(in_colour(station, text));
    }
    if lines.is_empty() {
        lines.push(RichText::new("no station clocks in these files"));
    }
    for station in stations() {
        let Some(estimated) = estimated.filter(|_| station > 0) else { continue };
        let Estimate { value, sigma } = estimated.offsets_s[station];
        let (late, sigma) = (value * 1e3, sigma * 1e3);
        let text =
            format!("{}: estimated {late:+.1} ± {sigma:.1} ms relative to 1 (dashed)", station + 1);
        lines.push(in_colour(station, text));
    }
    lines
}

/// Formats a time with decimals by its size: "+301.2 ms", "+3600.301 s".
fn seconds(value_s: f64) -> String {
    if value_s.abs() < 1.0 {
        format!("{:+.1} ms", value_s * 1e3)
    } else {
        format!("{value_s:+.3} s")
    }
}
