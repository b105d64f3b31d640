//! Rates of each station's raw readings over time, with the outlier filter's thresholds as draggable lines.
//!
//! The axis is logarithmic and shows absolute rates: outliers are a hundred times faster than driving, and the filter ignores the sign.

use egui::{RichText, Stroke};
use egui_plot::{HoverPosition, MarkerShape, Plot, PlotPoint, PlotPoints, Points};

use super::marks::Marks;
use super::strips::{Strip, strips};
use super::threshold::{self, Threshold};
use super::time_plot::{self, ShownPlot, TimePlot};
use super::times::Times;
use super::{in_the_middle, log_axis, station_switches};
use crate::app::model::{Commands, DeploymentCommand, OpenDeployment, Picked, TimeCommand};
use crate::app::prepared::{Quantity, RawReadings, StationReadings};
use crate::app::state::State;
use crate::app::theme;
use resect_core::network::{Number, PerStation, Station};
use resect_core::pipeline::outlier_filter::too_fast;
use resect_core::pipeline::{OutlierReason, PipelineSettings, SampleFate, Thresholds};
use resect_tools::palette;

/// Greatest distance from a dot at which a click selects it (points).
const NEAR: f32 = 8.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((open, _)) = state.analysed() else {
        in_the_middle(ui, "No readings to plot.");
        return;
    };
    let times = Times::of(open, state);
    head(ui, state, &times, commands);
    for (strip, quantity) in strips(ui, Quantity::ALL.len(), 1).iter().zip(Quantity::ALL) {
        RatePlot { open, state, times, quantity }.show(ui, strip, commands);
    }
}

/// Draws the switches, the legend of the marks, and a button that switches the filter on.
fn head(ui: &mut egui::Ui, state: &State, times: &Times, commands: &mut Commands) {
    time_plot::head(ui, |ui| {
        station_switches(ui, state, commands);
        time_plot::selection(ui, state, times, commands);
        let mut settings = *state.settings();
        if settings.pipeline.outlier_filter {
            let dark = ui.visuals().dark_mode;
            ui.small("rejected by");
            for quantity in Quantity::ALL {
                let colour = palette::fate(SampleFate::Rejected(quantity.reason()));
                let text = format!("× {}", quantity.symbol());
                ui.label(RichText::new(text).small().color(theme::readable(colour, dark)));
            }
        } else {
            ui.small("The outlier filter is off: nothing is rejected.");
            if !state.workspace.picturing && ui.button("Switch it on").clicked() {
                settings.pipeline.outlier_filter = true;
                commands.push(DeploymentCommand::Set(settings).into());
            }
        }
        time_plot::hint(ui, state, " · drag a line: set τ");
    });
}

/// One of the three plots of rates: range, azimuth or zenith angle.
struct RatePlot<'a> {
    open: &'a OpenDeployment,
    state: &'a State,
    times: Times,
    quantity: Quantity,
}

/// A reading that is drawn.
struct Dot {
    picked: Picked,
    /// Time (s), and the common logarithm of the rate.
    at: PlotPoint,
    fate: Option<SampleFate>,
}

