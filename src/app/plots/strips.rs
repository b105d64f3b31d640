//! Positions of plots over time, the same in all panes of equal width, so that simultaneous events line up vertically.

use egui::text::LayoutJob;
use egui::{Align, FontSelection, Rect, RichText, TextStyle};
use egui_plot::{AxisHints, GridInput, GridMark};

use super::LABELS;
use super::times::Times;
use crate::app::model::TimeScale;
use crate::app::model::time_scale::decimals;
use crate::app::model::units::without_negative_zero;
use crate::app::words;

/// Width left of a plot, for the numbers and the name of the axis (points).
pub const GUTTER: f32 = 66.0;
/// Height of the axis at the bottom, with its name and with its numbers alone (points).
const AXIS: f32 = 34.0;
const AXIS_NUMBERS: f32 = 18.0;
/// Least height of a plot whose axis below has a name (points).
const LEAST_NAMED: f32 = 44.0;
/// Gap between plots (points).
const GAP: f32 = 4.0;
/// Least height of a plot (points).
const LEAST: f32 = 28.0;
/// Share of a pane's width beside the plots for text that would cover data, with its least and greatest width (points).
const SHARE: f32 = 0.26;
const NARROWEST: f32 = 118.0;
const WIDEST: f32 = 190.0;
/// Width right of the plots without text beside them: half of the last number of the time axis (points).
const MARGIN: f32 = 26.0;
/// Panes narrower than this have text above their plots instead of beside them (points).
pub const NARROW: f32 = 430.0;
/// Height of a line of this text (points).
const LINE: f32 = 15.0;
/// Plots lower than this have no room for sentences beside them (points).
const TIGHT: f32 = 60.0;
/// Plots narrower than this have no room for a sentence below them (points).
const SENTENCE: f32 = 360.0;
/// Estimated width of a letter along an axis (points). Without room for the name of the axis, only the unit is shown.
const LETTER: f32 = 6.0;
/// Overhang of an axis name beyond its axis (points).
const BEYOND: f32 = 4.0;
/// Gap between a plot and the text beside it, for the handles of thresholds (points).
const ASIDE: f32 = 11.0;
/// Least distance of strong lines of the time axis, and the distances from which they have a number (points).
const TIMES_APART: f32 = 60.0;
const NUMBERED: std::ops::RangeInclusive<f32> = 52.0..=56.0;
/// Least distance of lines in `egui_plot` (points).
const LEAST_LINES: f32 = 8.0;

/// Reduced line height where there is little room, as a share of the usual one.
const CLOSE: f32 = 0.88;
/// Greatest share of a plot's height for the text above it.
const MOST_OF_HEIGHT: f32 = 0.45;

/// Place of a plot and of its text.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    pub plot: Rect,
    pub words: Rect,
    /// True if the text is above the plot instead of beside it.
    pub above: bool,
    /// Height of the axis below the plot (points); `None` unless this is the lowest plot.
    pub axis: Option<f32>,
}

/// Width beside the plots in a pane of this width (points).
pub fn beside(width: f32) -> f32 {
    if width < NARROW { MARGIN } else { (SHARE * width).clamp(NARROWEST, WIDEST) }
}

/// Places of `count` plots above each other in the rest of a pane, with `lines` lines of text each.
pub fn strips(ui: &mut egui::Ui, count: usize, lines: usize) -> Vec<Strip> {
    let whole = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(whole);
    in_rect(whole, count, lines)
}

/// Places of `count` plots above each other in a region as wide as the pane.
///
/// Without room beside the plots, the text is above them, in as many lines as the plots' height allows.
pub fn in_rect(whole: Rect, count: usize, lines: usize) -> Vec<Strip> {
    let gaps = GAP * count.saturating_sub(1) as f32;
    let height_over = |axis: f32| (whole.height() - axis - gaps) / count.max(1) as f32;
    let axis = if height_over(AXIS) < LEAST_NAMED { AXIS_NUMBERS } else { AXIS };
    let height = height_over(axis).max(LEAST);
    (0..count)
        .map(|index| {
            let top = whole.top() + index as f32 * (height + GAP);
            let axis = (index + 1 == count).then_some(axis);
            let row =
                Rect::from_x_y_ranges(whole.left() + BEYOND..=whole.right(), top..=top + height);
            let (mut plot, mut words) =
                row.split_left_right_at_x(row.right() - beside(whole.width()));
            let above = beside(whole.width()) <= MARGIN;
            if above {
                let spared = (MOST_OF_HEIGHT * height / LINE).floor().max(1.0);
                let bottom = top + LINE * spared.min(lines.max(1) as f32);
                words = row.with_max_y(bottom).with_min_x(row.left() + GUTTER);
                plot.min.y = words.max.y;
            }
            plot.max.y += axis.unwrap_or(0.0);
            Strip { plot, words, above, axis }
        })
        .collect()
}

