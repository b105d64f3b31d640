//! Boxes of a chart: widths, marks, and numbers if there is room.

use super::sizes::SMALL;
use crate::axis::{Axis, number};
use crate::drawing::{Anchor, Ink, Mark, shortened, text_width, wrap};
use resect_tools::experiment::{Quantiles, Study};

pub struct Slots {
    left: f32,
    /// Width of a group on the axis, and of a series within it.
    pub slot: f32,
    pub unit: f32,
    half_box: f32,
    numbers: Option<Numbers>,
}

/// Format of the numbers, equal for all boxes.
struct Numbers {
    size: f32,
    digits: usize,
    widest: f32,
}

const LINE: f32 = 1.2;

impl Slots {
    pub fn of(chart: &Study, left: f32, right: f32) -> Self {
        let slot = (right - left) / chart.groups.len().max(1) as f32;
        let unit = (0.9 * slot / chart.series.len().max(1) as f32).min(110.0);
        let numbers = [(10.5, 3), (9.5, 3), (9.5, 2), (8.5, 2)]
            .map(|(size, digits)| {
                let texts = chart.all_quantiles().flat_map(|quantiles| texts(quantiles, digits));
                let widest = texts.map(|text| text_width(&text, size)).fold(0.0, f32::max);
                Numbers { size, digits, widest }
            })
            .into_iter()
            .find(|numbers| unit - numbers.widest >= 16.0);
        let half_box = match &numbers {
            // As wide as a centred box may be; a narrow box is instead moved away from its number.
            Some(numbers) => {
                let aside = 0.5 * (unit - numbers.widest - 6.0);
                (0.5 * unit - numbers.widest - 5.0).max(aside.min(12.0)).min(20.0)
            }
            None => (0.3 * unit).min(20.0),
        };
        Self { left, slot, unit, half_box, numbers }
    }

    /// Returns the offset of boxes from the middles of their slots, which gives room to their numbers.
    pub fn aside(&self) -> f32 {
        let numbers = self.numbers.as_ref();
        numbers.map_or(0.0, |it| (0.5 * self.unit - it.widest - 5.0 - self.half_box).min(0.0))
    }

    /// Returns the legend of the marks, with the number of values.
    pub fn caption(&self, chart: &Study) -> String {
        let n = || chart.all_quantiles().map(|quantiles| quantiles.n);
        let (Some(fewest), Some(most)) = (n().min(), n().max()) else { return String::new() };
        let mut caption = "box: quartiles, line: median, whiskers: 5 % and 95 %".to_owned();
        if self.numbers.is_some() {
            caption += "; number beside the line: median, above the whisker: interquartile range";
        }
        caption += &if fewest == most {
            format!("; {most} values each")
        } else {
            format!("; {fewest} to {most} values each")
        };
        if chart.needs_log() && chart.all_quantiles().any(|quantiles| quantiles.q05 <= 0.0) {
            caption += "; open whiskers reach zero";
        }
        caption
    }

    pub fn draw(&self, chart: &Study, axis: &Axis, bottom: f32, marks: &mut Vec<Mark>) {
        for group in 0..chart.groups.len() {
            let centre = self.left + self.slot * (group as f32 + 0.5);
            if self.draw_missing_group(chart, group, [centre, bottom], marks) {
                continue;
            }
            for (index, series) in chart.series.iter().enumerate() {
                let from_middle = index as f32 - 0.5 * (chart.series.len() as f32 - 1.0);
                let x = centre + self.unit * from_middle;
                match chart.quantiles(group, index) {
                    Ok(quantiles) => self.draw_box(quantiles, x, Ink::Rgb(series.rgb), axis, marks),
                    Err(why) => self.draw_missing([x, bottom], axis.length(), why, marks),
                }
            }
        }
    }

