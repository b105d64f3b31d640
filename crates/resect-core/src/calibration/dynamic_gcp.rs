//! Method C: point-to-point alignment of the tracks of one moving prism that all three stations follow.
//!
//! The same cost as method B on the pipeline's triplets (Vaidis et al. 2022, section "Dynamic methods", "Dynamic GCPs
//! calibration").

use std::borrow::Cow;

use super::inter_prism::gross_errors::{self, NOTABLE_PULL_M};
use super::joint::{self, JointEstimate};
use super::point_to_point::{self, Aligned, Errors, Matches};
use super::track_clocks::{self, TrackClocks};
use super::{
    Alignment, Calibration, CalibrationError, CalibrationSettings, Details, Loss, Method, Offer,
    Verdict, checks, common_errors, time_blocks,
};
use super::{clocks_in_words, with_clocks};
use crate::deployment::{Deployment, Finding, Overrides, Remedy};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::stopwatch::Stopwatch;

use super::targets::Targets;

/// Three positions a triplet, two transforms.
const FEWEST_TRIPLETS: usize = 10;
/// The sandwich needs clearly more blocks than unknowns.
const FEWEST_BLOCKS: usize = 12;

#[derive(Clone, Debug)]
pub struct DynamicGcpDetails {
    /// Root mean square of the distances between the aligned tracks (m).
    pub rms_m: f64,
    /// Independent stretches of time that the covariance counts.
    pub blocks: usize,
    /// The clocks of stations 2 and 3, where they were to be estimated.
    pub clocks: Option<Box<TrackClocks>>,
    /// The joint estimate, where the readings themselves were used.
    pub joint: Option<Box<JointEstimate>>,
}

pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<Calibration, CalibrationError> {
    let started = Stopwatch::start();
    if offer.lack(Method::DynamicGcp).is_some() {
        return Err(CalibrationError::lacking(deployment, Method::DynamicGcp, offer));
    }
    if triplets.len() < FEWEST_TRIPLETS {
        return Err(CalibrationError::TooFewTriplets {
            deployment: deployment.name.clone(),
            found: triplets.len(),
            needed: FEWEST_TRIPLETS,
        });
    }
    let align = |triplets: &Triplets| align(triplets, settings.alignment);
    let on_a_line = || CalibrationError::PointsOnALine {
        deployment: deployment.name.clone(),
        method: Method::DynamicGcp,
    };
    let mut used = Cow::Borrowed(triplets);
    let mut aligned = align(&used).ok_or_else(on_a_line)?;
    let kept = fitting(&aligned);
    let wild = triplets.len() - kept.len();
    let mut pulled_m = 0.0;
    if wild > 0 && kept.len() >= FEWEST_TRIPLETS {
        let fitting = triplets.select(&kept);
        let without = align(&fitting).ok_or_else(on_a_line)?;
        if settings.loss == Loss::Squared {
            pulled_m = (0..2)
                .map(|k| without.to_from[k].translation_m - aligned.to_from[k].translation_m)
                .map(|moved| moved.norm())
                .fold(0.0, f64::max);
        } else {
            (used, aligned) = (Cow::Owned(fitting), without);
        }
    }
    let mut clocks = track_clocks::estimate(&used, &transforms(&aligned));
    let mut covariance = aligned.covariance.as_ref().map(point_to_point::level_part);
    let mut estimated = None;
    if settings.estimate.clocks
        && settings.alignment == Alignment::Level
        && let Some(found) = clocks.take()
    {
        let corrected = with_clocks(&used, found.clocks());
        aligned = align(&corrected).ok_or_else(on_a_line)?;
        covariance =
            track_clocks::estimate(&corrected, &transforms(&aligned)).map(|c| c.covariance);
        estimated = Some(Box::new(found));
    } else if let Some(found) = &clocks {
        // A clock that is off biases this answer; nobody may take it for more certain than that.
        covariance =
            covariance.map(|covariance| covariance + found.moves * found.moves.transpose());
    }
    let common = common_errors::covariance(&used, |triplets| {
        let placed = point_to_point::transforms(&matches(triplets), settings.alignment)?;
        Some([RigidTransform::IDENTITY, placed[0], placed[1]])
    });
    let covariance = covariance.zip(common).map(|(own, common)| own + common);
    let blocks = time_blocks::of(&used.time_s, &used.interval);
    let squares = aligned.residuals_m.iter().flatten().map(nalgebra::Vector3::norm_squared);
    let rms_m = (squares.sum::<f64>() / (2 * used.len()) as f64).sqrt();
    let mut findings = vec![Finding::note(format!(
        "tracks of one prism aligned, {:.1} mm rms over {} stretches of time",
        rms_m * 1e3,
        blocks.len()
    ))];
    let mut verdict = Verdict::Good;
    let mut lower = |to: Verdict, finding: Finding| {
        verdict = verdict.max(to);
        findings.push(finding);
    };
    if offer.targets == Targets::Undecided {
        let line = "the drive hardly turns, so one prism cannot be told from three; if it was one, say `prisms = 1` in \
                    deployment.toml";
        let one_prism = Overrides { prisms: Some(1), ..Overrides::default() };
        lower(
            Verdict::Ambiguous,
            Finding::warning(line).with(Remedy::ReadWith(Box::new(one_prism))),
        );
    }
    if pulled_m > NOTABLE_PULL_M {
        let pulled_mm = pulled_m * 1e3;
        lower(
            Verdict::Weak,
            Finding::warning(format!(
                "{wild} triplets that cannot be right pull this answer by {pulled_mm:.0} mm; the joint estimate leaves them out"
            ))
            .with(Remedy::JointEstimate),
        );
    }
    if rms_m > checks::HOPELESS_FIT_M {
        lower(
            Verdict::Degenerate,
            Finding::warning(format!(
                "the tracks lie {:.2} m apart (rms): the stations did not follow one prism, or their clocks are far off",
                rms_m
            ))
            .with(Remedy::PutRight),
        );
    } else if rms_m > checks::POOR_POINT_FIT_M {
        lower(
            Verdict::Weak,
            Finding::warning(format!(
                "the tracks fit poorly ({:.1} mm rms): check the clocks and the filters",
                rms_m * 1e3
            )),
        );
    }
    if blocks.len() < FEWEST_BLOCKS {
        lower(
            Verdict::Weak,
            Finding::warning(format!(
                "only {} stretches of independent time; σ is rough below {FEWEST_BLOCKS}: record longer",
                blocks.len()
            )),
        );
    }
    if let Some(found) = &clocks {
        for finding in clocks_in_words::suspicions(&found.offsets_s) {
            verdict = verdict.max(Verdict::Weak);
            findings.push(finding);
        }
    }
    if let Some(found) = &estimated {
        let uneven = clocks_in_words::implausible_drifts(
            &found.drifts,
            &[false; 2],
            clocks_in_words::NOT_CORRECTED,
        );
        if !uneven.is_empty() {
            verdict = verdict.max(Verdict::Weak);
        }
        findings.extend(uneven);
        // The joint estimate has its own.
        if settings.method != Some(Method::Joint) {
            let clocks = clocks_in_words::clocks(&found.offsets_s, &found.drifts);
            findings.extend(clocks.into_iter().map(Finding::tabled));
        }
    }
    let station1_from_station = transforms(&aligned);
    let mut calibration = Calibration {
        method: Method::DynamicGcp,
        station1_from_station,
        sigma: covariance.as_ref().map(point_to_point::sigmas),
        covariance,
        verdict,
        findings,
        checked_by: Vec::new(),
        details: Details::DynamicGcp(DynamicGcpDetails {
            rms_m,
            blocks: blocks.len(),
            clocks: estimated,
            joint: None,
        }),
        published: None,
        prior_ms: 0.0,
        solve_ms: 0.0,
    };
    checks::hold_against_the_rest(&mut calibration, deployment, triplets);
    calibration.solve_ms = started.elapsed_ms();
    Ok(calibration)
}