impl RatePlot<'_> {
    fn show(&self, ui: &mut egui::Ui, strip: &Strip, commands: &mut Commands) {
        let pipeline = self.state.settings().pipeline;
        let bounds = self.bounds(&pipeline.thresholds);
        // A plot draws three dots per run.
        let runs = (0.5 * strip.plot.width()) as usize;
        let dots = self.dots(&pipeline, bounds, runs);
        let (unit, scale) = (self.unit(), self.times.scale);
        let axis = strip
            .value_axis(self.quantity.name(), unit)
            .formatter(|mark, _| log_axis::number(mark.value));
        let plot = Plot::new(("rates", self.open.id, self.quantity.symbol()))
            .y_grid_spacer(log_axis::many_decades)
            .label_formatter(move |position| match position {
                HoverPosition::NearDataPoint { plot_name, position, .. } => {
                    let rate = threshold::short(10_f64.powf(position.y));
                    let time = scale.text_and_seconds(position.x, 2);
                    Some(format!("{plot_name}\n{time}\n{rate} {unit}"))
                }
                HoverPosition::Elsewhere { .. } => None,
            });
        let name = format!("{} over time", self.quantity.name());
        let stations = self.readings().stations.len();
        let kept_or_rejected =
            kept(&dots, stations).chain(rejected(&dots, self.quantity, stations));
        let left_out = left_out(&dots, stations);
        let time_plot = TimePlot { strip, name: &name, times: &self.times, y_bounds: bounds };
        let shown = time_plot.show(ui, plot, axis, commands, move |plot_ui| {
            kept_or_rejected.for_each(|marks| plot_ui.add(marks));
            left_out.for_each(|points| plot_ui.points(points));
        });
        self.ring(ui, &shown, &pipeline);
        shown.paint_times(ui, &self.times);
        self.words(ui, strip, &pipeline);
        self.line(ui, &shown, commands);
        shown.on_click(&self.times, commands, |at| {
            let far = |dot: &Dot| shown.transform.position_from_point(&dot.at).distance(at);
            let near = dots.iter().min_by(|a, b| far(a).total_cmp(&far(b)))?;
            (far(near) < NEAR).then_some(TimeCommand::PickInPlot(near.picked))
        });
    }

    fn readings(&self) -> &RawReadings {
        &self.open.plots.readings
    }

    /// True for angles, whose rates are stored in °/s.
    fn is_angular(&self) -> bool {
        self.quantity != Quantity::Range
    }

    fn unit(&self) -> &'static str {
        if self.is_angular() { self.state.workspace.units.angle.rate_name() } else { "m/s" }
    }

    /// Factor from a stored rate to the rate shown.
    fn per_stored(&self) -> f64 {
        if self.is_angular() { self.state.workspace.units.angle.rate_per_deg_per_s() } else { 1.0 }
    }

    /// Lowest and highest rate of the axis (log10), from the data and the threshold.
    fn bounds(&self, thresholds: &Thresholds) -> [f64; 2] {
        let [low, high] = self.readings().shown[self.quantity as usize];
        let threshold = self.threshold_value(thresholds);
        [low.min(threshold / 1.5), high.max(threshold * 1.5)]
            .map(|rate| (rate * self.per_stored()).log10())
    }

    fn threshold_value(&self, thresholds: &Thresholds) -> f64 {
        let mut thresholds = *thresholds;
        *self.quantity.threshold(&mut thresholds)
    }

    /// Returns at most a few dots per column of the screen, including the fastest and the slowest.
    fn dots(&self, pipeline: &PipelineSettings, bounds: [f64; 2], runs: usize) -> Vec<Dot> {
        let mut dots = Vec::new();
        for (station, own) in self.readings().stations.iter().enumerate() {
            if !self.state.scene.visibility.stations[station] {
                continue;
            }
            let part = own.within(self.times.window_s);
            // The first reading has no rate.
            let part = part.start.max(1)..part.end.max(1);
            let series = &own.rates[self.quantity as usize];
            for index in series.values.pyramid.visible(part, runs) {
                dots.push(Dot {
                    picked: Picked { station, index },
                    at: self.place(own, index, bounds),
                    fate: fate(own, index, pipeline),
                });
            }
        }
        dots
    }

    /// Returns the place of a reading's dot; readings too slow for the axis are at its lower end.
    fn place(&self, own: &StationReadings, index: usize, bounds: [f64; 2]) -> PlotPoint {
        let margin = 0.01 * (bounds[1] - bounds[0]);
        let rate = own.rates[self.quantity as usize].values.values[index] * self.per_stored();
        PlotPoint::new(own.time_s[index], rate.log10().max(bounds[0] + margin))
    }

    /// Draws a ring about the selected reading.
    fn ring(&self, ui: &egui::Ui, shown: &ShownPlot, pipeline: &PipelineSettings) {
        let Some(Picked { station, index }) = self.open.timeline.picked else { return };
        let Some(own) = self.readings().stations.as_slice().get(station) else { return };
        if index == 0 || index >= own.time_s.len() {
            return;
        }
        let at = self.place(own, index, self.bounds(&pipeline.thresholds));
        let stroke = Stroke::new(2.0, ui.visuals().strong_text_color());
        shown.painter(ui).circle_stroke(shown.transform.position_from_point(&at), 6.0, stroke);
    }

    /// Shows the threshold and the number of readings that it rejects.
    fn words(&self, ui: &mut egui::Ui, strip: &Strip, pipeline: &PipelineSettings) {
        let label = self.threshold(pipeline).label();
        // Without room at the axis, the name of the quantity is here.
        let label = match strip.names_axis(self.quantity.name(), self.unit()) {
            true => label,
            false => format!("{}, {label}", self.quantity.name()),
        };
        let mut lines = vec![RichText::new(label).strong()];
        let mut hint = format!("Magnitude of the {} ({}).", self.quantity.name(), self.unit());
        if let Some([what, count, all]) = self.counts(pipeline) {
            lines.push(RichText::new(format!("{what} {count} of {all}")));
            hint += &format!(
                "\nStations 1 / 2 / …: {what} {count} of {all}.\nRates are from one raw reading to the next. A reading \
                 beyond several thresholds counts for the first: range, azimuth, zenith."
            );
        }
        strip.words(ui, &lines, &hint);
    }

    /// "rejects", "12 / 30 / 9", "4321 / 4400 / 4391"; until the new result is computed, only the counts above the line.
    fn counts(&self, pipeline: &PipelineSettings) -> Option<[String; 3]> {
        let analysis = self.open.analysis.as_ref().filter(|_| pipeline.outlier_filter)?;
        let stations = &self.readings().stations;
        let (what, counts) = if self.state.is_stale() {
            let threshold = self.threshold_value(&pipeline.thresholds);
            let above = |own: &StationReadings| own.rates[self.quantity as usize].above(threshold);
            ("above the line", stations.map(above))
        } else {
            let fate = SampleFate::Rejected(self.quantity.reason());
            let count = |station: Station| analysis.pipeline.count(station.index(), fate);
            ("rejects", stations.map_each(|station, _| count(station)))
        };
        let all = stations.map(|own| own.time_s.len());
        Some([what.to_owned(), in_a_row(&counts), in_a_row(&all)])
    }

    fn threshold(&self, pipeline: &PipelineSettings) -> Threshold<'static> {
        let mut paper = Thresholds::default();
        Threshold {
            symbol: self.quantity.symbol(),
            value: self.threshold_value(&pipeline.thresholds) * self.per_stored(),
            paper: *self.quantity.threshold(&mut paper) * self.per_stored(),
            unit: self.unit(),
            range: 0.01..=100.0,
            enabled: pipeline.outlier_filter,
        }
    }

    fn line(&self, ui: &mut egui::Ui, shown: &ShownPlot, commands: &mut Commands) {
        let mut settings = *self.state.settings();
        let threshold = self.threshold(&settings.pipeline);
        let y = shown.transform.position_from_point_y(threshold.value.log10());
        let rate_at =
            |y: f32| 10_f64.powf(shown.transform.value_from_position(egui::pos2(0.0, y)).y);
        if let Some(value) = threshold.horizontal_line(ui, shown.frame(), y, rate_at) {
            // Rounds off the noise of the unit conversion.
            let stored = (value / self.per_stored() * 1e6).round() / 1e6;
            *self.quantity.threshold(&mut settings.pipeline.thresholds) = stored;
            commands.push(DeploymentCommand::Set(settings).into());
        }
    }
}

