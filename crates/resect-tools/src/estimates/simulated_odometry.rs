//! Simulated odometry with known clock, lever arm and body rotation, for tests.

use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};

/// Steps of the simulation (s), and its duration.
pub const STEP_S: f64 = 0.05;
pub const STEPS: usize = 4000;
pub const CLOCK_S: f64 = -0.2;

pub struct Drive {
    random: ChaCha8Rng,
    pub truth: Vec<EstimatedPose>,
    pub lever_m: Vector3<f64>,
    pub body: UnitQuaternion<f64>,
}

pub fn normal(random: &mut ChaCha8Rng) -> Vector3<f64> {
    Vector3::from_fn(|_, _| StandardNormal.sample(random))
}

/// A vehicle that turns and tilts, with stops.
pub fn drive(seed: u64) -> Drive {
    let mut random = ChaCha8Rng::seed_from_u64(seed);
    let (mut yaw_rad, mut position_m) = (0.0, Vector3::zeros());
    let [mut slow, mut tilt] = [Vector3::zeros(); 2];
    let truth = (0..STEPS).map(|index| {
        let time_s = index as f64 * STEP_S;
        // Speed, rate of turn, roll and pitch change within seconds.
        slow += -slow * STEP_S / 4.0 + normal(&mut random) * (2.0 * STEP_S / 4.0_f64).sqrt();
        tilt += (slow * 0.05 - tilt) * STEP_S / 0.5;
        let is_moving = f64::from(u8::from(time_s % 50.0 < 42.0));
        yaw_rad += 0.3 * slow.z * is_moving * STEP_S;
        let orientation = UnitQuaternion::from_euler_angles(tilt.x, tilt.y, yaw_rad);
        let speed_m_per_s = (1.0 + 0.5 * slow.x).max(0.0) * is_moving;
        position_m += orientation * Vector3::x() * (speed_m_per_s * STEP_S);
        EstimatedPose { time_s, position_m, orientation: Some(orientation) }
    });
    let truth = truth.collect();
    let lever_m = 0.2 * normal(&mut random);
    let body = UnitQuaternion::from_scaled_axis(0.5 * normal(&mut random));
    Drive { random, truth, lever_m, body }
}

impl Drive {
    /// Poses of an odometry at 10 Hz that drifts as a random walk, in a frame of its own.
    pub fn odometry(&mut self) -> EstimatedTrajectory {
        let of_body = |pose: &EstimatedPose| {
            let orientation = pose.orientation.expect("known");
            (pose.position_m + orientation * self.lever_m, orientation * self.body)
        };
        let (mut position_m, mut orientation) = (Vector3::zeros(), UnitQuaternion::identity());
        let mut poses = Vec::new();
        for (index, two) in self.truth.windows(2).enumerate() {
            let [(before_m, before), (after_m, after)] = [of_body(&two[0]), of_body(&two[1])];
            let moved_m = before.inverse() * (after_m - before_m);
            let walk_m = normal(&mut self.random) * (0.003 * moved_m.norm().sqrt());
            let turned = normal(&mut self.random) * (8e-4 * STEP_S.sqrt());
            position_m += orientation * (moved_m + walk_m);
            orientation *= before.inverse() * after * UnitQuaternion::from_scaled_axis(turned);
            if index % 2 == 0 {
                let noise = UnitQuaternion::from_scaled_axis(1e-3 * normal(&mut self.random));
                poses.push(EstimatedPose {
                    time_s: two[1].time_s - CLOCK_S,
                    position_m: position_m + 0.003 * normal(&mut self.random),
                    orientation: Some(orientation * noise),
                });
            }
        }
        trajectory("odometry", poses)
    }
}

pub fn trajectory(name: &str, poses: Vec<EstimatedPose>) -> EstimatedTrajectory {
    EstimatedTrajectory {
        name: name.to_owned(),
        path: name.into(),
        topic: None,
        frames: None,
        poses,
        covariances: Vec::new(),
        origin: None,
        findings: Vec::new(),
    }
}
