//! Marks of axes, and bounds with a margin about the values.

use egui_plot::{GridInput, GridMark};

/// Distances at which grid lines become visible and reach full strength (points). Full strength is so far away that the data are stronger
/// than the grid.
pub const GRID: std::ops::RangeInclusive<f32> = 8.0..=900.0;

/// Distances at which numbers along x appear and reach full strength (points).
pub const LABELS: std::ops::RangeInclusive<f32> = 20.0..=34.0;

/// Grid lines at 1, 2 or 5 times a power of ten, each with room for its number, and four or five faint ones per step.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn round_marks(input: GridInput) -> Vec<GridMark> {
    marks_apart(&input, 40.0)
}

/// Marks along y, where numbers may be closer.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn close_marks(input: GridInput) -> Vec<GridMark> {
    marks_apart(&input, 20.0)
}

/// Returns the largest round number up to a positive one.
pub fn round_below(most: f64) -> f64 {
    let decade = 10_f64.powf(most.log10().floor());
    let digits = [5.0, 4.0, 3.0, 2.0].into_iter().find(|times| times * decade <= most);
    digits.unwrap_or(1.0) * decade
}

/// Two round marks on both sides of zero, for an axis so short that zero would be its only number.
pub fn marks_about_zero(input: &GridInput) -> Option<[GridMark; 2]> {
    let (low, high) = numbered(input);
    let most = high.min(-low);
    if most <= 0.0 {
        return None;
    }
    let value = round_below(most);
    // Twice the value must be higher than a number.
    let is_room = 2.0 * value > 12.0 * per_point(input);
    let mark = |value: f64| GridMark { value, step_size: 4.0 * value.abs() };
    is_room.then(|| [mark(-value), mark(value)])
}

/// Marks closer than this to an end of their axis have no number, which would overlap that of the next plot (points).
pub const ENDS: f64 = 2.5;

/// Length of a point along the axis: the least step of `egui_plot` is eight points wide.
pub fn per_point(input: &GridInput) -> f64 {
    input.base_step_size / 8.0
}

/// Range of an axis in which marks have numbers.
pub fn numbered(input: &GridInput) -> (f64, f64) {
    let end = ENDS * per_point(input);
    (input.bounds.0 + end, input.bounds.1 - end)
}

/// Round marks, with strong ones at least this far apart (points).
pub fn marks_apart(input: &GridInput, points: f64) -> Vec<GridMark> {
    let least = points * per_point(input);
    let decade = 10_f64.powf(least.log10().floor());
    let (times, parts) = [(1.0, 5), (2.0, 4), (5.0, 5), (10.0, 5)]
        .into_iter()
        .find(|(times, _)| times * decade >= least)
        .unwrap_or((10.0, 5));
    let step = times * decade;
    let fine = step / f64::from(parts);
    let (low, high) = input.bounds;
    let (lowest, highest) = numbered(input);
    let strong = (highest / step).floor() - (lowest / step).ceil() + 1.0;
    if let Some(marks) = marks_about_zero(input).filter(|_| strong < 2.0) {
        return marks.to_vec();
    }
    if strong < 1.0 && low >= 0.0 && highest > 0.0 {
        // A single number, at the highest round value, gives a scale from zero.
        let value = round_below(highest);
        return vec![GridMark { value, step_size: 4.0 * value }];
    }
    ((low / fine).ceil() as i64..=(high / fine).floor() as i64)
        .map(|index| {
            let value = index as f64 * fine;
            let whole = index.rem_euclid(i64::from(parts)) == 0;
            let has_number = whole && (lowest..=highest).contains(&value);
            // The step size sets the strength of a line, and only strong lines have a number.
            GridMark { value, step_size: if has_number { step } else { fine } }
        })
        .collect()
}

/// Least and greatest value, with a margin.
pub fn with_room(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    if low > high {
        return [0.0, 1.0];
    }
    let margin = (0.05 * (high - low)).max(1e-6 * high.abs().max(1.0));
    [low - margin, high + margin]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of an axis between bounds with this height (points).
    fn numbers(bounds: (f64, f64), height: f64) -> Vec<f64> {
        let base_step_size = 8.0 * (bounds.1 - bounds.0) / height;
        let marks = close_marks(GridInput { bounds, base_step_size });
        let most = marks.iter().map(|mark| mark.step_size).fold(0.0, f64::max);
        marks.iter().filter(|mark| mark.step_size == most).map(|mark| mark.value).collect()
    }

    #[test]
    fn numbers_at_the_ends_of_an_axis_do_not_reach_into_the_next_plot() {
        assert_eq!(numbers((-6.1, 6.1), 130.0), [-4.0, -2.0, 0.0, 2.0, 4.0]);
        assert_eq!(numbers((-6.9, 6.9), 150.0), [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0]);
        // If the only numbers were at the ends, smaller ones appear about zero.
        assert_eq!(numbers((-5.1, 5.1), 30.0), [-4.0, 4.0]);
        // An axis from zero without room for two numbers has one.
        assert_eq!(numbers((0.0, 33.0), 22.0), [20.0]);
    }
}
