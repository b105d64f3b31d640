//! Value axis of a chart: its range, round ticks, and readable numbers.

/// Maps values to pixels: from `bottom` to `top`, or from left to right if horizontal.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    log: bool,
    /// Ends of the axis: values, or their decimal logarithms.
    low: f64,
    high: f64,
    bottom: f32,
    top: f32,
}

impl Axis {
    /// Creates an axis with `headroom` pixels above the largest value. A linear axis begins at zero, or below the
    /// lowest negative value; a logarithmic one ignores values that are not positive.
    pub fn of(
        values: impl Iterator<Item = f64>,
        log: bool,
        bottom: f32,
        top: f32,
        headroom: f32,
    ) -> Self {
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                (low.min(value), high.max(value))
            })
        };
        let (mut low, mut high) = if log {
            let (low, high) = ends(&mut values.filter(|&value| value > 0.0));
            (round_down(low).log10(), high.log10())
        } else {
            let (low, high) = ends(&mut values.chain([0.0]));
            (low, high)
        };
        if !(low.is_finite() && high > low) {
            (low, high) = (0.0, 1.0);
        }
        let length = bottom - top;
        let headroom = f64::from(headroom.min(0.5 * length) / length);
        let room = (high - low) * headroom / (1.0 - headroom);
        high += room;
        if !log && low < 0.0 {
            low -= 0.5 * room;
        }
        Self { log, low, high, bottom, top }
    }

    /// Creates a linear axis from `low` to `high` exactly, in either direction.
    pub fn between([low, high]: [f64; 2], [from, to]: [f32; 2]) -> Self {
        Self { log: false, low, high, bottom: from, top: to }
    }

    /// Returns the position of a value (pixels); values beyond an end are placed at the end.
    pub fn place(&self, value: f64) -> f32 {
        let value = if self.log { value.max(f64::MIN_POSITIVE).log10() } else { value };
        let share = ((value - self.low) / (self.high - self.low)).clamp(0.0, 1.0);
        self.bottom + (self.top - self.bottom) * share as f32
    }

    /// Length of the axis (pixels).
    pub fn length(&self) -> f32 {
        (self.bottom - self.top).abs()
    }

    /// Returns true if the axis begins above this value.
    pub fn cuts(&self, value: f64) -> bool {
        self.log && value <= 0.0
    }

    /// Returns round values along the axis, with their labels.
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let length = f64::from(self.length());
        let per_pixel = (self.high - self.low) / length;
        // Ticks of a short axis are closer, as far as their labels allow.
        if self.log {
            self.log_ticks((length / 11.0).clamp(14.0, 20.0) * per_pixel)
        } else {
            self.linear_ticks((length / 6.0).clamp(16.0, 36.0) * per_pixel)
        }
    }

    fn linear_ticks(&self, gap: f64) -> Vec<(f64, String)> {
        let step = round_up(gap);
        let decimals = (-(step * 1.001).log10().floor()).max(0.0) as usize;
        let first = (self.low / step).ceil() as i64;
        let last = (self.high / step).floor() as i64;
        let value = |index: i64| index as f64 * step;
        (first..=last).map(|index| (value(index), written(value(index), decimals))).collect()
    }

    /// Powers of ten: with twos and fives if there is room, otherwise only every second, third, … power.
    fn log_ticks(&self, gap: f64) -> Vec<(f64, String)> {
        let digits: &[f64] = if gap < 2f64.log10() { &[1.0, 2.0, 5.0] } else { &[1.0] };
        let every = gap.ceil().max(1.0) as i32;
        let decades = self.low.floor() as i32..=self.high.floor() as i32;
        decades
            .filter(|decade| decade.rem_euclid(every) == 0)
            .flat_map(|decade| digits.iter().map(move |digit| (decade, digit * 10f64.powi(decade))))
            .filter(|(_, value)| (self.low - 1e-9..=self.high).contains(&value.log10()))
            .map(|(decade, value)| (value, written(value, (-decade).max(0) as usize)))
            .collect()
    }
}

