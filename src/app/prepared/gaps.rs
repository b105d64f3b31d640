//! Gaps in the stations' readings, and the intervals between: computed once for each analysis by the worker.

use super::raw_readings::RawReadings;
use resect_core::analysis::Analysis;
use resect_core::network::PerStation;
use resect_core::pipeline::{FilteredTrack, Interval};

/// Gaps and intervals of a drive. Times are seconds since the first measurement of any station.
#[derive(Clone, Debug, Default)]
pub struct Gaps {
    /// Intervals of each station longer than τ_s without a reading that the outlier filter kept, also before its first and after its last.
    pub outages: PerStation<Vec<Interval>>,
    /// Times of each station's readings that the outlier filter rejected (s).
    pub rejected_s: PerStation<Vec<f64>>,
    /// Times of each station's readings that the user excluded (s).
    pub left_out_s: PerStation<Vec<f64>>,
    /// Spans in which all stations measured, in order: longer than τ_l, and shorter ones.
    pub kept: Vec<Interval>,
    pub short: Vec<Interval>,
    /// Lengths of each station's gaps between two readings that the filter kept.
    pub lengths: PerStation<LogHistogram>,
    /// Lengths of the spans, kept and short.
    pub interval_lengths: LogHistogram,
}

impl Gaps {
    pub fn of(analysis: &Analysis, readings: &RawReadings) -> Self {
        let (pipeline, settings) = (&analysis.pipeline, &analysis.settings.pipeline);
        let tau_s_seconds = settings.thresholds.tau_s_seconds;
        let shortest_s =
            if settings.interval_filter { settings.thresholds.tau_l_seconds } else { 0.0 };
        let since = |interval: &Interval| Interval {
            start_s: interval.start_s - readings.start_s,
            end_s: interval.end_s - readings.start_s,
        };
        let (kept, short): (Vec<Interval>, Vec<Interval>) =
            pipeline.intervals.iter().map(since).partition(|span| span.length_s() > shortest_s);
        let whole_s = [readings.start_s, readings.start_s + readings.length_s()];
        let filtered = &pipeline.filtered;
        Self {
            outages: filtered.map(|track| {
                let long = silences(track, whole_s).filter(|gap| gap.length_s() > tau_s_seconds);
                long.map(|gap| since(&gap)).collect()
            }),
            rejected_s: readings.stations.zip(filtered, |own, track| {
                let each = own.time_s.iter().zip(&track.rejected);
                each.filter(|(_, reason)| reason.is_some()).map(|(time_s, _)| *time_s).collect()
            }),
            left_out_s: readings.stations.map(|own| {
                let each = own.time_s.iter().zip(&own.left_out);
                each.filter(|(_, left_out)| **left_out).map(|(time_s, _)| *time_s).collect()
            }),
            kept,
            short,
            lengths: filtered.map(|track| {
                LogHistogram::of(track.time_s.windows(2).map(|pair| pair[1] - pair[0]))
            }),
            interval_lengths: LogHistogram::of(pipeline.intervals.iter().map(Interval::length_s)),
        }
    }
}

/// Returns the spans before, between and after the readings, in order; the whole drive for a station without readings.
fn silences(track: &FilteredTrack, [start_s, end_s]: [f64; 2]) -> impl Iterator<Item = Interval> {
    let before = std::iter::once(start_s).chain(track.time_s.iter().copied());
    let after = track.time_s.iter().copied().chain([end_s]);
    before.zip(after).map(|(start_s, end_s)| Interval { start_s, end_s })
}

/// Histogram in equal bins of the common logarithm.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LogHistogram {
    /// Index of the lowest bin; bin 0 begins at 1.
    first: i32,
    counts: Vec<usize>,
}

/// Bins per decade.
const BINS: f64 = 10.0;

impl LogHistogram {
    /// Returns the histogram of the positive values; ignores others.
    pub fn of(values: impl Iterator<Item = f64>) -> Self {
        let bins: Vec<i32> = values
            .filter(|value| *value > 0.0 && value.is_finite())
            .map(|value| (value.log10() * BINS).floor() as i32)
            .collect();
        let Some((low, high)) = bins.iter().min().zip(bins.iter().max()) else {
            return Self::default();
        };
        let mut counts = vec![0; (high - low) as usize + 1];
        for bin in &bins {
            counts[(bin - low) as usize] += 1;
        }
        Self { first: *low, counts }
    }

    /// Returns each non-empty bin: its ends (log10) and its count.
    pub fn bins(&self) -> impl Iterator<Item = ([f64; 2], usize)> {
        (self.first..)
            .zip(&self.counts)
            .filter(|(_, count)| **count > 0)
            .map(|(bin, count)| ([f64::from(bin) / BINS, f64::from(bin + 1) / BINS], *count))
    }
}

