//! Running quartiles of a series at several resolutions: a line through a cloud of dots, and a band about it.

use std::ops::Range;

use resect_core::statistics::quantiles;

/// Number of values in a run of the lowest level; each level's runs are twice as long as those of the one below.
const SHORTEST_RUN: usize = 16;
/// Least number of drawn runs, in any plot width: longer runs are not computed.
const FEWEST_RUNS: usize = 48;

/// A running median with its quartiles, at several resolutions.
#[derive(Clone, Debug, Default)]
pub struct Running {
    levels: Vec<Vec<RunningQuartiles>>,
}

/// Quartiles of the values of a span of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RunningQuartiles {
    /// Number of the continuous segment of the series that contains the run.
    piece: u32,
    pub from_s: f64,
    pub to_s: f64,
    /// The lower quartile, the median and the upper quartile.
    pub quartiles: [f64; 3],
}

/// Corners of the line and the band of a continuous segment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    pub times_s: Vec<f64>,
    pub q25: Vec<f64>,
    pub median: Vec<f64>,
    pub q75: Vec<f64>,
}

impl Running {
    /// Computes the running quartiles of a series in order of time; `pieces` are the numbers of its segments. No run crosses the end of a
    /// segment, unless there are too many segments to draw. Empty without values, as for errors of unknown distances.
    pub fn of(times_s: &[f64], values: &[f64], pieces: &[u32]) -> Self {
        if values.is_empty() {
            return Self::default();
        }
        let run = |range: &Range<usize>, piece: u32| -> Option<RunningQuartiles> {
            let quartiles = quantiles(values[range.clone()].iter().copied(), [0.25, 0.5, 0.75])?;
            let (from_s, to_s) = (times_s[range.start], times_s[range.end - 1]);
            Some(RunningQuartiles { piece, from_s, to_s, quartiles })
        };
        let mut whole = whole_pieces(pieces);
        let mut levels: Vec<Vec<RunningQuartiles>> = Vec::new();
        let mut length = SHORTEST_RUN;
        loop {
            let runs: Vec<RunningQuartiles> = (whole.iter())
                .flat_map(|piece| in_equal_parts(piece, length))
                .filter_map(|range| run(&range, pieces[range.start]))
                .collect();
            let enough = runs.len() <= whole.len().max(FEWEST_RUNS);
            levels.push(runs);
            if enough {
                break;
            }
            length *= 2;
        }
        while whole.len() > FEWEST_RUNS {
            let joined = joined_by_twos(&whole, times_s);
            if joined.len() == whole.len() {
                break;
            }
            whole = joined;
            let mut runs: Vec<RunningQuartiles> =
                whole.iter().filter_map(|range| run(range, 0)).collect();
            number_joined(&mut runs);
            levels.push(runs);
        }
        Self { levels }
    }

    /// Returns the segments within a window, of at most about `most` runs.
    pub fn visible(&self, [from_s, to_s]: [f64; 2], most: usize) -> Vec<Piece> {
        let seen = |runs: &[RunningQuartiles]| {
            let from = runs.partition_point(|run| run.to_s < from_s);
            from..runs.partition_point(|run| run.from_s <= to_s).max(from)
        };
        let few = self.levels.iter().find(|runs| seen(runs).len() <= most);
        let Some(runs) = few.or(self.levels.last()) else { return Vec::new() };
        let part = seen(runs);
        // The line continues to the runs just outside of the window.
        pieces(&runs[part.start.saturating_sub(1)..(part.end + 1).min(runs.len())])
    }
}

/// Returns the index range of each continuous segment.
fn whole_pieces(pieces: &[u32]) -> Vec<Range<usize>> {
    let mut start = 0;
    (pieces.chunk_by(|a, b| a == b))
        .map(|piece| {
            start += piece.len();
            start - piece.len()..start
        })
        .collect()
}

/// Splits a segment into ranges of about a length: equal ones, so that none at an end has only a few values.
fn in_equal_parts(piece: &Range<usize>, length: usize) -> impl Iterator<Item = Range<usize>> {
    let (start, len) = (piece.start, piece.len());
    let count = (len / length).max(1);
    (0..count).map(move |part| start + part * len / count..start + (part + 1) * len / count)
}

/// Joins neighbouring ranges of a series, except across a gap that is longer than either.
fn joined_by_twos(parts: &[Range<usize>], times_s: &[f64]) -> Vec<Range<usize>> {
    let ends_s = |part: &Range<usize>| [times_s[part.start], times_s[part.end - 1]];
    let mut joined: Vec<Range<usize>> = Vec::new();
    let mut rest = parts;
    while let [first, others @ ..] = rest {
        rest = others;
        match others {
            [second, beyond @ ..] if are_close(ends_s(first), ends_s(second)) => {
                joined.push(first.start..second.end);
                rest = beyond;
            }
            _ => joined.push(first.clone()),
        }
    }
    joined
}

