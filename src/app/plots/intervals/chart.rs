//! One row per station with its readings and gaps, and one row with the spans common to all.

use egui::{Align2, Color32, Pos2, Rangef, Rect, Shape, Stroke, StrokeKind, Vec2};
use egui_plot::{GridMark, Plot};

use super::super::quads::Quads;
use super::super::strips::{Strip, bare_axis};
use super::super::time_plot::{ShownPlot, TimePlot};
use super::super::times::Times;
use crate::app::model::{Commands, OpenDeployment, Picked, TimeCommand};
use crate::app::prepared::gaps::{Seen, first_from, visible};
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::network::PerStation;
use resect_core::pipeline::{FilteredTrack, Interval, OutlierReason, SampleFate};
use resect_tools::palette;

/// Letter size of a row's name, as a share of the row's height.
const LETTERS: f32 = 0.76;
/// Ticks further apart than this are drawn singly (points); closer ones are drawn as density, in columns of the second width (points).
const TICKS: f64 = 3.0;
const COLUMN: f32 = 2.0;
/// Greatest distance from a tick at which a click selects it (points).
const NEAR: f32 = 6.0;

pub fn ui(
    ui: &mut egui::Ui,
    strip: &Strip,
    (open, analysis): (&OpenDeployment, &Analysis),
    state: &State,
    times: &Times,
    commands: &mut Commands,
) {
    // One for each station, and one for all together.
    let rows = analysis.pipeline.filtered.len() + 1;
    // A name higher than its row would not be drawn.
    let size = (LETTERS * strip.height() / rows as f32).clamp(8.0, 11.0);
    let axis = bare_axis()
        .tick_label_font(egui::FontId::proportional(size))
        .formatter(move |mark, _| name(rows as f64 - mark.value, rows))
        .label_spacing(8.0..=10.0);
    let plot = Plot::new(("intervals", open.id))
        .y_grid_spacer(move |_| {
            let middle = |row| GridMark { value: f64::from(row) + 0.5, step_size: 1.0 };
            (0..rows as i32).map(middle).collect()
        })
        .show_grid([true, false])
        .label_formatter(|_| None);
    let name = "readings, silences and intervals over time";
    let time_plot = TimePlot { strip, name, times, y_bounds: [0.0, rows as f64] };
    let shown = time_plot.show(ui, plot, axis, commands, |_| {});
    let filtered = analysis.pipeline.filtered.as_ref();
    let chart = Chart { open, state, times, filtered, shown };
    for station in state.visible_stations() {
        chart.station(ui, station);
    }
    chart.common(ui);
    chart.shown.paint_times(ui, times);
    chart.hover(ui);
    chart.shown.on_click(times, commands, |at| chart.reading_at(at).map(TimeCommand::PickInPlot));
}

fn name(row: f64, rows: usize) -> String {
    match row as usize {
        station if station + 1 < rows => format!("station {}", station + 1),
        _ => match rows - 1 {
            2 => "both".to_owned(),
            3 => "all three".to_owned(),
            stations => format!("all {stations}"),
        },
    }
}

struct Chart<'a> {
    open: &'a OpenDeployment,
    state: &'a State,
    times: &'a Times,
    /// Readings of each track after the outlier filter.
    filtered: &'a PerStation<FilteredTrack>,
    shown: ShownPlot,
}