impl Strip {
    /// Height of the plot without the axis below it (points).
    pub fn height(&self) -> f32 {
        self.plot.height() - self.axis.unwrap_or(0.0)
    }

    /// Returns true if the text beside the plot must be shortened.
    pub fn is_tight(&self) -> bool {
        self.above || self.height() < TIGHT
    }

    /// The time axis; `None` unless this is the lowest of several plots.
    pub fn time_axis<'a>(&self, times: &Times) -> Option<AxisHints<'a>> {
        let scale = times.scale;
        let axis = self.axis_below(&scale.title(self.plot.width() < SENTENCE))?;
        Some(
            axis.formatter(move |mark, _| scale.number(mark.value, decimals(mark.step_size)))
                .label_spacing(NUMBERED),
        )
    }

    /// The axis at the bottom, without its name if the plots are low; `None` unless this is the lowest of several plots.
    pub fn axis_below<'a>(&self, name: &str) -> Option<AxisHints<'a>> {
        let thickness = self.axis?;
        let name = if thickness < AXIS { "" } else { name };
        Some(axis_below(name).min_thickness(thickness))
    }

    /// Returns true if the axis of values has room for its name.
    pub fn names_axis(&self, name: &str, unit: &str) -> bool {
        format!("{name} ({unit})").chars().count() as f32 * LETTER < self.height()
    }

    /// The axis of values with name and unit, or with the unit alone if there is no room.
    pub fn value_axis<'a>(&self, name: &str, unit: &str) -> AxisHints<'a> {
        let text = match self.names_axis(name, unit) {
            true => format!("{name} ({unit})"),
            false => unit.to_owned(),
        };
        bare_axis().label(RichText::new(text).small()).formatter(|mark, _| in_decimals(mark))
    }

    /// Shows text about the plot beside or above it; hovering shows all of it.
    ///
    /// Each entry has its own line if there is room. Otherwise entries share lines, and no line is clipped.
    pub fn words(&self, ui: &mut egui::Ui, lines: &[RichText], hint: &str) {
        let aside = if self.above { 0.0 } else { ASIDE };
        let place = self.words.with_min_x(self.words.left() + aside);
        let line = ui.text_style_height(&TextStyle::Small);
        // Above a plot, the frame follows directly; beside it, there is a gap before the text of the next plot.
        let below = if self.above { 0.0 } else { GAP };
        let lay_out = |between: &str, line: f32| {
            let mut job = joined(ui, lines, between);
            job.sections.iter_mut().for_each(|section| section.format.line_height = Some(line));
            job.wrap.max_width = place.width();
            job.wrap.max_rows = ((place.height() + below) / line).floor().max(1.0) as usize;
            ui.painter().layout_job(job)
        };
        let apart = lay_out("\n", line);
        let galley = if apart.elided { lay_out("  ", CLOSE * line) } else { apart };
        let whole = lines.iter().map(|line| line.text().to_owned()).collect::<Vec<_>>().join("\n");
        let whole = if hint.is_empty() { whole } else { format!("{whole}\n\n{hint}") };
        let id = ("words", self.words.top() as i32);
        let builder = egui::UiBuilder::new().id_salt(id).max_rect(place);
        let mut inside = ui.new_child(builder);
        inside.set_clip_rect(place.expand(2.0).intersect(ui.clip_rect()));
        let shown = inside.add(egui::Label::new(galley).show_tooltip_when_elided(false));
        words::mark_text(&shown, &whole);
        shown.on_hover_text(whole);
    }
}

/// The number of a mark with the decimals of its step, or more if that rounds it by over 5 %.
fn in_decimals(GridMark { value, step_size }: GridMark) -> String {
    let of_step = (-step_size.log10().round()).max(0.0) as usize;
    let is_told = |decimals: &usize| {
        let scale = 10_f64.powi(*decimals as i32);
        ((value * scale).round() / scale - value).abs() <= 0.05 * value.abs()
    };
    let decimals = (of_step..of_step + 3).find(is_told).unwrap_or(of_step);
    without_negative_zero(value, decimals)
}

