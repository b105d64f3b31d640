//! Simulated estimates of a SLAM system: the true poses of a simulated drive with noise, drift, another clock and another body frame.

use std::path::Path;

use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use resect_core::deployment::{Deployment, Track};
use resect_core::evaluation::trajectory::{ObservedRig, align_rig};
use resect_tools::estimates::{EstimatedPose, EstimatedTrajectory};
use resect_tools::simulation::{EPOCH_S, Preset, Simulated, simulate};

/// Errors of a SLAM system.
pub struct Slam {
    pub name: &'static str,
    pub seed: u64,
    /// Noise of each pose (m), and drift in a second (m).
    pub noise_m: f64,
    pub drift_m: f64,
    pub rate_hz: f64,
    /// Clock of the system minus the stations' (s), and pose of the body in the vehicle.
    pub clock_s: f64,
    pub lever_m: Vector3<f64>,
    pub turn_rad: Vector3<f64>,
}

pub const SLAM: Slam = Slam {
    name: "slam",
    seed: 1,
    noise_m: 0.01,
    drift_m: 0.002,
    rate_hz: 10.0,
    clock_s: 0.0,
    lever_m: Vector3::new(0.0, 0.0, 0.0),
    turn_rad: Vector3::new(0.0, 0.0, 0.0),
};

impl Slam {
    pub fn drive(&self, simulated: &Simulated) -> EstimatedTrajectory {
        let mut rng = ChaCha8Rng::seed_from_u64(self.seed);
        let mut normal = || Vector3::from_fn(|_, _| StandardNormal.sample(&mut rng));
        let turn = UnitQuaternion::from_scaled_axis(self.turn_rad);
        // The system's own frame is its initial pose, rotated.
        let (frame, origin_m) =
            (UnitQuaternion::from_euler_angles(0.02, -0.01, 1.0), Vector3::new(5.0, -3.0, 1.0));
        let (mut drift_m, mut drift_rad) = (Vector3::zeros(), Vector3::zeros());
        let step_s = 1.0 / self.rate_hz;
        let poses = (0..(span_s(simulated) * self.rate_hz) as usize).map(|index| {
            let since_s = index as f64 * step_s;
            let (position_m, orientation) = true_pose(simulated, EPOCH_S + since_s);
            drift_m += self.drift_m * step_s.sqrt() * normal();
            drift_rad += 0.05 * self.drift_m * step_s.sqrt() * normal();
            let body_m =
                position_m + orientation * self.lever_m + drift_m + self.noise_m * normal();
            let turned =
                UnitQuaternion::from_scaled_axis(drift_rad + 0.1 * self.noise_m * normal());
            EstimatedPose {
                time_s: EPOCH_S + since_s + self.clock_s,
                position_m: frame.inverse() * (body_m - origin_m),
                orientation: Some(frame.inverse() * turned * orientation * turn),
            }
        });
        let path = format!("{}.tum", self.name).into();
        EstimatedTrajectory {
            name: self.name.into(),
            path,
            topic: None,
            frames: None,
            poses: poses.collect(),
            covariances: Vec::new(),
            origin: None,
            findings: Vec::new(),
        }
    }
}

pub fn span_s(simulated: &Simulated) -> f64 {
    let last = |track: &Track| track.measurements.last().map(|m| m.time_s);
    let deployment = resect_io::simulation_files::open(simulated).expect("valid");
    deployment.tracks.iter().filter_map(last).fold(0.0, f64::max) - EPOCH_S
}

pub fn true_pose(simulated: &Simulated, time_s: f64) -> (Vector3<f64>, UnitQuaternion<f64>) {
    // For vehicles with one prism as well.
    let corners_m = [Vector3::x(), Vector3::y(), Vector3::z()];
    let points_m = corners_m.map(|p| simulated.truth.motion.position_m(&p, time_s - EPOCH_S));
    let observed = ObservedRig {
        time_s,
        points_m: points_m.into(),
        sigma_m: [Vector3::repeat(1e-3); 3].into(),
    };
    let pose = align_rig(&corners_m, &observed).expect("a triangle");
    (pose.position_m, pose.orientation)
}

/// Returns a simulated drive, whose vehicle frame is the true one.
pub fn driven(seed: u64) -> (Simulated, Deployment) {
    let simulated = simulate(Preset::Warthog, seed);
    let deployment =
        with_frame(&simulated, resect_io::simulation_files::open(&simulated).expect("valid"));
    (simulated, deployment)
}

pub fn with_frame(simulated: &Simulated, mut deployment: Deployment) -> Deployment {
    deployment.rig.as_mut().expect("a rig").in_vehicle_m = Some(simulated.truth.prisms_m.clone());
    deployment
}

pub fn write_tum(estimate: &EstimatedTrajectory, path: &Path) {
    let line = |pose: &EstimatedPose| {
        let (t, q) = (pose.position_m, pose.orientation.expect("turned"));
        format!(
            "{:.6} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9} {:.9}\n",
            pose.time_s, t.x, t.y, t.z, q.i, q.j, q.k, q.w
        )
    };
    std::fs::write(path, estimate.poses.iter().map(line).collect::<String>()).expect("written");
}
