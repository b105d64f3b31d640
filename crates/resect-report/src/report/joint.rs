//! What only a joint estimate knows: the instruments, and what its σ are made of.

use maud::{Markup, html};

use resect_core::calibration::Estimate;
use resect_core::calibration::joint::JointEstimate;

/// Errors of the three instruments, and the parts of each σ.
pub fn joint(found: &JointEstimate) -> Markup {
    let arcseconds = 3600.0_f64.to_degrees();
    let rows: [(&str, [Estimate; 3], f64); 6] = [
        ("ranges too long by (mm)", found.range_offsets_m, 1e3),
        ("ranges too long by (ppm)", found.range_scales, 1e6),
        ("zenith angles too large by (″)", found.indices_rad, arcseconds),
        ("leans about x (″)", found.leans_rad.map(|lean| lean[0]), arcseconds),
        ("leans about y (″)", found.leans_rad.map(|lean| lean[1]), arcseconds),
        ("angles older than ranges by (ms)", found.latencies_s, 1e3),
    ];
    html! {
        h3 { "Instruments" }
        table {
            thead { tr {
                th { "estimated" }
                @for station in 1..=3 { th.number { "station " (station) } }
            } }
            tbody {
                @for (name, estimates, scale) in rows { tr {
                    th { (name) }
                    @for estimate in estimates {
                        td.number { (format!("{:+.1} ± {:.1}", estimate.value * scale, estimate.sigma * scale)) }
                    }
                } }
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

fn sigma(place: usize, variance: f64) -> String {
    let sigma = variance.max(0.0).sqrt() * 1e3;
    if place % 4 == 3 { format!("{sigma:.3}") } else { format!("{sigma:.2}") }
}
