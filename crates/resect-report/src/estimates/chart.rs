//! Errors of estimates over time, in a strip each, with the uncertainty of the ground truth.

use crate::drawing::{Anchor, Drawing, Ink, Mark};
use crate::frame::Frame;
use crate::residual_chart::draw_strokes;
use resect_core::statistics::quantiles;
use resect_core::statistics::tables::NORMAL_95;
use resect_tools::estimates::EstimatesJudgement;
use resect_tools::estimates::odd::OddOne;
use resect_tools::palette::{self, Rgb};

const LABEL: f32 = 11.0;
const LEFT: f32 = 62.0;
const TOP: f32 = 8.0;
const BOTTOM: f32 = 52.0;
const ROW: f32 = 120.0;
const ROW_GAP: f32 = 24.0;
/// Share of the errors within the range.
const SHOWN: f64 = 0.995;

/// Colour of a span by its odd one: vermilion for the estimate, blue for the ground truth, grey if it is undecided.
pub fn odd_rgb(odd_one: OddOne) -> Rgb {
    match odd_one {
        OddOne::Estimate => palette::METRICS[1],
        OddOne::Undecided | OddOne::EstimateOrAll(_) | OddOne::Convention => palette::NO_VALUE,
        OddOne::Readings | OddOne::TruthAgainst(_) | OddOne::LeftOut => palette::METRICS[0],
    }
}

/// Draws the absolute position errors (mm) over the time since `start_s` (s); odd spans are shaded.
pub fn draw(judgement: &EstimatesJudgement, start_s: f64, width: f32) -> Drawing {
    let judged = &judgement.judged;
    let all_s = judged.iter().flat_map(|one| one.errors.iter().map(|error| error.time_s - start_s));
    let (from, to) =
        all_s.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), t| (low.min(t), high.max(t)));
    let times = if from < to { [from, to] } else { [0.0, 1.0] };
    let right = width - 12.0;
    let mut marks = Vec::new();
    for (index, one) in judged.iter().enumerate() {
        let bottom = TOP + (index + 1) as f32 * (ROW_GAP + ROW);
        let top = bottom - ROW;
        // Each strip has its own range: beside a bad estimate a good one would be a flat line.
        let sizes = one.errors.iter().map(|error| 1e3 * error.position_m.norm());
        let most = quantiles(sizes, [SHOWN]).map_or(1.0, |[most]| 1.1 * most.max(1e-3));
        let plot = Frame::new(times, [0.0, most], [LEFT, top], [right, bottom]);
        let name = format!("{}: {:.1} mm rmse", one.estimate.name, 1e3 * one.position.rmse);
        marks.push(Mark::text([LEFT, top - 10.0], name, LABEL, Ink::Text, Anchor::Left));
        for span in &one.odd {
            let [start, end] = span.span_s.map(|time_s| plot.place(time_s - start_s, 0.0)[0]);
            let ink = Ink::Rgb(odd_rgb(span.odd_one));
            let (min, max) = ([start, top], [end.max(start + 1.0), bottom]);
            marks.push(Mark::Rect { min, max, ink, opacity: 0.25, outline: None });
        }
        plot.draw_rows(true, &mut marks);
        plot.draw_columns(index + 1 == judged.len(), &mut marks);
        let times_s: Vec<f64> = one.errors.iter().map(|error| error.time_s - start_s).collect();
        let within = |value: f64| value.min(most);
        let sizes: Vec<f64> =
            one.errors.iter().map(|error| within(1e3 * error.position_m.norm())).collect();
        let open: Option<Vec<f64>> = one
            .errors
            .iter()
            .map(|error| Some(within(1e3 * NORMAL_95 * error.sigma_m()?)))
            .collect();
        draw_strokes(&sizes, &times_s, &plot, Ink::Rgb(palette::estimate(index)), &mut marks);
        if let Some(open) = open {
            draw_strokes(&open, &times_s, &plot, Ink::Weak, &mut marks);
        }
    }
    let height = TOP + judged.len() as f32 * (ROW_GAP + ROW) + BOTTOM;
    let middle = TOP + 0.5 * judged.len() as f32 * (ROW_GAP + ROW);
    marks.push(Mark::upwards(
        [10.0, middle],
        "position error (mm)",
        LABEL,
        Ink::Text,
        Anchor::Middle,
    ));
    let centre = 0.5 * (LEFT + right);
    for (text, above, ink) in [
        ("time since the first measurement (s)", 28.0, Ink::Text),
        (
            "grey: 1.96 σ of the ground truth; shaded: estimate wrong (red), ground truth wrong (blue), undecided (grey)",
            10.0,
            Ink::Weak,
        ),
    ] {
        marks.push(Mark::text([centre, height - above], text, LABEL, ink, Anchor::Middle));
    }
    Drawing { size: [width, height], marks }
}
