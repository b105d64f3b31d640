//! Gaussian process with white noise on acceleration: the motion model of continuous-time estimation.
//!
//! Along each axis the state is position and velocity, driven by white acceleration of power spectral density `q_c`.
//! Readings add white noise `σ_n²`. The process is Markov, so a Kalman filter and a Rauch–Tung–Striebel smoother give its
//! exact posterior (Barfoot, Tong & Särkkä 2014; Särkkä 2013, ch. 8). One forward and one backward pass cover readings and
//! the instants between them. `q_c` and `σ_n` maximise the marginal likelihood, which follows from the filter's innovations
//! (Särkkä 2013, ch. 12).
//!
//! Readings at 2.5 Hz of a vehicle that turns smoothly hardly determine `σ_n`: the acceleration of the turn, modelled as
//! white, hides the noise. The position at a reading is then the reading, and its standard deviation is too small.

use nalgebra::{Matrix2, RowVector2, SMatrix, Vector2, Vector3};
use rayon::prelude::*;

use super::allowance::Allowance;
use super::minimise;
use super::series::{
    FEWEST_TO_LEARN_FROM, InterpolatedTrack, LEAST_NOISE_M, ReadingSeries, by_interval,
};
use crate::pipeline::{FilteredTrack, Interval};
use crate::progress::{Cancelled, Progress};

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionModelHyperparameters {
    pub density_m2_per_s3: f64,
    pub noise_m: f64,
}

/// Hyper-parameters without an interval long enough to learn from, for a robot at walking pace and a good instrument.
const UNLEARNED: MotionModelHyperparameters =
    MotionModelHyperparameters { density_m2_per_s3: 0.1, noise_m: 2e-3 };

/// Interpolates positions at sorted `instants`: their times (s), and the index of each one's interval.
pub fn at(
    track: &FilteredTrack,
    intervals: &[Interval],
    instants: (&[f64], &[u32]),
    progress: &Progress,
) -> Result<InterpolatedTrack, Cancelled> {
    let learned = learn(track, intervals, progress)?;
    by_interval(track, intervals, instants, |index, series, instants_s| {
        progress.check()?;
        Ok(predict(series, &learned[index], instants_s))
    })
}

/// Learns the hyper-parameters of the horizontal axes and of the vertical one, for each interval.
pub fn learn(
    track: &FilteredTrack,
    intervals: &[Interval],
    progress: &Progress,
) -> Result<Vec<[MotionModelHyperparameters; 2]>, Cancelled> {
    let series: Vec<_> =
        intervals.iter().map(|interval| ReadingSeries::new(track, interval)).collect();
    // Work for both groups of axes; all of it is announced before the first search begins.
    let allow = |series: &[ReadingSeries]| Allowance::new(progress, 2 * readings(series));
    let of_all = allow(&series);
    let of_each: Vec<_> = series.iter().map(|own| allow(std::slice::from_ref(own))).collect();
    let shared = learn_together(&series, of_all)?.unwrap_or([UNLEARNED; 2]);
    let alone = |(own, allowance): (&ReadingSeries, Allowance<'_>)| {
        let own = Some(own).filter(|own| own.len() >= FEWEST_TO_LEARN_FROM);
        let own = own.map_or(&[][..], std::slice::from_ref);
        Ok(learn_together(own, allowance)?.unwrap_or(shared))
    };
    series.par_iter().zip(of_each).map(alone).collect()
}

fn readings(series: &[ReadingSeries]) -> usize {
    series.iter().map(ReadingSeries::len).sum()
}

/// Learns shared hyper-parameters; `None` if no series has more readings than a line needs.
fn learn_together(
    series: &[ReadingSeries],
    allowance: Allowance<'_>,
) -> Result<Option<[MotionModelHyperparameters; 2]>, Cancelled> {
    let spare = series.iter().any(|series| series.len() > 2);
    let learned = spare
        .then(|| [learn_axes(series, [0, 1], &allowance), learn_axes(series, [2], &allowance)]);
    // Hyper-parameters from a cancelled search are discarded.
    allowance.end()?;
    Ok(learned)
}

