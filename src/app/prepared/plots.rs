//! Data of the plots, computed once for each analysis by the worker: no frame iterates over all residuals.

use std::ops::Range;
use std::sync::Arc;

use egui_plot::PlotPoint;

use super::gaps::Gaps;
use super::pyramid::Pyramid;
use super::raw_readings::RawReadings;
use super::running::Running;
use super::track_series::TrackSeries;
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::misfits::compared_stations;
use resect_core::deployment::Deployment;
use resect_core::evaluation::Spread;
use resect_core::evaluation::vehicle::distance_sigma_m;
use resect_core::network::PerPair;
use resect_report::residual_chart::{histogram, range_mm};

const BINS: usize = 40;

/// Data of all plots; errors in mm, times in s since the first measurement.
#[derive(Clone, Debug, Default)]
pub struct PreparedPlots {
    /// Range of nearly all errors: outliers must not compress the rest into a line.
    /// It is symmetric about zero, or begins at zero if no error is negative.
    pub range_mm: [f64; 2],
    /// Distance errors of each pair.
    pub residuals: PerPair<Residuals>,
    /// Sorted errors of all pairs.
    sorted_mm: Vec<f64>,
    /// Band of two standard deviations of each pair's distance by the interpolation, one band for each interval; empty without a σ.
    pub bands: PerPair<Vec<Band>>,
    /// Distribution of the errors over the range.
    pub distributions: Distributions,
    pub gaps: Gaps,
    /// Positions of the prisms, and speed.
    pub track: TrackSeries,
    /// Plotted data of the raw readings, the same for every calibration.
    pub readings: Arc<RawReadings>,
}

/// Distance errors of a pair over time.
#[derive(Clone, Debug, Default)]
pub struct Residuals {
    /// The errors in order of time.
    pub dots: Vec<PlotPoint>,
    pub pyramid: Pyramid,
    /// Running median and quartiles of the dots (mm).
    pub running: Running,
}

/// Distribution of the errors of each pair.
#[derive(Clone, Debug, Default)]
pub struct Distributions {
    /// Outline of each pair's histogram: errors (mm), and the share of the pair's errors in each bin (%).
    pub outlines: PerPair<Vec<PlotPoint>>,
    /// Height of the highest bin of all (%).
    pub highest_percent: f64,
    pub bin_width_mm: f64,
    /// Spread of |error| of each pair (mm), and of all together.
    pub by_pair_mm: PerPair<Option<Spread>>,
    pub all_mm: Option<Spread>,
}

/// A symmetric band about zero.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Band {
    /// Times since the first measurement.
    pub times_s: Vec<f64>,
    pub half_widths_mm: Vec<f64>,
}

/// Number of dots of a pair up to which all are drawn, even in a narrow plot.
const WHOLE_CLOUD: usize = 3150;
/// Greatest number of a band's corners for each pair; more are not visible.
const MOST_BAND_CORNERS: usize = 1000;
/// Least number of triplets in a segment: one second of them.
const LEAST_STRETCH: usize = 10;

impl PreparedPlots {
    /// Returns the plots of an analysis; without a calibration there are no errors.
    pub fn of(deployment: &Deployment, analysis: &Analysis, readings: &Arc<RawReadings>) -> Self {
        let (gaps, readings) = (Gaps::of(analysis, readings), Arc::clone(readings));
        let track = TrackSeries::of(deployment, analysis, readings.start_s);
        let Ok(answer) = &analysis.answer else {
            return Self { gaps, track, readings, ..Self::default() };
        };
        let start_s = readings.start_s;
        let errors = &answer.evaluation.distance_errors_mm;
        let triplets = analysis.triplets();
        let since_s: Vec<f64> = triplets.time_s.iter().map(|time_s| time_s - start_s).collect();
        let range_mm = range_mm(errors.as_slice());
        let mut sorted_mm: Vec<f64> = errors.iter().flatten().copied().collect();
        sorted_mm.sort_unstable_by(f64::total_cmp);
        Self {
            range_mm,
            residuals: errors.map(|errors| Residuals {
                dots: (since_s.iter().zip(errors))
                    .map(|(since_s, error_mm)| PlotPoint::new(*since_s, *error_mm))
                    .collect(),
                pyramid: Pyramid::of(errors),
                running: Running::of(&since_s, errors, &triplets.interval),
            }),
            sorted_mm,
            bands: bands(analysis, answer, start_s),
            distributions: Distributions::of(errors, range_mm),
            gaps,
            track,
            readings,
        }
    }