/// Merges sorted spans for drawing: a span and the following ones that end within `least_s` of its start become one. The run time
/// grows with the number of drawn spans, not of all spans.
pub fn visible(spans: &[Interval], window_s: [f64; 2], least_s: f64) -> Vec<Seen> {
    let mut at = spans.partition_point(|span| span.end_s < window_s[0]);
    let mut seen = Vec::new();
    while let Some(first) = spans.get(at).filter(|span| span.start_s <= window_s[1]) {
        let close_s = first.start_s + least_s;
        let next = first_from(spans, at + 1, |span| span.end_s <= close_s);
        let last = &spans[next - 1];
        let span = Interval { start_s: first.start_s, end_s: last.end_s };
        seen.push(Seen { span, count: next - at });
        at = next;
    }
    seen
}

/// Returns the first index at or after `from` whose item is not before. Exponential search: among a million sorted items the next
/// is usually near, and distant ones are not in the cache.
pub fn first_from<T>(items: &[T], from: usize, is_before: impl Fn(&T) -> bool) -> usize {
    let (mut low, mut step) = (from.min(items.len()), 1);
    while items.get(low + step).is_some_and(&is_before) {
        low += step;
        step *= 2;
    }
    let high = items.len().min(low + step + 1);
    low + items[low..high].partition_point(is_before)
}

/// A span, or several merged ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    pub span: Interval,
    pub count: usize,
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use resect_core::analysis::{Analyst, Settings};
    use resect_io::sample::Sample;

    #[test]
    fn every_moment_in_no_interval_has_a_silent_station() {
        let deployment = Arc::new(Sample::Hd2Tunnel.open().expect("built in"));
        let readings = RawReadings::of(&deployment);
        let mut settings = Settings::default();
        settings.pipeline.thresholds.tau_l_seconds = 12.0;
        let analysis = Analyst::new(Arc::clone(&deployment)).run(&settings);
        let gaps = Gaps::of(&analysis, &readings);
        assert_eq!(gaps.kept.len(), analysis.pipeline.kept_intervals.len());
        assert_eq!(gaps.kept.len() + gaps.short.len(), analysis.pipeline.intervals.len());
        assert!(gaps.outages.iter().any(|outages| !outages.is_empty()));
        let holds =
            |spans: &[Interval], t: f64| spans.iter().any(|s| s.start_s <= t && t <= s.end_s);
        // Not within τ_s of the ends, where a station may start late.
        for step in 0..2000 {
            let t = 1.0 + (readings.length_s() - 2.0) * f64::from(step) / 2000.0;
            let common = holds(&gaps.kept, t) || holds(&gaps.short, t);
            let silent = gaps.outages.iter().any(|outages| holds(outages, t));
            assert!(common || silent, "{t}");
        }
        let rejected =
            |station: usize| analysis.pipeline.filtered[station].rejected.iter().flatten().count();
        assert!((0..3).all(|station| gaps.rejected_s[station].len() == rejected(station)));
    }

    #[test]
    fn spans_that_cannot_be_told_apart_are_drawn_as_one() {
        let many: Vec<Interval> = (0..100_000)
            .map(|i| Interval { start_s: f64::from(i) * 0.01, end_s: f64::from(i) * 0.01 + 0.005 })
            .collect();
        let seen = visible(&many, [200.0, 700.0], 1.0);
        assert!(seen.len() <= 502, "{}", seen.len());
        let counted: usize = seen.iter().map(|seen| seen.count).sum();
        assert!((counted as i64 - 50_000).abs() <= 100, "{counted}");
        assert!(seen.windows(2).all(|pair| pair[0].span.end_s < pair[1].span.start_s));
        let close = visible(&many, [200.0, 200.1], 1e-4);
        assert!(close.iter().all(|seen| seen.count == 1) && close.len() >= 10);
    }

    #[test]
    fn the_first_from_an_index_is_the_first_of_all() {
        let times_s: Vec<f64> = (0..100).map(|i| f64::from(i) * 0.4).collect();
        for wanted in [-1.0, 0.0, 0.3, 7.9, 8.0, 39.6, 50.0] {
            let expected = times_s.partition_point(|t| *t < wanted);
            for from in 0..=expected {
                let found = first_from(&times_s, from, |t| *t < wanted);
                assert_eq!(found, expected, "{wanted} from {from}");
            }
        }
        assert_eq!(first_from(&[], 0, |_: &f64| true), 0);
        assert_eq!(first_from(&[1.0], 1, |t| *t < 9.0), 1);
    }

    #[test]
    fn a_histogram_counts_everything_once() {
        let values = [0.1, 0.4, 0.41, 3.0, 900.0, 0.0, -1.0];
        let histogram = LogHistogram::of(values.into_iter());
        assert_eq!(histogram.bins().map(|(_, count)| count).sum::<usize>(), 5);
        for ([low, high], count) in histogram.bins() {
            let inside = values.iter().filter(|v| **v > 0.0 && (low..high).contains(&v.log10()));
            assert_eq!(inside.count(), count);
        }
        assert_eq!(LogHistogram::of(std::iter::empty()).bins().count(), 0);
    }
}
