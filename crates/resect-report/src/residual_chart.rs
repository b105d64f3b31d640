//! Distance errors of each pair over time, with their distributions.

use super::drawing::{Anchor, Drawing, Ink, Mark};
use super::frame::Frame;
use resect_core::network::{Number, Pair};
use resect_core::statistics::{quantile_of_sorted, quantiles};
use resect_tools::palette;

const LABEL: f32 = 11.0;
const LEFT: f32 = 58.0;
const TOP: f32 = 6.0;
const BOTTOM: f32 = 38.0;
const ROW: f32 = 104.0;
/// Space between rows, with the pair's name, and between the two columns.
const ROW_GAP: f32 = 22.0;
const COLUMN_GAP: f32 = 14.0;
const HISTOGRAM: f32 = 110.0;
/// Width of the time span that one stroke summarises.
const STROKE: f32 = 2.5;
/// Share of the errors within the range: outliers must not compress the rest.
const SHOWN: f64 = 0.985;
const BINS: usize = 40;

/// Draws the errors (mm) of each pair over time (s since the first measurement). `each` names the members of
/// pairs: prisms or stations.
pub fn draw(errors_mm: &[Vec<f64>], time_s: &[f64], each: &str, width: f32) -> Drawing {
    let range = range_mm(errors_mm);
    let pairs = errors_mm.len();
    let counts: Vec<Vec<usize>> =
        errors_mm.iter().map(|errors| histogram(errors, range, BINS)).collect();
    let most = counts.iter().flatten().copied().max().unwrap_or(0).max(1);
    let height = TOP + pairs as f32 * (ROW_GAP + ROW) + BOTTOM;
    let (right, plot_right) = (width - 12.0, width - 12.0 - HISTOGRAM - COLUMN_GAP);
    let times = [
        time_s.first().map_or(0.0, |first| first.min(0.0)),
        time_s.last().map_or(1.0, |last| last.max(1.0)),
    ];
    let mut marks = Vec::new();
    for pair in 0..pairs {
        let bottom = TOP + (pair + 1) as f32 * (ROW_GAP + ROW);
        let top = bottom - ROW;
        let ink = Ink::Rgb(palette::pair(pair));
        let at = [LEFT, top - 10.0];
        let name = format!("{each} {}", Pair::at(pair));
        marks.push(Mark::text(at, name, LABEL, Ink::Text, Anchor::Left));
        let plot = Frame::new(times, range, [LEFT, top], [plot_right, bottom]);
        let last = pair + 1 == pairs;
        plot.draw_rows(true, &mut marks);
        plot.draw_columns(last, &mut marks);
        draw_strokes(&errors_mm[pair], time_s, &plot, ink, &mut marks);
        let left = plot_right + COLUMN_GAP;
        let share = Frame::new([0.0, most as f64 * 1.05], range, [left, top], [right, bottom]);
        share.draw_rows(false, &mut marks);
        draw_bars(&counts[pair], range, &share, ink, &mut marks);
        marks.push(Mark::line(
            share.place(0.0, range[0]),
            share.place(0.0, range[1]),
            Ink::Weak,
            1.0,
        ));
    }
    let middle = TOP + 1.5 * (ROW_GAP + ROW) + 0.5 * ROW_GAP;
    marks.push(Mark::upwards(
        [10.0, middle],
        "distance error (mm)",
        LABEL,
        Ink::Text,
        Anchor::Middle,
    ));
    for (left, right, text) in [
        (LEFT, plot_right, "time since the first measurement (s)"),
        (plot_right + COLUMN_GAP, right, "count"),
    ] {
        let at = [0.5 * (left + right), height - 9.0];
        marks.push(Mark::text(at, text, LABEL, Ink::Text, Anchor::Middle));
    }
    Drawing { size: [width, height], marks }
}

