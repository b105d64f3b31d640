//! Gaussian process with a squared-exponential kernel, whose hyper-parameters are learned from the readings.
//!
//! Along each axis the prism moves on an unknown straight line at constant speed, plus a smooth deviation with covariance
//! `σ_f² exp(−Δt²/2ℓ²)`. Readings add white noise `σ_n²`. The line replaces the usual constant mean, with which `σ_f` would
//! grow as the vehicle drives away. It is integrated out under a flat prior, so its uncertainty is part of the result.
//!
//! `ℓ`, `σ_f` and `σ_n` maximise the marginal likelihood (Rasmussen & Williams 2006, eq. 5.8, with the gradient of eq. 5.9
//! and the explicit basis of section 2.7).

use nalgebra::{DMatrix, Vector2, Vector3};
use rayon::prelude::*;

use super::allowance::Allowance;
use super::dense::{self, Kernel};
use super::minimise;
use super::series::{
    AXIS_GROUPS, FEWEST_TO_LEARN_FROM, InterpolatedTrack, LEAST_NOISE_M, ReadingSeries, by_interval,
};
use crate::pipeline::{FilteredTrack, Interval};
use crate::progress::{Cancelled, Progress};

/// Number of readings in a chunk to learn from; the cost grows with its cube.
const CHUNK: usize = 64;
/// Largest number of readings for the shared first estimate, spread evenly over the station's intervals. Each interval is
/// then learned from all its readings, because a single sharp turn in a long drive is decisive.
const MOST_FOR_A_GUESS: usize = 4 * CHUNK;
/// Number of readings whose surroundings are predicted from one factorisation.
const CORE: usize = 64;
/// Number of readings beyond the core on either side: 13 s at the usual rate, some length scales of a vehicle's motion.
const MARGIN: usize = 32;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hyperparameters {
    pub length_scale_s: f64,
    /// Standard deviation of the prism's deviation from the straight line (m).
    pub signal_m: f64,
    pub noise_m: f64,
}

impl Hyperparameters {
    fn kernel(&self) -> Kernel {
        let noise_ratio = (self.noise_m / self.signal_m).powi(2);
        Kernel { length_scale_s: self.length_scale_s, noise_ratio }
    }

    /// Returns the coordinates of the search, `(ln ℓ, ln σ_n²/σ_f²)`.
    fn place(&self) -> Vector2<f64> {
        Vector2::new(self.length_scale_s.ln(), self.kernel().noise_ratio.ln())
    }
}

/// Hyper-parameters without an interval long enough to learn from, for a robot at walking pace and a good instrument.
const UNLEARNED: Hyperparameters =
    Hyperparameters { length_scale_s: 3.0, signal_m: 1.0, noise_m: 2e-3 };

/// Interpolates positions at sorted `instants`: their times (s), and the index of each one's interval.
pub fn at(
    track: &FilteredTrack,
    intervals: &[Interval],
    instants: (&[f64], &[u32]),
    progress: &Progress,
) -> Result<InterpolatedTrack, Cancelled> {
    let learned = learn(track, intervals, progress)?;
    by_interval(track, intervals, instants, |index, series, instants_s| {
        predict(series, &learned[index], instants_s, progress)
    })
}

