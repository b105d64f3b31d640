//! Top view of estimates over the ground truth, in a panel each, coloured by their position errors.

use nalgebra::Vector3;

use super::chart::odd_rgb;
use crate::axis::Axis;
use crate::drawing::{Anchor, Drawing, Ink, Mark, shortened, text_width};
use crate::frame::{Frame, NUMBER};
use crate::plan_view::{about_middle, length, range, thinned};
use resect_core::statistics::{median, quantiles};
use resect_tools::estimates::errors::EpochError;
use resect_tools::estimates::odd::OddOne;
use resect_tools::estimates::{EstimatesJudgement, Judged};
use resect_tools::palette::{self, Rgb};

const LABEL: f32 = 11.0;
const LEFT: f32 = 58.0;
const TOP: f32 = 10.0;
const BOTTOM: f32 = 62.0;
/// Room above a panel for the name of its estimate, and between panels for the numbers of an axis.
const NAME_ROW: f32 = 20.0;
const NUMBER_ROW: f32 = 20.0;
/// Room to the right of a panel for its colour bar with numbers.
const BAR_ROOM: f32 = 64.0;
const BAR_WIDTH: f32 = 10.0;
/// Gap between a panel and its colour bar.
const BAR_GAP: f32 = 10.0;
/// Largest height of a panel, and the smallest one, in which the numbers of a colour bar fit.
const HEIGHTS: [f32; 2] = [150.0, 520.0];
/// Number of colours between zero and the largest error.
const COLOURS: usize = 32;
/// Share of the errors within the range of colours, as in the plot over time.
const SHOWN: f64 = 0.995;
/// Poses further apart in time than this multiple of the usual interval are not joined by a line.
const LONG_INTERVAL: f64 = 20.0;
/// Coordinates of maps are shown without this multiple of their hundreds of metres.
const FAR_M: f64 = 10_000.0;
/// Share of the colour of an odd span beside the paper's.
const TINT: f32 = 0.4;

/// Horizontal range that all panels share, and the coordinates that their numbers are without.
struct Extent {
    x: [f64; 2],
    y: [f64; 2],
    origin_m: [f64; 2],
    size: [f32; 2],
}

/// Draws each estimate in the horizontal plane of the ground truth's frame (m), coloured by its position error (mm).
/// Odd spans are shaded.
pub fn draw_map(judgement: &EstimatesJudgement, width: f32) -> Drawing {
    let judged = &judgement.judged;
    let columns = if judged.len() > 1 { 2 } else { 1 };
    let column = (width - LEFT) / columns as f32;
    let extent = Extent::of(judged, column - BAR_ROOM);
    let row = NAME_ROW + extent.size[1] + NUMBER_ROW;
    let mut marks = Vec::new();
    for (index, estimate) in judged.iter().enumerate() {
        let left = LEFT + column * (index % columns) as f32;
        let top = TOP + row * (index / columns) as f32 + NAME_ROW;
        draw_panel(estimate, &extent, [left, top], index % columns == 0, &mut marks);
    }
    let rows = judged.len().div_ceil(columns);
    let height = TOP + row * rows as f32 + BOTTOM;
    let axis = |name: &str, origin_m: f64| match origin_m {
        0.0 => format!("{name} (m)"),
        _ => format!("{name} {} {:.0} (m)", if origin_m > 0.0 { "−" } else { "+" }, origin_m.abs()),
    };
    let [x, y] = extent.origin_m;
    let centre = LEFT + 0.5 * (width - LEFT - BAR_ROOM);
    let [across, up] = [axis("x", x), axis("y", y)];
    marks.push(Mark::text([centre, height - 50.0], across, LABEL, Ink::Text, Anchor::Middle));
    let middle = TOP + 0.5 * row * rows as f32;
    marks.push(Mark::upwards([10.0, middle], up, LABEL, Ink::Text, Anchor::Middle));
    draw_key(width, height, &mut marks);
    Drawing { size: [width, height], marks }
}

