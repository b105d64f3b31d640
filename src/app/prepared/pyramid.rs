//! Least and greatest values of increasingly long runs of a series, so that a plot represents a million values by a few.

use std::ops::Range;

/// Number of values in a run of the lowest level; each level's runs are twice as long as those of the one below.
const SHORTEST_RUN: usize = 8;

/// Selects the values of a series to draw: all of a few, or the extremes of runs of many.
#[derive(Clone, Debug, Default)]
pub struct Pyramid {
    len: usize,
    /// Indices of the least and greatest value, for each level and run. An incomplete last run is omitted.
    levels: Vec<Vec<[u32; 2]>>,
}

impl Pyramid {
    /// Builds the pyramid of a series of fewer than 2³² values, none of them NaN, in linear time.
    pub fn of(values: &[f64]) -> Self {
        let extremes = |indices: &mut dyn Iterator<Item = u32>| {
            let first = indices.next().unwrap_or(0);
            indices.fold([first; 2], |[low, high], index| {
                let value = |i: u32| values[i as usize];
                [
                    if value(index) < value(low) { index } else { low },
                    if value(index) > value(high) { index } else { high },
                ]
            })
        };
        let mut runs: Vec<[u32; 2]> = (0..values.len() / SHORTEST_RUN)
            .map(|run| (run * SHORTEST_RUN) as u32)
            .map(|start| extremes(&mut (start..start + SHORTEST_RUN as u32)))
            .collect();
        let mut levels = Vec::new();
        while !runs.is_empty() {
            let longer = runs
                .chunks_exact(2)
                .map(|pair| extremes(&mut pair.iter().flatten().copied()))
                .collect();
            levels.push(std::mem::replace(&mut runs, longer));
        }
        Self { len: values.len(), levels }
    }

    /// Returns indices, in order, that represent a range of the series. If it has at most three values for each of `runs`, these are all
    /// indices. Otherwise they are the extremes of about that many runs, and the middle value of each, so that usual values are visible
    /// too. They always include the least and the greatest value of the range.
    pub fn visible(&self, part: Range<usize>, runs: usize) -> Vec<usize> {
        let part = part.start.min(self.len)..part.end.min(self.len);
        let runs = runs.max(1);
        let mut indices = Vec::new();
        if part.len() <= 3 * runs {
            indices.extend(part);
            return indices;
        }
        let fits = |level: &usize| part.len() / run_length(*level) <= runs;
        let level = (1..=self.levels.len()).find(fits).unwrap_or(self.levels.len());
        self.cover(part, level, &mut indices);
        indices
    }

    /// Covers a range by runs of a level, and its partial runs at both ends by shorter ones. Level 0 is the values.
    fn cover(&self, part: Range<usize>, level: usize, indices: &mut Vec<usize>) {
        let Some(below) = level.checked_sub(1) else {
            indices.extend(part);
            return;
        };
        let (runs, length) = (&self.levels[below], run_length(level));
        let whole = part.start.div_ceil(length)..(part.end / length).min(runs.len());
        if whole.is_empty() {
            self.cover(part, below, indices);
            return;
        }
        self.cover(part.start..whole.start * length, below, indices);
        for run in whole.clone() {
            let [low, high] = runs[run].map(|index| index as usize);
            let mut some = [low, run * length + length / 2, high];
            some.sort_unstable();
            indices.extend(some);
        }
        indices.dedup();
        self.cover(whole.end * length..part.end, below, indices);
    }
}

/// Values in order of time, with their pyramid.
#[derive(Clone, Debug, Default)]
pub struct Values {
    pub values: Vec<f64>,
    pub pyramid: Pyramid,
}

impl Values {
    pub fn of(values: Vec<f64>) -> Self {
        Self { pyramid: Pyramid::of(&values), values }
    }
}

/// Returns the number of values in a run of a level above 0.
fn run_length(level: usize) -> usize {
    SHORTEST_RUN << (level - 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Compares with brute force: in any range, the extremes are drawn, in order, and the number is limited.
        #[test]
        fn extremes_are_never_lost(
            values in proptest::collection::vec(-1e3..1e3f64, 1..3000),
            ends in (0.0..1.0f64, 0.0..1.0f64),
            runs in 1usize..200,
        ) {
            let at = |share: f64| (share * (values.len() + 1) as f64) as usize;
            let part = at(ends.0.min(ends.1))..at(ends.0.max(ends.1));
            let drawn = Pyramid::of(&values).visible(part.clone(), runs);
            prop_assert!(drawn.windows(2).all(|pair| pair[0] < pair[1]));
            prop_assert!(drawn.iter().all(|index| part.contains(index)));
            // Three for each run, and the runs at both ends.
            prop_assert!(drawn.len() <= 3 * runs + 2 * (7 + 3 * 10), "{} of {}", drawn.len(), runs);
            if !part.is_empty() {
                let range = |values: &mut dyn Iterator<Item = f64>| {
                    values.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)))
                };
                let all = range(&mut values[part.clone()].iter().copied());
                prop_assert_eq!(range(&mut drawn.iter().map(|index| values[*index])), all);
            }
        }
    }

    #[test]
    fn a_million_values_become_a_few_thousand_and_the_outlier_among_them() {
        let mut values: Vec<f64> = (0..1_000_000).map(|i| (f64::from(i) * 1e-3).sin()).collect();
        values[512_345] = 40.0;
        let pyramid = Pyramid::of(&values);
        let drawn = pyramid.visible(0..values.len(), 900);
        assert!(drawn.len() <= 2800 && drawn.contains(&512_345), "{}", drawn.len());
        let usual = drawn.iter().filter(|index| values[**index].abs() < 0.9).count();
        assert!(usual > 200, "{usual}");
        // A short range has room for each value.
        assert_eq!(pyramid.visible(512_000..513_000, 900).len(), 1000);
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert!(Pyramid::default().visible(0..0, 100).is_empty());
        assert!(Pyramid::of(&[]).visible(0..5, 100).is_empty());
    }
}
