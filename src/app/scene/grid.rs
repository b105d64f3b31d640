//! The grid on the ground: lines at round metres of station 1's frame, and the numbers along its edges.

use eframe::egui::Pos2;
use nalgebra::Vector3;

use super::projection::Projection;
use super::vertices::{LineVertex, WORLD};

/// Squares along the longer side, about.
const SQUARES: f32 = 10.0;
/// Numbers stand this far outside of their line, and this far from each other (points on the screen).
const NUMBER_OUT: f32 = 12.0;
const NUMBERS_APART: f32 = 46.0;
/// A line that has this part of the numbers that another has is mostly in the picture.
const MOSTLY: f32 = 0.6;

/// Lines at whole multiples of the spacing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Spacing of the lines (m): 1, 2 or 5 times a power of ten.
    pub spacing_m: f32,
    /// Numbers of the first and last line across x, and across y.
    lines: [[i32; 2]; 2],
    height_m: f32,
}

/// Text where it is seen.
#[derive(Clone, Debug, PartialEq)]
pub struct GridNumber {
    pub at: Pos2,
    pub text: String,
}

impl Grid {
    /// A grid that lies under everything in a box.
    pub fn under(low: &Vector3<f32>, high: &Vector3<f32>) -> Self {
        let extent = (high.x - low.x).max(high.y - low.y).max(1.0);
        let rough = extent / SQUARES;
        let decade = 10_f32.powf(rough.log10().floor());
        let spacing_m = [1.0, 2.0, 5.0, 10.0]
            .map(|step| step * decade)
            .into_iter()
            .find(|step| *step >= rough)
            .unwrap_or(decade * 10.0);
        let from = |v: f32| (v / spacing_m).floor() as i32 - 1;
        let to = |v: f32| (v / spacing_m).ceil() as i32 + 1;
        Self {
            spacing_m,
            lines: [[from(low.x), to(high.x)], [from(low.y), to(high.y)]],
            height_m: low.z - 0.02 * extent.min(20.0),
        }
    }

    fn place(&self, along_x: i32, along_y: i32) -> Vector3<f32> {
        let [x, y] = [along_x, along_y].map(|line| line as f32 * self.spacing_m);
        Vector3::new(x, y, self.height_m)
    }

    pub fn add_lines(&self, lines: &mut Vec<LineVertex>, colour: [u8; 4]) {
        let [[x0, x1], [y0, y1]] = self.lines;
        let across_x = (x0..=x1).map(|x| [self.place(x, y0), self.place(x, y1)]);
        let across_y = (y0..=y1).map(|y| [self.place(x0, y), self.place(x1, y)]);
        lines.extend(across_x.chain(across_y).map(|[from, to]| LineVertex {
            from_m: from.into(),
            from_frame: WORLD,
            to_m: to.into(),
            to_frame: WORLD,
            colour,
            width_points: 1.0,
        }));
    }

    /// Coordinates along a line near each of the two edges that face the eye: the outermost line that is mostly in the
    /// picture, where the edge itself is not.
    pub fn numbers(&self, projection: &Projection, eye_m: &Vector3<f32>) -> Vec<GridNumber> {
        [0, 1]
            .into_iter()
            .flat_map(|axis| {
                let [first, last] = self.lines[1 - axis];
                let middle_m = 0.5 * (first + last) as f32 * self.spacing_m;
                let mut rows: Vec<i32> = (first..=last).collect();
                if eye_m[1 - axis] > middle_m {
                    rows.reverse();
                }
                let mut rows: Vec<_> =
                    rows.into_iter().map(|row| self.row(projection, axis, row)).collect();
                let most = rows.iter().map(Vec::len).max().unwrap_or(0);
                let enough = |row: &Vec<GridNumber>| row.len() as f32 >= MOSTLY * most as f32;
                rows.iter().position(enough).map_or(Vec::new(), |at| rows.swap_remove(at))
            })
            .collect()
    }

