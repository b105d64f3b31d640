//! An answer: transforms with their σ, mirror twin, estimates besides the transforms, metrics, charts.

use resect_core::network::{Number, Pair, PerStation, Prism};
use std::f64::consts::PI;

use maud::{Markup, html};

use super::joint::joint;
use super::reliability::reliability;
use super::{charts, correlation};
use crate::difference::moved_from_published;
use crate::rows::{Pivot, pivot};
use crate::text;
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::inter_prism::InterPrismDetails;
use resect_core::calibration::static_gcp::StaticGcpDetails;
use resect_core::calibration::two_point::TwoPointDetails;
use resect_core::calibration::{Calibration, Details, Quantity, ResolvedBy};
use resect_core::deployment::Deployment;
use resect_core::evaluation::answer_rows::{AnswerRow, RowGroup};
use resect_core::evaluation::{Evaluation, Spread};
use resect_core::geometry::LevelTransform;

/// A unit in the table of transforms, with the unit of σ.
struct TableUnit {
    name: &'static str,
    per_si: f64,
    decimals: usize,
    /// Name and decimals of a thousandth of the unit, in which σ is written; `None` for σ in the unit itself.
    thousandth: Option<(&'static str, usize)>,
}

impl TableUnit {
    fn value(&self, si: f64) -> String {
        format!("{:.*}", self.decimals, si * self.per_si)
    }

