//! Layout of a chart: axis, boxes, foot, lines and texts.

use super::boxes::{self, Slots};
use super::foot::{Foot, FootText};
use super::sizes::{HEADROOM, LABEL, MARGIN, SMALL, TITLE};
use crate::axis::Axis;
use crate::drawing::{Anchor, Drawing, Ink, Mark, shortened, text_width, wrap};

use resect_core::deployment::Finding;
use resect_tools::experiment::Study;

/// Returns the value axis of a study between two heights of a drawing.
fn value_axis(study: &Study, bottom: f32, top: f32) -> Axis {
    Axis::of(study.values(), study.needs_log(), bottom, top, HEADROOM)
}

/// A chart on its canvas, with the positions of its boxes.
pub struct LaidOut {
    pub drawing: Drawing,
    places: Places,
}

/// Positions of boxes (units of the canvas).
struct Places {
    /// Ends of the axis of groups, and of the axis of values.
    across: [f32; 2],
    upwards: [f32; 2],
    /// Width of a group on the axis, and of a series within it.
    slot: f32,
    unit: f32,
}

impl LaidOut {
    /// Returns the description of the box at a position on the canvas; `None` beside the boxes.
    pub fn said_at(&self, chart: &Study, [x, y]: [f32; 2]) -> Option<String> {
        let Places { across: [left, right], upwards: [bottom, top], slot, unit } = self.places;
        if !(left..right).contains(&x) || !(top..=bottom).contains(&y) {
            return None;
        }
        let group = ((x - left) / slot) as usize;
        let from_middle = x - left - slot * (group as f32 + 0.5);
        let series = (from_middle / unit + 0.5 * chart.series.len() as f32).floor();
        if series < 0.0 || group >= chart.groups.len() {
            return None;
        }
        boxes::said(chart, group, series as usize)
    }
}

/// Draws a study with its findings below it.
pub fn draw(chart: &Study, size: [f32; 2]) -> Drawing {
    lay_out(chart, &chart.findings, size).drawing
}

/// Lays out a study with these of its findings below it; none if they are already shown beside it.
pub fn lay_out(chart: &Study, findings: &[Finding], size: [f32; 2]) -> LaidOut {
    // Texts grow with the canvas, though less than the boxes.
    let scale = ((size[0] * size[1]).sqrt() / 720.0).clamp(0.85, 1.5);
    let [width, height] = size.map(|side| side / scale);
    let mut marks = Vec::new();
    let top = head(chart, width, &mut marks) + 8.0;
    let level_texts: Vec<Vec<String>> =
        chart.shown_levels().map(|level| wrap(&level.label, SMALL, 80.0, 2)).collect();
    let level_width =
        level_texts.iter().flatten().map(|line| text_width(line, SMALL) + 10.0).fold(0.0, f32::max);
    let right = width - MARGIN - level_width;

    // Labels left of the axis reduce the room of the groups; the groups' names then shorten the axis, which changes
    // its own labels. Increases the width until everything fits.
    let mut labels_width = 0.0;
    let (left, slots, foot, bottom, axis, value_lines) = loop {
        let left = MARGIN + labels_width + 8.0;
        let slots = Slots::of(chart, left, right);
        let text = FootText { caption: slots.caption(chart), findings };
        let foot = Foot::of(chart, &text, slots.slot, [width, height]);
        let bottom = (height - foot.height()).max(top + 2.0 * HEADROOM);
        let axis = value_axis(chart, bottom, top);
        let widths = axis.ticks().into_iter().map(|(_, label)| text_width(&label, SMALL));
        let value_lines = value_lines(chart, bottom - top);
        let needed = 15.0 * value_lines.len() as f32 + widths.fold(0.0, f32::max);
        if needed <= labels_width {
            break (left, slots, foot, bottom, axis, value_lines);
        }
        labels_width = needed;
    };
    if chart.all_quantiles().next().is_none() {
        let at = [0.5 * (left + right), 0.5 * (top + bottom)];
        marks.push(Mark::text(at, "no data", LABEL, Ink::Weak, Anchor::Middle));
    } else {
        for (value, label) in axis.ticks() {
            let y = axis.place(value);
            marks.push(Mark::line([left, y], [right, y], Ink::Grid, 1.0));
            marks.push(Mark::text([left - 6.0, y], label, SMALL, Ink::Text, Anchor::Right));
        }
        draw_levels(chart, &level_texts, &axis, [left, right], [top, bottom], &mut marks);
        slots.draw(chart, &axis, bottom, &mut marks);
    }
    for (column, line) in value_lines.into_iter().enumerate() {
        let at = [MARGIN + 6.0 + 15.0 * column as f32, 0.5 * (top + bottom)];
        marks.push(Mark::upwards(at, line, LABEL, Ink::Text, Anchor::Middle));
    }
    marks.push(Mark::line([left, bottom], [right, bottom], Ink::Weak, 1.0));
    // The name of a single box is right below it.
    let aside = if chart.series.len() == 1 { slots.aside() } else { 0.0 };
    foot.draw([left, right], aside, bottom, width, &mut marks);
    let places = Places {
        across: [left, right].map(|x| scale * x),
        upwards: [bottom, top].map(|y| scale * y),
        slot: scale * slots.slot,
        unit: scale * slots.unit,
    };
    LaidOut { drawing: Drawing { size: [width, height], marks }.scaled(scale), places }
}

