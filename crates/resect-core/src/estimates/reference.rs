//! Ground truth at any times: the vehicle's poses, or the positions of a single prism, by the deployment's answer.

use nalgebra::{Matrix3, UnitQuaternion, Vector3};

use super::estimate::EstimatedPose;
use crate::analysis::{Analysis, Answer};
use crate::calibration::joint::prism_motion::ConstantsJacobian;
use crate::calibration::{Calibration, Targets};
use crate::deployment::Deployment;
use crate::evaluation::vehicle::{
    Instants, NoTrajectory, common_errors, largest_about, prism_by, trajectory_by,
};
use crate::statistics::median;

/// Ground truth at one instant, in station 1's frame.
#[derive(Clone, Debug, PartialEq)]
pub struct True {
    pub time_s: f64,
    pub position_m: Vector3<f64>,
    pub velocity_m_per_s: Vector3<f64>,
    /// `None` for a single prism, which has no orientation.
    pub turned: Option<Turned>,
    /// Covariance of the position (m²).
    pub covariance_m2: Matrix3<f64>,
    /// Largest contradiction of the readings around the instant with the rig, or with each other if all are of one prism (m).
    /// No error of an estimate causes it.
    pub contradiction_m: f64,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Turned {
    pub orientation: UnitQuaternion<f64>,
    pub rate_rad_per_s: Vector3<f64>,
    /// Covariance of the rotation vector (rad²), and its covariance with the position (rad m), rows the rotation.
    pub covariance_rad2: Matrix3<f64>,
    pub with_position: Matrix3<f64>,
}

/// Readings are wrong if they contradict the rig by more than this multiple of the usual size, and by more than this length
/// (m).
const CONTRADICTED_TIMES: f64 = 4.0;
const CONTRADICTED_M: f64 = 0.01;

/// Largest contradiction of readings that are not wrong (m).
pub fn contradiction_limit_m<'a>(truths: impl Iterator<Item = &'a True>) -> f64 {
    let usual_m = median(truths.map(|truth| truth.contradiction_m)).unwrap_or_default();
    (CONTRADICTED_TIMES * usual_m).max(CONTRADICTED_M)
}

/// Pairs of pose and ground truth without those at which the readings are wrong. A ground truth that is metres off for some
/// seconds says nothing about an estimate's clock, lever arm and frame.
pub fn sound<'a>(pairs: &[(&'a EstimatedPose, &'a True)]) -> Vec<(&'a EstimatedPose, &'a True)> {
    let limit_m = contradiction_limit_m(pairs.iter().map(|(_, truth)| *truth));
    pairs.iter().filter(|(_, truth)| truth.contradiction_m <= limit_m).copied().collect()
}

/// Pairs each pose with the ground truth at its time, if there is any.
pub fn matched<'a>(
    poses: &'a [EstimatedPose],
    truths: &'a [True],
    time_offset_s: f64,
) -> Vec<(&'a EstimatedPose, &'a True)> {
    let mut truths = truths.iter().peekable();
    let mut matched = Vec::with_capacity(poses.len());
    for pose in poses {
        let time_s = pose.time_s + time_offset_s;
        while truths.next_if(|truth| truth.time_s < time_s).is_some() {}
        if let Some(truth) = truths.next_if(|truth| truth.time_s == time_s) {
            matched.push((pose, truth));
        }
    }
    matched
}

/// Source of the ground truth.
#[derive(Clone, Copy)]
pub struct GroundTruthSource<'a> {
    pub deployment: &'a Deployment,
    analysis: &'a Analysis,
}

impl<'a> GroundTruthSource<'a> {
    pub fn new(deployment: &'a Deployment, analysis: &'a Analysis) -> Self {
        Self { deployment, analysis }
    }

    /// Returns true if the vehicle's orientation is known.
    pub fn has_orientation(&self) -> bool {
        self.analysis.offer.targets != Targets::OnePrism
    }

    /// First and last time with readings of all stations (s).
    pub fn span_s(&self) -> Option<[f64; 2]> {
        let times_s = &self.analysis.triplets().time_s;
        Some([*times_s.first()?, *times_s.last()?])
    }

    /// Returns the ground truth at those of the times that have any, in order of time.
    pub fn at(&self, wanted: Instants<'_>) -> Result<Vec<True>, NoTrajectory> {
        let answer = self.analysis.answer.as_ref().map_err(|why| NoTrajectory::NoAnswer {
            name: self.deployment.name.clone(),
            why: why.to_string(),
        })?;
        if self.has_orientation() {
            self.of_rig(&answer.calibration, wanted)
        } else {
            self.of_prism(answer, wanted)
        }
    }

    /// Errors common to all instants: their Jacobian at each time, and their covariance; `None` if they are unknown.
    pub fn common_errors(&self, times_s: &[f64]) -> Option<ConstantsJacobian> {
        let calibration = &self.analysis.answer.as_ref().ok()?.calibration;
        common_errors(self.deployment, self.analysis.offer.targets, calibration, times_s)
    }

    fn of_rig(
        &self,
        calibration: &Calibration,
        wanted: Instants<'_>,
    ) -> Result<Vec<True>, NoTrajectory> {
        let (triplets, targets) = (self.analysis.triplets(), self.analysis.offer.targets);
        // No limit: contradictions between readings and rig are reported, not left out.
        let (found, _) =
            trajectory_by(self.deployment, triplets, targets, calibration, wanted, f64::INFINITY)?;
        let known = found.poses.into_iter().filter_map(|pose| {
            let twist = pose.twist?;
            let block = |row, column| pose.covariance.fixed_view::<3, 3>(row, column).into_owned();
            Some(True {
                time_s: pose.time_s,
                position_m: pose.position_m,
                velocity_m_per_s: twist.velocity_m_per_s,
                turned: Some(Turned {
                    orientation: pose.orientation,
                    rate_rad_per_s: twist.rate_rad_per_s,
                    covariance_rad2: block(3, 3),
                    with_position: block(3, 0),
                }),
                covariance_m2: block(0, 0),
                contradiction_m: pose.inter_prism_error_m,
            })
        });
        Ok(known.collect())
    }

    fn of_prism(&self, answer: &Answer, wanted: Instants<'_>) -> Result<Vec<True>, NoTrajectory> {
        let triplets = self.analysis.triplets();
        let found = prism_by(self.deployment, triplets, &answer.calibration, wanted)?;
        // All stations read one prism, so the distances between their positions are the contradiction.
        let apart_mm = &answer.evaluation.distance_errors_mm;
        Ok(found
            .into_iter()
            .map(|at| True {
                time_s: at.time_s,
                position_m: at.position_m,
                velocity_m_per_s: at.velocity_m_per_s,
                turned: None,
                covariance_m2: at.position_covariance,
                contradiction_m: 1e-3 * largest_about(at.time_s, &triplets.time_s, apart_mm),
            })
            .collect())
    }
}
