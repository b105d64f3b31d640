//! The joint estimate without the drive: the adjustment of the control points alone.

use nalgebra::DMatrix;

use std::sync::Arc;

use super::followed_prisms::one_prism;
use super::joint::Layout;
use super::joint::adjust_survey::adjust;
use super::judgement::Judgement;
use super::method_answer::MethodAnswer;
use super::static_gcp::StaticGcpDetails;
use super::{CalibrationError, CalibrationSettings, Method, Offer, checks};
use crate::deployment::Deployment;
use crate::deployment::findings::points::control_points_aligned;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

/// Calibrates by the least-squares adjustment of the control points.
///
/// # Errors
/// If a station does not share three control points with station 1.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<MethodAnswer<StaticGcpDetails>, CalibrationError> {
    let lacking = || CalibrationError::lacking(deployment, Method::StaticGcp, offer);
    let sets = deployment.comparable_control_points();
    let layout = Arc::new(Layout::new(&one_prism(deployment)));
    let survey = adjust(sets, &layout, &settings.errors).ok_or_else(lacking)?;
    let (poses, covariance) = survey.poses(&settings.errors).ok_or_else(lacking)?;
    let squares = survey.readings.iter().map(|reading| reading.residual_m.norm_squared());
    let rms_m = (squares.sum::<f64>() / survey.readings.len().max(1) as f64).sqrt();
    let points = poses.map_each(|station, _| survey.points(station));
    let most = points.iter().skip(1).max().copied().unwrap_or(0);
    let known = survey.has_surveyed_coordinates;
    let mut judgement = Judgement::good(vec![control_points_aligned(most, known, rms_m)]);
    judgement.findings.extend(survey.significant_face_errors(&settings.errors));
    let contradictions = survey.contradictions(sets);
    contradictions.into_iter().for_each(|(verdict, finding)| judgement.lower(verdict, finding));
    let mut answer = MethodAnswer {
        // The checks treat it like method B, which uses the same points.
        method: Method::StaticGcp,
        station1_from_station: poses.map(|level| RigidTransform::from(*level)),
        covariance: Some(DMatrix::from_column_slice(
            covariance.nrows(),
            covariance.ncols(),
            covariance.as_slice(),
        )),
        judgement,
        checked_by: Vec::new(),
        details: StaticGcpDetails { shared_points: points, rms_m, world_from_station1: None },
        prior_ms: 0.0,
    };
    checks::check_with_unused_data(&mut answer, rms_m, deployment, triplets, None);
    answer.method = Method::Joint;
    Ok(answer)
}
