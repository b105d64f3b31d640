//! What is usual in ever longer runs of a series: a line through a cloud of dots, and a band about it.

use crate::statistics::quantiles;

/// Values of a run of the lowest level; each level's runs are twice as long as those of the one below.
const SHORTEST_RUN: usize = 16;
/// So few runs are drawn however little room there is: longer ones are not made.
const FEWEST_RUNS: usize = 48;

/// A running median with its quartiles, in several finenesses.
#[derive(Clone, Debug, Default)]
pub struct Running {
    levels: Vec<Vec<Run>>,
}

/// Quartiles of the values of a span of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Run {
    /// Which unbroken piece of the series the run is of.
    piece: u32,
    pub from_s: f64,
    pub to_s: f64,
    /// The values below which a quarter, a half and three quarters of its values are.
    pub quartiles: [f64; 3],
}

/// Corners of the line and the band of an unbroken piece.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Piece {
    pub times_s: Vec<f64>,
    pub q25: Vec<f64>,
    pub median: Vec<f64>,
    pub q75: Vec<f64>,
}

impl Running {
    /// The running quartiles of a series in order of time, whose pieces are told by their numbers. No run reaches over the
    /// end of a piece.
    pub fn of(times_s: &[f64], values: &[f64], pieces: &[u32]) -> Self {
        let indices: Vec<usize> = (0..values.len()).collect();
        let whole: Vec<&[usize]> = indices.chunk_by(|a, b| pieces[*a] == pieces[*b]).collect();
        let mut levels: Vec<Vec<Run>> = Vec::new();
        let mut length = SHORTEST_RUN;
        loop {
            let runs: Vec<Run> = (whole.iter())
                .flat_map(|piece| {
                    let count = (piece.len() / length).max(1);
                    // Of equal lengths, so that none at an end is of a few values only.
                    (0..count).map(move |run| {
                        &piece[run * piece.len() / count..(run + 1) * piece.len() / count]
                    })
                })
                .filter_map(|run| {
                    let [first, last] = [*run.first()?, *run.last()?];
                    let quartiles =
                        quantiles(run.iter().map(|index| values[*index]), [0.25, 0.5, 0.75])?;
                    let (from_s, to_s) = (times_s[first], times_s[last]);
                    Some(Run { piece: pieces[first], from_s, to_s, quartiles })
                })
                .collect();
            let enough = runs.len() <= whole.len().max(FEWEST_RUNS);
            levels.push(runs);
            if enough {
                return Self { levels };
            }
            length *= 2;
        }
    }

    /// What is seen in a window, of about so many runs at most.
    pub fn visible(&self, [from_s, to_s]: [f64; 2], most: usize) -> Vec<Piece> {
        let seen = |runs: &[Run]| {
            let from = runs.partition_point(|run| run.to_s < from_s);
            from..runs.partition_point(|run| run.from_s <= to_s).max(from)
        };
        let Some(runs) = self.levels.iter().find(|runs| seen(runs).len() <= most) else {
            return self.levels.last().map_or_else(Vec::new, |runs| pieces(runs));
        };
        let part = seen(runs);
        // The line goes on to what is just out of sight.
        pieces(&runs[part.start.saturating_sub(1)..(part.end + 1).min(runs.len())])
    }
}

/// From the first moment of each piece to its last, through the middles of its runs.
fn pieces(runs: &[Run]) -> Vec<Piece> {
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

    /// Two pieces of a slow wave with wild values among them.
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
        // A hundred seconds are a thousand values, of which sixteen are a run.
        assert!((55..75).contains(&corners([500.0, 600.0])), "{}", corners([500.0, 600.0]));
    }

    #[test]
    fn nothing_is_drawn_of_nothing() {
        assert!(Running::of(&[], &[], &[]).visible([0.0, 1.0], 10).is_empty());
        assert!(Running::default().visible([0.0, 1.0], 10).is_empty());
    }
}
