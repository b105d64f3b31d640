//! Ground truth at the times of an estimate: by a deployment's answer, or by another trajectory.

use std::sync::Arc;

use nalgebra::Vector3;

use super::association::{associate, thinned};
use super::matched_pose::{MatchedPose, TruePose, TrueRotation};
use super::options::Association;
use super::station_trajectory::{shared_errors, station_trajectory};
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::joint::prism_motion::ConstantsJacobian;
use resect_core::calibration::{Calibration, ErrorSizes};
use resect_core::deployment::Deployment;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::evaluation::vehicle::{
    Instants, PoseLimits, common_errors, largest_about, prism_by, trajectory_by,
};
use resect_core::network::Prism;

/// Source of the ground truth.
#[derive(Clone)]
pub enum GroundTruth<'a> {
    /// The vehicle's poses, or the positions of a single prism, in station 1's frame.
    Deployment { deployment: &'a Deployment, analysis: &'a Analysis },
    /// The poses or positions of another system, such as motion capture, GNSS, or surveyed points. Those of a single station have the sizes of its
    /// errors.
    Trajectory(Arc<EstimatedTrajectory>, Option<ErrorSizes>),
}

impl<'a> GroundTruth<'a> {
    /// Returns the ground truth of a deployment: its trajectory of another system, or its own. `station` (from 0) chooses the
    /// prism of one station in its own frame. That is also the ground truth if only one station has measurements.
    pub fn of(deployment: &'a Deployment, analysis: &'a Analysis, station: Option<usize>) -> Self {
        if let Some(truth) = &deployment.ground_truth {
            return Self::Trajectory(Arc::clone(truth), None);
        }
        match station.or_else(|| only_station(deployment)) {
            Some(station) => {
                let truth = station_trajectory(deployment, analysis, station);
                Self::Trajectory(Arc::new(truth), Some(analysis.settings.calibration.errors))
            }
            None => Self::Deployment { deployment, analysis },
        }
    }

    /// Returns false if a deployment is the ground truth without a calibration.
    pub fn needs_answer(deployment: &Deployment) -> bool {
        deployment.ground_truth.is_none() && only_station(deployment).is_none()
    }

    /// Name of the deployment or trajectory.
    pub fn name(&self) -> &str {
        match self {
            Self::Deployment { deployment, .. } => &deployment.name,
            Self::Trajectory(truth, _) => &truth.name,
        }
    }

    /// Returns true if orientations are known.
    pub fn has_orientation(&self) -> bool {
        match self {
            Self::Deployment { analysis, .. } => !Prism::is_one(&analysis.offer.followed),
            Self::Trajectory(truth, _) => truth.has_orientations(),
        }
    }

    /// Positions of the stations of a deployment in station 1's frame (m); none of a trajectory.
    pub fn stations_m(&self) -> Vec<Vector3<f64>> {
        let Self::Deployment { analysis, .. } = self else { return Vec::new() };
        let answer = analysis.answer.iter();
        let transforms = answer.flat_map(|answer| answer.calibration.station1_from_station.iter());
        transforms.map(|transform| transform.translation_m).collect()
    }

    /// First time of the readings or poses (s).
    pub fn start_s(&self) -> Option<f64> {
        match self {
            Self::Deployment { deployment, .. } => deployment.start_s(),
            Self::Trajectory(truth, _) => Some(truth.poses.first()?.time_s),
        }
    }

    /// Returns the pairs of pose and ground truth at an offset that is added to the times of the poses (s), in order of time.
    /// They are at most `most` pairs, evenly spread.
    pub fn matched(
        &self,
        poses: &[EstimatedPose],
        time_offset_s: f64,
        (association, most): (Association, usize),
    ) -> Result<Vec<MatchedPose>, NoTrajectory> {
        let truth = match self {
            Self::Trajectory(truth, _) => truth,
            Self::Deployment { .. } => {
                let poses: Vec<EstimatedPose> = thinned(poses, most).copied().collect();
                let times_s: Vec<f64> =
                    poses.iter().map(|pose| pose.time_s + time_offset_s).collect();
                return Ok(at_equal_times(&poses, &times_s, self.at(Instants::At(&times_s))?));
            }
        };
        Ok(associate(truth, poses, time_offset_s, (association, most)))
    }

