//! A vehicle that drives itself over uneven ground.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::scenario::{Ground, Path, Scenario};
use crate::geometry::wrap_to_pi;

const STEP_S: f64 = 0.01;
/// The vehicle stands this long at the start, and at each stop.
const STAND_S: f64 = 8.0;
const BETWEEN_STOPS_S: f64 = 75.0;
/// The tightest bend (m).
const TURN_RADIUS_M: f64 = 3.5;

/// Where the vehicle is at every hundredth of a second.
#[derive(Clone, Debug)]
pub struct Motion {
    poses: Vec<Planar>,
    terrain: Terrain,
}

#[derive(Clone, Copy, Debug)]
struct Planar {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
}

impl Motion {
    pub fn drive(scenario: &Scenario, rng: &mut ChaCha8Rng) -> Self {
        let terrain = Terrain::new(&scenario.ground, -scenario.instrument_height_m, rng);
        let steps = (scenario.duration_s / STEP_S).ceil() as usize + 1;
        let mut driver = Driver::new(&scenario.path, rng);
        let mut poses = Vec::with_capacity(steps);
        let mut pose = driver.start();
        let mut speed_m_per_s = 0.0;
        for step in 0..steps {
            poses.push(pose);
            let t = step as f64 * STEP_S;
            let standing =
                t < STAND_S || (t - STAND_S) % BETWEEN_STOPS_S > BETWEEN_STOPS_S - STAND_S;
            let variation = 1.0 - 0.25 * (TAU * t / 31.0).sin().powi(2);
            let wanted = if standing { 0.0 } else { scenario.cruise_m_per_s * variation };
            // A soft foot on the pedal: about half a second to react.
            speed_m_per_s += (wanted - speed_m_per_s) * STEP_S / 0.6;
            let curvature = driver.curvature(&pose, speed_m_per_s * STEP_S);
            pose.x_m += speed_m_per_s * STEP_S * pose.heading_rad.cos();
            pose.y_m += speed_m_per_s * STEP_S * pose.heading_rad.sin();
            pose.heading_rad += speed_m_per_s * STEP_S * curvature;
        }
        Self { poses, terrain }
    }

    /// World position (m) of a point of the vehicle at a time (s).
    pub fn position_m(&self, point_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        let (origin_m, world_from_vehicle) = self.pose(time_s);
        origin_m + world_from_vehicle * point_m
    }

    /// World position (m) of the vehicle's origin at a time (s), and its axes in the world: x ahead, y left, z up.
    pub fn pose(&self, time_s: f64) -> (Vector3<f64>, Matrix3<f64>) {
        let at = (time_s / STEP_S).clamp(0.0, (self.poses.len() - 2) as f64);
        let (index, weight) = (at as usize, at.fract());
        let (a, b) = (self.poses[index], self.poses[index + 1]);
        let mix = |a: f64, b: f64| a + (b - a) * weight;
        let (x, y) = (mix(a.x_m, b.x_m), mix(a.y_m, b.y_m));
        let heading = mix(a.heading_rad, b.heading_rad);
        let (height, slope) = self.terrain.at(x, y);
        let ahead = Vector3::new(
            heading.cos(),
            heading.sin(),
            slope[0] * heading.cos() + slope[1] * heading.sin(),
        )
        .normalize();
        let up = Vector3::new(-slope[0], -slope[1], 1.0).normalize();
        let left = up.cross(&ahead);
        (Vector3::new(x, y, height), Matrix3::from_columns(&[ahead, left, up]))
    }
}

/// A sum of waves, its slopes being what tilts the vehicle.
#[derive(Clone, Debug)]
struct Terrain {
    mean_m: f64,
    waves: Vec<Wave>,
}

#[derive(Clone, Debug)]
struct Wave {
    amplitude_m: f64,
    wave_numbers: [f64; 2],
    phase: f64,
}