fn learn_axes<const A: usize>(
    series: &[ReadingSeries],
    axes: [usize; A],
    allowance: &Allowance<'_>,
) -> MotionModelHyperparameters {
    // From process noise too small to show within a minute, to process noise with which each reading determines its
    // position alone.
    let (low, high) = (1e-8_f64.ln(), 1e8_f64.ln());
    let look = |ln: f64| match allowance.spend(readings(series)) {
        true => likelihood(series, axes, ln.exp()).0,
        false => 0.0,
    };
    let best = minimise::on_line(low, high, 17, look).exp();
    let (_, noise_m2) = likelihood(series, axes, best);
    MotionModelHyperparameters { density_m2_per_s3: best * noise_m2, noise_m: noise_m2.sqrt() }
}

/// Returns the negative log-likelihood up to a constant, and the best `σ_n²` (m²) for this `q_c/σ_n²` (1/s³). The first two
/// readings of a series only determine the initial line.
fn likelihood<const A: usize>(
    series: &[ReadingSeries],
    axes: [usize; A],
    ratio: f64,
) -> (f64, f64) {
    let (mut energy_m2, mut volume, mut freedom) = (0.0, 0.0, 0.0);
    for series in series.iter().filter(|series| series.len() > 2) {
        let mut belief = Belief::of_two(series, axes, ratio);
        for index in 2..series.len() {
            belief = belief.after(series.time_s[index] - series.time_s[index - 1], ratio);
            let (surprise_m, spread) = belief.read(coordinates_m(series, index, axes));
            energy_m2 += surprise_m.norm_squared() / spread;
            volume += A as f64 * spread.ln();
            freedom += A as f64;
        }
    }
    let noise_m2 = energy_m2 / freedom + LEAST_NOISE_M.powi(2);
    (0.5 * (freedom * noise_m2.ln() + volume), noise_m2)
}

fn coordinates_m<const A: usize>(
    series: &ReadingSeries,
    index: usize,
    axes: [usize; A],
) -> SMatrix<f64, 1, A> {
    SMatrix::from_fn(|_, j| series.position_m[index][axes[j]])
}

/// Position (m) and velocity (m/s) along some axes, one column each, and their common covariance in units of `σ_n²`.
#[derive(Clone, Copy)]
struct Belief<const A: usize> {
    mean: SMatrix<f64, 2, A>,
    covariance: Matrix2<f64>,
}

impl<const A: usize> Belief<A> {
    /// Returns the state at the second reading, given the first two readings and a flat prior.
    fn of_two(series: &ReadingSeries, axes: [usize; A], ratio: f64) -> Self {
        let elapsed_s = series.time_s[1] - series.time_s[0];
        let [first_m, second_m] = [0, 1].map(|index| coordinates_m(series, index, axes));
        let mut mean = SMatrix::<f64, 2, A>::zeros();
        mean.set_row(0, &second_m);
        mean.set_row(1, &((second_m - first_m) / elapsed_s));
        let velocity = (2.0 + drift(elapsed_s, ratio).m11) / elapsed_s.powi(2);
        let covariance = Matrix2::new(1.0, 1.0 / elapsed_s, 1.0 / elapsed_s, velocity);
        Self { mean, covariance }
    }

    fn after(&self, elapsed_s: f64, ratio: f64) -> Self {
        let motion = motion(elapsed_s);
        Self {
            mean: motion * self.mean,
            covariance: motion * self.covariance * motion.transpose() + drift(elapsed_s, ratio),
        }
    }

    /// Updates the state with a reading; returns the innovation (m) and its variance in units of `σ_n²`.
    fn read(&mut self, position_m: SMatrix<f64, 1, A>) -> (SMatrix<f64, 1, A>, f64) {
        let surprise_m = position_m - self.mean.row(0);
        let spread = self.covariance.m11 + 1.0;
        let gain: Vector2<f64> = self.covariance.column(0) / spread;
        self.mean += gain * surprise_m;
        self.covariance -= gain * gain.transpose() * spread;
        (surprise_m, spread)
    }

