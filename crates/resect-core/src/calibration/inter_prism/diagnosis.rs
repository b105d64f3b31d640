//! The verdict, and the reasons for it in words that an engineer uses.

use super::drive_shape::Plan;
use super::mirror::Choice;
use super::motion_in_words::{TrackAxes, describe};
use super::observability::{Hold, Observability};
use super::uncertainty::Uncertainty;
use super::{CentredTriplets, Minimum, Parameters};
use crate::calibration::checks::{
    FREE_SIGMA_M, POOR_FIT_M, WEAK_SIGMA_M, control_points_contradict,
};
use crate::calibration::{ResolvedBy, TransformSigma, Verdict};
use crate::deployment::{Deployment, Finding, Remedy, Severity, ToldAngle, ToldIn};
use crate::geometry::RigidTransform;
use crate::statistics::median;

/// A minimum that is no mirror twin makes the answer ambiguous below this cost ratio.
const CLOSE_RIVAL: f64 = 2.0;

/// The stations are called far from the track where they are this many times less certain than anything at the track.
const FAR: f64 = 2.0;

/// What a verdict is made from.
pub struct Evidence<'a> {
    pub deployment: &'a Deployment,
    /// Triplets that are enough to see the track and the size of the errors.
    pub thinned: &'a CentredTriplets,
    pub answer: &'a Minimum,
    pub rival: Option<(Parameters, f64)>,
    pub uncertainty: &'a Uncertainty,
    pub observability: &'a Observability,
    pub choice: &'a Choice,
    /// The answer and its σ.
    pub station1_from_station: &'a [RigidTransform; 3],
    pub sigma: Option<[TransformSigma; 2]>,
}

/// Judges the answer; reasons are added to the findings, the mirror's first.
pub fn judge(evidence: &Evidence<'_>, findings: &mut Vec<Finding>) -> Verdict {
    let Evidence { thinned, answer, uncertainty, observability, choice, .. } = *evidence;
    findings.splice(0..0, choice.findings.iter().cloned());
    findings.extend(flat(evidence));
    let mut verdict = if choice.ambiguous { Verdict::Ambiguous } else { Verdict::Good };
    let mut lower = |to: Verdict, finding: Finding| {
        verdict = verdict.max(to);
        findings.push(finding);
    };
    if let Some(finding) = plan(evidence) {
        // What rests on one corner is not good, however small σ is: an error of that stretch is an error of everything.
        let weak = finding.severity > Severity::Note;
        lower(if weak { Verdict::Weak } else { Verdict::Good }, finding);
    }
    if let Some(finding) = rival(evidence) {
        lower(Verdict::Ambiguous, finding);
    }
    let control_points = evidence.sigma.and_then(|sigma| {
        control_points_contradict(evidence.deployment, evidence.station1_from_station, &sigma)
    });
    let doubts = [control_points, poor_fit(evidence)];
    for finding in doubts.into_iter().flatten() {
        lower(Verdict::Weak, finding);
    }
    if !answer.converged {
        lower(Verdict::Weak, Finding::warning("the solver stopped before it reached the minimum"));
    }
    let direction = describe(&TrackAxes::of(thinned), &uncertainty.weakest, false);
    let advice = observability.advice;
    // The weakest direction is judged at the track; the numbers above hold at the stations, which may lie far away.
    let largest_m = evidence.sigma.map_or(f64::INFINITY, |sigma| {
        sigma.iter().map(|s| s.translation_m.max()).fold(uncertainty.weakest_sigma_m, f64::max)
    });
    if uncertainty.weakest_sigma_m > FREE_SIGMA_M {
        let free = observability.words(Hold::Free);
        let line = format!("the drive leaves a direction free: {free}; next, {advice}");
        lower(Verdict::Degenerate, Finding::problem(line));
    } else if largest_m > WEAK_SIGMA_M {
        let largest_mm = largest_m * 1e3;
        let line = if largest_m > FAR * uncertainty.weakest_sigma_m {
            format!(
                "weakly held: the stations stand far from the track, where an error of yaw grows (σ up to \
                 {largest_mm:.0} mm); drive nearer to them, or over a larger area"
            )
        } else {
            format!("weakly held: {direction} (σ up to {largest_mm:.0} mm); next, {advice}")
        };
        lower(Verdict::Weak, Finding::warning(line));
    } else {
        let sigma_mm = uncertainty.weakest_sigma_m * 1e3;
        findings.push(Finding::note(format!("least certain: {direction} (σ {sigma_mm:.1} mm)")));
    }
    verdict
}