impl Chart<'_> {
    fn row(&self, row: usize) -> Rangef {
        let frame = self.shown.frame();
        let height = frame.height() / self.rows() as f32;
        let top = frame.top() + row as f32 * height;
        Rangef::new(top, top + height).shrink(0.12 * height)
    }

    /// Returns the number of rows: the stations, and all together.
    fn rows(&self) -> usize {
        self.filtered.len() + 1
    }

    fn points_per_s(&self) -> f64 {
        self.shown.transform.dpos_dvalue_x()
    }

    /// Gaps and spans at least one point wide.
    fn visible(&self, spans: &[Interval]) -> Vec<Seen> {
        visible(spans, self.times.window_s, 1.0 / self.points_per_s())
    }

    fn rect(&self, row: usize, span: &Interval) -> Rect {
        let frame = self.shown.frame();
        let x = [span.start_s, span.end_s].map(|t| {
            // Clamped because f32 is too coarse far outside the frame.
            self.shown.x(t).clamp(frame.left() - 9.0, frame.right() + 9.0)
        });
        Rect::from_x_y_ranges(x[0]..=x[1].max(x[0] + 1.0), self.row(row))
    }

    fn station(&self, ui: &egui::Ui, station: usize) {
        let painter = self.shown.painter(ui);
        let (row, gaps) = (self.row(station), &self.open.plots.gaps);
        let silent = theme::rgb(palette::fate(SampleFate::Rejected(OutlierReason::Range)));
        self.spans(ui, &painter, station, &gaps.outages[station], |quads, rect| {
            quads.add(rect, silent.gamma_multiply(0.3));
            quads.add_frame(rect, 1.0, silent);
        });
        if self.ticks_stand_alone(station) {
            self.ticks(ui, &painter, station);
        } else {
            self.density(&painter, station);
        }
        // Rejected readings often explain an apparent gap of a station.
        let foot = Rangef::new(row.max - 0.3 * row.span(), row.max);
        self.marks(&painter, foot, &gaps.rejected_s[station], silent);
        // Readings excluded by the user are marked separately.
        let head = Rangef::new(row.min, row.min + 0.3 * row.span());
        let by_hand = theme::rgb(palette::fate(SampleFate::LeftOut));
        self.marks(&painter, head, &gaps.left_out_s[station], by_hand);
    }

    /// Draws marks at single times, merging those at the same place.
    fn marks(&self, painter: &egui::Painter, y: Rangef, times_s: &[f64], colour: Color32) {
        let mut quads = Quads::default();
        let mut at = times_s.partition_point(|t| *t < self.times.window_s[0]);
        while let Some(time_s) = times_s.get(at).filter(|t| **t <= self.times.window_s[1]) {
            let x = self.shown.x(*time_s);
            quads.add(Rect::from_x_y_ranges(x - 0.75..=x + 0.75, y), colour);
            let close_s = time_s + 1.0 / self.points_per_s();
            at = first_from(times_s, at + 1, |t| *t <= close_s);
        }
        painter.add(quads.into_shape());
    }

    fn ticks_stand_alone(&self, station: usize) -> bool {
        let readings = self.open.plots.readings.stations[station].within(self.times.window_s);
        f64::from(self.shown.frame().width()) > TICKS * readings.len() as f64
    }

    fn ticks(&self, ui: &egui::Ui, painter: &egui::Painter, station: usize) {
        let own = &self.open.plots.readings.stations[station];
        let row = self.row(station);
        let colour = theme::rgb(palette::station(station));
        for index in own.within(self.times.window_s) {
            let x = self.shown.x(own.time_s[index]);
            if self.filtered[station].rejected[index].is_none() && !own.is_left_out(index) {
                painter.vline(x, row, Stroke::new(1.2, colour));
            }
            if self.open.timeline.picked == Some(Picked { station, index }) {
                let ring = Rect::from_x_y_ranges(x - 3.0..=x + 3.0, row.expand(1.0));
                let stroke = Stroke::new(1.5, ui.visuals().strong_text_color());
                painter.rect_stroke(ring, 2.0, stroke, StrokeKind::Outside);
            }
        }
    }

    /// Draws the density of accepted readings by column, stronger for more readings.
    fn density(&self, painter: &egui::Painter, station: usize) {
        let times_s = &self.filtered[station].time_s;
        let start_s = self.times.start_s;
        let (frame, row) = (self.shown.frame(), self.row(station));
        let columns = (frame.width() / COLUMN).ceil() as usize;
        let left = |column: usize| frame.left() + column as f32 * COLUMN;
        let time_at =
            |x: f32| self.shown.transform.value_from_position(Pos2::new(x, 0.0)).x + start_s;
        let mut end = times_s.partition_point(|t| *t < time_at(left(0)));
        let ends: Vec<usize> = (0..=columns)
            .map(|column| {
                let from_s = time_at(left(column));
                end = first_from(times_s, end, |t| *t < from_s);
                end
            })
            .collect();
        let most = ends.windows(2).map(|pair| pair[1] - pair[0]).max().unwrap_or(1).max(1);
        let colour = theme::rgb(palette::station(station));
        let mut quads = Quads::default();
        for (column, pair) in ends.windows(2).enumerate().filter(|(_, pair)| pair[0] < pair[1]) {
            let share = (pair[1] - pair[0]) as f32 / most as f32;
            let rect = Rect::from_x_y_ranges(left(column)..=left(column + 1), row);
            quads.add(rect, colour.gamma_multiply(0.25 + 0.6 * share));
        }
        painter.add(quads.into_shape());
    }

    /// Draws the visible spans of a row as one shape, with their durations over them.
    fn spans(
        &self,
        ui: &egui::Ui,
        painter: &egui::Painter,
        row: usize,
        spans: &[Interval],
        paint: impl Fn(&mut Quads, Rect),
    ) {
        let seen = self.visible(spans);
        let mut quads = Quads::default();
        seen.iter().for_each(|seen| paint(&mut quads, self.rect(row, &seen.span)));
        painter.add(quads.into_shape());
        seen.iter().for_each(|seen| label(ui, painter, self.rect(row, &seen.span), seen));
    }

    fn common(&self, ui: &egui::Ui) {
        let painter = self.shown.painter(ui);
        let gaps = &self.open.plots.gaps;
        let (row, kept) = (self.rows() - 1, theme::rgb(palette::fate(SampleFate::Kept)));
        self.spans(ui, &painter, row, &gaps.kept, |quads, rect| {
            quads.add(rect, kept.gamma_multiply(0.75));
        });
        let short = theme::rgb(palette::fate(SampleFate::IntervalTooShort));
        let place = |seen: &Seen| {
            let mut rect = self.rect(row, &seen.span);
            if seen.count > 1 {
                // Rejected spans between accepted ones must not hide them.
                rect.min.y = rect.max.y - 0.3 * rect.height();
            }
            rect
        };
        let seen = self.visible(&gaps.short);
        let mut quads = Quads::default();
        for rect in seen.iter().map(place) {
            quads.add(rect, short.gamma_multiply(0.15));
            quads.add_frame(rect, 1.0, short);
        }
        painter.add(quads.into_shape());
        for seen in &seen {
            hatch(&painter, place(seen), short);
            label(ui, &painter, place(seen), seen);
        }
    }

    /// Describes the item under the pointer.
    fn hover(&self, ui: &egui::Ui) {
        let Some(at) = self.shown.pointer(ui) else { return };
        let frame = self.shown.frame();
        let row = ((at.y - frame.top()) / frame.height() * self.rows() as f32) as usize;
        let time_s = self.shown.transform.value_from_position(at).x;
        let gaps = &self.open.plots.gaps;
        let silences = |station: usize| {
            let silent = under(&gaps.outages[station], time_s)?;
            let span = self.length_and_span(silent);
            Some(format!("station {} silent for {span}", station + 1))
        };
        let text = if row + 1 < self.rows() {
            silences(row)
        } else if let Some(kept) = under(&gaps.kept, time_s) {
            Some(format!("kept interval: {}", self.length_and_span(kept)))
        } else if let Some(short) = under(&gaps.short, time_s) {
            let tau_l = self.state.settings().pipeline.thresholds.tau_l_seconds;
            Some(format!("too short (τ_l {tau_l} s): {}", self.length_and_span(short)))
        } else {
            let silent: Vec<String> = (0..self.filtered.len()).filter_map(silences).collect();
            (!silent.is_empty()).then(|| format!("no interval\n{}", silent.join("\n")))
        };
        if let Some(text) = text {
            self.shown.response.clone().on_hover_text_at_pointer(text);
        }
    }

    fn length_and_span(&self, span: &Interval) -> String {
        let [from, to] =
            [span.start_s, span.end_s].map(|t| self.times.scale.text_and_seconds(t, 1));
        format!("{} s\n{from} to {to}", length(span))
    }

    /// Returns the reading whose tick is near; `None` if ticks are not drawn singly.
    fn reading_at(&self, at: Pos2) -> Option<Picked> {
        let station = (0..self.filtered.len()).find(|station| self.row(*station).contains(at.y))?;
        if !self.state.scene.visibility.stations[station] || !self.ticks_stand_alone(station) {
            return None;
        }
        let own = &self.open.plots.readings.stations[station];
        let far = |index: &usize| (self.shown.x(own.time_s[*index]) - at.x).abs();
        let near = own.within(self.times.window_s).min_by(|a, b| far(a).total_cmp(&far(b)))?;
        (far(&near) < NEAR).then_some(Picked { station, index: near })
    }
}