/// Learns the hyper-parameters of the horizontal axes and of the vertical one, for each interval.
pub fn learn(
    track: &FilteredTrack,
    intervals: &[Interval],
    progress: &Progress,
) -> Result<Vec<[Hyperparameters; 2]>, Cancelled> {
    let series: Vec<_> =
        intervals.iter().map(|interval| ReadingSeries::new(track, interval)).collect();
    let shared = AXIS_GROUPS
        .map(|axes| Likelihood::new(&series, axes, MOST_FOR_A_GUESS).map(|l| l.learn_afresh()));
    let learn_own = |(own, [level, vertical]): (&ReadingSeries, [Allowance<'_>; 2])| {
        let of_group = |group: usize, allowance: Allowance<'_>| {
            let learned = match shared[group] {
                None => UNLEARNED,
                Some(shared) if own.len() < FEWEST_TO_LEARN_FROM => shared,
                Some(shared) => {
                    let own = std::slice::from_ref(own);
                    let likelihood = Likelihood::new(own, AXIS_GROUPS[group], usize::MAX);
                    let go_on = |readings| allowance.spend(readings);
                    likelihood.map_or(shared, |own| own.learn_from(&shared, &go_on))
                }
            };
            // Hyper-parameters from a cancelled search are discarded.
            allowance.end()?;
            Ok::<_, Cancelled>(learned)
        };
        Ok([of_group(0, level)?, of_group(1, vertical)?])
    };
    // All work is announced before the first search begins.
    let allowances: Vec<_> =
        series.iter().map(|own| [0, 1].map(|_| Allowance::new(progress, own.len()))).collect();
    series.par_iter().zip(allowances).map(learn_own).collect()
}

/// Positions along some axes relative to the first one, which limits rounding errors.
fn columns_m(positions_m: &[Vector3<f64>], axes: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(positions_m.len(), axes.len(), |i, j| {
        positions_m[i][axes[j]] - positions_m[0][axes[j]]
    })
}

/// Called with the number of readings evaluated next; returns true to continue.
type GoOn<'a> = dyn Fn(usize) -> bool + 'a;

/// Composite likelihood of chunks that share hyper-parameters; each chunk has a line of its own.
struct Likelihood {
    /// Times (s) and positions (m) of each chunk.
    chunks: Vec<(Vec<f64>, DMatrix<f64>)>,
    /// Degrees of freedom: coordinates of readings less those that determine the lines.
    freedom: f64,
    /// Lower and upper limits of `(ln ℓ, ln σ_n²/σ_f²)`.
    limits: (Vector2<f64>, Vector2<f64>),
}

impl Likelihood {
    /// `None` if no series has more readings than a line needs.
    fn new(series: &[ReadingSeries], axes: &[usize], most_readings: usize) -> Option<Self> {
        let mut chunks = Vec::new();
        for series in series {
            let parts = series.len().div_ceil(CHUNK);
            for part in 0..parts {
                let range = part * series.len() / parts..(part + 1) * series.len() / parts;
                if range.len() > 2 {
                    let positions_m = columns_m(&series.position_m[range.clone()], axes);
                    chunks.push((series.time_s[range].to_vec(), positions_m));
                }
            }
        }
        let readings: usize = chunks.iter().map(|(times_s, _)| times_s.len()).sum();
        let share = readings.div_ceil(most_readings);
        let chunks: Vec<_> = chunks.into_iter().skip(share / 2).step_by(share.max(1)).collect();
        let steps: usize = chunks.iter().map(|(times_s, _)| times_s.len() - 1).sum();
        let span_s: f64 =
            chunks.iter().map(|(times_s, _)| times_s[times_s.len() - 1] - times_s[0]).sum();
        // Motion with a shorter length scale than the interval between readings is indistinguishable from noise.
        let shortest_s = (span_s / steps as f64).max(0.2);
        (steps > 0).then(|| Self {
            freedom: ((steps - chunks.len()) * axes.len()) as f64,
            chunks,
            limits: (
                Vector2::new(shortest_s.ln(), 1e-11_f64.ln()),
                Vector2::new(200.0_f64.max(shortest_s).ln(), 1e3_f64.ln()),
            ),
        })
    }

    /// Searches from the best point of a coarse grid, because there may be several minima.
    fn learn_afresh(&self) -> Hyperparameters {
        let grid = [1.0, 3.0, 10.0, 30.0_f64].into_iter().flat_map(|length_scale_s| {
            [1e-8, 1e-5, 1e-2_f64].map(|ratio| Vector2::new(length_scale_s.ln(), ratio.ln()))
        });
        let start = minimise::least(grid, |place| self.evaluate(place, &|_| true).0);
        self.climb(start.unwrap_or_default(), &|_| true)
    }

    fn learn_from(&self, start: &Hyperparameters, go_on: &GoOn<'_>) -> Hyperparameters {
        self.climb(start.place(), go_on)
    }

