//! Method C: point-to-point alignment of the tracks of one moving prism that all three stations follow.
//!
//! The same cost as method B on the pipeline's triplets (`paper.tex`, "Dynamic GCP calibration").

use super::point_to_point::{self, Errors, Matches};
use super::{
    Calibration, CalibrationError, CalibrationSettings, Details, Method, Offer, Verdict, checks,
    time_blocks,
};
use crate::deployment::{Deployment, Finding};
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

use super::targets::Targets;

/// Three positions a triplet, two transforms.
const FEWEST_TRIPLETS: usize = 10;
/// The sandwich needs clearly more blocks than unknowns.
const FEWEST_BLOCKS: usize = 12;

#[derive(Clone, Debug, PartialEq)]
pub struct DynamicGcpDetails {
    /// Root mean square of the distances between the aligned tracks (m).
    pub rms_m: f64,
    /// Independent stretches of time that the covariance counts.
    pub blocks: usize,
}

pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<Calibration, CalibrationError> {
    let started = std::time::Instant::now();
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
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let block: Vec<u32> = blocks
        .iter()
        .enumerate()
        .flat_map(|(number, range)| range.clone().map(move |_| number as u32))
        .collect();
    let matches: Vec<Matches> = (1..3)
        .map(|station| Matches {
            to_m: triplets.points_m[0].clone(),
            from_m: triplets.points_m[station].clone(),
            block: block.clone(),
        })
        .collect();
    let aligned =
        point_to_point::align(&matches, settings.alignment, Errors::ByBlock).ok_or_else(|| {
            CalibrationError::PointsOnALine {
                deployment: deployment.name.clone(),
                method: Method::DynamicGcp,
            }
        })?;
    let squares = aligned.residuals_m.iter().flatten().map(nalgebra::Vector3::norm_squared);
    let rms_m = (squares.sum::<f64>() / (2 * triplets.len()) as f64).sqrt();
    let covariance = aligned.covariance.as_ref().map(point_to_point::level_part);
    let mut findings = vec![Finding::note(format!(
        "tracks of one prism aligned, {:.1} mm rms over {} stretches of time",
        rms_m * 1e3,
        blocks.len()
    ))];
    let mut verdict = Verdict::Good;
    let mut lower = |to: Verdict, line: String| {
        verdict = verdict.max(to);
        findings.push(Finding::warning(line));
    };
    if offer.targets == Targets::Undecided {
        lower(
            Verdict::Ambiguous,
            "the drive hardly turns, so one prism cannot be told from three; if it was one, say `prisms = 1` in \
             deployment.toml"
                .to_owned(),
        );
    }
    if rms_m > checks::HOPELESS_FIT_M {
        lower(
            Verdict::Degenerate,
            format!(
                "the tracks lie {:.2} m apart (rms): the stations did not follow one prism, or their clocks are far off",
                rms_m
            ),
        );
    } else if rms_m > checks::POOR_POINT_FIT_M {
        lower(
            Verdict::Weak,
            format!(
                "the tracks fit poorly ({:.1} mm rms): check the clocks and the filters",
                rms_m * 1e3
            ),
        );
    }
    if blocks.len() < FEWEST_BLOCKS {
        lower(
            Verdict::Weak,
            format!(
                "only {} stretches of independent time; σ is rough below {FEWEST_BLOCKS}: record longer",
                blocks.len()
            ),
        );
    }
    let station1_from_station = [RigidTransform::IDENTITY, aligned.to_from[0], aligned.to_from[1]];
    let mut calibration = Calibration {
        method: Method::DynamicGcp,
        station1_from_station,
        sigma: covariance.as_ref().map(point_to_point::sigmas),
        covariance,
        verdict,
        findings,
        details: Details::DynamicGcp(DynamicGcpDetails { rms_m, blocks: blocks.len() }),
        prior_ms: 0.0,
        solve_ms: 0.0,
    };
    checks::hold_against_the_rest(&mut calibration, deployment, triplets);
    calibration.solve_ms = started.elapsed().as_secs_f64() * 1e3;
    Ok(calibration)
}