    /// Returns the smoothed state, from this filtered state and the smoothed one some time later.
    fn in_hindsight(&self, elapsed_s: f64, ratio: f64, later: &Self) -> Self {
        let ahead = self.after(elapsed_s, ratio);
        let Some(inverse) = ahead.covariance.try_inverse() else { return *self };
        let gain = self.covariance * motion(elapsed_s).transpose() * inverse;
        Self {
            mean: self.mean + gain * (later.mean - ahead.mean),
            covariance: self.covariance
                + gain * (later.covariance - ahead.covariance) * gain.transpose(),
        }
    }

    /// Returns the smoothed state before the second reading's instant, from the smoothed state at it. The filter starts at
    /// the second reading. Given the state there, only the first reading adds information, and the motion can run
    /// backwards.
    fn before_second(
        &self,
        series: &ReadingSeries,
        axes: [usize; A],
        time_s: f64,
        ratio: f64,
    ) -> Self {
        let back_s = time_s - series.time_s[1];
        let since_first_s = time_s - series.time_s[0];
        let drift_back = -drift(back_s, ratio);
        let first_seen = RowVector2::new(1.0, -since_first_s);
        let spread = 1.0
            + drift(since_first_s.abs(), ratio).m11
            + (first_seen * drift_back * first_seen.transpose()).x;
        let gain = drift_back * first_seen.transpose() / spread;
        let kept = Matrix2::identity() - gain * first_seen;
        let carried = kept * motion(back_s);
        Self {
            mean: carried * self.mean + gain * coordinates_m(series, 0, axes),
            covariance: carried * self.covariance * carried.transpose() + kept * drift_back,
        }
    }
}

/// Transition matrix without acceleration.
fn motion(elapsed_s: f64) -> Matrix2<f64> {
    Matrix2::new(1.0, elapsed_s, 0.0, 1.0)
}

/// Process noise covariance of white acceleration, in units of `σ_n²`.
fn drift(elapsed_s: f64, ratio: f64) -> Matrix2<f64> {
    let square = elapsed_s.powi(2);
    ratio * Matrix2::new(square * elapsed_s / 3.0, square / 2.0, square / 2.0, elapsed_s)
}

/// Predicts positions at sorted instants of one interval.
fn predict(
    series: &ReadingSeries,
    [level, vertical]: &[MotionModelHyperparameters; 2],
    instants_s: &[f64],
) -> InterpolatedTrack {
    let mut estimate = InterpolatedTrack::default();
    let in_plane = smooth(series, [0, 1], level, instants_s);
    let in_height = smooth(series, [2], vertical, instants_s);
    // Lower bound of the variance: weights that sum to one cannot average the noise further, but rounding could.
    let least = 1.0 / series.len() as f64;
    for (xy, z) in in_plane.iter().zip(&in_height) {
        let level_m = level.noise_m * xy.covariance.m11.max(least).sqrt();
        let vertical_m = vertical.noise_m * z.covariance.m11.max(least).sqrt();
        estimate.points_m.push(Vector3::new(xy.mean[(0, 0)], xy.mean[(0, 1)], z.mean[(0, 0)]));
        estimate.sigma_m.push(Vector3::new(level_m, level_m, vertical_m));
    }
    estimate
}

