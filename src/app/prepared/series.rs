//! A series over time, which can be interpolated at any time and plotted against another one.

use std::ops::Range;

use egui_plot::PlotPoint;

use super::pyramid::{Pyramid, Values};
use super::way::{Instant, Way};
use resect_core::calibration::Estimate;
use resect_core::statistics::tables::NORMAL_95;

/// Function that reads a value with σ at an instant of the vehicle's path; `None` if it is not determined.
pub type InstantValue = fn(&Instant) -> Option<Estimate>;

/// Values in order of time, in any storage.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    data: Data<'a>,
    /// `None` for the few values of a vehicle's path, which are all iterated over.
    pyramid: Option<&'a Pyramid>,
    /// True if its values are angles that wrap after a full turn.
    turns: bool,
    /// Greatest time between two values that are joined (s).
    longest_step_s: f64,
}

/// A corner of a line with its band of ±1.96 σ, which may represent several values.
pub struct Corner {
    pub since_s: f64,
    pub value: f64,
    pub low: f64,
    pub high: f64,
}

/// A row of a file.
pub struct Row {
    /// Index of the value in its series.
    pub index: usize,
    pub since_s: f64,
    /// The value of the other series at the same time.
    pub other: Option<f64>,
    pub value: f64,
    pub sigma: Option<f64>,
}