impl Extent {
    /// Returns the range of all estimates and true positions, for panels of this width.
    fn of(judged: &[Judged], width: f32) -> Self {
        let errors = || judged.iter().flat_map(|estimate| &estimate.errors);
        let all = |axis: usize| {
            let both =
                move |error: &EpochError| [error.true_position_m[axis], estimated_m(error)[axis]];
            range(errors().flat_map(both))
        };
        let (x, y) = (all(0), all(1));
        let per_metre = (f64::from(width) / length(x)).min(f64::from(HEIGHTS[1]) / length(y));
        let height = ((length(y) * per_metre) as f32).clamp(HEIGHTS[0], HEIGHTS[1]);
        let [x, y] = [(x, width), (y, height)]
            .map(|(range, pixels)| about_middle(range, f64::from(pixels) / per_metre));
        let origin = |[low, high]: [f64; 2]| match 0.5 * (low + high) {
            middle if middle.abs() > FAR_M => 100.0 * (middle / 100.0).round(),
            _ => 0.0,
        };
        Self { origin_m: [origin(x), origin(y)], x, y, size: [width, height] }
    }

    fn frame(&self, [left, top]: [f32; 2]) -> Frame {
        let without = |[low, high]: [f64; 2], origin_m: f64| [low - origin_m, high - origin_m];
        let [x_m, y_m] = self.origin_m;
        let max = [left + self.size[0], top + self.size[1]];
        Frame::new(without(self.x, x_m), without(self.y, y_m), [left, top], max)
    }
}

fn estimated_m(error: &EpochError) -> Vector3<f64> {
    error.true_position_m + error.position_m
}

fn draw_panel(
    estimate: &Judged,
    extent: &Extent,
    [left, top]: [f32; 2],
    has_numbers: bool,
    marks: &mut Vec<Mark>,
) {
    let errors = &estimate.errors[..];
    let frame = extent.frame([left, top]);
    let to_picture = |position_m: Vector3<f64>| {
        frame.place(position_m.x - extent.origin_m[0], position_m.y - extent.origin_m[1])
    };
    let rmse = format!(": {:.1} mm rmse", 1e3 * estimate.position.rmse);
    let room = extent.size[0] + BAR_ROOM - 12.0 - text_width(&rmse, LABEL);
    let name = shortened(&estimate.estimate.name, LABEL, room) + &rmse;
    marks.push(Mark::text([left, top - 10.0], name, LABEL, Ink::Text, Anchor::Left));
    frame.draw_rows(has_numbers, marks);
    frame.draw_columns(true, marks);
    let most_mm =
        quantiles(errors.iter().map(size_mm), [SHOWN]).map_or(1.0, |[most_mm]| most_mm.max(1e-3));
    for span in &estimate.odd {
        let in_span: Vec<&EpochError> = errors
            .iter()
            .filter(|error| (span.span_s[0]..=span.span_s[1]).contains(&error.time_s))
            .collect();
        let points = thinned(in_span.iter().map(|error| to_picture(estimated_m(error))));
        marks.push(Mark::Line { points, ink: odd_ink(span.odd_one), width: 14.0, dashed: false });
    }
    let runs = runs_without_gaps(errors);
    for run in &runs {
        let points = thinned(run.iter().map(|error| to_picture(estimated_m(error))));
        marks.push(Mark::Line { points, ink: Ink::Weak, width: 4.2, dashed: false });
    }
    for run in &runs {
        draw_coloured(run, most_mm, &|error| to_picture(estimated_m(error)), marks);
    }
    for run in &runs {
        let points = thinned(run.iter().map(|error| to_picture(error.true_position_m)));
        marks.push(Mark::Line { points, ink: Ink::Text, width: 0.7, dashed: false });
    }
    if let Some(first) = errors.first() {
        draw_start(to_picture(estimated_m(first)), marks);
    }
    draw_bar(most_mm, [left + extent.size[0] + BAR_GAP, top], extent.size[1], marks);
}

fn size_mm(error: &EpochError) -> f64 {
    1e3 * error.position_m.norm()
}

fn odd_ink(odd_one: OddOne) -> Ink {
    Ink::Rgb(tinted(odd_rgb(odd_one)))
}

/// Returns a light tint of a colour.
fn tinted(colour: Rgb) -> Rgb {
    colour.map(|channel| (TINT * f32::from(channel) + (1.0 - TINT) * 255.0) as u8)
}

/// Splits errors at long intervals without any.
fn runs_without_gaps(errors: &[EpochError]) -> Vec<&[EpochError]> {
    let usual_s = median(errors.windows(2).map(|two| two[1].time_s - two[0].time_s));
    let longest_s = LONG_INTERVAL * usual_s.unwrap_or(f64::INFINITY);
    errors.chunk_by(|a, b| b.time_s - a.time_s <= longest_s).collect()
}

