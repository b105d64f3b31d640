//! How good an answer is, by the paper's two metrics.

pub mod answer_rows;
pub mod far_end;
pub mod gnss;
pub mod rig_motion;
pub mod site;
pub mod trajectory;
pub mod vehicle;

use serde::{Deserialize, Serialize};

use crate::calibration::distance_errors_m;
use crate::calibration::{Calibration, Targets};
use crate::deployment::Deployment;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::statistics::quantiles;

/// Median and quartiles of a list.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    pub median: f64,
    pub q25: f64,
    pub q75: f64,
    pub iqr: f64,
    pub n: usize,
}

impl Spread {
    /// Spread of the sizes of these values; `None` of nothing.
    pub fn of(sizes: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut n = 0;
        let counted = sizes.into_iter().inspect(|_| n += 1).map(f64::abs);
        let [q25, median, q75] = quantiles(counted, [0.25, 0.5, 0.75])?;
        Some(Self { median, q25, q75, iqr: q75 - q25, n })
    }
}

/// The control-point metric of one file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ControlPointMetric {
    pub file: String,
    /// Distances between the stations' versions of the same point (mm).
    #[serde(flatten)]
    pub spread: Spread,
}

impl ControlPointMetric {
    /// The one whose median is the largest.
    pub fn worst(of: &[Self]) -> Option<&Self> {
        of.iter().max_by(|a, b| a.spread.median.total_cmp(&b.spread.median))
    }
}

/// Both metrics of an answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Apparent minus known distance of every triplet (mm), for pairs 12, 13, 23; the known distance is zero where
    /// all stations follow one prism.
    pub distance_errors_mm: [Vec<f64>; 3],
    /// |distance error| pooled over the pairs (mm): the paper's inter-prism metric.
    pub inter_prism_mm: Option<Spread>,
    /// |distance error| against the distances as measured on the vehicle (mm), where the answer estimates them.
    pub against_measured_mm: Option<Spread>,
    pub inter_prism_by_pair_mm: [Option<Spread>; 3],
    /// The control-point metric of each file of control points (mm); pillars are left out.
    pub control_points_mm: Vec<ControlPointMetric>,
}

/// The distances that errors are measured against (m): as measured on the vehicle, or zero where all stations follow
/// one prism, whose versions should coincide.
pub fn known_distances_m(deployment: &Deployment, targets: Targets) -> Option<[f64; 3]> {
    match targets {
        Targets::OnePrism => Some([0.0; 3]),
        _ => deployment.rig.as_ref().map(|rig| rig.inter_prism_m),
    }
}

/// Evaluates an answer on the corrected triplets, with its own distances where it estimates them.
///
/// Returns the corrected triplets, where there are any.
pub fn evaluate_answer(
    deployment: &Deployment,
    triplets: &Triplets,
    targets: Targets,
    calibration: &Calibration,
) -> (Option<Triplets>, Evaluation) {
    let estimated_m = calibration.joint().and_then(|joint| joint.distances_m);
    let corrected = calibration.corrected(triplets);
    let distances_m = estimated_m
        .map(|distances| distances.map(|distance| distance.value))
        .or_else(|| known_distances_m(deployment, targets));
    let distances_m = distances_m.filter(|_| calibration.placing_tracks(deployment).is_some());
    let mut evaluation = evaluate(
        deployment,
        corrected.as_ref().unwrap_or(triplets),
        distances_m,
        &calibration.station1_from_station,
    );
    let measured_m = known_distances_m(deployment, targets)
        .filter(|_| distances_m.is_some() && estimated_m.is_some());
    if let Some(measured_m) = measured_m {
        let triplets = corrected.as_ref().unwrap_or(triplets);
        let errors = distance_errors_m(triplets, &calibration.station1_from_station, &measured_m);
        evaluation.against_measured_mm =
            Spread::of(errors.iter().flatten().map(|error_m| error_m.abs() * 1e3));
    }
    if calibration.placing_control_points(deployment).is_none() {
        evaluation.control_points_mm.clear();
    }
    (corrected, evaluation)
}

/// Evaluates transforms on a deployment's triplets and control points.
pub fn evaluate(
    deployment: &Deployment,
    triplets: &Triplets,
    inter_prism_m: Option<[f64; 3]>,
    station1_from_station: &[RigidTransform; 3],
) -> Evaluation {
    let distance_errors_mm: [Vec<f64>; 3] = match inter_prism_m {
        Some(inter_prism_m) => distance_errors_m(triplets, station1_from_station, &inter_prism_m)
            .map(|errors| errors.into_iter().map(|e| e * 1e3).collect()),
        None => Default::default(),
    };
    let control_points_mm = deployment
        .control_points
        .iter()
        .filter(|set| !set.pillars)
        .filter_map(|set| {
            let distances = set.disagreements_m(station1_from_station);
            let spread = Spread::of(distances.into_iter().map(|d| d * 1e3))?;
            Some(ControlPointMetric { file: set.file.clone(), spread })
        })
        .collect();
    Evaluation {
        against_measured_mm: None,
        inter_prism_mm: Spread::of(distance_errors_mm.iter().flatten().copied()),
        inter_prism_by_pair_mm: distance_errors_mm
            .each_ref()
            .map(|errors| Spread::of(errors.iter().copied())),
        distance_errors_mm,
        control_points_mm,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn quartiles_are_numpy_s() {
        let spread = Spread::of(vec![3.0, 1.0]).expect("two");
        assert_eq!((spread.q25, spread.median, spread.q75), (1.5, 2.0, 2.5));
        // numpy.percentile([7, 1, 3, 10], [25, 50, 75]) = [2.5, 5.0, 7.75]
        let spread = Spread::of(vec![7.0, 1.0, 3.0, 10.0]).expect("four");
        assert_eq!((spread.q25, spread.median, spread.q75), (2.5, 5.0, 7.75));
        assert_eq!(Spread::of(vec![]), None);
    }

    proptest! {
        #[test]
        fn quartiles_are_ordered_and_scale(values in proptest::collection::vec(0.0..5.0f64, 1..40)) {
            let spread = Spread::of(values.clone()).expect("not empty");
            prop_assert!(spread.q25 <= spread.median && spread.median <= spread.q75);
            let twice = Spread::of(values.iter().map(|v| 2.0 * v)).expect("not empty");
            prop_assert!((twice.iqr - 2.0 * spread.iqr).abs() < 1e-12);
        }
    }
}