#[derive(Clone, Copy, Debug)]
enum Data<'a> {
    Lists { since_s: &'a [f64], values: &'a [f64] },
    Dots(&'a [PlotPoint]),
    Vehicle { instants: &'a [Instant], start_s: f64, value: InstantValue },
}

/// Greatest time between two readings or triplets that are joined (s).
const LONGEST_STEP_S: f64 = 1.0;

impl<'a> Series<'a> {
    pub fn of(since_s: &'a [f64], of: &'a Values, turns: bool) -> Option<Self> {
        let data = Data::Lists { since_s, values: &of.values };
        (!of.values.is_empty()).then_some(Self {
            data,
            pyramid: Some(&of.pyramid),
            turns,
            longest_step_s: LONGEST_STEP_S,
        })
    }

    pub fn of_dots(dots: &'a [PlotPoint], pyramid: &'a Pyramid) -> Option<Self> {
        (!dots.is_empty()).then_some(Self {
            data: Data::Dots(dots),
            pyramid: Some(pyramid),
            turns: false,
            longest_step_s: LONGEST_STEP_S,
        })
    }

    /// Returns a series of the vehicle; `None` if it is not determined at any instant.
    pub fn of_vehicle(
        way: &'a Way,
        start_s: f64,
        value: InstantValue,
        turns: bool,
    ) -> Option<Self> {
        let instants = &way.instants[..];
        instants.iter().any(|at| value(at).is_some()).then_some(Self {
            data: Data::Vehicle { instants, start_s, value },
            pyramid: None,
            turns,
            longest_step_s: way.longest_step_s(),
        })
    }

    fn len(&self) -> usize {
        match self.data {
            Data::Lists { since_s, values } => since_s.len().min(values.len()),
            Data::Dots(dots) => dots.len(),
            Data::Vehicle { instants, .. } => instants.len(),
        }
    }

    fn since_s(&self, index: usize) -> f64 {
        match self.data {
            Data::Lists { since_s, .. } => since_s[index],
            Data::Dots(dots) => dots[index].x,
            Data::Vehicle { instants, start_s, .. } => instants[index].time_s - start_s,
        }
    }

    /// Returns a value; NaN for a value of the vehicle that is not determined.
    fn value(&self, index: usize) -> f64 {
        match self.data {
            Data::Lists { values, .. } => values[index],
            Data::Dots(dots) => dots[index].y,
            Data::Vehicle { .. } => self.estimate(index).map_or(f64::NAN, |value| value.value),
        }
    }

    fn estimate(&self, index: usize) -> Option<Estimate> {
        match self.data {
            Data::Vehicle { instants, value, .. } => value(&instants[index]),
            Data::Lists { .. } | Data::Dots(_) => None,
        }
    }

    /// Returns true if its values have σ.
    pub fn has_sigma(&self) -> bool {
        matches!(self.data, Data::Vehicle { .. })
    }

    /// Returns the index of the first value that is not before a time.
    fn first_from(&self, since_s: f64) -> usize {
        match self.data {
            Data::Lists { since_s: all, .. } => all.partition_point(|t| *t < since_s),
            Data::Dots(dots) => dots.partition_point(|dot| dot.x < since_s),
            Data::Vehicle { instants, start_s, .. } => {
                instants.partition_point(|at| at.time_s - start_s < since_s)
            }
        }
    }

    fn within(&self, [from_s, to_s]: [f64; 2]) -> Range<usize> {
        let from = self.first_from(from_s);
        from..self.first_from(to_s.next_up()).min(self.len()).max(from)
    }

    /// Returns the number of values within a window.
    pub fn count(&self, window_s: [f64; 2]) -> usize {
        self.within(window_s).len()
    }

    /// Returns dots over time that represent those within a window, each with its index in the series.
    pub fn over_time(&self, window_s: [f64; 2], runs: usize) -> Vec<(usize, PlotPoint)> {
        let indices = self.visible(self.within(window_s), runs).into_iter();
        indices.map(|i| (i, PlotPoint::new(self.since_s(i), self.value(i)))).collect()
    }

    /// Returns indices of values that represent a range, extremes included.
    fn visible(&self, range: Range<usize>, runs: usize) -> Vec<usize> {
        match self.pyramid {
            Some(pyramid) => pyramid.visible(range, runs),
            None => range.collect(),
        }
    }

    /// Returns lines with bands that represent the values within a window and the adjacent ones, with at most about `most_corners` corners.
    /// A line ends at a gap, at an undetermined value, and at a jump of an angle by a full turn.
    pub fn lines(&self, window_s: [f64; 2], most_corners: usize) -> Vec<Vec<Corner>> {
        let within = self.within(window_s);
        let range = within.start.saturating_sub(1)..(within.end + 1).min(self.len());
        let stride = range.len().div_ceil(most_corners.max(1)).max(1);
        let known: Vec<(usize, Estimate)> =
            range.filter_map(|index| Some((index, self.estimate(index)?))).collect();
        let is_joined = |a: &(usize, Estimate), b: &(usize, Estimate)| {
            let jump = (b.1.value - a.1.value).abs();
            self.since_s(b.0) - self.since_s(a.0) <= self.longest_step_s
                && !(self.turns && jump >= std::f64::consts::PI)
        };
        let corner = |some: &[(usize, Estimate)]| {
            let (index, middle) = some[some.len() / 2];
            let bound =
                |sign: f64| some.iter().map(move |(_, at)| at.value + sign * NORMAL_95 * at.sigma);
            Corner {
                since_s: self.since_s(index),
                value: middle.value,
                low: bound(-1.0).fold(f64::INFINITY, f64::min),
                high: bound(1.0).fold(f64::NEG_INFINITY, f64::max),
            }
        };
        known.chunk_by(is_joined).map(|line| line.chunks(stride).map(corner).collect()).collect()
    }

    /// Returns dots that represent those within a window, each against another series at the same time, with its index in this one. They
    /// include the extremes of both.
    pub fn against(
        &self,
        other: &Series<'_>,
        window_s: [f64; 2],
        runs: usize,
    ) -> Vec<(usize, PlotPoint)> {
        let part = self.within(window_s);
        let mut indices = self.visible(part.clone(), runs);
        if other.len() == self.len() {
            indices.extend(other.visible(part, runs));
            indices.sort_unstable();
            indices.dedup();
        }
        indices
            .into_iter()
            .filter_map(|i| Some((i, PlotPoint::new(other.at(self.since_s(i))?, self.value(i)))))
            .collect()
    }

    /// Returns the value at a time, linearly interpolated; `None` in a gap.
    pub fn at(&self, since_s: f64) -> Option<f64> {
        let after = self.first_from(since_s);
        if after < self.len() && self.since_s(after) <= since_s {
            return Some(self.value(after)).filter(|value| value.is_finite());
        }
        let before = after.checked_sub(1).filter(|_| after < self.len())?;
        let [from_s, to_s] = [before, after].map(|index| self.since_s(index));
        let [from, to] = [before, after].map(|index| self.value(index));
        let share = (since_s - from_s) / (to_s - from_s);
        let joined = to_s - from_s <= self.longest_step_s;
        let turned = self.turns && (to - from).abs() > std::f64::consts::PI;
        let between = from + share * (to - from);
        (joined && !turned && between.is_finite()).then_some(between)
    }

    /// Returns each value within a window as a row.
    pub fn rows(&self, other: Option<Self>, window_s: [f64; 2]) -> impl Iterator<Item = Row> {
        let rows = self.within(window_s).map(move |index| {
            let since_s = self.since_s(index);
            let other = other.and_then(|other| other.at(since_s));
            let sigma = self.estimate(index).map(|value| value.sigma);
            Row { index, since_s, other, value: self.value(index), sigma }
        });
        rows.filter(|row| row.value.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_is_read_between_its_values_and_not_over_its_gaps() {
        let values = Values::of(vec![1.0, 3.0, 5.0, 50.0]);
        let series = Series::of(&[0.0, 0.5, 1.0, 9.0], &values, false).expect("some");
        let at = [0.0, 0.25, 1.0, 5.0, 9.0, 9.1, -0.1].map(|t| series.at(t));
        assert_eq!(at, [Some(1.0), Some(2.0), Some(5.0), None, Some(50.0), None, None]);
        assert_eq!(series.count([0.5, 9.0]), 3);
        assert_eq!(series.over_time([0.4, 1.0], 10).len(), 2);
        // The mean of 359° and 1° is not 180°.
        let values = Values::of(vec![6.25, 0.25]);
        let series = |turns| Series::of(&[0.0, 0.5], &values, turns).expect("some");
        assert_eq!([true, false].map(|turns| series(turns).at(0.25)), [None, Some(3.25)]);
    }

    #[test]
    fn one_series_against_another_loses_no_extreme_of_either() {
        let count = 100_000;
        let since_s: Vec<f64> = (0..count).map(|i| 0.1 * f64::from(i)).collect();
        let [mut a, mut b]: [Vec<f64>; 2] =
            [3.0, 7.0].map(|f| since_s.iter().map(|t| (t / f).sin()).collect());
        a[50_123] = 9.0;
        b[70_456] = -9.0;
        let [a, b] = [a, b].map(Values::of);
        let [a, b] = [&a, &b].map(|of| Series::of(&since_s, of, false).expect("some"));
        let dots = a.against(&b, [0.0, 1e9], 300);
        assert!(dots.len() < 3000, "{}", dots.len());
        assert!(
            dots.iter().any(|(_, dot)| dot.y == 9.0) && dots.iter().any(|(_, dot)| dot.x == -9.0)
        );
    }
}
