//! Jerk of the vehicle along a drive: where it starts, stops and turns sharply, its motion is less smooth than elsewhere.
//!
//! Third differences of the readings themselves show it, before a motion is estimated. One level of jerk for the whole drive would take the
//! readings of a sharp turn for outliers.

use std::sync::Arc;

use nalgebra::Vector3;

use super::readings::{Reading, STEPS_APART};
use crate::network::PerStation;
use crate::statistics::median;

/// Least time between the readings of a third difference (s): over shorter times it is noise alone.
const LEAST_STEP_S: f64 = 0.3;
/// The largest third difference within this time counts (s): a start or a stop is one impulse.
const HALF_WINDOW_S: f64 = 0.8;
/// Third differences of this many times their usual square are noise: the largest of five exceeds it once in eighty times.
const USUAL_TIMES: f64 = 6.0;
/// A third difference whose readings are further apart is one of a vehicle that moves (m).
const MOVING_M: f64 = 0.1;
/// Fewest third differences of a moving vehicle from which the usual square is taken.
const FEWEST_MOVING: usize = 10;
/// Most third differences from which the usual square is taken.
const MOST_USUAL: usize = 20_000;
/// Largest jerk (m/s³): wheels slip and masts bend, but a prism on a vehicle does not move more roughly.
const MOST_M_PER_S3: f64 = 3.0;
/// Median of the mean of two squared normal errors, and of one. Textbook: χ² with two degrees of freedom and with one.
const MEDIANS: JerkVariance = JerkVariance { horizontal: 0.693, vertical: 0.455 };

/// Variance of a jerk along horizontal axes and along the vertical one (m²/s⁶).
#[derive(Clone, Copy, Debug, Default)]
pub struct JerkVariance {
    pub horizontal: f64,
    pub vertical: f64,
}

/// Squared jerks beyond the usual ones along a drive.
#[derive(Clone, Debug, Default)]
pub struct ExcessJerk {
    by_station: PerStation<SquaredJerks>,
}

/// Squared jerks of one track. They are computed when they are needed: long drives have millions of readings.
#[derive(Clone, Debug)]
struct SquaredJerks {
    track: Arc<Vec<Reading>>,
    /// Readings from one of the four of a third difference to the next.
    stride: usize,
    /// Usual and longest time between them (s).
    step_s: f64,
    longest_s: f64,
    /// Usual squared jerk, by coordinate.
    usual: JerkVariance,
}

/// A third difference of the readings of a track.
struct SquaredJerk {
    /// Time of its middle (s).
    time_s: f64,
    square: JerkVariance,
    is_moving: bool,
}

impl ExcessJerk {
    pub fn new(tracks: &PerStation<Arc<Vec<Reading>>>) -> Self {
        Self { by_station: tracks.map(SquaredJerks::new) }
    }

    /// Returns the variance of the jerk at an instant (s) beyond the usual one, by coordinate, for knots this far apart (s).
    ///
    /// It is the median over stations: a single one may have outliers.
    pub fn variance(&self, time_s: f64, knot_s: f64) -> JerkVariance {
        let all: Vec<JerkVariance> =
            self.by_station.iter().filter_map(|jerks| jerks.excess(time_s, knot_s)).collect();
        let median = |of_one: fn(&JerkVariance) -> f64| {
            let mut excess: Vec<f64> = all.iter().map(of_one).collect();
            excess.sort_by(f64::total_cmp);
            let median = excess.get(excess.len().saturating_sub(1) / 2).copied();
            median.unwrap_or(0.0).min(MOST_M_PER_S3.powi(2))
        };
        JerkVariance { horizontal: median(|it| it.horizontal), vertical: median(|it| it.vertical) }
    }
}

impl SquaredJerks {
    fn new(track: &Arc<Vec<Reading>>) -> Self {
        let usual_s = median(track.windows(2).map(|both| both[1].time_s - both[0].time_s));
        let usual_s = usual_s.filter(|usual_s| *usual_s > 0.0).unwrap_or(LEAST_STEP_S);
        let stride = (LEAST_STEP_S / usual_s).ceil().max(1.0) as usize;
        let step_s = stride as f64 * usual_s;
        let longest_s = STEPS_APART * step_s;
        let usual = JerkVariance::default();
        let mut jerks = Self { track: Arc::clone(track), stride, step_s, longest_s, usual };
        let every = track.len().div_ceil(MOST_USUAL).max(1);
        let squares_of = |is_wanted: &dyn Fn(&SquaredJerk) -> bool| -> Vec<JerkVariance> {
            let some = (0..track.len()).step_by(every).filter_map(|first| jerks.at(first));
            some.filter(is_wanted).map(|jerk| jerk.square).collect()
        };
        let moving = squares_of(&|jerk| jerk.is_moving);
        let squares = if moving.len() < FEWEST_MOVING { squares_of(&|_| true) } else { moving };
        let usual = |of_one: fn(&JerkVariance) -> f64| {
            median(squares.iter().map(of_one)).unwrap_or(0.0) / of_one(&MEDIANS)
        };
        jerks.usual = JerkVariance {
            horizontal: usual(|it| it.horizontal),
            vertical: usual(|it| it.vertical),
        };
        jerks
    }

