//! Frame of a chart with two axes: grid, numbers along the axes, and positions of values.

use super::axis::Axis;
use super::drawing::{Anchor, Ink, Mark};

/// Size of the numbers along the axes.
pub const NUMBER: f32 = 10.0;

/// Two linear axes that fill a frame from end to end.
pub struct Frame {
    x: Axis,
    y: Axis,
    /// Corners, the upper left one first.
    min: [f32; 2],
    max: [f32; 2],
}

impl Frame {
    /// Creates a frame from the values at the ends of both axes, and from its corners.
    pub fn new(x: [f64; 2], y: [f64; 2], min: [f32; 2], max: [f32; 2]) -> Self {
        let (x, y) = (Axis::between(x, [min[0], max[0]]), Axis::between(y, [max[1], min[1]]));
        Self { x, y, min, max }
    }

    pub fn place(&self, x: f64, y: f64) -> [f32; 2] {
        [self.x.place(x), self.y.place(y)]
    }

    /// Draws horizontal lines at round values of the vertical axis, with their numbers if wanted.
    pub fn draw_rows(&self, numbers: bool, marks: &mut Vec<Mark>) {
        for (value, label) in self.y.ticks() {
            let y = self.y.place(value);
            marks.push(Mark::line([self.min[0], y], [self.max[0], y], Ink::Grid, 1.0));
            if numbers {
                let at = [self.min[0] - 6.0, y];
                marks.push(Mark::text(at, label, NUMBER, Ink::Weak, Anchor::Right));
            }
        }
    }

    /// Draws vertical lines at round values of the horizontal axis, with their numbers if wanted.
    pub fn draw_columns(&self, numbers: bool, marks: &mut Vec<Mark>) {
        for (value, label) in self.x.ticks() {
            let x = self.x.place(value);
            marks.push(Mark::line([x, self.min[1]], [x, self.max[1]], Ink::Grid, 1.0));
            if numbers {
                let at = [x, self.max[1] + 0.5 * NUMBER + 5.0];
                marks.push(Mark::text(at, label, NUMBER, Ink::Weak, Anchor::Middle));
            }
        }
    }
}