    /// Returns the distribution of the errors of a span of time (s since the first measurement).
    pub fn distributions_within(&self, span_s: [f64; 2]) -> Distributions {
        let errors = self.residuals.map(|residuals| -> Vec<f64> {
            residuals.dots[residuals.within(span_s)].iter().map(|dot| dot.y).collect()
        });
        Distributions::of(&errors, self.range_mm)
    }

    /// Returns the number of all pairs' errors outside a range (mm), and the number of all errors.
    pub fn outside(&self, [low, high]: [f64; 2]) -> [usize; 2] {
        let below = self.sorted_mm.partition_point(|error| *error < low);
        let up_to = self.sorted_mm.partition_point(|error| *error <= high);
        [self.sorted_mm.len() - (up_to - below), self.sorted_mm.len()]
    }

    /// Returns the least and the greatest error (mm), with a margin.
    pub fn all_mm(&self) -> [f64; 2] {
        let [low, high] = self.range_mm;
        let low = self.sorted_mm.first().map_or(low, |least| least.min(low));
        let high = self.sorted_mm.last().map_or(high, |greatest| greatest.max(high));
        [low - 0.04 * (high - low), high + 0.04 * (high - low)]
    }
}

impl Residuals {
    /// Returns dots that represent those within a window (s since the first measurement)
    /// of so many columns: all of a small cloud, the outline and a sample of a large one.
    pub fn cloud(&self, window_s: [f64; 2], columns: usize) -> Vec<PlotPoint> {
        let is_whole = self.within(window_s).len() <= WHOLE_CLOUD;
        self.visible(window_s, if is_whole { WHOLE_CLOUD } else { columns })
    }

    /// Returns dots that represent those within a window, from about `runs` runs.
    pub fn visible(&self, window_s: [f64; 2], runs: usize) -> Vec<PlotPoint> {
        let indices = self.pyramid.visible(self.within(window_s), runs);
        indices.into_iter().map(|index| self.dots[index]).collect()
    }

    fn within(&self, [from_s, to_s]: [f64; 2]) -> Range<usize> {
        let from = self.dots.partition_point(|dot| dot.x < from_s);
        from..self.dots.partition_point(|dot| dot.x <= to_s).max(from)
    }
}

impl Distributions {
    fn of(errors_mm: &PerPair<Vec<f64>>, range_mm: [f64; 2]) -> Self {
        let bin_width_mm = (range_mm[1] - range_mm[0]) / BINS as f64;
        let outlines = errors_mm.map(|errors| {
            let counts = histogram(errors, range_mm, BINS);
            outline(&counts, 100.0 / errors.len().max(1) as f64, range_mm[0], bin_width_mm)
        });
        Self {
            highest_percent: outlines.iter().flatten().map(|corner| corner.y).fold(0.0, f64::max),
            outlines,
            bin_width_mm,
            by_pair_mm: errors_mm.map(|errors| Spread::of(errors.iter().copied())),
            all_mm: Spread::of(errors_mm.iter().flatten().copied()),
        }
    }
}

/// Returns the greatest half-width of each segment of some triplets: between readings σ rises and falls many times a second.
fn bands(analysis: &Analysis, answer: &Answer, start_s: f64) -> PerPair<Vec<Band>> {
    let triplets = analysis.triplets();
    let transforms = &answer.calibration.station1_from_station;
    let mut bands = answer.evaluation.distance_errors_mm.map(|_| Vec::new());
    if triplets.sigma_m.is_none() {
        return bands;
    }
    let by_station = compared_stations(&analysis.offer.followed);
    let length = triplets.len().div_ceil(MOST_BAND_CORNERS).max(LEAST_STRETCH);
    let indices: Vec<usize> = (0..triplets.len()).collect();
    for interval in indices.chunk_by(|a, b| triplets.interval[*a] == triplets.interval[*b]) {
        bands.iter_mut().for_each(|bands: &mut Vec<Band>| bands.push(Band::default()));
        for stretch in interval.chunks(length) {
            let widest_m = stretch
                .iter()
                .filter_map(|index| distance_sigma_m(triplets, *index, transforms, &by_station))
                .reduce(|a, b| a.zip(&b, |a, b| f64::max(*a, *b)));
            let ends = [stretch[0], stretch[stretch.len() - 1]];
            for (bands, sigma_m) in bands.iter_mut().zip(widest_m.into_iter().flatten()) {
                if let Some(band) = bands.last_mut() {
                    band.times_s.extend(ends.map(|index| triplets.time_s[index] - start_s));
                    band.half_widths_mm.extend([2e3 * sigma_m; 2]);
                }
            }
        }
    }
    bands
}