    /// Returns a deployment's ground truth at those of the times that have any, in order of time; nothing for a trajectory.
    pub fn at(&self, wanted: Instants<'_>) -> Result<Vec<TruePose>, NoTrajectory> {
        let Self::Deployment { deployment, analysis } = self else { return Ok(Vec::new()) };
        let answer = analysis.answer.as_ref().map_err(|why| NoTrajectory::NoAnswer {
            name: deployment.name.clone(),
            why: why.to_string(),
        })?;
        if self.has_orientation() {
            by_rig(deployment, analysis, &answer.calibration, wanted)
        } else {
            by_prism(deployment, analysis, answer, wanted)
        }
    }

    /// Errors common to all instants: their Jacobian at each time, and their covariance; `None` if they are unknown.
    pub fn common_errors(&self, times_s: &[f64]) -> Option<ConstantsJacobian> {
        let (deployment, analysis) = match self {
            Self::Deployment { deployment, analysis } => (deployment, analysis),
            Self::Trajectory(truth, sizes) => {
                return Some(shared_errors(truth, times_s, sizes.as_ref()?));
            }
        };
        let calibration = &analysis.answer.as_ref().ok()?.calibration;
        common_errors(deployment, &analysis.offer.followed, calibration, times_s)
    }
}

/// Returns the station (0 to 2) that alone has measurements.
fn only_station(deployment: &Deployment) -> Option<usize> {
    match deployment.stations_with_readings()[..] {
        [only] => Some(only),
        _ => None,
    }
}

/// Pairs each pose with the ground truth at its time (s), if there is any.
fn at_equal_times(
    poses: &[EstimatedPose],
    times_s: &[f64],
    truths: Vec<TruePose>,
) -> Vec<MatchedPose> {
    let mut truths = truths.into_iter().peekable();
    let mut matched = Vec::with_capacity(poses.len());
    for (pose, time_s) in poses.iter().zip(times_s) {
        while truths.next_if(|truth| truth.time_s < *time_s).is_some() {}
        if let Some(truth) = truths.next_if(|truth| truth.time_s == *time_s) {
            matched.push(MatchedPose { pose: *pose, truth, pose_twist: None });
        }
    }
    matched
}

fn by_rig(
    deployment: &Deployment,
    analysis: &Analysis,
    calibration: &Calibration,
    wanted: Instants<'_>,
) -> Result<Vec<TruePose>, NoTrajectory> {
    let (triplets, followed) = (analysis.triplets(), &analysis.offer.followed);
    // No limit: contradictions between readings and rig are reported, not left out. A ground truth does not rest on a usual tilt.
    let limits = PoseLimits { needs_three_prisms: true, ..PoseLimits::NONE };
    let (trajectory, _) =
        trajectory_by(deployment, triplets, followed, calibration, wanted, &limits)?;
    let known = trajectory.poses.into_iter().filter_map(|pose| {
        let twist = pose.twist?;
        let block = |row, column| pose.covariance.fixed_view::<3, 3>(row, column).into_owned();
        Some(TruePose {
            time_s: pose.time_s,
            position_m: pose.position_m,
            velocity_m_per_s: twist.velocity_m_per_s,
            rotation: Some(TrueRotation {
                orientation: pose.orientation,
                rate_rad_per_s: twist.rate_rad_per_s,
                covariance_rad2: Some(block(3, 3)),
                with_position: block(3, 0),
            }),
            covariance_m2: Some(block(0, 0)),
            contradiction_m: Some(pose.inter_prism_error_m),
        })
    });
    Ok(known.collect())
}

fn by_prism(
    deployment: &Deployment,
    analysis: &Analysis,
    answer: &Answer,
    wanted: Instants<'_>,
) -> Result<Vec<TruePose>, NoTrajectory> {
    let triplets = analysis.triplets();
    let instants = prism_by(deployment, triplets, &answer.calibration, wanted)?;
    // All stations read one prism, so the distances between their positions are the contradiction.
    let apart_mm = &answer.evaluation.distance_errors_mm;
    Ok(instants
        .into_iter()
        .map(|at| TruePose {
            time_s: at.time_s,
            position_m: at.position_m,
            velocity_m_per_s: at.velocity_m_per_s,
            rotation: None,
            covariance_m2: Some(at.position_covariance),
            contradiction_m: Some(1e-3 * largest_about(at.time_s, &triplets.time_s, apart_mm)),
        })
        .collect())
}