/// The joint estimate of one prism: from the aligned tracks on, out of the readings themselves.
pub fn solve_jointly(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let started = Stopwatch::start();
    let mut calibration = solve(deployment, triplets, settings, offer)?;
    let plain = calibration
        .station1_from_station
        .map(|transform| LevelTransform::new(transform.translation_m, transform.yaw_rad()));
    let triplets = || Cow::Borrowed(triplets);
    let Some(joint) = joint::estimate(&triplets, &plain, None, &settings.errors, progress)? else {
        calibration.verdict = calibration.verdict.max(Verdict::Weak);
        let line = "the readings do not hold all that the joint estimate asks of them: these are the aligned tracks";
        calibration.findings.insert(0, Finding::warning(line));
        return Ok(calibration);
    };
    let doubts = checks::unconverged(joint.converged).into_iter();
    for (to, finding) in doubts.chain(joint::in_words::doubts(&joint)).rev() {
        calibration.verdict = calibration.verdict.max(to);
        calibration.findings.insert(0, finding);
    }
    calibration.findings.extend(joint::in_words::findings(&joint));
    calibration.station1_from_station = joint.station1_from_station.map(RigidTransform::from);
    calibration.covariance = Some(joint.covariance);
    calibration.sigma = Some(joint.sigma());
    if let Details::DynamicGcp(details) = &mut calibration.details {
        details.clocks = None;
        details.joint = Some(Box::new(joint));
    }
    calibration.solve_ms = started.elapsed_ms();
    Ok(calibration)
}

fn align(triplets: &Triplets, alignment: Alignment) -> Option<Aligned> {
    point_to_point::align(&matches(triplets), alignment, Errors::ByBlock)
}

/// Stations 2 and 3 with station 1.
fn matches(triplets: &Triplets) -> Vec<Matches> {
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let block: Vec<u32> = blocks
        .iter()
        .enumerate()
        .flat_map(|(number, range)| range.clone().map(move |_| number as u32))
        .collect();
    (1..3)
        .map(|station| Matches {
            to_m: triplets.points_m[0].clone(),
            from_m: triplets.points_m[station].clone(),
            block: block.clone(),
        })
        .collect()
}

fn transforms(aligned: &Aligned) -> [RigidTransform; 3] {
    [RigidTransform::IDENTITY, aligned.to_from[0], aligned.to_from[1]]
}

/// Triplets whose positions belong together.
fn fitting(aligned: &Aligned) -> Vec<usize> {
    let [second, third] = [0, 1].map(|k| &aligned.residuals_m[k]);
    gross_errors::fitting(second.iter().zip(third).map(|(a, b)| [a.norm(), b.norm(), 0.0]))
}
