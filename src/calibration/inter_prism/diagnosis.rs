//! The verdict, and the reasons for it in words that an engineer uses.

use super::mirror::Choice;
use super::uncertainty::Uncertainty;
use super::{CentredTriplets, Minimum, Parameters};
use crate::calibration::checks::{
    FREE_SIGMA_M, POOR_FIT_M, WEAK_SIGMA_M, control_points_contradict,
};
use crate::calibration::{TransformSigma, Verdict};
use crate::deployment::{Deployment, Finding, pairwise_distances};
use crate::geometry::RigidTransform;

/// A reading of the rig, to the millimetre and with 2 mm of noise, may differ this much from the distances (m).
const RIG_DISTANCE_M: f64 = 0.010;
/// The vehicle may have been tilted this much against the drive's average while its rig was read.
const RIG_TILT_RAD: f64 = 0.2;
/// A minimum that is no mirror twin makes the answer ambiguous below this cost ratio.
const CLOSE_RIVAL: f64 = 2.0;

/// What a verdict is made from.
pub struct Evidence<'a> {
    pub deployment: &'a Deployment,
    /// Enough triplets to see the track and the size of the errors.
    pub thinned: &'a CentredTriplets,
    pub answer: &'a Minimum,
    pub rival: Option<(Parameters, f64)>,
    pub uncertainty: &'a Uncertainty,
    pub choice: &'a Choice,
    /// The answer, refined where that was asked for, and its σ.
    pub station1_from_station: &'a [RigidTransform; 3],
    pub sigma: Option<[TransformSigma; 2]>,
}

/// Judges the answer; reasons are added to the findings, the mirror's first.
pub fn judge(evidence: &Evidence<'_>, findings: &mut Vec<Finding>) -> Verdict {
    let Evidence { thinned, answer, uncertainty, choice, .. } = *evidence;
    findings.splice(0..0, choice.findings.iter().cloned());
    let mut verdict = if choice.ambiguous { Verdict::Ambiguous } else { Verdict::Good };
    let mut lower = |to: Verdict, finding: Finding| {
        verdict = verdict.max(to);
        findings.push(finding);
    };
    if let Some(finding) = rival(evidence) {
        lower(Verdict::Ambiguous, finding);
    }
    let control_points = evidence.sigma.and_then(|sigma| {
        control_points_contradict(evidence.deployment, evidence.station1_from_station, &sigma)
    });
    let doubts = [control_points, rig_contradicts(evidence), poor_fit(evidence)];
    for finding in doubts.into_iter().flatten() {
        lower(Verdict::Weak, finding);
    }
    if !answer.converged {
        lower(Verdict::Weak, Finding::warning("the solver stopped before it reached the minimum"));
    }
    let direction = describe(thinned, &uncertainty.weakest);
    let advice = "drive a figure-eight with turns to both sides";
    // The weakest direction is judged at the track; the numbers above hold at the stations, which may lie far away.
    let largest_m = evidence.sigma.map_or(f64::INFINITY, |sigma| {
        sigma.iter().map(|s| s.translation_m.max()).fold(uncertainty.weakest_sigma_m, f64::max)
    });
    if uncertainty.weakest_sigma_m > FREE_SIGMA_M {
        let line = format!("the drive leaves a direction free: {direction}; {advice}");
        lower(Verdict::Degenerate, Finding::problem(line));
    } else if largest_m > WEAK_SIGMA_M {
        let line =
            format!("weakly held: {direction} (σ up to {:.0} mm); {advice}", largest_m * 1e3);
        lower(Verdict::Weak, Finding::warning(line));
    } else {
        let sigma_mm = uncertainty.weakest_sigma_m * 1e3;
        findings.push(Finding::note(format!("least certain: {direction} (σ {sigma_mm:.1} mm)")));
    }
    verdict
}

/// Another minimum, not the mirror twin, that the data cannot tell from the answer.
fn rival(evidence: &Evidence<'_>) -> Option<Finding> {
    let (rival, cost_ratio) = evidence.rival.filter(|(_, ratio)| *ratio < CLOSE_RIVAL)?;
    // Its heights may be mirrored too; that difference is the twin's, not the rival's.
    let apart_m = [rival, evidence.thinned.mirrored_in_height(&rival, [true, true])]
        .map(|rival| {
            let apart = rival - evidence.answer.parameters;
            apart.fixed_rows::<3>(0).norm().max(apart.fixed_rows::<3>(4).norm())
        })
        .into_iter()
        .fold(f64::INFINITY, f64::min);
    Some(Finding::warning(format!(
        "another solution {apart_m:.2} m away costs only {cost_ratio:.2} times as much; turn to both sides while driving"
    )))
}

/// The rig's own reading against the distances, and against the heights of the answer.
fn rig_contradicts(evidence: &Evidence<'_>) -> Option<Finding> {
    let rig = evidence.deployment.rig.as_ref()?;
    let read_m = pairwise_distances(&rig.prisms_m?);
    let heights_m = rig.height_differences_m()?;
    let off_m = (0..3).map(|i| (read_m[i] - rig.inter_prism_m[i]).abs()).fold(0.0, f64::max);
    if off_m > RIG_DISTANCE_M {
        return Some(Finding::warning(format!(
            "the inter-prism distances and the reading of the rig disagree by {:.0} mm; one of them is wrong",
            off_m * 1e3
        )));
    }
    let found_m = evidence.choice.answer.height_differences_m;
    let misfit_m = (0..2)
        .map(|i| (found_m[i] - heights_m[i]).abs() - RIG_TILT_RAD * rig.inter_prism_m[i])
        .fold(f64::NEG_INFINITY, f64::max);
    (misfit_m > 0.0).then(|| {
        Finding::warning(format!(
            "prism 1 stands {:+.2} and {:+.2} m above prisms 2 and 3 in this answer, {:+.2} and {:+.2} m in the reading \
             of the rig; check which station tracked which prism",
            found_m[0], found_m[1], heights_m[0], heights_m[1]
        ))
    })
}

/// Errors larger than noise, interpolation and the distances explain.
fn poor_fit(evidence: &Evidence<'_>) -> Option<Finding> {
    let mut errors_m = evidence.thinned.distance_errors_m(&evidence.answer.parameters);
    errors_m.iter_mut().for_each(|e| *e = e.abs());
    let middle = errors_m.len() / 2;
    let median_m = *errors_m.select_nth_unstable_by(middle, f64::total_cmp).1;
    (median_m > POOR_FIT_M).then(|| {
        Finding::warning(format!(
            "the distances fit poorly (median {:.1} mm): check the order of the prisms, the distances, the clocks and the filters",
            median_m * 1e3
        ))
    })
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
