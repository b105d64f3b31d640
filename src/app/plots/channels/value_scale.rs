//! The scale of an axis of values, and the numbers of the right axis.

use egui::{Align2, FontId, Pos2, Rect, Stroke};
use egui_plot::GridInput;

use crate::app::model::Units;
use crate::app::model::units::without_negative_zero;
use crate::app::plots::axis_marks::marks_apart;
use crate::app::plots::dimension_units::unit;
use crate::app::prepared::dimension::Dimension;

/// Distances between the numbers of the right axis, in low and in high plots (points).
const APART: [f64; 2] = [12.0, 26.0];
/// Height from which the unit has a place of its own above the numbers (points).
const HIGH: f32 = 64.0;
/// Length of a mark (points).
const MARK: f32 = 4.0;

/// Scale of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ValueScale {
    pub dimension: Dimension,
    /// Values at the lower and the upper end, in the unit shown.
    pub bounds: [f64; 2],
}

impl ValueScale {
    /// Converts a value to the coordinates of the left axis.
    pub fn to_left(self, value: f64, left: &Self) -> f64 {
        if self == *left { value } else { convert(value, self.bounds, left.bounds) }
    }

    /// Returns the value at a coordinate of the left axis.
    pub fn value_at(self, value: f64, left: &Self) -> f64 {
        if self == *left { value } else { convert(value, left.bounds, self.bounds) }
    }

    /// Paints marks and numbers inside the right border, where they leave the plots aligned with those of other panes.
    pub fn paint(&self, painter: &egui::Painter, frame: Rect, units: Units) {
        let [low, high] = self.bounds;
        let base_step_size = 8.0 * (high - low) / f64::from(frame.height().max(1.0));
        let input = GridInput { bounds: (low, high), base_step_size };
        let is_high = frame.height() >= HIGH;
        let marks = marks_apart(&input, APART[usize::from(is_high)]);
        let step = marks.iter().map(|mark| mark.step_size).fold(0.0, f64::max);
        let decimals = (-step.log10().floor()).clamp(0.0, 9.0) as usize;
        let style = painter.ctx().global_style();
        let (ink, ground) = (style.visuals.text_color(), style.visuals.panel_fill);
        let font = FontId::proportional(11.0);
        let right = frame.right();
        let text = |at: Pos2, align: Align2, text: String| {
            let galley = painter.layout_no_wrap(text, font.clone(), ink);
            let place = align.anchor_size(at, galley.size());
            painter.rect_filled(
                place.expand2(egui::vec2(2.0, 0.0)),
                2.0,
                ground.gamma_multiply(0.8),
            );
            painter.galley(place.min, galley, ink);
            place
        };
        // In a low plot the uppermost number carries the unit.
        let mut unit = Some(unit(self.dimension, units));
        let mut top = frame.top();
        if is_high && let Some(unit) = unit.take() {
            let corner = frame.right_top() - egui::vec2(MARK, -1.0);
            top = text(corner, Align2::RIGHT_TOP, unit.to_owned()).bottom();
        }
        for mark in marks.iter().rev().filter(|mark| mark.step_size == step) {
            let share = ((mark.value - low) / (high - low)) as f32;
            let at = Pos2::new(right, frame.bottom() - share * frame.height());
            painter.line_segment([at, at - egui::vec2(MARK, 0.0)], Stroke::new(1.0, ink));
            if at.y > top + 6.0 && at.y < frame.bottom() - 6.0 {
                let mut number = without_negative_zero(mark.value, decimals);
                if let Some(unit) = unit.take() {
                    number = format!("{number} {unit}");
                }
                text(at - egui::vec2(MARK + 3.0, 0.0), Align2::RIGHT_CENTER, number);
            }
        }
    }
}

fn convert(value: f64, [from_low, from_high]: [f64; 2], [low, high]: [f64; 2]) -> f64 {
    low + (value - from_low) / (from_high - from_low) * (high - low)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_ends_of_both_axes_are_at_one_height() {
        let left = ValueScale { dimension: Dimension::Length, bounds: [-10.0, 30.0] };
        let right = ValueScale { dimension: Dimension::Other("m/s"), bounds: [0.0, 2.0] };
        assert_eq!([0.0, 1.0, 2.0].map(|speed| right.to_left(speed, &left)), [-10.0, 10.0, 30.0]);
        assert_eq!(right.value_at(right.to_left(1.7, &left), &left), 1.7);
        assert_eq!(left.to_left(3.0, &left), 3.0);
    }
}