/// Returns the label of the value axis, which mentions a logarithmic scale, in one line if it fits.
fn value_lines(chart: &Study, room: f32) -> Vec<String> {
    let mut lines = wrap(&chart.value_label, LABEL, room, 2);
    if chart.needs_log() {
        let whole = format!("{}, log scale", chart.value_label);
        if text_width(&whole, LABEL) <= room {
            return vec![whole];
        }
        lines.push("log scale".to_owned());
    }
    lines
}

/// Draws title, subtitle and legend from the top down; returns their lower end.
fn head(chart: &Study, width: f32, marks: &mut Vec<Mark>) -> f32 {
    let room = width - 2.0 * MARGIN;
    let mut y = MARGIN;
    for line in wrap(&chart.title, TITLE, 0.96 * room, 2) {
        marks.push(Mark::Text {
            at: [MARGIN, y + 0.5 * TITLE],
            text: line,
            size: TITLE,
            ink: Ink::Text,
            anchor: Anchor::Left,
            strong: true,
            upwards: false,
        });
        y += 1.3 * TITLE;
    }
    for line in wrap(&chart.subtitle, LABEL, room, 2) {
        marks.push(Mark::text([MARGIN, y + 0.5 * LABEL], line, LABEL, Ink::Weak, Anchor::Left));
        y += 1.3 * LABEL;
    }
    let mut x = MARGIN;
    let named = chart.series.iter().filter(|series| !series.name.trim().is_empty());
    for (index, series) in named.enumerate() {
        let name = shortened(&series.name, LABEL, room - 16.0);
        let entry = 16.0 + text_width(&name, LABEL);
        if index == 0 {
            y += 5.0;
        } else if x + entry > width - MARGIN {
            x = MARGIN;
            y += 1.3 * LABEL;
        }
        let middle = y + 0.5 * LABEL;
        marks.push(Mark::Rect {
            min: [x, middle - 5.0],
            max: [x + 10.0, middle + 5.0],
            ink: Ink::Rgb(series.rgb),
            opacity: 0.85,
            outline: None,
        });
        marks.push(Mark::text([x + 15.0, middle], name, LABEL, Ink::Text, Anchor::Left));
        x += entry + 16.0;
    }
    if x > MARGIN { y + 1.3 * LABEL } else { y }
}

/// Draws the dashed lines with their labels to the right, moved apart if lines are close.
fn draw_levels(
    chart: &Study,
    texts: &[Vec<String>],
    axis: &Axis,
    [left, right]: [f32; 2],
    [top, bottom]: [f32; 2],
    marks: &mut Vec<Mark>,
) {
    let mut labels: Vec<(f32, &Vec<String>)> =
        chart.shown_levels().map(|level| axis.place(level.value)).zip(texts).collect();
    labels.sort_by(|a, b| a.0.total_cmp(&b.0));
    let tall = |lines: &[String]| 1.2 * SMALL * lines.len() as f32;
    // From the bottom up, each label is as low as its line requires and the labels below allow; the highest use the headroom.
    let mut free = bottom;
    for (y, lines) in labels.into_iter().rev() {
        marks.push(Mark::Line {
            points: vec![[left, y], [right, y]],
            ink: Ink::Text,
            width: 1.0,
            dashed: true,
        });
        let tall = tall(lines);
        let middle = y.min(free - 0.5 * tall);
        free = middle - 0.5 * tall - 2.0;
        if middle < top {
            continue;
        }
        marks.push(Mark::line([right, y], [right + 7.0, middle], Ink::Text, 1.0));
        let first = middle - 0.5 * tall + 0.6 * SMALL;
        for (index, line) in lines.iter().enumerate() {
            let at = [right + 10.0, first + 1.2 * SMALL * index as f32];
            marks.push(Mark::text(at, line, SMALL, Ink::Text, Anchor::Left));
        }
    }
}

#[cfg(test)]
mod tests;
