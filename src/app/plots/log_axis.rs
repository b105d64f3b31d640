//! Axes that show the common logarithm of the labelled quantity.

use egui_plot::{GridInput, GridMark};

/// Height of a number on an axis, with a margin (points).
const NUMBER: f64 = 16.0;
/// Half of a number's height (points).
const END: f64 = 5.0;

/// Lines at 1, 2 and 5 times the powers of ten, and at digits between them if less than a decade is visible.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let times: &[f64] = match high - low {
        // The step from one digit to the next can be half of the visible range.
        span if span < 0.4 => &[1.0, 1.2, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        span if span < 0.7 => &[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0],
        _ => &[1.0, 2.0, 5.0],
    };
    marks(low, high, &times.iter().map(|times| (*times, 1.0)).collect::<Vec<_>>())
}

/// Marks for axes on which decades have little room: strong lines at the powers of ten, faint ones at 2 and 5 times them. Numbers are shown
/// if they fit, and not at the ends, where they would overlap those of the next plot.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn many_decades(input: GridInput) -> Vec<GridMark> {
    let (low, high) = input.bounds;
    let per_point = super::per_point(&input);
    let inside = low + END * per_point..=high - END * per_point;
    // If a decade is lower than a number, only every second power of ten, or fewer, has one.
    let every = (NUMBER * per_point).ceil().max(1.0);
    let first = inside.start().ceil();
    let has_number =
        |value: f64| inside.contains(&value) && (value - first).rem_euclid(every) < 1e-9;
    let numbered = |mark: GridMark| match mark.step_size {
        1.0 if has_number(mark.value) => GridMark { step_size: every, ..mark },
        1.0 => GridMark { step_size: 0.3, ..mark },
        _ => mark,
    };
    let all = marks(low, high, &[(1.0, 1.0), (2.0, 0.3), (5.0, 0.3)]);
    all.into_iter().map(numbered).collect()
}

fn marks(low: f64, high: f64, steps: &[(f64, f64)]) -> Vec<GridMark> {
    (low.floor() as i32..=high.ceil() as i32)
        .flat_map(|decade| {
            steps.iter().map(move |(times, step_size)| GridMark {
                value: f64::from(decade) + times.log10(),
                step_size: *step_size,
            })
        })
        .filter(|mark| (low..=high).contains(&mark.value))
        .collect()
}

/// Formats the value of a logarithm with as many digits as a mark needs.
pub fn number(log10: f64) -> String {
    let value = 10_f64.powf(log10);
    // A mark at 0.5 is slightly less than 0.5.
    match value {
        v if v < 0.000_95 => format!("{v:.4}"),
        v if v < 0.009_5 => format!("{v:.3}"),
        v if v < 0.095 => format!("{v:.2}"),
        v if v < 0.95 => format!("{v:.1}"),
        v if v < 9.5 && (v - v.round()).abs() > 0.05 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(bounds: (f64, f64), height: f64) -> Vec<f64> {
        let base_step_size = 8.0 * (bounds.1 - bounds.0) / height;
        let marks = many_decades(GridInput { bounds, base_step_size });
        marks.iter().filter(|mark| mark.step_size >= 1.0).map(|mark| mark.value).collect()
    }

    #[test]
    fn a_low_axis_of_decades_has_a_number_that_is_not_at_its_end() {
        assert_eq!(numbers((-2.2, 1.3), 90.0), [-2.0, -1.0, 0.0, 1.0]);
        // The power of ten next to the end has no number, and the others have one each only where they fit.
        assert_eq!(numbers((-1.8, 0.1), 30.0), [-1.0]);
        assert_eq!(numbers((-3.5, 1.5), 40.0), [-2.0, 0.0]);
    }
}
