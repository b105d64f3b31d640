//! What the plots draw, made once for each answer by the worker: no frame goes through all residuals.

use std::sync::Arc;

use egui_plot::PlotPoint;

use super::gaps::Gaps;
use super::pyramid::Pyramid;
use super::raw_readings::RawReadings;
use crate::analysis::{Analysis, Answer};
use crate::evaluation::vehicle::distance_sigma_m;
use crate::export::residual_chart::{histogram, range_mm};

const BINS: usize = 40;

/// Ready to draw; errors in mm, times in s since the first measurement.
#[derive(Clone, Debug, Default)]
pub struct PreparedPlots {
    /// The range that shows nearly all errors: outliers must not squeeze the rest into a line. About zero, or from
    /// zero up where no error is negative.
    pub range_mm: [f64; 2],
    /// Distance errors of each pair.
    pub residuals: [Residuals; 3],
    /// The errors of all pairs in order of size.
    sorted_mm: Vec<f64>,
    /// Twice the standard deviation that the interpolation states for each pair's distance, one band an interval;
    /// empty where it states none.
    pub bands: [Vec<Band>; 3],
    /// Outline of each pair's histogram over the range.
    pub outlines: [Vec<PlotPoint>; 3],
    pub bin_width_mm: f64,
    pub highest_count: usize,
    pub gaps: Gaps,
    /// What is plotted of the raw readings, the same for every answer.
    pub readings: Arc<RawReadings>,
}

/// Distance errors of a pair over time.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    /// The errors in order of time.
    pub dots: Vec<PlotPoint>,
    pub pyramid: Pyramid,
}

/// A band about zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Since the first measurement.
    pub times_s: Vec<f64>,
    pub half_widths_mm: Vec<f64>,
}

/// Most corners of a band for each pair: more say nothing more to the eye.
const MOST_BAND_CORNERS: usize = 1000;
/// Triplets of a stretch at least: a second of them.
const LEAST_STRETCH: usize = 10;

impl PreparedPlots {
    /// The plots of an analysis; without an answer there are no errors.
    pub fn of(analysis: &Analysis, readings: &Arc<RawReadings>) -> Self {
        let (gaps, readings) = (Gaps::of(analysis, readings), Arc::clone(readings));
        let Ok(answer) = &analysis.answer else {
            return Self { gaps, readings, ..Self::default() };
        };
        let start_s = readings.start_s;
        let errors = &answer.evaluation.distance_errors_mm;
        let time_s = &analysis.triplets().time_s;
        let range_mm = range_mm(errors);
        let bin_width_mm = (range_mm[1] - range_mm[0]) / BINS as f64;
        let counts = errors.each_ref().map(|errors| histogram(errors, range_mm, BINS));
        let mut sorted_mm: Vec<f64> = errors.iter().flatten().copied().collect();
        sorted_mm.sort_unstable_by(f64::total_cmp);
        Self {
            range_mm,
            residuals: errors.each_ref().map(|errors| Residuals {
                dots: (time_s.iter().zip(errors))
                    .map(|(time_s, error_mm)| PlotPoint::new(time_s - start_s, *error_mm))
                    .collect(),
                pyramid: Pyramid::of(errors),
            }),
            sorted_mm,
            bands: bands(analysis, answer, start_s),
            outlines: counts.each_ref().map(|counts| outline(counts, range_mm[0], bin_width_mm)),
            bin_width_mm,
            highest_count: counts.iter().flatten().copied().max().unwrap_or(0),
            gaps,
            readings,
        }
    }

    /// How many of the errors of all pairs are outside a range (mm), and how many there are.
    pub fn outside(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let below = self.sorted_mm.partition_point(|error| *error < low);
        let up_to = self.sorted_mm.partition_point(|error| *error <= high);
        [self.sorted_mm.len() - (up_to - below), self.sorted_mm.len()]
    }

    /// The least and the greatest error (mm), with some room about them.
    pub fn all_mm(&self) -> [f64; 2] {
        let [low, high] = self.range_mm;
        let low = self.sorted_mm.first().map_or(low, |least| least.min(low));
        let high = self.sorted_mm.last().map_or(high, |greatest| greatest.max(high));
        [low - 0.04 * (high - low), high + 0.04 * (high - low)]
    }
}

impl Residuals {
    /// Dots that stand for those within a window (s since the first measurement).
    pub fn visible(&self, [from_s, to_s]: [f64; 2], runs: usize) -> Vec<PlotPoint> {
        let from = self.dots.partition_point(|dot| dot.x < from_s);
        let to = self.dots.partition_point(|dot| dot.x <= to_s).max(from);
        let indices = self.pyramid.visible(from..to, runs);
        indices.into_iter().map(|index| self.dots[index]).collect()
    }
}

/// The widest of each stretch of some triplets: between readings σ rises and falls many times a second.
fn bands(analysis: &Analysis, answer: &Answer, start_s: f64) -> [Vec<Band>; 3] {
    let triplets = analysis.triplets();
    let transforms = &answer.calibration.station1_from_station;
    let mut bands: [Vec<Band>; 3] = Default::default();
    if triplets.sigma_m.is_none() {
        return bands;
    }
    let length = triplets.len().div_ceil(MOST_BAND_CORNERS).max(LEAST_STRETCH);
    let indices: Vec<usize> = (0..triplets.len()).collect();
    for interval in indices.chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b]) {
        bands.iter_mut().for_each(|bands| bands.push(Band::default()));
        for stretch in interval.chunks(length) {
            let widest = stretch
                .iter()
                .filter_map(|index| distance_sigma_m(triplets, *index, transforms))
                .fold([0.0; 3], |a, b| std::array::from_fn(|pair| f64::max(a[pair], b[pair])));
            let ends = [stretch[0], stretch[stretch.len() - 1]];
            for (bands, sigma_m) in bands.iter_mut().zip(widest) {
                if let Some(band) = bands.last_mut() {
                    band.times_s.extend(ends.map(|index| triplets.time_s[index] - start_s));
                    band.half_widths_mm.extend([2e3 * sigma_m; 2]);
                }
            }
        }
    }
    bands
}

fn outline(counts: &[usize], low: f64, width: f64) -> Vec<PlotPoint> {
    counts
        .iter()
        .enumerate()
        .flat_map(|(bin, count)| {
            let left = low + bin as f64 * width;
            [left, left + width].map(|x| PlotPoint::new(x, *count as f64))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::{Analyst, Settings};
    use crate::deployment::Sample;

    #[test]
    fn errors_outside_a_range_are_counted_as_by_brute_force() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let readings = Arc::new(RawReadings::of(&deployment));
        let analysis = Analyst::new(deployment).run(&Settings::default());
        let plots = PreparedPlots::of(&analysis, &readings);
        let answer = analysis.answer.as_ref().expect("an answer");
        let errors = || answer.evaluation.distance_errors_mm.iter().flatten();
        for range_mm in [plots.range_mm, [-1.0, 2.0], plots.all_mm(), [0.0, 0.0]] {
            let outside = errors().filter(|e| **e < range_mm[0] || **e > range_mm[1]).count();
            assert_eq!(plots.outside(range_mm), [outside, errors().count()]);
        }
        assert_eq!(plots.outside(plots.all_mm())[0], 0);
    }
}
