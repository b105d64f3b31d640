//! Charts of an answer, in the colours of the page.

use maud::{Markup, PreEscaped, html};
use nalgebra::Vector3;

use crate::drawing::Drawing;
use crate::plan_view;
use crate::plan_view::Tracks;
use crate::residual_chart;
use crate::svg::{Colours, to_svg};
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::Deployment;
use resect_core::network::{PerStation, Prism};
use resect_core::pipeline::{SampleFate, Triplets};

/// Width at which texts have their nominal size on the screen, and nearly so on paper.
const WIDTH: f32 = 800.0;

pub fn plan(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Markup {
    let calibration = &answer.calibration;
    let points = calibration.placing_control_points(deployment);
    let points = points.map_or(&[][..], |_| &deployment.control_points);
    let nothing = Triplets::default();
    let tracks = calibration.placing_tracks(deployment);
    let triplets = tracks.map_or(&nothing, |_| &*answer.triplets);
    let unused_m = tracks.map_or_else(Default::default, |_| unused_m(deployment, analysis));
    let tracks_m = Tracks { triplets, unused_m: &unused_m };
    let drawing = plan_view::draw(points, &tracks_m, &calibration.station1_from_station, WIDTH);
    let unused = unused_m.iter().map(Vec::len).sum::<usize>();
    let caption = html! {
        "From above, both axes to the same scale."
        @if unused > 0 {
            " Crosses in a station's colour: unused readings (" (unused) " in all, some perhaps outside the plan). "
            "The Pipeline table gives the reasons."
        }
        @if tracks.is_none() { " The tracks are not drawn: this answer is in another frame." }
        @if points.is_empty() && !deployment.control_points.is_empty() {
            " The control points are not drawn: the tracks are in another frame."
        }
    };
    figure(&drawing, "plan view", &caption)
}

/// Readings of each station that were rejected, left out or outside the used intervals, in its own frame (m).
fn unused_m(deployment: &Deployment, analysis: &Analysis) -> PerStation<Vec<Vector3<f64>>> {
    deployment.tracks.zip(&analysis.pipeline.fates, |track, fates| {
        let unused = track.measurements.iter().zip(&fates.each);
        let unused = unused.filter(|(_, fate)| **fate != SampleFate::Kept);
        unused.map(|(measurement, _)| track.position_m(measurement)).collect()
    })
}

pub fn residuals(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Markup {
    let errors_mm = &answer.evaluation.distance_errors_mm;
    if answer.evaluation.inter_prism_mm.is_none() {
        let why = match analysis.offer.followed.len() {
            1 => "distance errors need two stations",
            _ => "there are no triplets, or the inter-prism distances are unknown",
        };
        return html! { p.weak { "No chart: " (why) "." } };
    }
    let start_s = deployment.start_s().unwrap_or(0.0);
    let time_s: Vec<f64> = answer.triplets.time_s.iter().map(|time_s| time_s - start_s).collect();
    let (each, what) = match Prism::is_one(&analysis.offer.followed) {
        true => ("stations", "Distance between two stations' positions of the same prism"),
        false => ("prisms", "Computed minus known distance between two prisms"),
    };
    let drawing = residual_chart::draw(errors_mm.as_slice(), &time_s, each, WIDTH);
    let beyond = residual_chart::beyond(
        errors_mm.as_slice(),
        residual_chart::range_mm(errors_mm.as_slice()),
    );
    let all = errors_mm.iter().map(Vec::len).sum::<usize>();
    figure(
        &drawing,
        "distance errors over time",
        &html! {
            (what) ". Each stroke covers a short interval: the thin part reaches from its lowest to its highest error, "
            "the thick part between its quartiles. "
            @if beyond > 0 { (beyond) " of " (all) " errors lie beyond the axis; their strokes end at its edge." }
        },
    )
}

pub fn figure(drawing: &Drawing, name: &str, caption: &Markup) -> Markup {
    html! {
        figure {
            div.picture role="img" aria-label=(name) { (PreEscaped(to_svg(drawing, Colours::Page))) }
            figcaption { (caption) }
        }
    }
}
