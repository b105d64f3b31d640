//! A series over time, which can be read at any time and plotted against another one.

use std::ops::Range;

use egui_plot::PlotPoint;

use super::pyramid::{Pyramid, Values};

/// Values in order of time, wherever they are kept.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    data: Data<'a>,
    pyramid: &'a Pyramid,
    /// Whether its values are angles that begin again after a full turn.
    turns: bool,
}

#[derive(Clone, Copy, Debug)]
enum Data<'a> {
    Lists { since_s: &'a [f64], values: &'a [f64] },
    Dots(&'a [PlotPoint]),
}

/// Values further apart than this are not joined (s): what was between them nobody knows.
const FARTHEST_S: f64 = 1.0;

impl<'a> Series<'a> {
    pub fn of(since_s: &'a [f64], of: &'a Values, turns: bool) -> Option<Self> {
        let data = Data::Lists { since_s, values: &of.values };
        (!of.values.is_empty()).then_some(Self { data, pyramid: &of.pyramid, turns })
    }

    pub fn of_dots(dots: &'a [PlotPoint], pyramid: &'a Pyramid) -> Option<Self> {
        (!dots.is_empty()).then_some(Self { data: Data::Dots(dots), pyramid, turns: false })
    }

    fn len(&self) -> usize {
        match self.data {
            Data::Lists { since_s, values } => since_s.len().min(values.len()),
            Data::Dots(dots) => dots.len(),
        }
    }

    fn since_s(&self, index: usize) -> f64 {
        match self.data {
            Data::Lists { since_s, .. } => since_s[index],
            Data::Dots(dots) => dots[index].x,
        }
    }

    fn value(&self, index: usize) -> f64 {
        match self.data {
            Data::Lists { values, .. } => values[index],
            Data::Dots(dots) => dots[index].y,
        }
    }

    /// Index of the first value that is not before a time.
    fn first_from(&self, since_s: f64) -> usize {
        match self.data {
            Data::Lists { since_s: all, .. } => all.partition_point(|t| *t < since_s),
            Data::Dots(dots) => dots.partition_point(|dot| dot.x < since_s),
        }
    }

    fn within(&self, [from_s, to_s]: [f64; 2]) -> Range<usize> {
        let from = self.first_from(from_s);
        from..self.first_from(to_s.next_up()).min(self.len()).max(from)
    }

    /// How many values are within a window.
    pub fn count(&self, window_s: [f64; 2]) -> usize {
        self.within(window_s).len()
    }

    /// Dots over time that stand for those within a window.
    pub fn over_time(&self, window_s: [f64; 2], runs: usize) -> Vec<PlotPoint> {
        let indices = self.pyramid.visible(self.within(window_s), runs);
        indices.into_iter().map(|i| PlotPoint::new(self.since_s(i), self.value(i))).collect()
    }

    /// Dots that stand for those within a window, each against another series at the same time. Extremes of both are
    /// among them.
    pub fn against(&self, other: &Series<'_>, window_s: [f64; 2], runs: usize) -> Vec<PlotPoint> {
        let part = self.within(window_s);
        let mut indices = self.pyramid.visible(part.clone(), runs);
        if other.len() == self.len() {
            indices.extend(other.pyramid.visible(part, runs));
            indices.sort_unstable();
            indices.dedup();
        }
        indices
            .into_iter()
            .filter_map(|i| Some(PlotPoint::new(other.at(self.since_s(i))?, self.value(i))))
            .collect()
    }

    /// The value at a time, on a straight line between two that are not far apart.
    pub fn at(&self, since_s: f64) -> Option<f64> {
        let after = self.first_from(since_s);
        if after < self.len() && self.since_s(after) <= since_s {
            return Some(self.value(after));
        }
        let before = after.checked_sub(1).filter(|_| after < self.len())?;
        let [from_s, to_s] = [before, after].map(|index| self.since_s(index));
        let [from, to] = [before, after].map(|index| self.value(index));
        let share = (since_s - from_s) / (to_s - from_s);
        let joined = to_s - from_s <= FARTHEST_S;
        let turned = self.turns && (to - from).abs() > std::f64::consts::PI;
        (joined && !turned).then_some(from + share * (to - from))
    }

    /// Each value within a window: the time, what it stands against, and itself.
    pub fn rows(
        &self,
        other: Option<Self>,
        window_s: [f64; 2],
    ) -> impl Iterator<Item = (f64, Option<f64>, f64)> {
        self.within(window_s).map(move |index| {
            let since_s = self.since_s(index);
            (since_s, other.and_then(|other| other.at(since_s)), self.value(index))
        })
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
        // Between 359° and 1° is not 180°.
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
        assert!(dots.iter().any(|dot| dot.y == 9.0) && dots.iter().any(|dot| dot.x == -9.0));
    }
}
