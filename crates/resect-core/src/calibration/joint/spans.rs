//! The spans of a drive in which the same prisms are followed.

use super::readings::DriveReadings;
use super::state_vector::Layout;

/// Longest time without a reading of a prism that its motion is estimated through (s). The readings of the other prisms and the rig's
/// distances determine it there, as far as they do.
const LONGEST_GAP_S: f64 = 2.0;
/// Fewest readings of a prism in a row. Textbook: a motion with acceleration has three unknowns by coordinate.
const FEWEST_READINGS: usize = 3;

/// A span of time in which the same prisms are followed.
#[derive(Clone, Debug, PartialEq)]
pub struct Span {
    pub start_s: f64,
    pub end_s: f64,
    /// Their places among the prisms of the drive, in order.
    pub prisms: Vec<usize>,
}

impl Span {
    fn length_s(&self) -> f64 {
        self.end_s - self.start_s
    }
}

/// Returns the spans of a drive in order of time. One that is not as long as `shortest_s` is added to the span beside it that follows most
/// prisms, or left out without one.
pub fn spans(layout: &Layout, readings: &DriveReadings, shortest_s: f64) -> Vec<Span> {
    let times_s: Vec<Vec<f64>> =
        (0..layout.prisms()).map(|place| times_s(layout, readings, place)).collect();
    let followed_s: Vec<Vec<[f64; 2]>> =
        times_s.iter().map(|times_s| followed_s(times_s, &readings.restarts_s)).collect();
    // From an instant on, or after it.
    let begins_s = followed_s.iter().flatten().map(|[start_s, _]| *start_s);
    let ends_s = followed_s.iter().flatten().map(|[_, end_s]| end_s.next_up());
    let mut cuts_s: Vec<f64> = begins_s.chain(ends_s).chain(layout.prism_changes_s()).collect();
    cuts_s.sort_by(f64::total_cmp);
    cuts_s.dedup();
    let span = |cut: &[f64]| {
        let (start_s, end_s) = (cut[0], cut[1].next_down());
        let is_followed = |place: &usize| {
            let spans_s = &followed_s[*place];
            let index = spans_s.partition_point(|[_, end_s]| *end_s < start_s);
            spans_s.get(index).is_some_and(|[from_s, _]| *from_s <= start_s)
        };
        let prisms: Vec<usize> = (0..followed_s.len()).filter(is_followed).collect();
        (!prisms.is_empty()).then_some(Span { start_s, end_s, prisms })
    };
    let mut spans: Vec<Span> = cuts_s.windows(2).filter_map(span).collect();
    while let Some(short) = spans.iter().position(|span| span.length_s() < shortest_s) {
        merge(layout, &mut spans, short);
    }
    for Span { start_s, end_s, prisms } in &mut spans {
        prisms.retain(|place| {
            let from = times_s[*place].partition_point(|time_s| time_s < start_s);
            let to = times_s[*place].partition_point(|time_s| time_s <= end_s);
            to - from >= FEWEST_READINGS
        });
    }
    spans.retain(|span| !span.prisms.is_empty());
    spans
}

/// Adds a span to the one beside it that follows most prisms; removes it without one.
fn merge(layout: &Layout, spans: &mut Vec<Span>, index: usize) {
    let short = spans.remove(index);
    let is_same_drive =
        |other_s: f64| layout.followed_at(other_s) == layout.followed_at(short.start_s);
    let before = index.checked_sub(1).filter(|before| {
        spans[*before].end_s.next_up() >= short.start_s && is_same_drive(spans[*before].start_s)
    });
    let after = Some(index).filter(|after| {
        let is_next = |next: &Span| short.end_s.next_up() >= next.start_s;
        spans.get(*after).is_some_and(|next| is_next(next) && is_same_drive(next.start_s))
    });
    let beside = before.into_iter().chain(after).max_by_key(|beside| spans[*beside].prisms.len());
    match beside {
        Some(beside) if beside < index => spans[beside].end_s = short.end_s,
        Some(beside) => spans[beside].start_s = short.start_s,
        None => {}
    }
}