/// The largest of …, 0.5, 1, 2, 5, 10, … that is not above the value.
pub fn round_down(value: f64) -> f64 {
    let ten = 10f64.powf(value.log10().floor());
    let digit = value / ten;
    ten * if digit >= 5.0 {
        5.0
    } else if digit >= 2.0 {
        2.0
    } else {
        1.0
    }
}

/// The smallest of …, 0.5, 1, 2, 5, 10, … that is not below the value.
fn round_up(value: f64) -> f64 {
    let down = round_down(value);
    if down >= value { down } else { round_down(2.6 * down) }
}

/// Formats a number with this many significant digits, for a chart.
pub fn number(value: f64, digits: usize) -> String {
    let tens = value.abs().max(1e-300).log10().floor();
    let decimals = (digits as f64 - 1.0 - tens).clamp(0.0, 6.0) as usize;
    written(value, if value == 0.0 { 0 } else { decimals })
}

fn written(value: f64, decimals: usize) -> String {
    let size = value.abs();
    let text = if size >= 1e6 || (size > 0.0 && size < 1e-3) {
        format!("{value:.0e}")
    } else {
        format!("{value:.decimals$}")
    };
    text.replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(values: &[f64], log: bool) -> Vec<String> {
        let axis = Axis::of(values.iter().copied(), log, 300.0, 0.0, 18.0);
        axis.ticks().into_iter().map(|(_, label)| label).collect()
    }

    #[test]
    fn ticks_are_round() {
        assert_eq!(labels(&[2.1], false), ["0.0", "0.5", "1.0", "1.5", "2.0"]);
        assert_eq!(labels(&[0.019], false), ["0.000", "0.005", "0.010", "0.015", "0.020"]);
        assert_eq!(labels(&[-3.0, 9.0], false), ["−2", "0", "2", "4", "6", "8"]);
        assert_eq!(labels(&[0.7, 120.0], true), ["0.5", "1", "2", "5", "10", "20", "50", "100"]);
    }

    #[test]
    fn a_long_logarithmic_axis_has_few_ticks() {
        let labels = labels(&[1e-12, 1e14], true);
        assert!((4..=16).contains(&labels.len()), "{labels:?}");
    }

    #[test]
    fn the_largest_value_leaves_headroom() {
        for log in [false, true] {
            let axis = Axis::of([1.0, 7.0].into_iter(), log, 300.0, 0.0, 18.0);
            assert!((axis.place(7.0) - 18.0).abs() < 1e-3);
        }
        let axis = Axis::of([1.0, 7.0].into_iter(), true, 300.0, 0.0, 18.0);
        assert_eq!(axis.place(0.0), 300.0);
    }

    #[test]
    fn an_axis_between_two_ends_runs_either_way() {
        let across = Axis::between([-5.0, 15.0], [100.0, 300.0]);
        assert_eq!([-5.0, 5.0, 15.0].map(|value| across.place(value)), [100.0, 200.0, 300.0]);
        let labels: Vec<String> = across.ticks().into_iter().map(|(_, label)| label).collect();
        assert_eq!(labels, ["−5", "0", "5", "10", "15"]);
        let upwards = Axis::between([-5.0, 15.0], [300.0, 100.0]);
        assert_eq!(upwards.place(0.0), 250.0);
    }

    #[test]
    fn no_values_give_an_axis_too() {
        for log in [false, true] {
            assert!(!Axis::of([].into_iter(), log, 300.0, 0.0, 18.0).ticks().is_empty());
        }
    }

    #[test]
    fn numbers_have_the_digits_asked_for() {
        let values = [0.0, 0.0123, 1.934, 12.36, 119.6, -2.5, 3.2e7];
        let written = values.map(|value| number(value, 3));
        assert_eq!(written, ["0", "0.0123", "1.93", "12.4", "120", "−2.50", "3e7"]);
        let written = values.map(|value| number(value, 2));
        assert_eq!(written, ["0", "0.012", "1.9", "12", "120", "−2.5", "3e7"]);
    }
}