/// Returns true if the gap between two spans of time (s) is no longer than the longer of them.
fn are_close(before_s: [f64; 2], after_s: [f64; 2]) -> bool {
    let longest_s = (before_s[1] - before_s[0]).max(after_s[1] - after_s[0]);
    after_s[0] - before_s[1] <= longest_s
}

/// Gives runs of many segments one number as long as they follow each other closely.
fn number_joined(runs: &mut [RunningQuartiles]) {
    for index in 1..runs.len() {
        let [before, run] = [runs[index - 1], runs[index]];
        let close = are_close([before.from_s, before.to_s], [run.from_s, run.to_s]);
        runs[index].piece = before.piece + u32::from(!close);
    }
}

/// Returns the corners of each segment, from its first time to its last, through the middles of its runs.
fn pieces(runs: &[RunningQuartiles]) -> Vec<Piece> {
    runs.chunk_by(|a, b| a.piece == b.piece)
        .map(|runs| {
            let mut piece = Piece::default();
            let mut add = |time_s: f64, [q25, median, q75]: [f64; 3]| {
                piece.times_s.push(time_s);
                piece.q25.push(q25);
                piece.median.push(median);
                piece.q75.push(q75);
            };
            let (first, last) = (runs[0], runs[runs.len() - 1]);
            add(first.from_s, first.quartiles);
            for run in runs {
                add(0.5 * (run.from_s + run.to_s), run.quartiles);
            }
            add(last.to_s, last.quartiles);
            piece
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two segments of a slow wave with outliers.
    fn series(count: usize) -> (Vec<f64>, Vec<f64>, Vec<u32>) {
        let times_s: Vec<f64> = (0..count).map(|i| 0.1 * i as f64).collect();
        let wave =
            |i: usize| (0.01 * i as f64).sin() + if i.is_multiple_of(9) { 50.0 } else { 0.0 };
        let values = (0..count).map(wave).collect();
        let pieces = (0..count).map(|i| u32::from(i >= count / 3)).collect();
        (times_s, values, pieces)
    }

    #[test]
    fn the_line_follows_what_is_usual_and_stops_where_the_series_does() {
        let (times_s, values, pieces) = series(3000);
        let running = Running::of(&times_s, &values, &pieces);
        let seen = running.visible([0.0, 300.0], 400);
        assert_eq!(seen.len(), 2);
        assert_eq!(
            (seen[0].times_s[0], *seen[0].times_s.last().expect("some")),
            (0.0, times_s[999])
        );
        assert_eq!(seen[1].times_s[0], times_s[1000]);
        for piece in &seen {
            for (at, time_s) in piece.times_s.iter().enumerate() {
                let wave = (0.1 * time_s).sin();
                assert!((piece.median[at] - wave).abs() < 0.15, "{} {wave}", piece.median[at]);
                assert!(piece.q25[at] <= piece.median[at] && piece.median[at] <= piece.q75[at]);
            }
        }
    }

    #[test]
    fn a_million_values_are_a_few_runs_and_close_up_the_short_ones() {
        let (times_s, values, pieces) = series(1_000_000);
        let running = Running::of(&times_s, &values, &pieces);
        let corners = |window_s: [f64; 2]| -> usize {
            running.visible(window_s, 100).iter().map(|piece| piece.times_s.len()).sum()
        };
        assert!(corners([0.0, 1e5]) < 110, "{}", corners([0.0, 1e5]));
        // A hundred seconds are a thousand values; a run has sixteen.
        assert!((55..75).contains(&corners([500.0, 600.0])), "{}", corners([500.0, 600.0]));
    }

    /// A plot draws each segment separately, at a cost for each.
    #[test]
    fn thousands_of_pieces_are_joined_but_over_long_gaps() {
        // Ten thousand segments of ten seconds, a second apart, and a gap of some hours in the middle.
        let piece = |i: usize| i / 100;
        let times_s: Vec<f64> = (0..1_000_000)
            .map(|i| 0.1 * i as f64 + piece(i) as f64 + if i < 500_000 { 0.0 } else { 2e4 })
            .collect();
        let values: Vec<f64> = (0..1_000_000).map(|i| (i % 7) as f64).collect();
        let pieces: Vec<u32> = (0..1_000_000).map(|i| piece(i) as u32).collect();
        let running = Running::of(&times_s, &values, &pieces);
        let seen = running.visible([0.0, 2e5], 100);
        assert_eq!(seen.len(), 2, "before the long gap and after it");
        assert!(seen.iter().map(|piece| piece.times_s.len()).sum::<usize>() < 110);
        let gap_s = seen[1].times_s[0] - seen[0].times_s.last().expect("some");
        assert!((gap_s - 2e4).abs() < 2.0, "{gap_s}");
        assert_eq!(running.visible([0.0, 100.0], 100).len(), 10, "near by, each is itself");
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert!(Running::of(&[], &[], &[]).visible([0.0, 1.0], 10).is_empty());
        assert!(Running::of(&[0.0, 0.5], &[], &[0, 0]).visible([0.0, 1.0], 10).is_empty());
        assert!(Running::default().visible([0.0, 1.0], 10).is_empty());
    }
}
