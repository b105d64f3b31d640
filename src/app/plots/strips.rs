//! Where plots over time are in their panes: in all panes of the same width at the same place, so that what happened at
//! one time stands under each other in all of them.

use eframe::egui::{self, Rect, RichText, Vec2};
use egui_plot::{AxisHints, GridInput, GridMark};

use super::times::Times;
use crate::app::model::TimeScale;
use crate::app::model::time_scale::decimals;
use crate::app::words;

/// Space for the numbers and the name of the axis at the left (points).
pub const GUTTER: f32 = 66.0;
/// Height of the time axis at the bottom.
const TIME_AXIS: f32 = 34.0;
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

/// The place of a plot, and of the words about it.
#[derive(Clone, Copy, Debug)]
pub struct Strip {
    pub plot: Rect,
    pub words: Rect,
    /// Whether the time axis is below it.
    pub lowest: bool,
}

/// The width beside the plots in a pane of this width (points).
pub fn beside(width: f32) -> f32 {
    if width < NARROW { MARGIN } else { (SHARE * width).clamp(NARROWEST, WIDEST) }
}

/// Places for so many plots above each other in what is left of a pane.
pub fn strips(ui: &mut egui::Ui, count: usize) -> Vec<Strip> {
    let whole = ui.available_rect_before_wrap();
    ui.advance_cursor_after_rect(whole);
    in_rect(whole, count)
}

/// Places for so many plots above each other in a part of a pane whose whole width it has.
pub fn in_rect(whole: Rect, count: usize) -> Vec<Strip> {
    let gaps = GAP * count.saturating_sub(1) as f32;
    let height = ((whole.height() - TIME_AXIS - gaps) / count.max(1) as f32).max(LEAST);
    (0..count)
        .map(|index| {
            let top = whole.top() + index as f32 * (height + GAP);
            let lowest = index + 1 == count;
            let row =
                Rect::from_x_y_ranges(whole.left() + BEYOND..=whole.right(), top..=top + height);
            let (mut plot, mut words) =
                row.split_left_right_at_x(row.right() - beside(whole.width()));
            if beside(whole.width()) <= MARGIN {
                words = row.with_max_y(top + LINE).with_min_x(row.left() + GUTTER);
                plot.min.y = words.max.y;
            }
            if lowest {
                plot.max.y += TIME_AXIS;
            }
            Strip { plot, words, lowest }
        })
        .collect()
}

impl Strip {
    /// The height of the plot without the time axis.
    pub fn height(&self) -> f32 {
        self.plot.height() - if self.lowest { TIME_AXIS } else { 0.0 }
    }

    /// An axis of values with its name and unit, or where that has no room with the unit alone.
    pub fn value_axis<'a>(&self, name: &str, unit: &str) -> AxisHints<'a> {
        let whole = format!("{name} ({unit})");
        let fits = whole.chars().count() as f32 * LETTER < self.height();
        let text = if fits { whole } else { unit.to_owned() };
        bare_axis().label(RichText::new(text).small())
    }

    /// Words about the plot, where they cover no data; all of them are under the pointer, too.
    pub fn words(&self, ui: &mut egui::Ui, lines: Vec<RichText>, hint: &str) {
        // A line's height is a difference of places, which are rounded.
        let narrow = self.words.height() < LINE + 0.5;
        let place =
            if narrow { self.words } else { self.words.with_min_x(self.words.left() + ASIDE) };
        let layout = if narrow {
            egui::Layout::left_to_right(egui::Align::Center)
        } else {
            egui::Layout::top_down(egui::Align::Min)
        };
        let id = ("words", self.words.top() as i32);
        let builder = egui::UiBuilder::new().id_salt(id).max_rect(place).layout(layout);
        let mut inside = ui.new_child(builder);
        inside.set_clip_rect(place.expand(2.0).intersect(ui.clip_rect()));
        inside.spacing_mut().item_spacing = Vec2::new(8.0, 0.0);
        let whole = lines.iter().map(|line| line.text().to_owned()).collect::<Vec<_>>().join("\n");
        let whole = if hint.is_empty() { whole } else { format!("{whole}\n\n{hint}") };
        for line in lines {
            let label = egui::Label::new(line.small());
            let label = if narrow { label.truncate() } else { label.wrap() };
            let shown = inside.add(label);
            words::mark_text(&shown, &whole);
            shown.on_hover_text(&whole);
        }
    }
}

/// An axis of values that other panes' stand above and below.
pub fn bare_axis<'a>() -> AxisHints<'a> {
    AxisHints::new_y()
        .label_spacing(9.0..=16.0)
        .min_thickness(GUTTER)
        .tick_label_font(egui::FontId::proportional(11.0))
}

/// The axis that plots over time have at the bottom; of several above each other only the lowest.
pub fn time_axis<'a>(times: &Times, width: f32) -> AxisHints<'a> {
    let scale = times.scale;
    AxisHints::new_x()
        .label(RichText::new(scale.title(width < SENTENCE)).small())
        .tick_label_font(egui::FontId::proportional(11.0))
        .formatter(move |mark, _| scale.number(mark.value, decimals(mark.step_size)))
        .label_spacing(NUMBERED)
        .min_thickness(TIME_AXIS)
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
                in_rect(Rect::from_min_size(egui::pos2(10.0, top), Vec2::new(width, height)), count)
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
}