    /// The third difference from a reading on; `None` across a gap.
    fn at(&self, first: usize) -> Option<SquaredJerk> {
        let [a, b, c, d] = [0, 1, 2, 3].map(|k| self.track.get(first + k * self.stride));
        let four = [a?, b?, c?, d?];
        if four.windows(2).any(|both| both[1].time_s - both[0].time_s > self.longest_s) {
            return None;
        }
        Some(SquaredJerk {
            time_s: 0.5 * (four[0].time_s + four[3].time_s),
            square: {
                let jerk = third_derivative(four);
                JerkVariance {
                    horizontal: 0.5 * jerk.xy().norm_squared(),
                    vertical: jerk.z.powi(2),
                }
            },
            is_moving: (four[3].point_m - four[0].point_m).norm() > MOVING_M,
        })
    }

    /// Excess of the variance at an instant; `None` without readings.
    fn excess(&self, time_s: f64, knot_s: f64) -> Option<JerkVariance> {
        let earliest_s = time_s - HALF_WINDOW_S - 1.5 * self.longest_s;
        let first = self.track.partition_point(|reading| reading.time_s < earliest_s);
        let end = self.track.partition_point(|reading| reading.time_s <= time_s + HALF_WINDOW_S);
        let near = (first..end).filter_map(|first| self.at(first));
        let near = near.filter(|jerk| (jerk.time_s - time_s).abs() <= HALF_WINDOW_S);
        let near: Vec<JerkVariance> = near.map(|jerk| jerk.square).collect();
        let excess = |of_one: fn(&JerkVariance) -> f64| {
            let largest = near.iter().map(of_one).fold(0.0, f64::max);
            // A white jerk has the larger variance the shorter the time that it is averaged over.
            (largest - USUAL_TIMES * of_one(&self.usual)).max(0.0) * self.step_s / knot_s
        };
        (!near.is_empty()).then(|| JerkVariance {
            horizontal: excess(|it| it.horizontal),
            vertical: excess(|it| it.vertical),
        })
    }
}

/// Third derivative of the cubic through four readings (m/s³).
fn third_derivative(four: [&Reading; 4]) -> Vector3<f64> {
    let mut differences = four.map(|reading| reading.point_m);
    for order in 1..4 {
        for k in 0..4 - order {
            let apart_s = four[k + order].time_s - four[k].time_s;
            differences[k] = (differences[k + 1] - differences[k]) / apart_s;
        }
    }
    6.0 * differences[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A vehicle at 1 m/s that stops between 20 s and 30 s, read by a station at 2.5 Hz with errors of millimetres.
    fn track(outlier: Option<usize>) -> Vec<Reading> {
        let position_m = |time_s: f64| time_s.min(20.0) + (time_s - 30.0).max(0.0);
        let reading = |k: usize| {
            let time_s = 0.4 * k as f64;
            let noise_m = 1e-3 * (1.7 * k as f64).sin();
            let outlier_m = if outlier == Some(k) { 0.5 } else { 0.0 };
            let point_m = Vector3::new(position_m(time_s) + outlier_m, noise_m, -noise_m);
            Reading { time_s, point_m }
        };
        (0..150).map(reading).collect()
    }

    #[test]
    fn a_cubic_has_its_third_derivative() {
        let reading = |time_s: f64| Reading { time_s, point_m: Vector3::x() * time_s.powi(3) };
        let four = [0.0, 0.3, 0.7, 1.2].map(reading);
        assert!((third_derivative(four.each_ref()).x - 6.0).abs() < 1e-9);
    }

    #[test]
    fn stops_and_starts_exceed_the_rest_and_an_outlier_of_one_station_does_not() {
        let tracks = [track(None), track(None), track(Some(100))];
        let excess = ExcessJerk::new(&tracks.map(Arc::new).into());
        let jerk_m_per_s3 = |time_s: f64| excess.variance(time_s, 0.4).horizontal.sqrt();
        for time_s in [20.0, 30.0] {
            assert!(jerk_m_per_s3(time_s) > 0.5, "{time_s} s: {} m/s³", jerk_m_per_s3(time_s));
        }
        for time_s in [5.0, 15.0, 25.0, 35.0, 40.0, 55.0] {
            assert!(jerk_m_per_s3(time_s) < 0.05, "{time_s} s: {} m/s³", jerk_m_per_s3(time_s));
        }
    }
}
