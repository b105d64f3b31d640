//! Method C: point-to-point alignment of the tracks of one moving prism that all stations follow.
//!
//! The same cost as method B on the pipeline's triplets (Vaidis et al. 2022, section "Dynamic methods", "Dynamic GCPs
//! calibration").

use std::borrow::Cow;
use std::sync::Arc;

use nalgebra::{DMatrix, Vector3};

use super::common_errors::{self, Displaced};
use super::followed_prisms::{one_prism, schedule};
use super::inter_prism::gross_errors::{self, NOTABLE_PULL_M};
use super::joint;
use super::joint::{JointEstimate, JointInput, Layout, RigDistances};
use super::joint_data::{JointData, contradicting_runs};
use super::joint_failure::{JointFailure, JointResult};
use super::judgement::Judgement;
use super::method_answer::MethodAnswer;
use super::point_to_point::{self, Aligned, Errors, Matches};
use super::track_clocks::{self, TrackClocks};
use super::{
    Alignment, CalibrationError, CalibrationSettings, ErrorSizes, Estimate, Method, Offer, Verdict,
    checks, time_blocks,
};
use super::{clocks_in_words, with_clocks};
use crate::deployment::findings::outliers::outliers_shift_answer;
use crate::deployment::findings::points::{
    few_time_blocks, prism_count_undecided, tracks_aligned, tracks_apart, tracks_fit_poorly,
};
use crate::deployment::{Deployment, Finding};
use crate::geometry::{LevelTransform, RigidTransform};
use crate::network::{PerPair, PerStation, Station};
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Fewest triplets for the two transforms; each has three positions.
const FEWEST_TRIPLETS: usize = 10;
/// Number of triplets from which the effect of a shared error is computed.
const ENOUGH: usize = 400;
/// The sandwich needs clearly more blocks than unknowns.
const FEWEST_BLOCKS: usize = 12;

#[derive(Clone, Copy, Debug)]
pub struct DynamicGcpDetails {
    /// Root mean square of the distances between the aligned tracks (m).
    pub rms_m: f64,
    /// Number of independent blocks of time in the covariance.
    pub blocks: usize,
}

/// Calibrates by the alignment of the tracks, as published.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<MethodAnswer<DynamicGcpDetails>, CalibrationError> {
    require_triplets(deployment, triplets, offer)?;
    let tracks = AlignedTracks::published(triplets, settings.alignment)
        .ok_or_else(|| on_a_line(deployment))?;
    let mut judgement = tracks.judge(offer);
    if let Some(clocks) = &tracks.clocks {
        judgement.doubt(clocks_in_words::suspicions(&clocks.offsets_s));
    }
    let mut answer = tracks.into_answer(settings.alignment, &settings.errors, judgement);
    let rms_m = answer.details.rms_m;
    checks::check_with_unused_data(&mut answer, rms_m, deployment, triplets, None);
    Ok(answer)
}

/// Calibrates by the joint estimate of one prism, which starts from the aligned tracks. If it fails, the answer is that of method C.
pub fn solve_jointly(
    deployment: &Deployment,
    all: &JointData<'_>,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<MethodAnswer<(JointResult, DynamicGcpDetails)>, CalibrationError> {
    let triplets = all.triplets;
    require_triplets(deployment, triplets, offer)?;
    let tracks = AlignedTracks::robust(triplets).ok_or_else(|| on_a_line(deployment))?;
    let judgement = tracks.judge(offer);
    let drifts = tracks.clocks.as_ref().map(|clocks| clocks.drifts.clone());
    let mut answer = tracks.into_answer(Alignment::Level, &settings.errors, judgement);
    let plain = answer
        .station1_from_station
        .map(|transform| LevelTransform::new(transform.translation_m, transform.yaw_rad()));
    let layout = &Arc::new(Layout::of_schedule(&schedule(deployment, &one_prism(deployment))));
    let rig = match &deployment.rig {
        Some(rig) if layout.pairs() > 0 => RigDistances::new(rig, layout, settings.evidence.rig),
        _ => RigDistances::exact(PerPair::default()),
    };
    let input = JointInput {
        layout,
        published: &plain,
        rig,
        survey: joint::adjust_survey::of_deployment(deployment, layout, settings),
        is_determined_by_drive: true,
        sizes: &settings.errors,
    };
    let (readings, runs) = all.fitting(deployment, &offer.followed, &plain);
    let estimate = joint::estimate(&readings, &input, progress)?;
    let estimate = match estimate {
        Ok(estimate) => estimate,
        Err(trace) => {
            let failure = JointFailure::from(trace);
            let published = solve(deployment, all.of_published, settings, offer)
                .map_err(|why| failure.without_published(why))?;
            return Ok(published.in_place_of_joint(failure));
        }
    };
    answer.station1_from_station =
        estimate.station1_from_station.map(|level| RigidTransform::from(*level));
    let covariance = &estimate.covariance;
    answer.covariance = Some(DMatrix::from_column_slice(
        covariance.nrows(),
        covariance.ncols(),
        covariance.as_slice(),
    ));
    let (rms_m, survey) = (answer.details.rms_m, estimate.survey.as_ref());
    checks::check_with_unused_data(&mut answer, rms_m, deployment, triplets, survey);
    let judgement = &mut answer.judgement;
    if let Some(drifts) = drifts {
        judgement.doubt(drifts_beyond_the_estimate(&drifts, &estimate));
    }
    let rig = deployment.rig.as_ref();
    joint::findings::add_notes(&mut judgement.findings, &estimate, rig);
    judgement.findings.extend(contradicting_runs(&runs, triplets.time_s[0]));
    judgement.put_first(joint::findings::doubts(&estimate));
    Ok(MethodAnswer {
        method: Method::Joint,
        station1_from_station: answer.station1_from_station,
        covariance: answer.covariance,
        judgement: answer.judgement,
        checked_by: answer.checked_by,
        details: (Ok(estimate), answer.details),
        prior_ms: 0.0,
    })
}