/// A drive whose shape leaves something free or weak, as what it is.
fn plan(evidence: &Evidence<'_>) -> Option<Finding> {
    let Evidence { observability, rival, .. } = *evidence;
    let mut angle = None;
    let mut told = |rad: f64| *angle.insert(ToldAngle::size(rad, ToldIn::Degrees, 0));
    let shape = match observability.drive.plan {
        Plan::Winding => return None,
        Plan::Standing => "the vehicle hardly moved".to_owned(),
        Plan::StraightLine { length_m, bends_m } => format!(
            "the drive is one straight line ({length_m:.0} m, bends under {:.1} m), on which the rig never turns",
            (bends_m * 10.0).ceil().max(1.0) / 10.0
        ),
        Plan::Circle { radius_m, driven_rad, .. } if driven_rad > std::f64::consts::TAU => {
            format!("the drive goes round one circle, one way (radius {radius_m:.1} m)")
        }
        Plan::Circle { radius_m, driven_rad, .. } => format!(
            "the drive is an arc of one circle ({} of radius {radius_m:.1} m)",
            told(driven_rad)
        ),
        Plan::TwoLegs { corner_m, turn_rad } => {
            let rival = rival.map_or_else(String::new, |(_, cost_ratio)| {
                format!(
                    ", with the rig turned another solution costs {cost_ratio:.1} times as much"
                )
            });
            format!(
                "the drive is an L, two straight legs with one corner of {} at ({:.1}, {:.1}) m: everything rests on \
                 that corner{rival}",
                told(turn_rad),
                corner_m.x,
                corner_m.y
            )
        }
    };
    let of_all = |count, how| match count {
        1 => format!("1 of 8 directions is {how}"),
        _ => format!("{count} of 8 directions are {how}"),
    };
    let (severity, holds) = match (observability.count(Hold::Free), observability.count(Hold::Weak))
    {
        (0, 0) => (Severity::Note, "yet all 8 directions are held".to_owned()),
        (0, weak) => (Severity::Warning, of_all(weak, "weakly held")),
        (free, _) => (Severity::Problem, of_all(free, "free")),
    };
    let finding = Finding::note(format!("{shape}; {holds}")).telling(angle);
    Some(Finding { severity, ..finding })
}

/// Ground on which nothing but the rig or control points tells the mirror twin.
fn flat(evidence: &Evidence<'_>) -> Option<Finding> {
    let drive = &evidence.observability.drive;
    let mirror = &evidence.choice.mirror;
    if !drive.is_flat() || mirror.twin.is_none() {
        return None;
    }
    let tilt = ToldAngle::size(drive.tilt_rad, ToldIn::Degrees, 2);
    let ground = if drive.is_floor() {
        format!("the floor is flat (heights vary by {:.0} mm)", drive.relief_m * 1e3)
    } else {
        format!("the rig never pitches or rolls (by {tilt} at most)")
    };
    let message = format!(
        "{ground}: heights have a mirror twin that only the rig or control points can tell from the answer"
    );
    Some(match mirror.resolved_by {
        ResolvedBy::Nothing => Finding::warning(message),
        _ => Finding::note(message),
    })
    .map(|finding| finding.telling((!drive.is_floor()).then_some(tilt)))
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

/// Errors larger than noise, interpolation and the distances explain.
fn poor_fit(evidence: &Evidence<'_>) -> Option<Finding> {
    let errors_m = evidence.thinned.distance_errors_m(&evidence.answer.parameters);
    let median_m = median(errors_m.into_iter().map(f64::abs))?;
    (median_m > POOR_FIT_M).then(|| {
        Finding::warning(format!(
            "the distances fit poorly (median {:.1} mm): check the order of the prisms, the distances, the clocks and the filters",
            median_m * 1e3
        ))
        .with(Remedy::PutRight)
    })
}