    fn draw_box(
        &self,
        quantiles: &Quantiles,
        x: f32,
        ink: Ink,
        axis: &Axis,
        marks: &mut Vec<Mark>,
    ) {
        let [q05, q25, median, q75, q95] = quantiles.values().map(|value| axis.place(value));
        let end = x + 0.5 * self.unit;
        // The box is centred unless its number needs the room.
        let x = x + self.aside();
        if let Some(numbers) = &self.numbers {
            let [median_text, range_text] = texts(quantiles, numbers.digits);
            let size = numbers.size;
            // The median is beside its line; the interquartile range is above the whisker, clear of the median.
            let half = 0.5 * text_width(&median_text, size);
            let at = [x + self.half_box + 4.0 + half, median];
            paper(at, [half, 0.5 * size], marks);
            marks.push(Mark::text(at, median_text, size, Ink::Text, Anchor::Middle));
            let half = 0.5 * text_width(&range_text, size);
            let middle = x.min(end - half - 1.0).max(end - self.unit + half + 1.0);
            let at = [middle, (q95 - 0.8 * size).min(median - 1.15 * size)];
            paper(at, [half, 0.5 * size], marks);
            marks.push(Mark::text(at, range_text, size, Ink::Weak, Anchor::Middle));
        }
        let half = self.half_box;
        for (value, from, to) in [(quantiles.q95, q75, q95), (quantiles.q05, q25, q05)] {
            marks.push(Mark::line([x, from], [x, to], ink, LINE));
            if !axis.cuts(value) {
                marks.push(Mark::line([x - 0.5 * half, to], [x + 0.5 * half, to], ink, LINE));
            }
        }
        marks.push(Mark::Rect {
            min: [x - half, q75],
            max: [x + half, q25],
            ink,
            opacity: 0.3,
            outline: Some(LINE),
        });
        marks.push(Mark::line([x - half, median], [x + half, median], ink, 2.4));
    }

    /// Writes the common reason once in a group without any box; returns false if there is none, or it does not fit.
    fn draw_missing_group(
        &self,
        chart: &Study,
        group: usize,
        [x, bottom]: [f32; 2],
        marks: &mut Vec<Mark>,
    ) -> bool {
        let mut reasons =
            (0..chart.series.len()).map(|series| chart.quantiles(group, series).err());
        let Some(Some(why)) = reasons.next() else { return false };
        let lines = wrap(why, SMALL, self.slot - 6.0, 3);
        let whole = lines.iter().all(|line| !line.is_empty() && !line.contains('…'));
        if lines.is_empty() || !whole || reasons.any(|reason| reason != Some(why)) {
            return false;
        }
        for (index, line) in lines.into_iter().rev().enumerate() {
            let at = [x, bottom - 10.0 - 1.25 * SMALL * index as f32];
            let half = [0.5 * text_width(&line, SMALL), 0.5 * SMALL];
            paper(at, half, marks);
            marks.push(Mark::text(at, line, SMALL, Ink::Weak, Anchor::Middle));
        }
        true
    }

    /// Writes the reason for a missing box upwards at its position, or a dash if it does not fit.
    fn draw_missing(&self, [x, bottom]: [f32; 2], room: f32, why: &str, marks: &mut Vec<Mark>) {
        let why = shortened(why, SMALL, room - 12.0);
        if why.is_empty() || self.unit < 1.3 * SMALL {
            let width = (0.5 * self.unit).min(6.0);
            let y = bottom - 10.0;
            marks.push(Mark::line([x - 0.5 * width, y], [x + 0.5 * width, y], Ink::Weak, 1.0));
            return;
        }
        let half = 0.5 * text_width(&why, SMALL);
        paper([x, bottom - 6.0 - half], [0.5 * SMALL, half], marks);
        marks.push(Mark::upwards([x, bottom - 6.0], why, SMALL, Ink::Weak, Anchor::Left));
    }
}

/// Describes a box in words and numbers, or the reason for its absence; `None` without either.
pub fn said(chart: &Study, group: usize, series: usize) -> Option<String> {
    let of = chart.groups.get(group)?;
    let name = chart.series.get(series)?.name.trim();
    let names = [of.label.trim(), name].into_iter().filter(|name| !name.is_empty());
    let mut lines = vec![names.collect::<Vec<_>>().join(", ")];
    match chart.quantiles(group, series) {
        Ok(quantiles) => {
            let [q05, q25, median, q75, q95] =
                quantiles.values().map(|value| format!("{} mm", number(value, 3)));
            lines.push(format!("median {median}"));
            lines.push(format!("quartiles {q25} and {q75}"));
            lines.push(format!("90 % from {q05} to {q95}"));
            lines.push(format!("{} values", quantiles.n));
        }
        Err("") => return None,
        Err(why) => lines.push(why.to_owned()),
    }
    lines.extend(Some(of.note.clone()).filter(|note| !note.trim().is_empty()));
    Some(lines.join("\n"))
}

/// Formats the median and the interquartile range of a box.
fn texts(quantiles: &Quantiles, digits: usize) -> [String; 2] {
    [quantiles.median, quantiles.q75 - quantiles.q25].map(|value| number(value, digits))
}

/// Draws a background for a text, which hides the grid and the dashed levels behind it.
fn paper([x, y]: [f32; 2], [half_width, half_height]: [f32; 2], marks: &mut Vec<Mark>) {
    const ABOUT: f32 = 1.5;
    marks.push(Mark::Rect {
        min: [x - half_width - ABOUT, y - half_height],
        max: [x + half_width + ABOUT, y + half_height],
        ink: Ink::Paper,
        opacity: 1.0,
        outline: None,
    });
}