/// Joins small texts in one layout, each in its colour.
fn joined(ui: &egui::Ui, lines: &[RichText], between: &str) -> LayoutJob {
    let mut job = LayoutJob::default();
    let mut add = |text: RichText| {
        text.small().append_to(&mut job, ui.style(), FontSelection::Default, Align::Min);
    };
    for (number, line) in lines.iter().enumerate() {
        if number > 0 {
            add(RichText::new(between));
        }
        add(line.clone());
    }
    job
}

/// An axis of values that lines up with those of other panes.
pub fn bare_axis<'a>() -> AxisHints<'a> {
    AxisHints::new_y()
        .label_spacing(9.0..=16.0)
        .min_thickness(GUTTER)
        .tick_label_font(egui::FontId::proportional(11.0))
}

/// The horizontal axis of plots over a quantity other than time.
pub fn axis_below<'a>(name: &str) -> AxisHints<'a> {
    AxisHints::new_x()
        .label(RichText::new(name).small())
        .tick_label_font(egui::FontId::proportional(11.0))
        .label_spacing(LABELS)
        .min_thickness(AXIS)
}

/// Marks at round times, far enough apart for their numbers.
pub fn time_marks(scale: &TimeScale, input: &GridInput) -> Vec<GridMark> {
    let least_s = f64::from(TIMES_APART / LEAST_LINES) * input.base_step_size;
    let times = scale.round_times(input.bounds.into(), least_s);
    times.into_iter().map(|t| GridMark { value: t.since_s, step_size: t.step_s }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plots_of_panes_of_one_width_stand_under_each_other() {
        for width in [250.0, 500.0, 900.0] {
            let pane = |top: f32, height: f32, count: usize| {
                in_rect(
                    Rect::from_min_size(egui::pos2(10.0, top), egui::vec2(width, height)),
                    count,
                    1,
                )
            };
            let all = [pane(0.0, 300.0, 3), pane(400.0, 200.0, 1)].concat();
            assert!(all.iter().all(|strip| strip.plot.x_range() == all[0].plot.x_range()));
            for strip in &all {
                // The text covers no data.
                let frame = strip.plot.with_min_x(strip.plot.left() + GUTTER);
                assert!(!frame.shrink(0.5).intersects(strip.words), "{strip:?}");
            }
            let heights = all[..3].iter().map(Strip::height);
            assert!(heights.into_iter().all(|height| height == all[0].height() && height > 50.0));
        }
    }

    #[test]
    fn a_narrow_pane_gives_words_as_many_lines_as_it_can_spare() {
        let words = |height: f32, lines: usize| {
            let pane = Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(NARROW - 1.0, height));
            in_rect(pane, 1, lines)[0].words.height()
        };
        assert_eq!(words(400.0, 3), 3.0 * LINE);
        assert_eq!(words(400.0, 1), LINE);
        assert!(words(110.0, 5) < 0.5 * (110.0 - AXIS), "the plot keeps the most");
    }

    #[test]
    fn words_that_lack_the_height_follow_each_other_whole() {
        let lines = ["1–2", "median |e| 0.75 mm, IQR 1.66, n 2032", "at the cursor +1.7 mm"];
        let lines = lines.map(RichText::new);
        let shown = |height: f32| {
            let place = Rect::from_min_size(egui::pos2(20.0, 20.0), egui::vec2(260.0, height));
            let strip = Strip { plot: place, words: place, above: false, axis: None };
            let ctx = egui::Context::default();
            let mut output =
                ctx.run_ui(egui::RawInput::default(), |ui| strip.words(ui, &lines, ""));
            output.textures_delta.clear();
            let texts = output.shapes.into_iter().filter_map(|shape| match shape.shape {
                egui::Shape::Text(text) => Some(text),
                _ => None,
            });
            let [text] = &texts.collect::<Vec<_>>()[..] else { panic!("one text") };
            assert!(text.visual_bounding_rect().height() <= height + GAP, "{height}");
            (text.galley.text().to_owned(), text.galley.elided)
        };
        let (low, elided) = shown(20.0);
        assert!(low.starts_with("1–2  median") && !elided, "{low}");
        assert!(shown(80.0).0.starts_with("1–2\nmedian"));
    }
}
