//! Differences between a station's own clock and the synchronised time, computed once for each deployment by the worker.

use egui_plot::PlotPoint;

use super::pyramid::Pyramid;
use resect_core::deployment::station_clocks;
use resect_core::deployment::station_clocks::ClockComparison;
use resect_core::deployment::{TimeCorrection, Track};
use resect_core::statistics::median;

/// A station's own clock minus the synchronised time.
#[derive(Clone, Debug, Default)]
pub struct ClockSeries {
    /// The median (s), which is subtracted before drawing; `None` if no file contains the station's own clock.
    pub median_s: Option<f64>,
    /// Median, drift and steps; `None` with fewer than ten readings.
    pub comparison: Option<ClockComparison>,
    /// Differences at its readings: time since the first measurement of any station (s), and the difference minus the median (ms).
    pub readings: Dots,
    /// Differences by the recorded corrections, minus the same median (s, ms).
    pub corrections: Dots,
}

/// Dots of a plot in order of time.
#[derive(Clone, Debug, Default)]
pub struct Dots {
    pub all: Vec<PlotPoint>,
    pyramid: Pyramid,
    /// Least and greatest value (ms); `None` without dots.
    pub range_ms: Option<[f64; 2]>,
}

impl ClockSeries {
    pub fn of(track: &Track, corrections: &[TimeCorrection], start_s: f64) -> Self {
        let readings = track.measurements.iter().zip(&track.own_clock_s);
        let readings: Vec<[f64; 2]> = readings
            .map(|(reading, own_s)| [reading.time_s, own_s - reading.time_s])
            .filter(|[_, offset_s]| offset_s.is_finite())
            .collect();
        let corrections: Vec<[f64; 2]> =
            corrections.iter().map(|c| [c.time_s, c.offset_s]).collect();
        let comparison = station_clocks::compare(track);
        let compared_s = comparison.as_ref().map(|both| both.median_s);
        let median_s = compared_s
            .or_else(|| median_offset_s(&readings))
            .or_else(|| median_offset_s(&corrections));
        let dots = |offsets: &[[f64; 2]]| {
            Dots::of(offsets.iter().map(|[time_s, offset_s]| {
                let left_s = offset_s - median_s.unwrap_or(0.0);
                PlotPoint::new(time_s - start_s, left_s * 1e3)
            }))
        };
        let (readings, corrections) = (dots(&readings), dots(&corrections));
        Self { median_s, comparison, readings, corrections }
    }
}

impl Dots {
    fn of(dots: impl Iterator<Item = PlotPoint>) -> Self {
        let mut all: Vec<PlotPoint> = dots.collect();
        all.sort_unstable_by(|a, b| a.x.total_cmp(&b.x));
        let values: Vec<f64> = all.iter().map(|dot| dot.y).collect();
        let range_ms = values.iter().fold(None, |range: Option<[f64; 2]>, value| {
            let [low, high] = range.unwrap_or([*value; 2]);
            Some([low.min(*value), high.max(*value)])
        });
        Self { pyramid: Pyramid::of(&values), all, range_ms }
    }

    pub fn pyramid(&self) -> &Pyramid {
        &self.pyramid
    }

    /// Returns dots that represent those within a window (s since the first measurement).
    pub fn visible(&self, [from_s, to_s]: [f64; 2], runs: usize) -> Vec<PlotPoint> {
        let from = self.all.partition_point(|dot| dot.x < from_s);
        let to = self.all.partition_point(|dot| dot.x <= to_s).max(from);
        self.pyramid.visible(from..to, runs).into_iter().map(|index| self.all[index]).collect()
    }
}

fn median_offset_s(offsets: &[[f64; 2]]) -> Option<f64> {
    median(offsets.iter().map(|[_, offset_s]| *offset_s))
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::deployment::Measurement;

    #[test]
    fn the_median_is_taken_off_and_holes_are_left_out() {
        let reading =
            |time_s| Measurement { time_s, range_m: 9.0, azimuth_rad: 0.1, zenith_rad: 1.5 };
        let track = Track {
            measurements: [100.0, 101.0, 102.0, 103.0].map(reading).to_vec(),
            own_clock_s: vec![100.3, f64::NAN, 102.3, 103.304],
            ..Track::default()
        };
        let corrections = [TimeCorrection { time_s: 101.0, offset_s: 0.31 }];
        let series = ClockSeries::of(&track, &corrections, 100.0);
        assert!((series.median_s.expect("told") - 0.3).abs() < 1e-9);
        let readings: Vec<_> =
            series.readings.all.iter().map(|dot| (dot.x, dot.y.round())).collect();
        assert_eq!(readings, [(0.0, 0.0), (2.0, 0.0), (3.0, 4.0)]);
        assert!((series.corrections.all[0].y - 10.0).abs() < 1e-6);
        assert!(ClockSeries::of(&Track::default(), &[], 0.0).median_s.is_none());
    }
}