/// Returns the implausible drifts of the tracks where the estimate determines none: such a clock wanders more than it allows for.
fn drifts_beyond_the_estimate(
    drifts: &PerStation<Estimate>,
    estimate: &JointEstimate,
) -> Vec<Finding> {
    let by_readings = estimate.clock_drifts_by_readings();
    let beyond = drifts.zip(&by_readings, |of_tracks, by_readings| {
        if by_readings.sigma.is_finite() { Estimate::ZERO } else { *of_tracks }
    });
    clocks_in_words::implausible_drifts(&beyond, &beyond.map(|_| false), false)
}

fn require_triplets(
    deployment: &Deployment,
    triplets: &Triplets,
    offer: &Offer,
) -> Result<(), CalibrationError> {
    // The joint estimate starts from all readings, also where the paper's pipeline leaves no triplets, and from the track of one station.
    let published_lacks = offer.lack(offer.published_method()).is_some();
    let is_joint_alone = published_lacks && offer.lack(Method::Joint).is_none();
    let method = if is_joint_alone { Method::Joint } else { Method::DynamicGcp };
    if offer.lack(method).is_some() {
        return Err(CalibrationError::lacking(deployment, method, offer));
    }
    if triplets.len() < FEWEST_TRIPLETS {
        return Err(CalibrationError::TooFewTriplets {
            deployment: deployment.name.clone(),
            found: triplets.len(),
            needed: FEWEST_TRIPLETS,
        });
    }
    Ok(())
}

fn on_a_line(deployment: &Deployment) -> CalibrationError {
    CalibrationError::PointsOnALine {
        deployment: deployment.name.clone(),
        method: Method::DynamicGcp,
    }
}

/// Aligned tracks with their uncertainty.
struct AlignedTracks<'a> {
    used: Cow<'a, Triplets>,
    aligned: Aligned,
    /// Covariance of (x, y, z, yaw) of stations 2, 3, … from the scatter of the tracks (m, rad).
    covariance: Option<DMatrix<f64>>,
    /// One-step estimate of the clocks.
    clocks: Option<TrackClocks>,
    /// Number of gross outliers, and the shift of the answer by them (m).
    wild: usize,
    pulled_m: f64,
}

impl<'a> AlignedTracks<'a> {
    /// Aligns all triplets as published. `None` if the points do not determine an alignment.
    fn published(triplets: &'a Triplets, alignment: Alignment) -> Option<Self> {
        let aligned = align(triplets, alignment)?;
        let fitting = fitting_triplets(triplets, &aligned);
        let mut pulled_m = 0.0;
        if let Some(fitting) = &fitting {
            let without = align(fitting, alignment)?;
            let both = without.to_from.iter().zip(&aligned.to_from);
            pulled_m = both
                .map(|(without, with)| (without.translation_m - with.translation_m).norm())
                .fold(0.0, f64::max);
        }
        let wild = fitting.map_or(0, |fitting| triplets.len() - fitting.len());
        let clocks = track_clocks::estimate(triplets, &transforms(&aligned));
        let covariance = aligned.covariance.as_ref().map(point_to_point::level_part);
        // A clock offset biases this answer, so σ covers the bias.
        let covariance = match &clocks {
            Some(found) => covariance.map(|own| own + &found.moves * found.moves.transpose()),
            None => covariance,
        };
        Some(Self { used: Cow::Borrowed(triplets), aligned, covariance, clocks, wild, pulled_m })
    }

    /// Aligns the triplets without gross outliers, with corrected clocks. `None` if the points do not determine an alignment.
    fn robust(triplets: &'a Triplets) -> Option<Self> {
        let align = |triplets: &Triplets| align(triplets, Alignment::Level);
        let mut used = Cow::Borrowed(triplets);
        let mut aligned = align(&used)?;
        if let Some(fitting) = fitting_triplets(triplets, &aligned) {
            aligned = align(&fitting)?;
            used = Cow::Owned(fitting);
        }
        let clocks = track_clocks::estimate(&used, &transforms(&aligned));
        let mut covariance = aligned.covariance.as_ref().map(point_to_point::level_part);
        if let Some(found) = &clocks {
            let corrected = with_clocks(&used, &found.clocks());
            aligned = align(&corrected)?;
            covariance = track_clocks::estimate(&corrected, &transforms(&aligned))
                .map(|found| found.covariance);
        }
        Some(Self { used, aligned, covariance, clocks, wild: 0, pulled_m: 0.0 })
    }