    fn climb(&self, start: Vector2<f64>, go_on: &GoOn<'_>) -> Hyperparameters {
        let curvature = 0.5 * self.freedom;
        let look = |at: &Vector2<f64>| self.evaluate(at, go_on);
        let (best, signal_m2) = minimise::in_box(start, self.limits, curvature, look);
        Hyperparameters {
            length_scale_s: best.x.exp(),
            signal_m: signal_m2.sqrt(),
            noise_m: (signal_m2 * best.y.exp()).sqrt(),
        }
    }

    /// Returns the negative log-likelihood up to a constant, its gradient with respect to `(ln ℓ, ln σ_n²/σ_f²)`, and the
    /// best `σ_f²` (m²) for these. The result is meaningless if `go_on` stops it early.
    fn evaluate(&self, at: &Vector2<f64>, go_on: &GoOn<'_>) -> (f64, Vector2<f64>, f64) {
        let kernel = Kernel { length_scale_s: at.x.exp(), noise_ratio: at.y.exp() };
        // Sums of `yᵀ P y` and of the log-determinants.
        let least_m2 = self.freedom * LEAST_NOISE_M.powi(2) / kernel.noise_ratio;
        let (mut energy_m2, mut energy_slope) = (least_m2, Vector2::new(0.0, -least_m2));
        let (mut volume, mut volume_slope) = (0.0, Vector2::zeros());
        for (times_s, positions_m) in &self.chunks {
            if !go_on(times_s.len()) {
                break;
            }
            let axes = positions_m.ncols() as f64;
            let found = dense::evidence(times_s, positions_m, kernel);
            energy_m2 += found.energy_m2;
            energy_slope += found.energy_slope;
            volume += axes * found.volume;
            volume_slope += axes * found.volume_slope;
        }
        let value = 0.5 * (self.freedom * energy_m2.ln() + volume);
        let slope = 0.5 * (self.freedom / energy_m2 * energy_slope + volume_slope);
        (value, slope, energy_m2 / self.freedom)
    }
}

