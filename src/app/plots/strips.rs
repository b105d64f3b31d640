//! Where plots over time are in their panes: in all panes of the same width at the same place, so that what happened at
//! one time stands under each other in all of them.

use egui::text::LayoutJob;
use egui::{Align, FontSelection, Rect, RichText, TextStyle};
use egui_plot::{AxisHints, GridInput, GridMark};

use super::LABELS;
use super::times::Times;
use crate::app::model::TimeScale;
use crate::app::model::time_scale::decimals;
use crate::app::model::units::without_negative_zero;
use crate::app::words;

/// Space for the numbers and the name of the axis at the left (points).
pub const GUTTER: f32 = 66.0;
/// Height of the axis at the bottom, and of its numbers alone.
const AXIS: f32 = 34.0;
const AXIS_NUMBERS: f32 = 18.0;
/// Plots lower than this have no room for the name of the axis below them.
const LEAST_NAMED: f32 = 44.0;
/// Between plots above each other.
const GAP: f32 = 4.0;
/// Least height of a plot.
const LEAST: f32 = 28.0;
/// The part of a pane's width beside the plots where words stand that would cover data, and its least and greatest.
const SHARE: f32 = 0.26;
const NARROWEST: f32 = 118.0;
const WIDEST: f32 = 190.0;
/// Half of the last number of the time axis, where there is nothing beside the plots.
const MARGIN: f32 = 26.0;
/// Panes narrower than this have words above their plots and not beside them.
pub const NARROW: f32 = 430.0;
/// Height of a line of such words.
const LINE: f32 = 15.0;
/// Lower plots have no room for sentences beside them.
const TIGHT: f32 = 60.0;
/// Plots narrower than this have no room for a sentence below them.
const SENTENCE: f32 = 360.0;
/// Length of a letter along an axis: where a name does not fit, there is only its unit.
const LETTER: f32 = 6.0;
/// The name of an axis reaches so far beyond it.
const BEYOND: f32 = 4.0;
/// From a plot to the words beside it: handles of thresholds are there.
const ASIDE: f32 = 11.0;
/// Strong lines of the time axis are so far apart at least, and have their number from this distance on.
const TIMES_APART: f32 = 60.0;
const NUMBERED: std::ops::RangeInclusive<f32> = 52.0..=56.0;
/// egui_plot's least distance of lines.
const LEAST_LINES: f32 = 8.0;

/// The height of a line over the usual where there is little room.
const CLOSE: f32 = 0.88;
/// The part of a plot's height that words above it may take.
const MOST_OF_HEIGHT: f32 = 0.45;

/// The place of a plot, and of the words about it.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    pub plot: Rect,
    pub words: Rect,
    /// Whether the words stand above the plot and not beside it.
    pub above: bool,
    /// Height of the axis below it, where it is the lowest.
    pub axis: Option<f32>,
}

/// The width beside the plots in a pane of this width (points).
pub fn beside(width: f32) -> f32 {
    if width < NARROW { MARGIN } else { (SHARE * width).clamp(NARROWEST, WIDEST) }
}

/// Places for so many plots above each other in what is left of a pane, each with so many lines of words.
pub fn strips(ui: &mut egui::Ui, count: usize, lines: usize) -> Vec<Strip> {
    let whole = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(whole);
    in_rect(whole, count, lines)
}

/// Places for so many plots above each other in a part of a pane whose whole width it has.
///
/// Where there is no room beside them, words stand above, in as many of the lines as the plots' height spares.
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
    /// The height of the plot without the axis below it.
    pub fn height(&self) -> f32 {
        self.plot.height() - self.axis.unwrap_or(0.0)
    }

    /// Whether words beside the plot have room for less than everything there is to say.
    pub fn is_tight(&self) -> bool {
        self.above || self.height() < TIGHT
    }

    /// The time axis, where this is the lowest of several plots above each other.
    pub fn time_axis<'a>(&self, times: &Times) -> Option<AxisHints<'a>> {
        let scale = times.scale;
        let axis = self.axis_below(&scale.title(self.plot.width() < SENTENCE))?;
        Some(
            axis.formatter(move |mark, _| scale.number(mark.value, decimals(mark.step_size)))
                .label_spacing(NUMBERED),
        )
    }

    /// The axis at the bottom, where this is the lowest of several plots; without its name where they are low.
    pub fn axis_below<'a>(&self, name: &str) -> Option<AxisHints<'a>> {
        let thickness = self.axis?;
        let name = if thickness < AXIS { "" } else { name };
        Some(axis_below(name).min_thickness(thickness))
    }

    /// Whether the axis of values has room for its name.
    pub fn names_axis(&self, name: &str, unit: &str) -> bool {
        format!("{name} ({unit})").chars().count() as f32 * LETTER < self.height()
    }

    /// An axis of values with its name and unit, or where that has no room with the unit alone.
    pub fn value_axis<'a>(&self, name: &str, unit: &str) -> AxisHints<'a> {
        let text = match self.names_axis(name, unit) {
            true => format!("{name} ({unit})"),
            false => unit.to_owned(),
        };
        bare_axis().label(RichText::new(text).small()).formatter(|mark, _| in_decimals(mark))
    }

    /// Words about the plot, where they cover no data; all of them are under the pointer, too.
    ///
    /// Each has a line of its own where that has room. Otherwise they follow each other, and no line is cut through.
    pub fn words(&self, ui: &mut egui::Ui, lines: &[RichText], hint: &str) {
        let aside = if self.above { 0.0 } else { ASIDE };
        let place = self.words.with_min_x(self.words.left() + aside);
        let line = ui.text_style_height(&TextStyle::Small);
        // Above a plot its frame is right below; beside it, there is a gap to the next one's words.
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

/// The number of a mark, with the decimals of the step to the next; more where that would round it to another number.
fn in_decimals(GridMark { value, step_size }: GridMark) -> String {
    let of_step = (-step_size.log10().round()).max(0.0) as usize;
    let is_told = |decimals: &usize| {
        let scale = 10_f64.powi(*decimals as i32);
        ((value * scale).round() / scale - value).abs() <= 0.05 * value.abs()
    };
    let decimals = (of_step..of_step + 3).find(is_told).unwrap_or(of_step);
    without_negative_zero(value, decimals)
}

/// Small texts one after the other, each in its colour.
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

/// An axis of values that other panes' stand above and below.
pub fn bare_axis<'a>() -> AxisHints<'a> {
    AxisHints::new_y()
        .label_spacing(9.0..=16.0)
        .min_thickness(GUTTER)
        .tick_label_font(egui::FontId::proportional(11.0))
}

/// The axis at the bottom of plots over something else than time.
pub fn axis_below<'a>(name: &str) -> AxisHints<'a> {
    AxisHints::new_x()
        .label(RichText::new(name).small())
        .tick_label_font(egui::FontId::proportional(11.0))
        .label_spacing(LABELS)
        .min_thickness(AXIS)
}

/// Round times, far enough apart for their numbers.
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
                // Words cover no data.
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