    fn sigma(&self, si: f64) -> String {
        match self.thousandth {
            Some((name, digits)) => {
                format!("± {} {name}", text::sigma_text(Some(si * self.per_si), digits))
            }
            None => format!("± {} {}", self.value(si), self.name),
        }
    }
}

const LENGTHS: &[TableUnit] =
    &[TableUnit { name: "m", per_si: 1.0, decimals: 4, thousandth: Some(("mm", 1)) }];
/// A circle has 400 gon.
const ANGLES: &[TableUnit] = &[
    TableUnit { name: "rad", per_si: 1.0, decimals: 6, thousandth: Some(("mrad", 3)) },
    TableUnit { name: "deg", per_si: 180.0 / PI, decimals: 5, thousandth: None },
    TableUnit { name: "gon", per_si: 200.0 / PI, decimals: 5, thousandth: Some(("mgon", 2)) },
];

pub fn markup(deployment: &Deployment, analysis: &Analysis, answer: &Answer) -> Markup {
    let Answer { calibration, evaluation, .. } = answer;
    let rows = analysis.rows(deployment);
    let is_one_station = calibration.station1_from_station.len() == 1;
    html! {
        @if !is_one_station {
            (transforms(&rows))
            (matrices(calibration))
        }
        (published(calibration))
        @match &calibration.details {
            Details::TwoPoint(details) => (two_point(details)),
            Details::StaticGcp(details) => (static_gcp(details)),
            Details::DynamicGcp(_) | Details::InterPrism(_) | Details::Joint(_) => {}
        }
        @if let Some(details) = calibration.inter_prism() {
            (mirror(details, calibration.joint().is_some()))
        }
        @if let Some(found) = calibration.joint() {
            (joint(found, &rows))
            (reliability(deployment, found))
        }
        (metrics(evaluation, &analysis.offer.followed))
        h3 { "Plan view" }
        (charts::plan(deployment, analysis, answer))
        h3 { "Distance errors" }
        (charts::residuals(deployment, analysis, answer))
        @if !is_one_station {
            h3 { "Correlation" }
            @match &calibration.covariance {
                Some(covariance) => (correlation::table(covariance)),
                None => p.weak { "No covariance: this data leaves at least one direction unobservable." },
            }
        }
    }
}

/// The transforms, angles in radians, degrees and gon.
fn transforms(rows: &[AnswerRow]) -> Markup {
    let Pivot { subjects, lines } =
        pivot(rows.iter().filter(|row| row.group == RowGroup::Transforms));
    let units = |quantity| if quantity == Quantity::Angle { ANGLES } else { LENGTHS };
    html! {
        h3 { "Transforms" }
        table {
            thead { tr {
                th {}
                @for subject in subjects {
                    th.number { (subject) }
                    th { "σ" }
                }
            } }
            tbody {
                @for line in lines {
                    @for unit in units(line.quantity) { tr {
                        th { (line.name) " (" (unit.name) ")" }
                        @for row in &line.cells {
                            td.number { (row.map_or("–".to_owned(), |row| unit.value(row.value))) }
                            td.sigma { (row.and_then(|row| row.sigma).map_or("–".to_owned(), |sigma| unit.sigma(sigma))) }
                        }
                    } }
                }
            }
        }
    }
}

fn matrices(calibration: &Calibration) -> Markup {
    html! {
        div.matrices {
            @for station in 1..calibration.station1_from_station.len() {
                figure {
                    figcaption { "T1" (station + 1) ", frame of station " (station + 1) " into station 1's (m)" }
                    pre { (text::matrix(calibration, station).trim_end()) }
                }
            }
        }
    }
}

fn mirror(details: &InterPrismDetails, is_joint: bool) -> Markup {
    let (Some(twin), Some(ratio)) = (&details.mirror.twin, details.mirror.cost_ratio) else {
        return html! {
            h3 { "Mirrored solution" }
            p { "None: the pitch and roll of the vehicle rule it out." }
        };
    };
    let solutions = [(&details.basin, "answer"), (twin, "mirrored")];
    let numbers = |transform: &LevelTransform| {
        let metres = transform.translation_m.map(|metres| format!("{metres:.4}"));
        let [[x, y, z]] = metres.data.0;
        [x, y, z, format!("{:.6}", transform.yaw_rad)]
    };
    html! {
        h3 { "Mirrored solution" }
        p { (resolved(details.mirror.resolved_by)) }
        table {
            thead { tr {
                th {}
                @for heading in ["x (m)", "y (m)", "z (m)", "yaw (rad)", "RMS error (mm)", "cost ratio"] {
                    th.number { (heading) }
                }
            } }
            tbody {
                @for station in 1..twin.station1_from_station.len() {
                    @for ((solution, name), ratio) in solutions.into_iter().zip([1.0, ratio]) { tr {
                        th { "T1" (station + 1) ", " (name) }
                        @for number in numbers(&solution.station1_from_station[station]) {
                            td.number { (number) }
                        }
                        @if station == 1 {
                            td.number { (format!("{:.2}", solution.mean_square_m2.sqrt() * 1e3)) }
                            td.number { (format!("{ratio:.2}")) }
                        } @else {
                            td {}
                            td {}
                        }
                    } }
                }
            }
        }
        @if is_joint {
            p.weak { "Both solutions use the readings as corrected by the joint estimate." }
        }
    }
}

fn resolved(by: ResolvedBy) -> &'static str {
    match by {
        ResolvedBy::Rig => {
            "Resolved by the rig: the order of its prisms in height rules out the mirrored solution."
        }
        ResolvedBy::ControlPoints => "Resolved by the control points.",
        ResolvedBy::Cost => {
            "Resolved by the fit: with the vehicle's pitch and roll, the mirrored solution fits worse."
        }
        ResolvedBy::Likelihood => {
            "Resolved by all readings: the joint estimate at the mirrored solution is far less likely."
        }
        ResolvedBy::Nothing => "Not resolved: the answer is one of the two solutions.",
    }
}

/// The paper's answer beside a joint estimate, with the difference of the two.
fn published(joint: &Calibration) -> Markup {
    let (Some(published), Some(moved)) = (&joint.published, moved_from_published(joint)) else {
        return html! {};
    };
    let mm = |m: f64| format!("{:+.2}", m * 1e3);
    let cells = |value: String, sigmas: Option<f64>| {
        html! {
            td.number { (value) }
            td.sigma { (sigmas.map_or("–".to_owned(), |sigmas| format!("{sigmas:.1} σ"))) }
        }
    };
    html! {
        h3 { "The paper's " (published.method.short_name()) }
        p {
            (published.method.title()) ", as published, verdict " (published.verdict_in_words())
            ". Difference, joint estimate minus this answer:"
        }
        table {
            thead { tr {
                th {}
                @for heading in ["distance (mm)", "x (mm)", "y (mm)", "z (mm)", "yaw (mrad)"] {
                    th.number { (heading) }
                    th {}
                }
            } }
            tbody {
                @for station in &moved { tr {
                    th { "T1" (station.station) }
                    (cells(format!("{:.2}", station.distance_m.value * 1e3), station.distance_m.sigmas))
                    @for along in station.translation_m { (cells(mm(along.value), along.sigmas)) }
                    (cells(format!("{:+.4}", station.yaw_rad.value * 1e3), station.yaw_rad.sigmas))
                } }
            }
        }
        p.weak { "Differences are in σ of both answers combined." }
    }
}

