//! The grid behind the data: lines at round metres of station 1's frame, as dense as the zoom permits, and numbers along its edges.

use egui::{Pos2, Rect, Vec2};
use nalgebra::Vector3;

use super::projection::Projection;
use super::vertices::{LineVertex, WORLD};
use crate::app::model::Camera;

/// Least distance of the lines at the camera's target (points), and number of lines on each side of it.
const SQUARE: f32 = 64.0;
const LINES: f32 = 16.0;
/// Steepness of a side view below which the grid is upright.
const UPRIGHT: f32 = 0.1;
/// Distance of a number from its line, and from the next number (points).
const NUMBER_OUT: f32 = 12.0;
const NUMBERS_APART: f32 = 46.0;
/// Size of a number that names its axis (points).
const NAMED: Vec2 = Vec2::new(70.0, 14.0);
/// Share of numbers in view, relative to another line, from which a line counts as mostly in view.
const MOSTLY: f32 = 0.6;

/// Grid lines at whole multiples of the spacing, in a plane along two of the axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// The axes of the plane, and the one normal to it (0 for x to 2 for z).
    along: [usize; 2],
    across: usize,
    /// Spacing of the lines for each axis along the plane (m): 1, 2 or 5 times a power of ten.
    pub spacing_m: [f32; 2],
    /// Indices of the first and last line for each axis.
    lines: [[i32; 2]; 2],
    /// Coordinate of the plane on its normal axis.
    level_m: f32,
}

/// A text and its position on the screen.
#[derive(Clone, Debug, PartialEq)]
pub struct GridNumber {
    pub at: Pos2,
    pub text: String,
}

impl Grid {
    /// Returns the grid around a camera's target: on the ground under a box, or behind it in a view from a side.
    pub fn of(
        camera: &Camera,
        viewport_height: f32,
        low: &Vector3<f32>,
        high: &Vector3<f32>,
    ) -> Self {
        let back = camera.back();
        let upright = camera.parallel && back.z.abs() < UPRIGHT;
        let (along, across) = match upright {
            true if back.x.abs() > back.y.abs() => ([1, 2], 0),
            true => ([0, 2], 1),
            false => ([0, 1], 2),
        };
        let extent = (high.x - low.x).max(high.y - low.y).max(1.0);
        let level_m = if back[across] > 0.0 || !upright {
            low[across] - 0.02 * extent.min(20.0)
        } else {
            high[across] + 0.02 * extent.min(20.0)
        };
        let rough = SQUARE * camera.metres_per_point(viewport_height);
        let spacing_m =
            along.map(|axis| round_up(if axis == 2 { rough / camera.vertical } else { rough }));
        let lines = std::array::from_fn(|of| {
            let (axis, spacing) = (along[of], spacing_m[of]);
            let target = camera.target_m[axis];
            // From the data's extent to the camera's target.
            let first = (low[axis].min(target) / spacing).floor() - 1.0;
            let last = (high[axis].max(target) / spacing).ceil() + 1.0;
            let middle = (target / spacing).round();
            [first.max(middle - LINES) as i32, last.min(middle + LINES) as i32]
        });
        Self { along, across, spacing_m, lines, level_m }
    }

    fn place(&self, lines: [i32; 2]) -> Vector3<f32> {
        let mut place = Vector3::zeros();
        place[self.across] = self.level_m;
        for of in 0..2 {
            place[self.along[of]] = lines[of] as f32 * self.spacing_m[of];
        }
        place
    }

    pub fn add_lines(&self, lines: &mut Vec<LineVertex>, colour: [u8; 4]) {
        let [[u0, u1], [v0, v1]] = self.lines;
        let first = (u0..=u1).map(|u| [self.place([u, v0]), self.place([u, v1])]);
        let second = (v0..=v1).map(|v| [self.place([u0, v]), self.place([u1, v])]);
        lines.extend(first.chain(second).map(|[from, to]| LineVertex {
            from_m: from.into(),
            from_frame: WORLD,
            to_m: to.into(),
            to_frame: WORLD,
            colour,
            width_points: 1.0,
        }));
    }

    /// Returns the spacing in words: one number, or one for each axis.
    pub fn spacing(&self) -> String {
        // Rounded, since 0.1 in single precision has spurious digits.
        let [first, second] = self.spacing_m.map(|metres| (f64::from(metres) * 1e6).round() / 1e6);
        if first == second {
            return format!("{first} m");
        }
        let [u, v] = self.along.map(|axis| ["x", "y", "z"][axis]);
        format!("{u} {first} m, {v} {second} m")
    }

