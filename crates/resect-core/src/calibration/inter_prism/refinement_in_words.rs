//! What a refinement found, in words: what is off and which way, whether the data supports it, what moved.

use super::refinement::{Refinement, Support};
use crate::calibration::clocks_in_words::{NOT_CORRECTED, clocks, implausible_drifts};
use crate::calibration::estimate::sigmas_in_words;
use crate::calibration::instrument::{PRISM_CONSTANT_SIGMA_M, TILT_SIGMA_RAD};
use crate::calibration::{CalibrationSettings, Verdict};
use crate::deployment::{Finding, Remedy, ToldAngle, ToldIn, pair_label};

/// An inter-prism distance this many millimetres from its measurement asks for a new one.
const NOTABLE_DISTANCE_M: f64 = 0.003;
/// An estimate further than this many σ of its prior from where that puts it has another cause than chance.
const MOST_PRIOR_SIGMAS: f64 = 5.0;
/// No rig is measured better than this (m).
const LEAST_DISTANCE_SIGMA_M: f64 = 1e-4;

pub fn findings(refined: &Refinement, inter_prism_m: &[f64; 3]) -> Vec<Finding> {
    let mut findings = Vec::new();
    if refined.joint.is_none()
        && let (Some(offsets_s), Some(drifts)) = (&refined.clock_offsets_s, &refined.clock_drifts)
    {
        findings.extend(clocks(offsets_s, drifts).into_iter().map(Finding::tabled));
    }
    for (pair, distance) in refined.distances_m.iter().flatten().enumerate() {
        let off_m = distance.value - inter_prism_m[pair];
        let line = format!(
            "prisms {}: {:+.1} ± {:.1} mm against the measured distance{}",
            pair_label(pair),
            off_m * 1e3,
            distance.sigma * 1e3,
            sigmas_in_words(distance.sigmas_from(inter_prism_m[pair])),
        );
        findings.push(if off_m.abs() > NOTABLE_DISTANCE_M {
            Finding::warning(format!("{line}; measure the rig again")).with(Remedy::PutRight)
        } else {
            Finding::note(line).tabled()
        });
    }
    for (slot, tilts) in refined.tilts_rad.iter().flatten().enumerate() {
        let angles = tilts
            .map(|tilt| ToldAngle::signed(tilt.value, ToldIn::Arcseconds, 1).sigma(tilt.sigma));
        let [x, y] = angles;
        let largest = tilts.map(|tilt| tilt.sigmas_from(0.0).abs()).into_iter().fold(0.0, f64::max);
        let line = format!(
            "station {} leans {x} about x and {y} about y{}",
            slot + 2,
            sigmas_in_words(largest),
        );
        findings.push(Finding::note(line).telling(angles).tabled());
    }
    findings.extend(refined.support.iter().map(support_in_words));
    // Beside a joint estimate the published answer stands whole.
    if refined.joint.is_none() {
        let moves = refined.moves_sigmas.map(|sigmas| format!("{sigmas:+.1}"));
        findings.push(Finding::note(format!(
            "against the published method, in σ: T12 moved {} in x, y, z, yaw; T13 {}",
            moves[..4].join(", "),
            moves[4..].join(", ")
        )));
    }
    findings
}

/// Estimates of the refinement that their priors do not allow; those of the joint estimate are for its own words.
pub fn doubts(
    refined: &Refinement,
    inter_prism_m: &[f64; 3],
    settings: &CalibrationSettings,
) -> Vec<(Verdict, Finding)> {
    if refined.joint.is_some() {
        return Vec::new();
    }
    let mut doubts = Vec::new();
    let check = |line: String| Finding::warning(line).with(Remedy::PutRight);
    let distance_sigma_m = settings.inter_prism_sigma_m.max(LEAST_DISTANCE_SIGMA_M);
    for (pair, distance) in refined.distances_m.iter().flatten().enumerate() {
        let off_m = distance.value - inter_prism_m[pair];
        if off_m.abs() > MOST_PRIOR_SIGMAS * distance_sigma_m {
            doubts.push(check(format!(
                "prisms {} would be {:+.1} mm from their measured distance, which is known to {:.1} mm (1 σ): the rig, its \
                 units or the stations' numbers are wrong",
                pair_label(pair),
                off_m * 1e3,
                distance_sigma_m * 1e3
            )));
        }
    }
    for (slot, tilts) in refined.tilts_rad.iter().flatten().enumerate() {
        let leans_rad = tilts.map(|tilt| tilt.value.abs()).into_iter().fold(0.0, f64::max);
        if leans_rad > MOST_PRIOR_SIGMAS * TILT_SIGMA_RAD {
            let lean = ToldAngle::size(leans_rad, ToldIn::Arcseconds, 0);
            let known = ToldAngle::size(TILT_SIGMA_RAD, ToldIn::Arcseconds, 0);
            let line = format!(
                "station {} would lean by {lean}, which its compensator does not leave ({known}, 1 σ): it was knocked, or \
                 something else bends the answer",
                slot + 2,
            );
            doubts.push(Finding::warning(line).telling([lean, known]));
        }
    }
    if let Some(constant) = refined.prism_constant_error_m
        && constant.value.abs() > MOST_PRIOR_SIGMAS * PRISM_CONSTANT_SIGMA_M
    {
        doubts.push(check(format!(
            "ranges would be {:+.1} mm too long, where the prism constant is known to {:.1} mm (1 σ): check it",
            constant.value * 1e3,
            PRISM_CONSTANT_SIGMA_M * 1e3
        )));
    }
    doubts.into_iter().map(|finding| (Verdict::Weak, finding)).collect()
}

fn support_in_words(support: &Support) -> Finding {
    let Support { what, chi_square, unknowns, supported } = support;
    Finding::note(if *supported {
        format!("the data supports estimating the {what} (χ² = {chi_square:.0} on {unknowns})")
    } else {
        format!(
            "the data does not ask for the {what} (χ² = {chi_square:.1} on {unknowns}); they widen σ and hardly move the answer"
        )
    })
}

/// Clocks that drift as none does.
pub fn uneven_clocks(refined: &Refinement) -> Vec<Finding> {
    refined
        .clock_drifts
        .iter()
        .flat_map(|drifts| implausible_drifts(drifts, &[false; 2], NOT_CORRECTED))
        .collect()
}