/// Every pair of known points, with the errors at the points that it leaves out.
fn two_point(details: &TwoPointDetails) -> Markup {
    let widest = |metres: Option<f64>| {
        metres.map_or("–".to_owned(), |metres| format!("{:.1}", metres * 1e3))
    };
    html! {
        h3 { "Pairs of known points" }
        table {
            thead { tr {
                th { "points" }
                th { "file" }
                th.number { "baseline (m)" }
                th.number { "baseline errors by station (mm)" }
                th.number { "largest error at other points (mm)" }
                th.number { "largest difference from known (mm)" }
            } }
            tbody {
                @for (index, pair) in details.pairs.iter().enumerate() {
                    tr.chosen[index == details.chosen] {
                        th { (pair.markers[0]) "–" (pair.markers[1]) }
                        td { (pair.file) }
                        td.number { (format!("{:.3}", pair.baseline_m)) }
                        td.number { (pair.baseline_errors_m.map(|m| format!("{:+.1}", m * 1e3)).as_slice().join(", ")) }
                        td.number { (widest(pair.left_out_m.last().copied())) }
                        td.number { (widest(pair.largest_from_known_m())) }
                    }
                }
            }
        }
        p.weak { "Marked: the pair that the answer uses." }
    }
}

fn static_gcp(details: &StaticGcpDetails) -> Markup {
    html! {
        @if let Some(world) = &details.world_from_station1 {
            @let t = world.translation_m;
            h3 { "Station 1 in the points' frame" }
            p {
                (format!("x {:.4} m, y {:.4} m, z {:.4} m, yaw {:.6} rad", t.x, t.y, t.z, world.yaw_rad()))
            }
        }
    }
}

fn metrics(evaluation: &Evaluation, followed: &PerStation<Prism>) -> Markup {
    // With one prism, the distances compare the stations' positions of it.
    let (all, each) = match Prism::is_one(followed) {
        true => ("same prism", "stations"),
        false => ("inter-prism distances", "prisms"),
    };
    let row = |name: Markup, spread: &Spread| {
        html! { tr {
            th { (name) }
            @for mm in [spread.median, spread.q25, spread.q75, spread.iqr] {
                td.number { (format!("{mm:.2}")) }
            }
            td.number { (spread.n) }
        } }
    };
    html! {
        h3 { "Metrics" }
        table {
            thead { tr {
                th { "absolute errors (mm)" }
                @for heading in ["median", "lower quartile", "upper quartile", "IQR", "n"] {
                    th.number { (heading) }
                }
            } }
            tbody {
                @if let Some(spread) = &evaluation.inter_prism_mm { (row(html! { (all) }, spread)) }
                @for (pair, spread) in evaluation.inter_prism_by_pair_mm.iter().enumerate() {
                    @if let Some(spread) = spread {
                        (row(html! { span.indent { (each) " " (Pair::at(pair)) } }, spread))
                    }
                }
                @if let Some(spread) = &evaluation.against_measured_mm {
                    (row(html! { "compared with the measured distances" }, spread))
                }
                @for metric in &evaluation.control_points_mm {
                    (row(html! { "control points of " (metric.file) }, &metric.spread))
                }
            }
        }
        @if followed.len() == 1 {
            p.weak { "One station: the metrics need two." }
        } @else if evaluation.control_points_mm.is_empty() {
            p.weak { "No control points: no control-point metric." }
        }
    }
}