/// Draws, for each short span of time, a thin stroke from the lowest to the highest error and a thick one between the
/// quartiles.
pub fn draw_strokes(
    errors_mm: &[f64],
    time_s: &[f64],
    plot: &Frame,
    ink: Ink,
    marks: &mut Vec<Mark>,
) {
    let indices: Vec<usize> = (0..errors_mm.len()).collect();
    let span = |index: usize| (plot.place(time_s[index], 0.0)[0] / STROKE) as i64;
    let (mut thin, mut thick) = (Vec::new(), Vec::new());
    for group in indices.chunk_by(|a, b| span(*a) == span(*b)) {
        let mut sorted: Vec<f64> = group.iter().map(|index| errors_mm[*index]).collect();
        sorted.sort_by(f64::total_cmp);
        let middle_s = 0.5 * (time_s[group[0]] + time_s[group[group.len() - 1]]);
        for (shares, strokes) in [([0.0, 1.0], &mut thin), ([0.25, 0.75], &mut thick)] {
            let [Some(low), Some(high)] = shares.map(|share| quantile_of_sorted(&sorted, share))
            else {
                continue;
            };
            let ([x, bottom], [_, top]) = (plot.place(middle_s, low), plot.place(middle_s, high));
            // A single error becomes a dot.
            strokes.push([[x, bottom.max(top + 0.8)], [x, top.min(bottom - 0.8)]]);
        }
    }
    marks.extend(thin.into_iter().map(|[from, to]| Mark::line(from, to, ink, 0.8)));
    marks.extend(thick.into_iter().map(|[from, to]| Mark::line(from, to, ink, 2.0)));
}

fn draw_bars(counts: &[usize], range: [f64; 2], frame: &Frame, ink: Ink, marks: &mut Vec<Mark>) {
    let height_mm = (range[1] - range[0]) / counts.len() as f64;
    for (bin, count) in counts.iter().enumerate().filter(|(_, count)| **count > 0) {
        let low_mm = range[0] + bin as f64 * height_mm;
        let [left, bottom] = frame.place(0.0, low_mm);
        let [right, top] = frame.place(*count as f64, low_mm + height_mm);
        let (min, max) = ([left, top], [right, bottom]);
        marks.push(Mark::Rect { min, max, ink, opacity: 0.75, outline: None });
    }
}

/// Returns the range of nearly all errors (mm): about zero, or from zero up if no error is negative.
pub fn range_mm(errors_mm: &[Vec<f64>]) -> [f64; 2] {
    let sizes = errors_mm.iter().flatten().map(|error| error.abs());
    let Some([shown]) = quantiles(sizes, [SHOWN]) else { return [-1.0, 1.0] };
    let high = (shown * 1.15).max(0.5);
    if errors_mm.iter().flatten().any(|error| *error < 0.0) { [-high, high] } else { [0.0, high] }
}

/// Counts errors in equal bins over the range; errors beyond it are not counted.
pub fn histogram(errors_mm: &[f64], [low, high]: [f64; 2], bins: usize) -> Vec<usize> {
    let mut counts = vec![0; bins];
    for error in errors_mm {
        let at = (error - low) / (high - low) * bins as f64;
        if at >= 0.0 && at < bins as f64 {
            counts[at as usize] += 1;
        }
    }
    counts
}

/// Returns the number of errors outside the range.
pub fn beyond(errors_mm: &[Vec<f64>], [low, high]: [f64; 2]) -> usize {
    errors_mm.iter().flatten().filter(|error| **error < low || **error > high).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn everything_within_the_range_is_counted_once() {
        let counts = histogram(&[-0.999, -0.2, 0.0, 0.5, 0.999, 3.0], [-1.0, 1.0], 40);
        assert_eq!(counts.iter().sum::<usize>(), 5);
        assert_eq!((counts[0], counts[39]), (1, 1));
    }

    #[test]
    fn outliers_do_not_set_the_range_and_are_counted() {
        let mut errors: [Vec<f64>; 3] =
            std::array::from_fn(|_| (0..1000).map(|i| (f64::from(i)).sin()).collect());
        errors[1][500] = 400.0;
        let range = range_mm(&errors);
        assert!(range[1] < 1.3 && range[0] == -range[1], "{range:?}");
        assert_eq!(beyond(&errors, range), 1);
    }

    #[test]
    fn strokes_stay_inside_however_many_errors_there_are() {
        for n in [0, 1, 2, 5000] {
            let errors: [Vec<f64>; 3] = std::array::from_fn(|pair| {
                (0..n).map(|i| 30.0 * (f64::from(i) + pair as f64).tan()).collect()
            });
            let time_s: Vec<f64> = (0..n).map(|i| 0.1 * f64::from(i)).collect();
            let drawing = draw(&errors, &time_s, "prisms", 700.0);
            assert!(drawing.marks.len() < 3 * 2 * 250 + 400, "{}", drawing.marks.len());
            for mark in &drawing.marks {
                if let Mark::Line { points, .. } = mark {
                    let inside = |[x, y]: &[f32; 2]| {
                        (LEFT..=690.0).contains(x) && *y > 0.0 && *y < drawing.size[1]
                    };
                    assert!(points.iter().all(inside), "{points:?}");
                }
            }
        }
    }
}
