//! The verdict, and the reasons for it in words that an engineer uses.

use super::CentredTriplets;
use super::mirror::Choice;
use super::uncertainty::Uncertainty;
use crate::calibration::Verdict;
use crate::deployment::{Deployment, Finding};

/// An answer whose largest standard deviation exceeds this is weak (m). The paper's deployments reach a few
/// millimetres; two centimetres is what its failed ones show.
const WEAK_SIGMA_M: f64 = 0.020;
/// What two readings of a control point may differ by (m): ranges, centring, angles at a hundred metres.
const CONTROL_POINT_SIGMA_M: f64 = 0.005;
/// Control points this many times further apart than expected contradict the answer.
const CONTRADICTION: f64 = 3.0;
/// Beyond this the direction is as good as free (m).
const FREE_SIGMA_M: f64 = 0.5;

/// Judges the answer; reasons are added to the findings, the mirror's first.
pub fn judge(
    deployment: &Deployment,
    data: &CentredTriplets,
    uncertainty: &Uncertainty,
    choice: &Choice,
    findings: &mut Vec<Finding>,
) -> Verdict {
    findings.splice(0..0, choice.findings.iter().cloned());
    let contradiction = control_points_contradict(deployment, uncertainty, choice);
    let contradicted = contradiction.is_some();
    findings.extend(contradiction);
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
        if contradicted { Verdict::Weak } else { Verdict::Good }
    }
}

/// Control points that lie further apart than their noise and the answer's own uncertainty allow.
///
/// Where they do, either they or a station moved, or something that this method does not model biases it.
fn control_points_contradict(
    deployment: &Deployment,
    uncertainty: &Uncertainty,
    choice: &Choice,
) -> Option<Finding> {
    let sigma = uncertainty.sigma()?;
    let mut worst: Option<(f64, f64, &str)> = None;
    for set in deployment.control_points.iter().filter(|set| !set.pillars) {
        let mut apart_m = set.disagreements_m(&choice.answer.station1_from_station);
        apart_m.sort_by(f64::total_cmp);
        let Some(median_m) = apart_m.get(apart_m.len() / 2).copied() else { continue };
        let mut ranges_m: Vec<f64> = set
            .points
            .iter()
            .flat_map(|p| p.readings)
            .flatten()
            .map(|polar| polar.range_m)
            .collect();
        ranges_m.sort_by(f64::total_cmp);
        let range_m = ranges_m[ranges_m.len() / 2];
        let expected_m = sigma
            .iter()
            .map(|s| s.translation_m.norm_squared() + (s.yaw_rad * range_m).powi(2))
            .fold(CONTROL_POINT_SIGMA_M.powi(2), f64::max)
            .sqrt()
            .max(CONTROL_POINT_SIGMA_M);
        if median_m > CONTRADICTION * expected_m && worst.is_none_or(|(known, ..)| median_m > known)
        {
            worst = Some((median_m, expected_m, &set.file));
        }
    }
    let (median_m, expected_m, file) = worst?;
    Some(Finding::warning(format!(
        "control points contradict this answer: {:.0} mm apart in {file} (median) where about {:.0} mm are expected; \
         a station moved between the two, or a bias is not modelled",
        median_m * 1e3,
        expected_m * 1e3
    )))
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
