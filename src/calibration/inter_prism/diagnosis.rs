//! The verdict, and the reasons for it in words that an engineer uses.

use super::CentredTriplets;
use super::mirror::Choice;
use super::uncertainty::Uncertainty;
use crate::calibration::Verdict;
use crate::deployment::Finding;

/// An answer whose largest standard deviation exceeds this is weak (m). The paper's deployments reach a few
/// millimetres; two centimetres is what its failed ones show.
const WEAK_SIGMA_M: f64 = 0.020;
/// Beyond this the direction is as good as free (m).
const FREE_SIGMA_M: f64 = 0.5;

/// Judges the answer; reasons are added to the findings, the mirror's first.
pub fn judge(
    data: &CentredTriplets,
    uncertainty: &Uncertainty,
    choice: &Choice,
    findings: &mut Vec<Finding>,
) -> Verdict {
    findings.splice(0..0, choice.findings.iter().cloned());
    let direction = describe(data, &uncertainty.weakest);
    let advice = "drive a figure-eight with turns to both sides";
    if uncertainty.weakest_sigma_m > FREE_SIGMA_M {
        findings.push(Finding::problem(format!(
            "the drive leaves a direction free: {direction}; {advice}"
        )));
        Verdict::Degenerate
    } else if choice.ambiguous {
        Verdict::Ambiguous
    } else if uncertainty.weakest_sigma_m > WEAK_SIGMA_M {
        findings.push(Finding::warning(format!(
            "weakly held: {direction} (σ {:.0} mm); {advice}",
            uncertainty.weakest_sigma_m * 1e3
        )));
        Verdict::Weak
    } else {
        findings.push(Finding::note(format!(
            "least certain: {direction} (σ {:.1} mm)",
            uncertainty.weakest_sigma_m * 1e3
        )));
        Verdict::Good
    }
}

/// The motion that a direction of the centred parameters stands for, by its largest part.
fn describe(data: &CentredTriplets, direction: &[f64; 8]) -> String {
    let along = track_direction(data);
    let mut parts = Vec::with_capacity(8);
    for (slot, station) in [2, 3].into_iter().enumerate() {
        let [x, y, z, yaw] = [0, 1, 2, 3].map(|k| direction[4 * slot + k]);
        let (lengthwise, sideways) = (x * along[0] + y * along[1], y * along[0] - x * along[1]);
        parts.push((lengthwise.abs(), station, "along the track"));
        parts.push((sideways.abs(), station, "across the track"));
        parts.push((z.abs(), station, "in height"));
        parts.push((yaw.abs(), station, "in yaw about the middle of the track"));
    }
    parts.sort_by(|a, b| b.0.total_cmp(&a.0));
    let (largest, station, how) = parts[0];
    let together = parts[1..]
        .iter()
        .any(|(size, other, same)| *other != station && *same == how && *size > 0.5 * largest);
    if together { format!("stations 2 and 3 {how}") } else { format!("station {station} {how}") }
}

/// Horizontal direction in which the track extends most, in station 1's frame.
fn track_direction(data: &CentredTriplets) -> [f64; 2] {
    let [x, y, _] = &data.coordinates[0];
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for (x, y) in x.iter().zip(y) {
        xx += x * x;
        xy += x * y;
        yy += y * y;
    }
    let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
    [angle.cos(), angle.sin()]
}