fn under(spans: &[Interval], time_s: f64) -> Option<&Interval> {
    let span = spans.get(spans.partition_point(|span| span.end_s < time_s))?;
    (span.start_s <= time_s).then_some(span)
}

fn length(span: &Interval) -> String {
    let length_s = span.length_s();
    if length_s < 9.95 { format!("{length_s:.1}") } else { format!("{length_s:.0}") }
}

/// Draws the duration of a span if there is room.
fn label(ui: &egui::Ui, painter: &egui::Painter, rect: Rect, seen: &Seen) {
    let seen_part = rect.intersect(painter.clip_rect());
    if seen_part.width() < 5.0 * "0.0 s".len() as f32 {
        return;
    }
    let text = format!("{} s", length(&seen.span));
    // Most spans have no room; this check avoids the layout of the text.
    if seen.count > 1 || seen_part.width() < 5.0 * text.len() as f32 {
        return;
    }
    let font = egui::TextStyle::Small.resolve(ui.style());
    let galley = painter.layout_no_wrap(text, font, ui.visuals().strong_text_color());
    if seen_part.width() > galley.size().x + 4.0 {
        let place = Align2::CENTER_CENTER.anchor_size(seen_part.center(), galley.size());
        let ground = ui.visuals().extreme_bg_color.gamma_multiply(0.7);
        painter.rect_filled(place.expand(1.0), 2.0, ground);
        painter.galley(place.min, galley, ui.visuals().strong_text_color());
    }
}

/// Draws slanted lines if there is room. They are clipped here, because the painter draws each line that it has to clip separately.
fn hatch(painter: &egui::Painter, rect: Rect, colour: Color32) {
    let (step, rise) = (5.0, rect.height());
    let seen = rect.intersect(painter.clip_rect());
    if seen.width() < step {
        return;
    }
    let first = ((seen.left() - rect.left() - rise) / step).floor().max(0.0) as i32;
    let last = ((seen.right() - rect.left() + rise) / step).ceil() as i32;
    for line in first..=last {
        let foot = rect.left_bottom() + Vec2::new(line as f32 * step - rise, 0.0);
        let [from, to] = [foot.x.max(seen.left()), (foot.x + rise).min(seen.right())];
        if from < to {
            let ends = [from, to].map(|x| Pos2::new(x, foot.y - (x - foot.x)));
            painter.add(Shape::line_segment(ends, Stroke::new(1.0, colour)));
        }
    }
}
