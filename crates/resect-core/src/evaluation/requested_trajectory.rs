//! The trajectory that a user requests: its instants, its frame, and the point of the vehicle that it refers to.

use nalgebra::Vector3;

use super::no_trajectory::NoTrajectory;
use super::rig_layout::VehicleFrame;
use super::site::{NoSite, SiteFrame};
use super::trajectory::Trajectory;
use super::vehicle::{Instants, PoseLimits, prism_by, trajectory_by};
use crate::calibration::Calibration;
use crate::calibration::joint::prism_motion::PrismInstant;
use crate::deployment::Deployment;
use crate::network::{PerStation, Prism};
use crate::pipeline::Triplets;

/// Greatest rate of poses (1/s), above the rate of any sensor.
pub const LARGEST_RATE_HZ: f64 = 10_000.0;

/// A request for a trajectory.
#[derive(Clone, Copy, Debug)]
pub struct TrajectoryRequest<'a> {
    pub instants: Instants<'a>,
    /// Poses beyond these limits are left out.
    pub limits: PoseLimits,
    /// Origin of a sensor in the vehicle's frame (m), whose poses are requested; its axes are those of the vehicle.
    pub lever_arm_m: Option<Vector3<f64>>,
    /// True for poses in the frame of the control points, false for station 1's.
    pub is_in_site_frame: bool,
}

impl Default for TrajectoryRequest<'_> {
    fn default() -> Self {
        Self {
            instants: Instants::Usual,
            limits: PoseLimits::default(),
            lever_arm_m: None,
            is_in_site_frame: false,
        }
    }
}

/// A requested trajectory with its frame.
#[derive(Clone, Debug)]
pub struct RequestedTrajectory {
    pub motion: RequestedMotion,
    /// The frame of the control points; `None` for station 1's.
    pub site: Option<SiteFrame>,
}

/// Poses, or the positions of a single prism; never empty.
#[derive(Clone, Debug)]
pub enum RequestedMotion {
    Poses { trajectory: Trajectory, vehicle: VehicleFrame },
    Prism(Vec<PrismInstant>),
}

/// Reason why a request has no trajectory.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RequestError {
    #[error(transparent)]
    NoTrajectory(#[from] NoTrajectory),
    #[error(transparent)]
    NoSite(#[from] NoSite),
    #[error("{0}: a lever arm needs an orientation, and one prism has none; leave it out")]
    NoOrientation(String),
    #[error(
        "{name}: no pose: all {dropped} epochs have an inter-prism error above {limit_mm} mm, have too large a σ, or lie outside of \
         the drive; check the distances and times, or raise the largest error and σ"
    )]
    NoPose { name: String, dropped: usize, limit_mm: f64 },
    #[error("{0}: no position: all times lie outside of the drive")]
    NoPosition(String),
}

impl RequestedTrajectory {
    /// Returns the frame of the positions in words.
    pub fn frame_in_words(&self) -> String {
        self.site.as_ref().map_or("frame of station 1".to_owned(), SiteFrame::in_words)
    }
}

/// Returns the trajectory of the vehicle, or of the single prism that all stations follow, by an answer.
pub fn requested_trajectory(
    deployment: &Deployment,
    triplets: &Triplets,
    followed: &PerStation<Prism>,
    calibration: &Calibration,
    request: &TrajectoryRequest<'_>,
) -> Result<RequestedTrajectory, RequestError> {
    let name = || deployment.name.clone();
    let site = match request.is_in_site_frame {
        true => {
            // Control points have no position in a calibration of another frame.
            let placing = calibration.placing_control_points(deployment);
            let placing = placing.ok_or_else(|| NoTrajectory::OtherFrame(name()))?;
            Some(SiteFrame::of(deployment, &placing)?)
        }
        false => None,
    };
    if Prism::is_one(followed) {
        if request.lever_arm_m.is_some() {
            return Err(RequestError::NoOrientation(name()));
        }
        let mut positions = prism_by(deployment, triplets, calibration, request.instants)?;
        if let Some(site) = &site {
            positions.iter_mut().for_each(|at| *at = site.prism(at));
        }
        if positions.is_empty() {
            return Err(RequestError::NoPosition(name()));
        }
        return Ok(RequestedTrajectory { motion: RequestedMotion::Prism(positions), site });
    }
    let limits = &request.limits;
    let (mut trajectory, vehicle) =
        trajectory_by(deployment, triplets, followed, calibration, request.instants, limits)?;
    if let Some(lever_arm_m) = &request.lever_arm_m {
        trajectory.poses.iter_mut().for_each(|pose| *pose = pose.at_lever_arm(lever_arm_m));
    }
    if let Some(site) = &site {
        trajectory.poses.iter_mut().for_each(|pose| *pose = site.pose(pose));
    }
    if trajectory.poses.is_empty() {
        let dropped = trajectory.dropped;
        return Err(RequestError::NoPose {
            name: name(),
            dropped,
            limit_mm: (limits.inter_prism_error_m * 1e9).round() / 1e6,
        });
    }
    Ok(RequestedTrajectory { motion: RequestedMotion::Poses { trajectory, vehicle }, site })
}