    /// Returns the coordinates along a line near each of the two edges that face the
    /// eye: the outermost line that is mostly in view, if the edge itself is not.
    ///
    /// The number that names its axis is where no overlay covers it.
    pub fn numbers(
        &self,
        projection: &Projection,
        eye_m: &Vector3<f32>,
        covered: &[Rect],
    ) -> Vec<GridNumber> {
        [0, 1]
            .into_iter()
            .flat_map(|of| {
                let other = 1 - of;
                let [first, last] = self.lines[other];
                let middle_m = 0.5 * (first + last) as f32 * self.spacing_m[other];
                let mut rows: Vec<i32> = (first..=last).collect();
                if eye_m[self.along[other]] > middle_m {
                    rows.reverse();
                }
                let mut rows: Vec<_> =
                    rows.into_iter().map(|row| self.row(projection, of, row, covered)).collect();
                let most = rows.iter().map(Vec::len).max().unwrap_or(0);
                let enough = |row: &Vec<GridNumber>| row.len() as f32 >= MOSTLY * most as f32;
                rows.iter().position(enough).map_or(Vec::new(), |at| rows.swap_remove(at))
            })
            .collect()
    }

    /// Returns the visible numbers along one of the plane's axes, beside a line in its direction; the last names the axis.
    fn row(
        &self,
        projection: &Projection,
        of: usize,
        row: i32,
        covered: &[Rect],
    ) -> Vec<GridNumber> {
        let at = |line: i32, row: i32| {
            let place = self.place(if of == 0 { [line, row] } else { [row, line] });
            projection.screen(&place)
        };
        let [first, last] = self.lines[of];
        let [other_first, other_last] = self.lines[1 - of];
        let towards = if 2 * row > other_first + other_last { row - 1 } else { row + 1 };
        let area = projection.rect.shrink(2.0 * NUMBER_OUT);
        let mut numbers: Vec<(i32, GridNumber)> = Vec::new();
        for line in first..=last {
            let (Some(at), Some(inner)) = (at(line, row), at(line, towards)) else { continue };
            let at = at + NUMBER_OUT * (at - inner).normalized();
            if area.contains(at) {
                numbers.push((line, GridNumber { at, text: self.number(of, line) }));
            }
        }
        let gaps = numbers.windows(2).map(|two| two[0].1.at.distance(two[1].1.at));
        let step = step_between(gaps.fold(f32::INFINITY, f32::min));
        numbers.retain(|(line, _)| line % step == 0);
        let has_room = |(_, number): &(i32, GridNumber)| {
            let place = Rect::from_center_size(number.at, NAMED);
            projection.rect.shrink(5.0).contains_rect(place)
                && !covered.iter().any(|other| other.intersects(place))
        };
        let named = numbers.iter().rposition(has_room).unwrap_or(numbers.len().saturating_sub(1));
        if let Some((line, number)) = numbers.get_mut(named) {
            let axis = ["x", "y", "z"][self.along[of]];
            number.text = format!("{axis} = {} m", self.number(of, *line));
        }
        numbers.into_iter().map(|(_, number)| number).collect()
    }

    /// Returns the coordinate of a line, with as many decimals as the spacing needs.
    fn number(&self, of: usize, line: i32) -> String {
        // Rounded to the millimetre, the finest grid.
        let metres = (f64::from(line) * f64::from(self.spacing_m[of]) * 1e3).round() / 1e3;
        metres.to_string()
    }
}

/// Rounds up to 1, 2 or 5 times a power of ten, at least a millimetre.
fn round_up(length_m: f32) -> f32 {
    let length_m = length_m.max(1e-3);
    let decade = 10_f32.powf(length_m.log10().floor());
    let steps = [1.0, 2.0, 5.0, 10.0].map(|step| step * decade);
    steps.into_iter().find(|step| *step >= 0.999 * length_m).unwrap_or(10.0 * decade)
}