/// Predicts positions at sorted instants of one interval. Long intervals are predicted in windows with overlapping margins,
/// because readings many length scales away have almost no weight.
fn predict(
    series: &ReadingSeries,
    learned: &[Hyperparameters; 2],
    instants_s: &[f64],
    progress: &Progress,
) -> Result<InterpolatedTrack, Cancelled> {
    let mut estimate = InterpolatedTrack::default();
    let cores = if series.len() <= CORE + 2 * MARGIN { 1 } else { series.len().div_ceil(CORE) };
    let mut asked = 0;
    for core in 0..cores {
        progress.check()?;
        let (from, to) = (core * series.len() / cores, (core + 1) * series.len() / cores);
        let until_s = if to < series.len() { series.time_s[to] } else { f64::INFINITY };
        let until = instants_s.partition_point(|t| *t < until_s);
        let near = from.saturating_sub(MARGIN)..(to + MARGIN).min(series.len());
        let (times_s, near_m) = (&series.time_s[near.clone()], &series.position_m[near]);
        let [(level_m, level_sigma), (vertical_m, vertical_sigma)] = std::array::from_fn(|group| {
            let positions_m = columns_m(near_m, AXIS_GROUPS[group]);
            dense::predict(
                times_s,
                &positions_m,
                learned[group].kernel(),
                &instants_s[asked..until],
            )
        });
        for i in 0..until - asked {
            let moved_m = Vector3::new(level_m[(i, 0)], level_m[(i, 1)], vertical_m[(i, 0)]);
            let sigma = Vector3::new(level_sigma[i], level_sigma[i], vertical_sigma[i]);
            let [level, vertical] = learned.map(|learned| learned.signal_m);
            estimate.points_m.push(near_m[0] + moved_m);
            estimate.sigma_m.push(sigma.component_mul(&Vector3::new(level, level, vertical)));
        }
        asked = until;
    }
    Ok(estimate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::interpolation::tests::{dense_by_the_book, series_of, wander};

    #[test]
    fn the_gradient_is_that_of_the_likelihood() {
        let series = [series_of(&wander(50, 1)), series_of(&wander(30, 2))];
        for axes in AXIS_GROUPS {
            let likelihood = Likelihood::new(&series, axes, usize::MAX).expect("enough readings");
            for place in [Vector2::new(0.3, -4.0), Vector2::new(1.5, -11.0), Vector2::new(2.5, 1.0)]
            {
                let (_, slope, _) = likelihood.evaluate(&place, &|_| true);
                for i in 0..2 {
                    let step = Vector2::ith(i, 1e-4);
                    let [up, down] =
                        [place + step, place - step].map(|p| likelihood.evaluate(&p, &|_| true).0);
                    let by_difference = (up - down) / 2e-4;
                    assert!(
                        (slope[i] - by_difference).abs() < 1e-4 * (1.0 + by_difference.abs()),
                        "{} and {by_difference} at {place}",
                        slope[i]
                    );
                }
            }
        }
    }

    #[test]
    fn prediction_is_the_textbook_formula() {
        let series = series_of(&wander(40, 3));
        let learned = Hyperparameters { length_scale_s: 2.5, signal_m: 3.0, noise_m: 0.02 };
        let instants_s: Vec<_> = (0..60).map(|k| 0.25 * f64::from(k)).collect();
        let found = predict(&series, &[learned; 2], &instants_s, &Progress::default())
            .expect("nobody cancels it");
        let kernel = |a: f64, b: f64| {
            learned.signal_m.powi(2) * (-0.5 * ((a - b) / learned.length_scale_s).powi(2)).exp()
        };
        let (points_m, sigma_m) = dense_by_the_book(kernel, learned.noise_m, &series, &instants_s);
        for i in 0..instants_s.len() {
            assert!((found.points_m[i] - points_m[i]).norm() < 1e-8, "at {}", instants_s[i]);
            assert!((found.sigma_m[i].x / sigma_m[i] - 1.0).abs() < 1e-6, "at {}", instants_s[i]);
        }
    }

    #[test]
    fn windows_agree_with_one_factorisation() {
        let series = series_of(&wander(400, 4));
        let learned = Hyperparameters { length_scale_s: 3.0, signal_m: 3.0, noise_m: 0.002 };
        let instants_s: Vec<_> = (0..1600).map(|k| 0.1 * f64::from(k)).collect();
        let found = predict(&series, &[learned; 2], &instants_s, &Progress::default())
            .expect("nobody cancels it");
        let positions_m = columns_m(&series.position_m, &[0, 1]);
        let (moved_m, sigma) =
            dense::predict(&series.time_s, &positions_m, learned.kernel(), &instants_s);
        for i in 0..instants_s.len() {
            let off_m =
                (found.points_m[i] - series.position_m[0]).xy() - moved_m.row(i).transpose();
            let sigma_m = learned.signal_m * sigma[i];
            assert!(off_m.amax() < 0.25 * sigma_m, "{off_m} of {sigma_m} at {}", instants_s[i]);
            assert!((found.sigma_m[i].x / sigma_m - 1.0).abs() < 0.05, "at {}", instants_s[i]);
        }
    }

    #[test]
    fn no_other_place_explains_the_readings_much_better() {
        let abrupt = crate::pipeline::interpolation::tests::stop_and_go(2e-3);
        for track in [wander(200, 5), abrupt] {
            let likelihood =
                Likelihood::new(&[series_of(&track)], AXIS_GROUPS[0], usize::MAX).expect("enough");
            let found = likelihood.learn_afresh();
            let (least, ..) = likelihood.evaluate(&found.place(), &|_| true);
            for (i, j) in (0..15).flat_map(|i| (0..15).map(move |j| (i, j))) {
                let share = Vector2::new(f64::from(i), f64::from(j)) / 14.0;
                let (low, high) = likelihood.limits;
                let (value, ..) =
                    likelihood.evaluate(&(low + (high - low).component_mul(&share)), &|_| true);
                assert!(value > least - 0.1, "{value} and {least} at {share}");
            }
        }
    }
}