    fn rms_m(&self) -> f64 {
        let squares = self.aligned.residuals_m.iter().flatten().map(Vector3::norm_squared);
        (squares.sum::<f64>() / (self.aligned.residuals_m.len() * self.used.len()) as f64).sqrt()
    }

    fn details(&self) -> DynamicGcpDetails {
        let blocks = time_blocks::of(&self.used.time_s, &self.used.interval).len();
        DynamicGcpDetails { rms_m: self.rms_m(), blocks }
    }

    /// Returns the answer of method C.
    fn into_answer(
        self,
        alignment: Alignment,
        sizes: &ErrorSizes,
        judgement: Judgement,
    ) -> MethodAnswer<DynamicGcpDetails> {
        let details = self.details();
        let independent = 3 * details.blocks * self.aligned.to_from.len();
        let stride = self.used.len().div_ceil(ENOUGH).max(1);
        let some: Vec<usize> = (0..self.used.len()).step_by(stride).collect();
        let some = self.used.select(&some);
        let common =
            common_errors::effect(sizes, some.points_m.len(), independent, &[], |displace| {
                let points_m = some.points_m.map_each(|station, points| {
                    points.iter().map(|point| displace(station, point)).collect()
                });
                let displaced = matches(&Triplets { points_m, ..some.clone() });
                let placed = point_to_point::transforms(&displaced, alignment)?;
                let residuals_m = point_to_point::residuals_m(&displaced, &placed).concat();
                let placed = std::iter::once(RigidTransform::IDENTITY).chain(placed).collect();
                Some(Displaced::new(placed, &residuals_m))
            });
        // Variance of a random walk's mean about its start is a third of that of its end.
        let settling = common_errors::settling(sizes, &transforms(&self.aligned)) / 3.0;
        MethodAnswer {
            method: Method::DynamicGcp,
            station1_from_station: transforms(&self.aligned),
            covariance: self
                .covariance
                .zip(common)
                .map(|(own, common)| own + common.covariance + settling),
            judgement,
            checked_by: Vec::new(),
            details,
            prior_ms: 0.0,
        }
    }

    /// Judges the fit of the tracks.
    fn judge(&self, offer: &Offer) -> Judgement {
        let DynamicGcpDetails { rms_m, blocks } = self.details();
        // The track of a single station has nothing to be aligned with.
        let fit = (!self.aligned.residuals_m.is_empty()).then(|| tracks_aligned(rms_m, blocks));
        let mut judgement = Judgement::good(fit.into_iter().collect());
        if offer.is_undecided {
            judgement.lower(Verdict::Ambiguous, prism_count_undecided());
        }
        if self.pulled_m > NOTABLE_PULL_M {
            judgement.doubt([outliers_shift_answer(self.wild, None, self.pulled_m)]);
        }
        if rms_m > checks::HOPELESS_FIT_M {
            judgement.lower(Verdict::Degenerate, tracks_apart(rms_m));
        } else if rms_m > checks::POOR_POINT_FIT_M {
            judgement.doubt([tracks_fit_poorly(rms_m)]);
        }
        if blocks < FEWEST_BLOCKS {
            judgement.doubt([few_time_blocks(blocks, FEWEST_BLOCKS)]);
        }
        judgement
    }
}

fn align(triplets: &Triplets, alignment: Alignment) -> Option<Aligned> {
    point_to_point::align(&matches(triplets), alignment, Errors::ByBlock)
}

/// Returns the points of stations 2, 3, … with those of station 1.
fn matches(triplets: &Triplets) -> Vec<Matches> {
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);
    let block: Vec<u32> = blocks
        .iter()
        .enumerate()
        .flat_map(|(number, range)| range.clone().map(move |_| number as u32))
        .collect();
    let first_m = &triplets.points_m[Station::FIRST];
    let others_m = triplets.points_m.iter().skip(1);
    others_m
        .map(|points_m| Matches {
            to_m: first_m.clone(),
            from_m: points_m.clone(),
            block: block.clone(),
        })
        .collect()
}

fn transforms(aligned: &Aligned) -> PerStation<RigidTransform> {
    std::iter::once(RigidTransform::IDENTITY).chain(aligned.to_from.iter().copied()).collect()
}

/// Returns the triplets whose positions agree; `None` if these are all triplets, or too few.
fn fitting_triplets(triplets: &Triplets, aligned: &Aligned) -> Option<Triplets> {
    let largest_m = |index: usize| {
        aligned.residuals_m.iter().map(|residuals_m| residuals_m[index].norm()).fold(0.0, f64::max)
    };
    let kept = gross_errors::fitting((0..triplets.len()).map(|index| [largest_m(index)]));
    (kept.len() < triplets.len() && kept.len() >= FEWEST_TRIPLETS).then(|| triplets.select(&kept))
}