    /// Numbers along an axis (0 for x, 1 for y) beside one of the lines in its direction, as far as they are in the
    /// picture; the last says what they are.
    fn row(&self, projection: &Projection, axis: usize, row: i32) -> Vec<GridNumber> {
        let at = |line: i32| {
            let place = if axis == 0 { self.place(line, row) } else { self.place(row, line) };
            projection.screen(&place)
        };
        let [first, last] = self.lines[axis];
        let [other_first, other_last] = self.lines[1 - axis];
        let towards = if 2 * row > other_first + other_last { row - 1 } else { row + 1 };
        let beside = |line: i32| {
            let place =
                if axis == 0 { self.place(line, towards) } else { self.place(towards, line) };
            projection.screen(&place)
        };
        let area = projection.rect.shrink(2.0 * NUMBER_OUT);
        let mut numbers: Vec<(i32, GridNumber)> = Vec::new();
        for line in first..=last {
            let (Some(at), Some(inner)) = (at(line), beside(line)) else { continue };
            let at = at + NUMBER_OUT * (at - inner).normalized();
            if area.contains(at) {
                numbers.push((line, GridNumber { at, text: self.number(line) }));
            }
        }
        let gaps = numbers.windows(2).map(|two| two[0].1.at.distance(two[1].1.at));
        let step = step_between(gaps.fold(f32::INFINITY, f32::min));
        numbers.retain(|(line, _)| line % step == 0);
        if let Some((line, number)) = numbers.last_mut() {
            number.text = format!("{} = {} m", ["x", "y"][axis], self.number(*line));
        }
        numbers.into_iter().map(|(_, number)| number).collect()
    }

    /// The coordinate of a line, with as many decimals as the spacing needs.
    fn number(&self, line: i32) -> String {
        // Rounded to the millimetre, below which no grid goes.
        let metres = (f64::from(line) * f64::from(self.spacing_m) * 1e3).round() / 1e3;
        metres.to_string()
    }
}

/// Every how manieth line has room for its number, where neighbouring ones are this far apart.
fn step_between(square: f32) -> i32 {
    [1, 2, 5, 10].into_iter().find(|step| *step as f32 * square >= NUMBERS_APART).unwrap_or(20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::Camera;
    use eframe::egui::Rect;

    #[test]
    fn numbers_stand_in_the_picture_at_whole_steps_with_room() {
        let (low, high) = (Vector3::new(-6.0, -20.0, -1.0), Vector3::new(74.0, 31.0, 2.0));
        let grid = Grid::under(&low, &high);
        assert_eq!(grid.spacing_m, 10.0);
        let rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(1200.0, 800.0));
        for (distance_m, least) in [(40.0, 4), (130.0, 10), (900.0, 2)] {
            let camera = Camera { target_m: (low + high) / 2.0, distance_m, ..Camera::default() };
            let numbers = grid.numbers(&Projection::new(&camera, rect), &camera.eye_m());
            assert!(numbers.len() >= least, "{distance_m}: {numbers:?}");
            assert!(numbers.iter().all(|number| rect.contains(number.at)));
            for name in ["x = ", "y = "] {
                let named = numbers.iter().filter(|number| number.text.starts_with(name));
                assert_eq!(named.count(), 1, "{numbers:?}");
            }
            for (index, number) in numbers.iter().enumerate() {
                let apart = |other: &GridNumber| other.at.distance(number.at);
                // The last of x and the first of y may meet in the corner; the placer sees to that.
                let next = numbers.get(index + 1).filter(|_| !number.text.contains('='));
                assert!(next.is_none_or(|next| apart(next) > 0.9 * NUMBERS_APART));
            }
        }
    }

    #[test]
    fn numbers_have_the_decimals_they_need() {
        let fine = Grid::under(&Vector3::zeros(), &Vector3::new(0.9, 0.2, 0.1));
        assert_eq!(fine.spacing_m, 0.1);
        assert_eq!([3, -20].map(|line| fine.number(line)), ["0.3", "-2"]);
    }
}
