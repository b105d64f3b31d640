//! The metrics of an answer: inter-prism errors and control points.

use serde::{Deserialize, Serialize};

use crate::calibration::Calibration;
use crate::calibration::distance_errors_m;
use crate::calibration::joint::JointEstimate;
use crate::calibration::misfits::compared_stations;
use crate::deployment::Deployment;
use crate::geometry::RigidTransform;
use crate::network::{Pair, PerPair, PerStation, Prism};
use crate::pipeline::Triplets;

use super::spread::Spread;

/// The control-point metric of one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlPointMetric {
    pub file: String,
    /// Distances between the stations' readings of the same point (mm).
    #[serde(flatten)]
    pub spread: Spread,
}

impl ControlPointMetric {
    /// The metric with the largest median.
    pub fn worst(of: &[Self]) -> Option<&Self> {
        of.iter().max_by(|a, b| a.spread.median.total_cmp(&b.spread.median))
    }
}

/// Both metrics of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Apparent minus known distance of every triplet (mm), for pairs 12, 13, 23, … The known distance is zero if all stations
    /// follow one prism.
    pub distance_errors_mm: PerPair<Vec<f64>>,
    /// |distance error| pooled over the pairs (mm): the paper's inter-prism metric.
    pub inter_prism_mm: Option<Spread>,
    /// |distance error| from the distances measured on the vehicle (mm), if the answer estimates distances.
    pub against_measured_mm: Option<Spread>,
    pub inter_prism_by_pair_mm: PerPair<Option<Spread>>,
    /// The control-point metric of each file of control points (mm), without pillars.
    pub control_points_mm: Vec<ControlPointMetric>,
}

/// Known inter-prism distances (m): as measured on the vehicle, or zero if all stations follow one prism. `None` without a rig.
pub fn known_distances_m(
    deployment: &Deployment,
    followed: &PerStation<Prism>,
) -> Option<PerPair<f64>> {
    if Prism::is_one(followed) {
        return Some(PerPair::repeat(Pair::count(followed.len()), 0.0));
    }
    deployment.rig.as_ref().map(|rig| rig.inter_prism_m.clone())
}

/// Evaluates an answer on the corrected triplets, with its estimated distances if it has any.
///
/// Returns the corrected triplets too, if there are any.
pub fn evaluate_answer(
    deployment: &Deployment,
    triplets: &Triplets,
    followed: &PerStation<Prism>,
    calibration: &Calibration,
) -> (Option<Triplets>, Evaluation) {
    let estimated_m = calibration.joint().and_then(JointEstimate::distances_m);
    let corrected = calibration.corrected(triplets);
    let is_estimated = estimated_m.is_some();
    let distances_m = estimated_m
        .map(|distances| distances.map(|distance| distance.value))
        .or_else(|| known_distances_m(deployment, followed));
    let distances_m = distances_m.filter(|_| calibration.placing_tracks(deployment).is_some());
    let mut evaluation = evaluate(
        deployment,
        corrected.as_ref().unwrap_or(triplets),
        (followed, distances_m.as_ref()),
        &calibration.station1_from_station,
    );
    evaluation.control_points_mm = calibration
        .placing_control_points(deployment)
        .map_or_else(Vec::new, |transforms| control_points_mm(deployment, &transforms));
    let measured_m =
        known_distances_m(deployment, followed).filter(|_| distances_m.is_some() && is_estimated);
    if let Some(measured_m) = measured_m {
        let triplets = corrected.as_ref().unwrap_or(triplets);
        let transforms = &calibration.station1_from_station;
        let errors = distance_errors_m(triplets, transforms, followed, &measured_m);
        evaluation.against_measured_mm =
            Spread::of(errors.iter().flatten().map(|error_m| error_m.abs() * 1e3));
    }
    (corrected, evaluation)
}

/// Evaluates transforms on a deployment's triplets and control points.
pub fn evaluate(
    deployment: &Deployment,
    triplets: &Triplets,
    (followed, inter_prism_m): (&PerStation<Prism>, Option<&PerPair<f64>>),
    station1_from_station: &PerStation<RigidTransform>,
) -> Evaluation {
    let distance_errors_mm: PerPair<Vec<f64>> = match inter_prism_m {
        Some(known_m) => distance_errors_m(triplets, station1_from_station, followed, known_m)
            .map(|errors| errors.iter().map(|error_m| error_m * 1e3).collect()),
        None => PerPair::repeat(Pair::count(compared_stations(followed).len()), Vec::new()),
    };
    Evaluation {
        against_measured_mm: None,
        inter_prism_mm: Spread::of(distance_errors_mm.iter().flatten().copied()),
        inter_prism_by_pair_mm: distance_errors_mm.map(|errors| Spread::of(errors.iter().copied())),
        distance_errors_mm,
        control_points_mm: control_points_mm(deployment, station1_from_station),
    }
}

/// The control-point metric of each file (mm), without pillars.
fn control_points_mm(
    deployment: &Deployment,
    station1_from_station: &PerStation<RigidTransform>,
) -> Vec<ControlPointMetric> {
    deployment
        .control_points
        .iter()
        .filter(|set| !set.pillars)
        .filter_map(|set| {
            let distances = set.disagreements_m(station1_from_station);
            let spread = Spread::of(distances.into_iter().map(|d| d * 1e3))?;
            Some(ControlPointMetric { file: set.file.clone(), spread })
        })
        .collect()
}