/// Returns the step between labelled lines, for lines at this distance (points).
fn step_between(square: f32) -> i32 {
    [1, 2, 5, 10].into_iter().find(|step| *step as f32 * square >= NUMBERS_APART).unwrap_or(20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::model::{Frame, ViewPreset};
    use egui::Rect;

    const LOW: Vector3<f32> = Vector3::new(-6.0, -20.0, -1.0);
    const HIGH: Vector3<f32> = Vector3::new(74.0, 31.0, 2.0);

    fn seen(camera: &Camera) -> (Grid, Vec<GridNumber>, Rect) {
        let rect = Rect::from_min_max(Pos2::ZERO, Pos2::new(1200.0, 800.0));
        let grid = Grid::of(camera, rect.height(), &LOW, &HIGH);
        let numbers = grid.numbers(&Projection::new(camera, rect), &camera.eye_m(), &[]);
        (grid, numbers, rect)
    }

    #[test]
    fn numbers_stand_in_the_picture_at_whole_steps_with_room() {
        for (distance_m, least) in [(2.0, 4), (40.0, 4), (130.0, 8), (900.0, 2)] {
            let target_m = (LOW + HIGH) / 2.0 - Vector3::new(0.0, 0.0, 1.5);
            let camera = Camera { target_m, distance_m, ..Camera::default() };
            let (_, numbers, rect) = seen(&camera);
            assert!(numbers.len() >= least, "{distance_m}: {numbers:?}");
            assert!(numbers.iter().all(|number| rect.contains(number.at)));
            for name in ["x = ", "y = "] {
                let named = numbers.iter().filter(|number| number.text.starts_with(name));
                assert_eq!(named.count(), 1, "{numbers:?}");
            }
            for (index, number) in numbers.iter().enumerate() {
                let apart = |other: &GridNumber| other.at.distance(number.at);
                // The last number of x and the first of y may overlap in the corner; the placer prevents that.
                let next = numbers.get(index + 1).filter(|_| !number.text.contains('='));
                assert!(next.is_none_or(|next| apart(next) > 0.9 * NUMBERS_APART));
            }
        }
    }

    #[test]
    fn an_axis_is_named_where_nothing_covers_its_name() {
        let camera =
            Camera { target_m: (LOW + HIGH) / 2.0, distance_m: 130.0, ..Camera::default() };
        let (grid, numbers, rect) = seen(&camera);
        let names = |numbers: &[GridNumber]| -> Vec<Pos2> {
            numbers.iter().filter(|it| it.text.contains('=')).map(|it| it.at).collect()
        };
        let before = names(&numbers);
        let legend = Rect::from_center_size(before[0], Vec2::splat(40.0));
        let projection = Projection::new(&camera, rect);
        let after = names(&grid.numbers(&projection, &camera.eye_m(), &[legend]));
        assert_eq!(after.len(), before.len());
        for at in after {
            let name = Rect::from_center_size(at, NAMED);
            assert!(!name.intersects(legend) && rect.contains_rect(name), "{at}");
        }
    }

    #[test]
    fn the_spacing_follows_the_zoom_in_steps_of_one_two_and_five() {
        let mut camera = Camera { target_m: (LOW + HIGH) / 2.0, ..Camera::default() };
        let mut spacings = Vec::new();
        for _ in 0..45 {
            camera.zoom(0.85);
            let spacing_m = seen(&camera).0.spacing_m[0];
            let square = spacing_m / camera.metres_per_point(800.0);
            // Consecutive spacings of the series 1, 2, 5, 10 differ by a factor of 2.5 at most.
            assert!(square > 0.99 * SQUARE && square < 2.6 * SQUARE, "{square}");
            let digit = spacing_m / 10_f32.powf((1.001 * spacing_m).log10().floor());
            assert!([1.0, 2.0, 5.0].iter().any(|d| (digit - d).abs() < 1e-3), "{spacing_m}");
            spacings.push(spacing_m);
        }
        assert!(spacings.windows(2).all(|two| two[1] <= two[0]));
        assert!(spacings[0] > 500.0 * spacings[44], "{spacings:?}");
    }

    #[test]
    fn a_view_from_a_side_has_heights_beside_it() {
        for (preset, along) in [(ViewPreset::Front, "x"), (ViewPreset::Side, "y")] {
            let mut camera = Camera { vertical: 5.0, ..Camera::default() };
            camera.look(preset, &[LOW, HIGH], &Frame::whole(1.5));
            let (grid, numbers, _) = seen(&camera);
            for name in [along, "z"] {
                let named = |number: &&GridNumber| number.text.starts_with(&format!("{name} = "));
                assert_eq!(numbers.iter().filter(named).count(), 1, "{numbers:?}");
            }
            assert!(grid.spacing_m[1] < grid.spacing_m[0], "{grid:?}");
            assert!(grid.spacing().starts_with(&format!("{along} ")), "{}", grid.spacing());
        }
    }

    #[test]
    fn numbers_have_the_decimals_they_need() {
        let grid = Grid {
            along: [0, 1],
            across: 2,
            spacing_m: [0.1, 20.0],
            lines: [[0, 1]; 2],
            level_m: 0.0,
        };
        assert_eq!([3, -20].map(|line| grid.number(0, line)), ["0.3", "-2"]);
        assert_eq!(grid.number(1, -2), "-40");
    }
}
