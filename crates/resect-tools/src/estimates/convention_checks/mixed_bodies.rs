//! Poses of two bodies in one file.

use nalgebra::Vector3;

use resect_core::deployment::EstimatedPose;
use resect_core::statistics::median;

/// Poses of two bodies that follow each other in one trajectory.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MixedBodies {
    /// Poses of each body.
    pub poses: [usize; 2],
    /// Median distance from the motion of the other body, and of the same body (m).
    pub between_m: f64,
    pub within_m: f64,
}

/// Bodies are two if the steps between them are this many times those within each.
const TIMES_LONGER: f64 = 4.0;
/// Least share of the steps that change the body.
const LEAST_CHANGES: f64 = 0.15;
/// Fewest steps of each kind.
const FEWEST: usize = 20;
/// Factor by which a step has to exceed the usual one to begin the second body.
const BEGINS: f64 = 1.5;
/// Number of following poses among which one is of the same body.
const FOLLOWING: usize = 4;

/// A body's last pose and velocity.
#[derive(Clone, Copy)]
struct BodyMotion {
    time_s: f64,
    position_m: Vector3<f64>,
    velocity_m_per_s: Vector3<f64>,
}

impl BodyMotion {
    /// Distance of a pose from where the body would be at constant velocity (m).
    fn distance_m(&self, pose: &EstimatedPose) -> f64 {
        let later_s = pose.time_s - self.time_s;
        (pose.position_m - self.position_m - later_s * self.velocity_m_per_s).norm()
    }

    fn next(before: Option<Self>, pose: &EstimatedPose) -> Self {
        let velocity_m_per_s = before.map_or_else(Vector3::zeros, |before| {
            (pose.position_m - before.position_m) / (pose.time_s - before.time_s)
        });
        Self { time_s: pose.time_s, position_m: pose.position_m, velocity_m_per_s }
    }
}

/// Returns the two bodies of a trajectory; `None` if it is of one.
///
/// Each pose belongs to the body that would be nearer to it at constant velocity.
pub fn mixed_bodies(poses: &[EstimatedPose]) -> Option<MixedBodies> {
    let nearest_m = |index: usize| {
        let next = poses[index + 1..].iter().take(FOLLOWING);
        next.map(|pose| (pose.position_m - poses[index].position_m).norm())
            .fold(f64::INFINITY, f64::min)
    };
    let usual_m = median((0..poses.len().checked_sub(FOLLOWING)?).map(nearest_m))?;
    let mut bodies: [Option<BodyMotion>; 2] = [None; 2];
    let (mut body, mut counts) = (0, [0; 2]);
    let (mut between_m, mut within_m) = (Vec::new(), Vec::new());
    for (index, pose) in poses.iter().enumerate() {
        let distance_m = |body: usize| bodies[body].map(|motion| motion.distance_m(pose));
        let next = match (distance_m(0), distance_m(1)) {
            (Some(first_m), Some(second_m)) => usize::from(second_m < first_m),
            (Some(first_m), None) => usize::from(first_m > BEGINS * usual_m),
            (None, _) => 0,
        };
        within_m.extend(distance_m(next));
        if next != body && index > 0 {
            between_m.extend(distance_m(body));
        }
        bodies[next] = Some(BodyMotion::next(bodies[next], pose));
        counts[next] += 1;
        body = next;
    }
    let fewest = FEWEST.max((LEAST_CHANGES * poses.len() as f64) as usize);
    if between_m.len() < fewest || within_m.len() < FEWEST {
        return None;
    }
    let (between_m, within_m) = (median(between_m)?, median(within_m)?);
    let are_two = between_m > TIMES_LONGER * within_m;
    are_two.then_some(MixedBodies { poses: counts, between_m, within_m })
}
