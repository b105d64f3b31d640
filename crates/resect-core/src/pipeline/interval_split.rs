//! Module 2: time intervals in which all stations measured without a long gap.

use super::FilteredTrack;
use crate::network::PerStation;

/// A closed time interval (s).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    pub start_s: f64,
    pub end_s: f64,
}

impl Interval {
    pub fn length_s(&self) -> f64 {
        self.end_s - self.start_s
    }
}

/// Splits each station's track at gaps longer than τ_s, and intersects the intervals of all stations, in order.
pub fn split(tracks: &PerStation<FilteredTrack>, tau_s_seconds: f64) -> Vec<Interval> {
    let intervals = tracks.iter().map(|track| uninterrupted(track, tau_s_seconds));
    intervals.reduce(|common, own| intersect(&common, &own)).unwrap_or_default()
}

/// Returns one station's intervals without a gap longer than τ_s, in each of which it follows one prism.
pub fn uninterrupted(track: &FilteredTrack, tau_s_seconds: f64) -> Vec<Interval> {
    track
        .time_s
        .chunk_by(|a, b| b - a <= tau_s_seconds && !track.changes_prism(*a, *b))
        .map(|span| Interval { start_s: span[0], end_s: span[span.len() - 1] })
        .collect()
}

/// Intersects two ordered lists; intervals without length are dropped.
fn intersect(a: &[Interval], b: &[Interval]) -> Vec<Interval> {
    let (mut i, mut j) = (0, 0);
    let mut common = Vec::new();
    while i < a.len() && j < b.len() {
        let overlap =
            Interval { start_s: a[i].start_s.max(b[j].start_s), end_s: a[i].end_s.min(b[j].end_s) };
        if overlap.length_s() > 0.0 {
            common.push(overlap);
        }
        if a[i].end_s < b[j].end_s { i += 1 } else { j += 1 }
    }
    common
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn track(time_s: Vec<f64>) -> FilteredTrack {
        FilteredTrack { time_s, ..Default::default() }
    }

    #[test]
    fn a_gap_of_one_station_cuts_all() {
        let steady: Vec<f64> = (0..20).map(f64::from).collect();
        let with_gap: Vec<f64> = (0..8).chain(12..20).map(f64::from).collect();
        let late: Vec<f64> = (1..25).map(|t| f64::from(t) + 0.5).collect();
        let intervals = split(&[track(steady), track(with_gap), track(late)].into(), 1.0);
        let expected =
            [Interval { start_s: 1.5, end_s: 7.0 }, Interval { start_s: 12.0, end_s: 19.0 }];
        assert_eq!(intervals, expected);
    }

    proptest! {
        /// For any stamps, every interval lies inside an uninterrupted span of each station.
        #[test]
        fn intervals_hold_no_gap(gaps in proptest::array::uniform3(proptest::collection::vec(0.1..3.0f64, 1..60)), tau in 0.2..2.5f64) {
            let tracks: PerStation<FilteredTrack> = gaps.map(|gaps| track(gaps.iter().scan(0.0, |t, g| { *t += g; Some(*t) }).collect())).into();
            for interval in split(&tracks, tau) {
                prop_assert!(interval.length_s() > 0.0);
                for track in &tracks {
                    let inside = uninterrupted(track, tau).iter().any(|span| {
                        span.start_s <= interval.start_s && interval.end_s <= span.end_s
                    });
                    prop_assert!(inside);
                }
            }
        }
    }
}