/// Draws a line for each run of steps with one colour, that of the larger error at their ends.
fn draw_coloured(
    errors: &[EpochError],
    most_mm: f64,
    to_picture: &dyn Fn(&EpochError) -> [f32; 2],
    marks: &mut Vec<Mark>,
) {
    let colour = |index: usize| {
        let largest_mm = errors[index..=index + 1].iter().map(size_mm).fold(0.0, f64::max);
        ((largest_mm / most_mm * COLOURS as f64) as usize).min(COLOURS - 1)
    };
    let steps: Vec<usize> = (0..errors.len().saturating_sub(1)).collect();
    for run in steps.chunk_by(|a, b| colour(*a) == colour(*b)) {
        let ends = run[0]..=run[run.len() - 1] + 1;
        let points = thinned(errors[ends].iter().map(to_picture));
        let ink = colour_ink(colour(run[0]));
        marks.push(Mark::Line { points, ink, width: 3.0, dashed: false });
    }
}

fn colour_ink(index: usize) -> Ink {
    Ink::Rgb(palette::continuous(index as f32 / (COLOURS - 1) as f32))
}

fn draw_start([x, y]: [f32; 2], marks: &mut Vec<Mark>) {
    let (min, max) = ([x - 4.0, y - 4.0], [x + 4.0, y + 4.0]);
    marks.push(Mark::Rect { min, max, ink: Ink::Paper, opacity: 1.0, outline: None });
    let (min, max) = ([x - 2.5, y - 2.5], [x + 2.5, y + 2.5]);
    marks.push(Mark::Rect { min, max, ink: Ink::Text, opacity: 1.0, outline: None });
}

/// Draws the scale of colours from zero to the largest error (mm).
fn draw_bar(most_mm: f64, [left, top]: [f32; 2], height: f32, marks: &mut Vec<Mark>) {
    let bottom = top + height;
    let step = height / COLOURS as f32;
    for index in 0..COLOURS {
        let low = bottom - step * index as f32;
        let (min, max) = ([left, low - step - 0.2], [left + BAR_WIDTH, low]);
        marks.push(Mark::Rect { min, max, ink: colour_ink(index), opacity: 1.0, outline: None });
    }
    let axis = Axis::between([0.0, most_mm], [bottom, top]);
    for (value, label) in axis.ticks() {
        let y = axis.place(value);
        marks.push(Mark::line([left + BAR_WIDTH, y], [left + BAR_WIDTH + 3.0, y], Ink::Weak, 1.0));
        let position = [left + BAR_WIDTH + 6.0, y];
        marks.push(Mark::text(position, label, NUMBER, Ink::Weak, Anchor::Left));
    }
    let position = [left + 0.5 * BAR_WIDTH, bottom + 0.5 * NUMBER + 5.0];
    marks.push(Mark::text(position, "mm", NUMBER, Ink::Weak, Anchor::Middle));
}

/// Explains lines, marks and tints below the panels.
fn draw_key(width: f32, height: f32, marks: &mut Vec<Mark>) {
    let y = height - 16.0;
    let entries: [(&str, Ink, f32); 5] = [
        ("ground truth", Ink::Text, 0.7),
        ("start", Ink::Text, 5.0),
        ("estimate wrong", odd_ink(OddOne::Estimate), 12.0),
        ("ground truth wrong", odd_ink(OddOne::Readings), 12.0),
        ("undecided", odd_ink(OddOne::Undecided), 12.0),
    ];
    let colours = "colour: position error";
    let wide = |text: &str| text_width(text, LABEL) + 18.0;
    let all: f32 = entries.iter().map(|(text, ..)| wide(text) + 20.0).sum::<f32>() + wide(colours);
    let mut x = (0.5 * (width - all)).max(8.0);
    marks.push(Mark::text([x, y], colours, LABEL, Ink::Weak, Anchor::Left));
    x += wide(colours);
    for (text, ink, thickness) in entries {
        let from = if text == "start" { x + 9.0 } else { x };
        marks.push(Mark::line([from, y], [x + 14.0, y], ink, thickness));
        marks.push(Mark::text([x + 20.0, y], text, LABEL, Ink::Weak, Anchor::Left));
        x += wide(text) + 20.0;
    }
}
