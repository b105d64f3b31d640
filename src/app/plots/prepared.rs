//! What the plots draw, made once for each answer by the worker: no frame goes through all residuals.

use egui_plot::PlotPoint;

use crate::analysis::{Analysis, Answer};
use crate::evaluation::vehicle::distance_sigma_m;
use crate::export::residual_chart::{histogram, range_mm};

/// More dots than this a pair are thinned to the extremes of short spans: what the eye would see anyway.
const MOST_DOTS: usize = 4000;
const BINS: usize = 40;

/// Ready to draw; errors in mm, times in s since the first measurement.
#[derive(Clone, Debug, Default)]
pub struct PreparedPlots {
    /// The range that shows nearly all errors: outliers must not squeeze the rest into a line. About zero, or from
    /// zero up where no error is negative.
    pub range_mm: [f64; 2],
    /// For each pair.
    pub dots: [Vec<PlotPoint>; 3],
    /// Twice the standard deviation that the interpolation states for each pair's distance, one band an interval;
    /// empty where it states none.
    pub bands: [Vec<Band>; 3],
    /// Outline of each pair's histogram over the range.
    pub outlines: [Vec<PlotPoint>; 3],
    pub bin_width_mm: f64,
    pub highest_count: usize,
}

/// A band about zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Since the first measurement.
    pub times_s: Vec<f64>,
    pub half_widths_mm: Vec<f64>,
}

/// More corners than this a pair say nothing more to the eye.
const MOST_BAND_CORNERS: usize = 1000;
/// Triplets of a stretch at least: a second of them.
const LEAST_STRETCH: usize = 10;

impl PreparedPlots {
    /// `start_s` is the time of the first measurement. Empty without an answer.
    pub fn of(analysis: &Analysis, start_s: f64) -> Self {
        let Ok(answer) = &analysis.answer else { return Self::default() };
        let errors = &answer.evaluation.distance_errors_mm;
        let time_s = &analysis.triplets().time_s;
        let range_mm = range_mm(errors);
        let bin_width_mm = (range_mm[1] - range_mm[0]) / BINS as f64;
        let counts = errors.each_ref().map(|errors| histogram(errors, range_mm, BINS));
        Self {
            range_mm,
            dots: errors.each_ref().map(|errors| {
                thinned(errors)
                    .into_iter()
                    .map(|index| PlotPoint::new(time_s[index] - start_s, errors[index]))
                    .collect()
            }),
            bands: bands(analysis, answer, start_s),
            outlines: counts.each_ref().map(|counts| outline(counts, range_mm[0], bin_width_mm)),
            bin_width_mm,
            highest_count: counts.iter().flatten().copied().max().unwrap_or(0),
        }
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

/// Indices to draw: all, or lowest and highest of each of equal spans.
fn thinned(errors: &[f64]) -> Vec<usize> {
    if errors.len() <= MOST_DOTS {
        return (0..errors.len()).collect();
    }
    let span = errors.len().div_ceil(MOST_DOTS / 2);
    let by_error = |a: &usize, b: &usize| errors[*a].total_cmp(&errors[*b]);
    (0..errors.len())
        .step_by(span)
        .flat_map(|start| {
            let range = start..(start + span).min(errors.len());
            let low = range.clone().min_by(by_error).unwrap_or(start);
            let high = range.max_by(by_error).unwrap_or(start);
            [low.min(high), low.max(high)]
        })
        .collect()
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

    #[test]
    fn thinning_keeps_the_extremes() {
        let mut errors: Vec<f64> = (0..100_000).map(|i| (f64::from(i) * 0.01).sin()).collect();
        errors[51_234] = 40.0;
        errors[7] = -30.0;
        let kept = thinned(&errors);
        assert!(kept.len() <= MOST_DOTS + 2);
        assert!(kept.contains(&51_234) && kept.contains(&7));
        assert!(kept.windows(2).all(|w| w[0] <= w[1]));
    }
}