fn outline(counts: &[usize], percent: f64, low: f64, width: f64) -> Vec<PlotPoint> {
    counts
        .iter()
        .enumerate()
        .flat_map(|(bin, count)| {
            let left = low + bin as f64 * width;
            [left, left + width].map(|x| PlotPoint::new(x, *count as f64 * percent))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_core::calibration::Method;
    use resect_io::sample::Sample;

    #[test]
    fn errors_outside_a_range_are_counted_as_by_brute_force() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let readings = Arc::new(RawReadings::of(&deployment));
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&Settings::default());
        let plots = PreparedPlots::of(&deployment, &analysis, &readings);
        let answer = analysis.answer.as_ref().expect("an answer");
        let errors = || answer.evaluation.distance_errors_mm.iter().flatten();
        for range_mm in [plots.range_mm, [-1.0, 2.0], plots.all_mm(), [0.0, 0.0]] {
            let outside = errors().filter(|e| **e < range_mm[0] || **e > range_mm[1]).count();
            assert_eq!(plots.outside(range_mm), [outside, errors().count()]);
        }
        assert_eq!(plots.outside(plots.all_mm())[0], 0);
    }

    /// Control points alone give a calibration, without a rig to compare distances with.
    #[test]
    fn an_answer_without_a_rig_has_no_errors_to_draw() {
        let mut deployment = Sample::Warthog.open().expect("built in");
        deployment.rig = None;
        let deployment = Arc::new(deployment);
        let readings = Arc::new(RawReadings::of(&deployment));
        let mut settings = Settings::default();
        settings.calibration.method = Some(Method::StaticGcp);
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&settings);
        assert!(analysis.answer.is_ok() && !analysis.triplets().is_empty());
        let plots = PreparedPlots::of(&deployment, &analysis, &readings);
        let everything = [f64::MIN, f64::MAX];
        assert!(plots.residuals.iter().all(|errors| errors.cloud(everything, 100).is_empty()));
        assert_eq!(plots.outside(plots.range_mm), [0, 0]);
    }

    #[test]
    fn the_distribution_of_a_span_is_that_of_its_errors_alone() {
        let deployment = Arc::new(Sample::Warthog.open().expect("built in"));
        let readings = Arc::new(RawReadings::of(&deployment));
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&Settings::default());
        let plots = PreparedPlots::of(&deployment, &analysis, &readings);
        let answer = analysis.answer.as_ref().expect("an answer");
        // The distribution over the whole drive equals that of the result.
        let whole = plots.distributions_within([f64::MIN, f64::MAX]);
        assert_eq!(whole.all_mm, answer.evaluation.inter_prism_mm);
        assert_eq!(whole.by_pair_mm, answer.evaluation.inter_prism_by_pair_mm);
        let part = plots.distributions_within([100.0, 200.0]);
        let n = part.by_pair_mm[1].expect("some").n;
        let since_s = analysis.triplets().time_s.iter().map(|t| t - readings.start_s);
        assert_eq!(n, since_s.filter(|t| (100.0..=200.0).contains(t)).count());
        assert!(n > 100 && part.all_mm.expect("some").n == 3 * n);
        // Every bin has two corners; errors beyond the range count, but are in no bin.
        for outline in &part.outlines {
            let sum: f64 = outline.iter().map(|corner| corner.y / 2.0).sum();
            assert!((90.0..=100.0 + 1e-9).contains(&sum), "{sum}");
        }
        assert_eq!(plots.distributions_within([-9.0, -8.0]).all_mm, None);
    }
}
