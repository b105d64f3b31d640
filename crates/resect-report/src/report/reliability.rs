//! Reliability of the groups of readings: redundancy numbers, normalised residuals, minimal detectable biases and their effect.

use maud::{Markup, html};

use crate::rows::{decimals_of, largest_residual};
use resect_core::calibration::joint::JointEstimate;
use resect_core::calibration::joint::reliability::GroupReliability;
use resect_core::deployment::Deployment;

/// The table of all groups.
pub fn reliability(deployment: &Deployment, found: &JointEstimate) -> Markup {
    html! {
        h3 { "Reliability" }
        table {
            thead { tr {
                th { "readings" }
                th.number { "redundancy number" }
                th.number { "normalised residual" }
                th.number { "minimal detectable bias" }
                @for station in 2..=found.station1_from_station.len() {
                    th.number { "effect on T1" (station) " (mm)" }
                    th.number { "yaw (mrad)" }
                }
            } }
            tbody {
                @for group in &found.reliability { (row(deployment, group)) }
            }
        }
        p.weak {
            "The minimal detectable bias is reported with a probability of 80 %. All tests of a kind reject one good drive of a thousand. The effect is \
             that of an undetected bias of this size."
        }
        p.weak {
            "Drive: root mean square of the normalised residuals, and a bias that all readings of the station share. Control points: \
             largest residual, and a bias of one reading; its median, with the largest effect. Angles to control points are in mm \
             across the sight."
        }
    }
}

/// The minimal detectable bias with its unit.
fn bias_size(group: &GroupReliability) -> Option<String> {
    let (scale, unit) = group.kind.quantity().told();
    let size = group.bias.as_ref()?.size * scale;
    Some(format!("{size:.*} {unit}", decimals_of(size).unwrap_or(1)))
}

fn row(deployment: &Deployment, group: &GroupReliability) -> Markup {
    let number = |value: Option<f64>, decimals: usize| {
        value.map_or("–".to_owned(), |value| format!("{value:.decimals$}"))
    };
    let sets = deployment.comparable_control_points();
    let effect = |slot: usize| Some(*group.bias.as_ref()?.effect.get(slot)?);
    html! { tr {
        th { (group.subject()) ", " (group.kind.name()) }
        td.number { (number(group.redundancy, 2)) }
        td.number {
            (number(group.residual_sigmas(), 2))
            @if let Some(point) = largest_residual(sets, group) { " (" (point) ")" }
        }
        td.number { (bias_size(group).unwrap_or_else(|| "not determined".to_owned())) }
        @for slot in 1..deployment.tracks.len() {
            td.number { (number(effect(slot - 1).map(|effect| effect.position_m * 1e3), 2)) }
            td.number { (number(effect(slot - 1).map(|effect| effect.yaw_rad * 1e3), 3)) }
        }
    } }
}