/// Returns the times of the readings of a prism (s), by its place among the prisms of the drive.
fn times_s(layout: &Layout, readings: &DriveReadings, place: usize) -> Vec<f64> {
    let mut times_s: Vec<f64> = Vec::new();
    for (station, track) in readings.tracks.each() {
        let follows = |time_s: &f64| layout.place_of(layout.followed_at(*time_s)[station]) == place;
        times_s.extend(track.iter().map(|reading| reading.time_s).filter(follows));
    }
    times_s.sort_by(f64::total_cmp);
    times_s
}

/// Returns the spans without a long gap between readings (s).
fn followed_s(times_s: &[f64], restarts_s: &[f64]) -> Vec<[f64; 2]> {
    let is_unbroken = |before_s: &f64, after_s: &f64| {
        let restarts = |restart_s: &f64| before_s < restart_s && restart_s <= after_s;
        after_s - before_s <= LONGEST_GAP_S && !restarts_s.iter().any(restarts)
    };
    let unbroken = times_s.chunk_by(is_unbroken).filter(|times_s| times_s.len() >= FEWEST_READINGS);
    unbroken.map(|times_s| [times_s[0], times_s[times_s.len() - 1]]).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use nalgebra::Vector3;

    use super::super::readings::Reading;
    use super::super::state_vector::tests::layout;
    use super::*;

    /// Readings of stations at 2 Hz during some spans (s).
    fn readings(spans_s: [&[[f64; 2]]; 3]) -> DriveReadings {
        let reading = |time_s: f64| Reading { time_s, point_m: Vector3::x() };
        let of_span = |[from_s, to_s]: &[f64; 2]| {
            let (from_s, steps) = (*from_s, ((to_s - from_s) / 0.5) as usize);
            (0..=steps).map(move |k| reading(from_s + 0.5 * k as f64)).collect::<Vec<_>>()
        };
        let track = |spans_s: &[[f64; 2]]| Arc::new(spans_s.iter().flat_map(of_span).collect());
        let tracks = spans_s.map(track).into();
        DriveReadings { tracks, restarts_s: Vec::new() }
    }

    fn found(readings: &DriveReadings) -> Vec<(f64, f64, Vec<usize>)> {
        let spans = spans(&layout(3), readings, 2.0);
        let rounded = |time_s: f64| (1e3 * time_s).round() / 1e3;
        let all = spans.into_iter();
        all.map(|span| (rounded(span.start_s), rounded(span.end_s), span.prisms)).collect()
    }

    #[test]
    fn a_long_gap_of_one_station_leaves_the_others() {
        let both = [[0.0, 20.0], [30.0, 50.0]];
        let spans = found(&readings([&[[0.0, 50.0]], &both, &[[0.0, 50.0]]]));
        let all = vec![0, 1, 2];
        assert_eq!(spans, [(0.0, 20.0, all.clone()), (20.0, 30.0, vec![0, 2]), (30.0, 50.0, all)]);
    }

    #[test]
    fn short_gaps_are_bridged_and_short_spans_belong_to_those_beside_them() {
        // 1.5 s without station 2, and station 3 ends a second after all others.
        let with_gap = [[0.0, 20.0], [21.5, 40.0]];
        let spans = found(&readings([&[[0.0, 40.0]], &with_gap, &[[0.0, 41.0]]]));
        assert_eq!(spans, [(0.0, 41.0, vec![0, 1, 2])]);
    }

    #[test]
    fn a_station_alone_has_spans_of_its_own() {
        let spans = found(&readings([&[[0.0, 10.0]], &[[20.0, 20.5]], &[[40.0, 45.0]]]));
        assert_eq!(spans, [(0.0, 10.0, vec![0]), (40.0, 45.0, vec![2])]);
    }
}