/// Returns "12 / 30 / 9".
pub fn in_a_row<T: ToString>(counts: &PerStation<T>) -> String {
    counts.map(T::to_string).as_slice().join(" / ")
}

/// Returns the reading's fate by the present thresholds, because the result may not be computed yet.
fn fate(own: &StationReadings, index: usize, pipeline: &PipelineSettings) -> Option<SampleFate> {
    if own.is_left_out(index) {
        return Some(SampleFate::LeftOut);
    }
    let rates = pipeline.outlier_filter.then(|| own.rates_at(index))?;
    too_fast(&rates, &pipeline.thresholds).map(SampleFate::Rejected)
}

/// Dots of the accepted readings, in the stations' colours.
fn kept(dots: &[Dot], stations: usize) -> impl Iterator<Item = Marks> {
    (0..stations).map(|station| {
        let own = |dot: &&Dot| dot.picked.station == station && dot.fate.is_none();
        let at = dots.iter().filter(own).map(|dot| dot.at).collect();
        Marks::dots(format!("station {}", station + 1), at, theme::rgb(palette::station(station)))
    })
}

/// Crosses of the rejected readings, in the colours of the fates; small if another rate caused the rejection.
fn rejected(dots: &[Dot], quantity: Quantity, stations: usize) -> Vec<Marks> {
    let rejected: Vec<(&Dot, SampleFate)> =
        dots.iter().filter_map(|dot| Some((dot, dot.fate?))).collect();
    let series = |reason: OutlierReason, station: usize| {
        let fate = SampleFate::Rejected(reason);
        let own = rejected.iter().filter(|(dot, of)| dot.picked.station == station && *of == fate);
        let at = own.map(|(dot, _)| dot.at).collect();
        let name = format!("station {}, {}", station + 1, fate.label());
        let colour = theme::rgb(palette::fate(fate));
        if reason == quantity.reason() {
            Marks::crosses(name, at, colour.gamma_multiply(0.7), 3.5)
        } else {
            Marks::crosses(name, at, colour.gamma_multiply(0.3), 2.0)
        }
    };
    let mut all = Vec::new();
    for other in Quantity::ALL {
        all.extend((0..stations).map(|station| series(other.reason(), station)));
    }
    all
}

/// Squares at the bottom for the readings excluded by hand, which have no rate.
fn left_out(dots: &[Dot], stations: usize) -> impl Iterator<Item = Points<'static>> {
    (0..stations).map(|station| {
        let own =
            |dot: &&Dot| dot.picked.station == station && dot.fate == Some(SampleFate::LeftOut);
        let at: Vec<PlotPoint> = dots.iter().filter(own).map(|dot| dot.at).collect();
        let name = format!("station {}, left out by hand", station + 1);
        Points::new(name, PlotPoints::Owned(at))
            .color(theme::rgb(palette::fate(SampleFate::LeftOut)))
            .shape(MarkerShape::Square)
            .filled(false)
            .radius(2.4)
    })
}
