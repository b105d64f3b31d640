//! A joint estimate: its estimates besides the transforms, and the sources of their σ.

use maud::{Markup, html};

use crate::rows::{decimals_of, prior, signed};
use resect_core::calibration::joint::JointEstimate;
use resect_core::calibration::{Quantity, SUPPORTED_SIGMAS};
use resect_core::evaluation::answer_rows::{AnswerRow, RowGroup};

/// The estimates besides the transforms, and the sources of each σ.
pub fn joint(found: &JointEstimate, rows: &[AnswerRow]) -> Markup {
    html! {
        h3 { "Other estimates" }
        table {
            thead { tr {
                th { "error" }
                th.number { "value" }
                th { "σ" }
                th.number { "in σ" }
                th.number { "prior, 1 σ" }
                th.number { "reference" }
            } }
            tbody {
                @for row in rows.iter().filter(|row| row.group.is_beside_transforms()) {
                    (estimate(row))
                }
            }
        }
        p.weak { "Bold: significant, more than " (SUPPORTED_SIGMAS) " σ from the reference." }
        h3 { "Noise of the readings" }
        table {
            thead { tr { th { "noise" } th.number { "1 σ" } } }
            tbody {
                @for row in rows.iter().filter(|row| row.group == RowGroup::Noise) { tr {
                    th { (row.name) " (" (row.quantity.told().1) ")" }
                    td.number { (format!("{:.2}", row.value * row.quantity.told().0)) }
                } }
            }
        }
        h3 { "Sources of σ" }
        table {
            thead { tr {
                th { "1 σ by source (mm; yaw mrad)" }
                @for station in 2..=found.station1_from_station.len() {
                    @for name in ["x", "y", "z", "yaw"] { th.number { (name) " " (station) } }
                }
            } }
            tbody {
                @for (what, variances) in &found.budget { tr {
                    th { (what) }
                    @for (place, variance) in variances.iter().enumerate() {
                        td.number { (sigma(place, *variance)) }
                    }
                } }
                tr {
                    th { "total" }
                    @for place in 0..found.covariance.nrows() { td.number { (sigma(place, found.covariance[(place, place)])) } }
                }
            }
        }
    }
}

/// A row of the estimates, as the deviation from its reference.
fn estimate(row: &AnswerRow) -> Markup {
    let (scale, unit) = row.quantity.told();
    let sigma = row.sigma.map(|sigma| sigma * scale);
    let decimals = sigma.and_then(decimals_of).unwrap_or(1);
    let value = signed(row.deviation() * scale, decimals);
    let dash = || "–".to_owned();
    html! { tr {
        th { (row.subject) ", " (row.name) " " i { (row.symbol) } " (" (unit) ")" }
        td.number { @if row.is_significant { strong { (value) } } @else { (value) } }
        td.sigma { (sigma.map_or_else(dash, |sigma| format!("± {sigma:.decimals$}"))) }
        td.number { (row.deviation_sigmas().map_or_else(dash, |sigmas| signed(sigmas, 1))) }
        td.number { (prior(row)) }
        td.number { (compared_with(row)) }
    } }
}

fn compared_with(row: &AnswerRow) -> String {
    row.reference.as_ref().map_or("0".to_owned(), |reference| match row.quantity {
        Quantity::Length => format!("{} {:.4} m", reference.name, reference.value),
        _ => reference.name.clone(),
    })
}

fn sigma(place: usize, variance: f64) -> String {
    let sigma = variance.max(0.0).sqrt() * 1e3;
    if place % 4 == 3 { format!("{sigma:.3}") } else { format!("{sigma:.2}") }
}