impl Terrain {
    fn new(ground: &Ground, mean_m: f64, rng: &mut ChaCha8Rng) -> Self {
        const WAVES: usize = 8;
        let waves = (0..WAVES)
            .map(|_| {
                let wavelength = rng.random_range(ground.wavelengths_m[0]..ground.wavelengths_m[1]);
                let direction: f64 = rng.random_range(0.0..TAU);
                let k = TAU / wavelength;
                // Each wave brings an equal part of the mean square slope, (a k)²/2.
                let amplitude_m = ground.slope_rms_rad * (2.0 / WAVES as f64).sqrt() / k;
                let wave_numbers = [k * direction.cos(), k * direction.sin()];
                Wave { amplitude_m, wave_numbers, phase: rng.random_range(0.0..TAU) }
            })
            .collect();
        Self { mean_m, waves }
    }

    /// Height (m) and slopes along x and y.
    fn at(&self, x_m: f64, y_m: f64) -> (f64, [f64; 2]) {
        let mut height = self.mean_m;
        let mut slope = [0.0; 2];
        for wave in &self.waves {
            let [kx, ky] = wave.wave_numbers;
            let (sin, cos) = (kx * x_m + ky * y_m + wave.phase).sin_cos();
            height += wave.amplitude_m * sin;
            slope[0] += wave.amplitude_m * kx * cos;
            slope[1] += wave.amplitude_m * ky * cos;
        }
        (height, slope)
    }
}

/// Steers along a path.
struct Driver {
    path: Path,
    driven_m: f64,
    phases: [f64; 3],
    outbound: bool,
}

impl Driver {
    fn new(path: &Path, rng: &mut ChaCha8Rng) -> Self {
        let phases = std::array::from_fn(|_| rng.random_range(0.0..TAU));
        Self { path: *path, driven_m: 0.0, phases, outbound: true }
    }

    fn start(&self) -> Planar {
        match self.path {
            Path::Wander { centre_m: [x_m, y_m], .. } => {
                Planar { x_m, y_m, heading_rad: self.phases[0] }
            }
            Path::Bends { start_m: [x_m, y_m], .. } => Planar { x_m, y_m, heading_rad: 0.0 },
            Path::Tunnel { from_x_m, .. } => Planar { x_m: from_x_m, y_m: 0.0, heading_rad: 0.0 },
        }
    }

    /// Curvature (1/m, left positive) for the next piece of the way.
    fn curvature(&mut self, pose: &Planar, advance_m: f64) -> f64 {
        self.driven_m += advance_m;
        let most = 1.0 / TURN_RADIUS_M;
        match self.path {
            Path::Wander { centre_m: [cx, cy], radius_m } => {
                let s = self.driven_m;
                let winding = 0.16 * (TAU * s / 37.0 + self.phases[1]).sin()
                    + 0.12 * (TAU * s / 17.0 + self.phases[2]).sin();
                let away = (pose.x_m - cx).hypot(pose.y_m - cy) / radius_m;
                let homeward = (cy - pose.y_m).atan2(cx - pose.x_m);
                let pull = (away - 0.6).max(0.0) * 1.2;
                (winding + pull * wrap_to_pi(homeward - pose.heading_rad).clamp(-1.0, 1.0))
                    .clamp(-most, most)
            }
            Path::Bends { bends, .. } => {
                let round_m: f64 = bends.iter().map(|bend| bend.length_m).sum();
                let mut left_m = self.driven_m % round_m;
                let here = bends.iter().find(|bend| {
                    let inside = left_m < bend.length_m;
                    left_m -= bend.length_m;
                    inside
                });
                here.map_or(0.0, |bend| bend.curvature_per_m)
            }
            Path::Tunnel { from_x_m, to_x_m, amplitude_m, wavelength_m } => {
                if self.outbound && pose.x_m > to_x_m {
                    self.outbound = false;
                } else if !self.outbound && pose.x_m < from_x_m {
                    self.outbound = true;
                }
                let (direction, base) = if self.outbound { (1.0, 0.0) } else { (-1.0, PI) };
                // Aim at the weaving centre line a little ahead.
                let ahead_m = 2.5;
                let target_y =
                    amplitude_m * (TAU * (pose.x_m + direction * ahead_m) / wavelength_m).sin();
                let wanted = base + direction * ((target_y - pose.y_m) / ahead_m).atan();
                let tight = 1.0 / 1.2;
                (wrap_to_pi(wanted - pose.heading_rad) * 0.6).clamp(-tight, tight)
            }
        }
    }
}
