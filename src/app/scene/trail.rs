//! The trail: the recent segment of each prism's path up to the time cursor.

use std::ops::Range;

use crate::app::prepared::Cloud;
use resect_core::network::{Number, PerStation};

/// Segment of the tracks that is drawn a second time, wider and fading into the past.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trail {
    /// Start and end (s, in the time of the points).
    pub span_s: [f32; 2],
    /// Range of the trail's points in each station's track; empty if it is not drawn.
    pub ranges: PerStation<Range<usize>>,
}

impl Trail {
    /// Returns the trail up to a time (s, in the time of the points), by binary search in the tracks.
    pub fn behind(time_s: f64, length_s: u32, tracks: &Cloud, drawn: &PerStation<bool>) -> Self {
        let span_s = [time_s - f64::from(length_s), time_s].map(|t| t as f32);
        let ranges = drawn.map_each(|station, drawn| match drawn {
            true => tracks.along(station.index(), span_s),
            false => 0..0,
        });
        Self { span_s, ranges }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;
    use resect_core::pipeline::Triplets;

    /// A minute of triplets, two a second, and another minute of them after a gap of a minute.
    fn tracks() -> Cloud {
        let time_s: Vec<f64> = (0..=120).chain(240..=360).map(|i| 0.5 * f64::from(i)).collect();
        let points_m = [0.0; 3].map(|_| vec![Vector3::zeros(); time_s.len()]);
        let interval = time_s.iter().map(|t| u32::from(*t > 60.0)).collect();
        Cloud::of_triplets(&Triplets::new(time_s, interval, points_m), 0.0)
    }

    /// Returns the times of each trail's points (s).
    fn times_s(trail: &Trail) -> PerStation<Vec<f32>> {
        let points = tracks().points;
        trail.ranges.map(|range| points[range.clone()].iter().map(|p| p.time_s).collect())
    }

    #[test]
    fn it_reaches_back_so_many_seconds_and_not_beyond_the_cursor() {
        // At triplets, and between two: the line is cut at the end of the span.
        for (cursor_s, from_s, to_s) in [(30.0, 20.0, 30.0), (30.2, 20.0, 30.5), (4.0, 0.0, 4.0)] {
            let trail = Trail::behind(cursor_s, 10, &tracks(), &[true; 3].into());
            assert_eq!(trail.span_s, [cursor_s - 10.0, cursor_s].map(|t| t as f32));
            for of_prism in times_s(&trail) {
                assert_eq!((of_prism[0], of_prism[of_prism.len() - 1]), (from_s, to_s));
                assert_eq!(of_prism.len(), (2.0 * (to_s - from_s)) as usize + 1);
            }
        }
    }

    #[test]
    fn in_a_gap_it_runs_out_and_before_the_start_there_is_none() {
        let left = |cursor_s: f64| {
            let trail = Trail::behind(cursor_s, 10, &tracks(), &[true; 3].into());
            let [from_s, to_s] = trail.span_s;
            times_s(&trail)[0].iter().filter(|t| (from_s..=to_s).contains(*t)).count()
        };
        assert_eq!([left(60.0), left(65.0), left(75.0), left(-20.0)], [21, 11, 0, 0]);
    }

    #[test]
    fn what_is_not_drawn_leaves_none() {
        let trail = Trail::behind(30.2, 10, &tracks(), &[true, false, true].into());
        assert_eq!(times_s(&trail).map(Vec::len).as_slice(), [22, 0, 22]);
        let empty = Trail::behind(30.2, 10, &Cloud::default(), &PerStation::default());
        assert!(empty.ranges.is_empty());
    }
}