/// Returns the smoothed state at each instant, by one forward and one backward pass over readings and instants together.
fn smooth<const A: usize>(
    series: &ReadingSeries,
    axes: [usize; A],
    learned: &MotionModelHyperparameters,
    instants_s: &[f64],
) -> Vec<Belief<A>> {
    let ratio = learned.density_m2_per_s3 / learned.noise_m.powi(2);
    if series.len() == 1 {
        // The speed is unknown; zero is the best estimate.
        let mut mean = SMatrix::<f64, 2, A>::zeros();
        mean.set_row(0, &coordinates_m(series, 0, axes));
        return vec![Belief { mean, covariance: Matrix2::identity() }; instants_s.len()];
    }
    let (early_s, instants_s) =
        instants_s.split_at(instants_s.partition_point(|t| *t < series.time_s[1]));
    let readings = (2..series.len()).map(|index| (series.time_s[index], Some(index)));
    let mut stops: Vec<_> = readings.chain(instants_s.iter().map(|t| (*t, None))).collect();
    stops.sort_by(|a, b| a.0.total_cmp(&b.0));

    let (mut now_s, mut belief) = (series.time_s[1], Belief::of_two(series, axes, ratio));
    let mut filtered = vec![(now_s, false, belief)];
    for (time_s, reading) in stops {
        belief = belief.after(time_s - now_s, ratio);
        now_s = time_s;
        if let Some(index) = reading {
            belief.read(coordinates_m(series, index, axes));
        }
        filtered.push((time_s, reading.is_none(), belief));
    }
    let mut latest_first = Vec::with_capacity(early_s.len() + instants_s.len());
    for (time_s, is_asked, before) in filtered.iter().rev() {
        belief = before.in_hindsight(now_s - time_s, ratio, &belief);
        now_s = *time_s;
        if *is_asked {
            latest_first.push(belief);
        }
    }
    let early = early_s.iter().rev();
    latest_first.extend(early.map(|t| belief.before_second(series, axes, *t, ratio)));
    latest_first.reverse();
    latest_first
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::interpolation::tests::{dense_by_the_book, series_of, wander};

    #[test]
    fn smoothing_is_the_textbook_formula_with_the_integrated_wiener_kernel() {
        let series = series_of(&wander(40, 3));
        let learned = MotionModelHyperparameters { density_m2_per_s3: 0.3, noise_m: 0.02 };
        let mut instants_s: Vec<_> = (0..60).map(|k| 0.25 * f64::from(k)).collect();
        instants_s.extend(&series.time_s);
        instants_s.sort_by(f64::total_cmp);
        let found = predict(&series, &[learned; 2], &instants_s);
        let kernel = |a: f64, b: f64| {
            let shorter = a.min(b);
            learned.density_m2_per_s3 * shorter.powi(2) * (shorter / 3.0 + (a - b).abs() / 2.0)
        };
        let (points_m, sigma_m) = dense_by_the_book(kernel, learned.noise_m, &series, &instants_s);
        for i in 0..instants_s.len() {
            assert!((found.points_m[i] - points_m[i]).norm() < 1e-9, "at {}", instants_s[i]);
            assert!((found.sigma_m[i].x / sigma_m[i] - 1.0).abs() < 1e-8, "at {}", instants_s[i]);
        }
    }

    /// The likelihood from innovations differs from the dense one by the same constant for any ratio.
    #[test]
    fn innovations_give_the_dense_likelihood() {
        use nalgebra::{Cholesky, DMatrix};
        let series = [series_of(&wander(30, 5))];
        let times_s = &series[0].time_s;
        let line = DMatrix::from_fn(30, 2, |i, j| times_s[i].powi(j as i32));
        let z_m = DMatrix::from_fn(30, 1, |i, _| series[0].position_m[i].z);
        let offsets = [1e-3, 1.0, 1e3, 1e6].map(|ratio| {
            let kernel = DMatrix::from_fn(30, 30, |i, j| {
                let shorter = times_s[i].min(times_s[j]);
                let apart = (times_s[i] - times_s[j]).abs();
                let noise = if i == j { 1.0 } else { 0.0 };
                ratio * shorter.powi(2) * (shorter / 3.0 + apart / 2.0) + noise
            });
            let factor = Cholesky::new(kernel).expect("positive");
            let seen = Cholesky::new(line.tr_mul(&factor.solve(&line))).expect("positive");
            let rest_m = &z_m - &line * seen.solve(&line.tr_mul(&factor.solve(&z_m)));
            let noise_m2 = rest_m.dot(&factor.solve(&rest_m)) / 28.0 + LEAST_NOISE_M.powi(2);
            let volume = factor.ln_determinant() + seen.ln_determinant();
            let (value, found_m2) = likelihood(&series, [2], ratio);
            assert!((found_m2 / noise_m2 - 1.0).abs() < 1e-4, "{found_m2} and {noise_m2}");
            value - 0.5 * (28.0 * noise_m2.ln() + volume)
        });
        assert!(offsets.iter().all(|o| (o - offsets[0]).abs() < 1e-3), "{offsets:?}");
    }
}
