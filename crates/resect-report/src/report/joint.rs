//! A joint estimate: its estimates beside the transforms, and the sources of their σ.

use maud::{Markup, html};

use resect_core::calibration::Extra;
use resect_core::calibration::joint::JointEstimate;

/// The estimates beside the transforms, and the parts of each σ.
pub fn joint(found: &JointEstimate, extras: &[Extra]) -> Markup {
    html! {
        h3 { "Estimated besides" }
        @if !found.converged { p { "It stopped before it reached the minimum." } }
        table {
            thead { tr {
                th { "error" }
                th.number { "value" }
                th { "σ" }
                th.number { "in σ" }
                th.number { "known before, 1 σ" }
            } }
            tbody {
                @for extra in extras { (row(extra)) }
            }
        }
        h3 { "What σ is made of" }
        table {
            thead { tr {
                th { "1 σ by source (mm; yaw mrad)" }
                @for station in 2..=3 {
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
                    th { "together" }
                    @for place in 0..8 { td.number { (sigma(place, found.covariance[(place, place)])) } }
                }
            }
        }
    }
}

fn row(extra: &Extra) -> Markup {
    let (scale, unit) = extra.quantity.told();
    let estimate = extra.estimate;
    html! { tr {
        th { (extra.of) ", " (extra.name) " (" (unit) ")" }
        td.number { (format!("{:+.2}", estimate.value * scale)) }
        td.sigma { (format!("± {:.2} {unit}", estimate.sigma * scale)) }
        td.number { (format!("{:+.1}", estimate.sigmas_from(0.0))) }
        td.number { (extra.prior.map_or("–".to_owned(), |sigma| format!("{:.2}", sigma * scale))) }
    } }
}

fn sigma(place: usize, variance: f64) -> String {
    let sigma = variance.max(0.0).sqrt() * 1e3;
    if place % 4 == 3 { format!("{sigma:.3}") } else { format!("{sigma:.2}") }
}
