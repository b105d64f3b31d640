//! Motion of a vehicle over uneven ground.

use std::f64::consts::{PI, TAU};

use nalgebra::{Matrix3, Vector3};
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::follow::Follower;
use super::ground::Ramp;
use super::planar::{Planar, STEP_S, reacting};
use super::scenario::{Path, Scenario};
use super::waypoint::Waypoint;
use resect_core::geometry::wrap_to_pi;

/// Duration of the stop at the start and of later stops (s), and time between stops (s).
const STAND_S: f64 = 8.0;
const BETWEEN_STOPS_S: f64 = 75.0;
/// Smallest turning radius (m).
const TURN_RADIUS_M: f64 = 3.5;

/// Poses of the vehicle at intervals of a hundredth of a second.
#[derive(Clone, Debug)]
pub struct Motion {
    poses: Vec<Planar>,
    terrain: Terrain,
}

impl Motion {
    pub fn drive(scenario: &Scenario, rng: &mut ChaCha8Rng) -> Self {
        let steps = (scenario.duration_s / STEP_S).ceil() as usize + 1;
        // Always drawn, and in this order, so that other random numbers do not change.
        let mut terrain = Terrain::new(scenario, rng);
        let phases = std::array::from_fn(|_| rng.random_range(0.0..TAU));
        let poses = match &scenario.path {
            Path::Waypoints { waypoints, turn_radius_m } => {
                let mut follower =
                    Follower::new(waypoints, *turn_radius_m, scenario.cruise_m_per_s);
                // The ground is fixed to the start of the path, so a displaced path has the same ground.
                terrain.from = follower.pose();
                let follow = |_| {
                    let pose = follower.pose();
                    follower.drive(STEP_S);
                    pose
                };
                (0..steps).map(follow).collect()
            }
            path => {
                let mut driver = Driver { path, driven_m: 0.0, phases, outbound: true };
                let (mut pose, mut speed_m_per_s) = (driver.start(), 0.0);
                let drive = |step: usize| {
                    let here = pose;
                    let t = step as f64 * STEP_S;
                    let standing =
                        t < STAND_S || (t - STAND_S) % BETWEEN_STOPS_S > BETWEEN_STOPS_S - STAND_S;
                    let variation = 1.0 - 0.25 * (TAU * t / 31.0).sin().powi(2);
                    let wanted = if standing { 0.0 } else { scenario.cruise_m_per_s * variation };
                    speed_m_per_s = reacting(speed_m_per_s, wanted);
                    let curvature = driver.curvature(&pose, speed_m_per_s * STEP_S);
                    pose.x_m += speed_m_per_s * STEP_S * pose.heading_rad.cos();
                    pose.y_m += speed_m_per_s * STEP_S * pose.heading_rad.sin();
                    pose.heading_rad += speed_m_per_s * STEP_S * curvature;
                    here
                };
                (0..steps).map(drive).collect()
            }
        };
        Self { poses, terrain }
    }

    /// Returns the time at which a follower of waypoints arrives at the last one (s), at most `latest_s`.
    pub fn arrival_s(
        waypoints: &[Waypoint],
        turn_radius_m: f64,
        cruise_m_per_s: f64,
        latest_s: f64,
    ) -> f64 {
        let mut follower = Follower::new(waypoints, turn_radius_m, cruise_m_per_s);
        let mut steps: u32 = 0;
        while !follower.has_arrived() && f64::from(steps) * STEP_S < latest_s {
            follower.drive(STEP_S);
            steps += 1;
        }
        f64::from(steps) * STEP_S
    }

    /// Returns the world position (m) of a point of the vehicle at a time (s).
    pub fn position_m(&self, point_m: &Vector3<f64>, time_s: f64) -> Vector3<f64> {
        let (origin_m, world_from_vehicle) = self.pose(time_s);
        origin_m + world_from_vehicle * point_m
    }

    /// Returns the world position (m) of the vehicle's origin at a time (s), and its axes in the world: x ahead, y left, z
    /// up.
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

/// Height of the ground as a sum of waves, whose slopes tilt the vehicle.
#[derive(Clone, Debug)]
struct Terrain {
    mean_m: f64,
    waves: Vec<Wave>,
    /// Origin and direction of the waves' coordinates.
    from: Planar,
    ramps: Vec<Ramp>,
}

#[derive(Clone, Debug)]
struct Wave {
    amplitude_m: f64,
    wave_numbers: [f64; 2],
    phase: f64,
}

impl Terrain {
    fn new(scenario: &Scenario, rng: &mut ChaCha8Rng) -> Self {
        const WAVES: usize = 8;
        let ground = &scenario.ground;
        let waves = (0..WAVES)
            .map(|_| {
                let wavelength = rng.random_range(ground.wavelengths_m[0]..ground.wavelengths_m[1]);
                let direction: f64 = rng.random_range(0.0..TAU);
                let k = TAU / wavelength;
                // Each wave contributes an equal share of the mean square slope, (a k)²/2.
                let amplitude_m = ground.slope_rms_rad * (2.0 / WAVES as f64).sqrt() / k;
                let wave_numbers = [k * direction.cos(), k * direction.sin()];
                Wave { amplitude_m, wave_numbers, phase: rng.random_range(0.0..TAU) }
            })
            .collect();
        Self {
            mean_m: ground.height_m,
            waves,
            from: Planar::default(),
            ramps: ground.ramps.clone(),
        }
    }

    /// Returns the height (m) and the slopes along x and y.
    fn at(&self, x_m: f64, y_m: f64) -> (f64, [f64; 2]) {
        let mut height = self.mean_m;
        let (sin_from, cos_from) = self.from.heading_rad.sin_cos();
        let (dx, dy) = (x_m - self.from.x_m, y_m - self.from.y_m);
        let (along, aside) = (dx * cos_from + dy * sin_from, dy * cos_from - dx * sin_from);
        let mut own = [0.0; 2];
        for wave in &self.waves {
            let [kx, ky] = wave.wave_numbers;
            let (sin, cos) = (kx * along + ky * aside + wave.phase).sin_cos();
            height += wave.amplitude_m * sin;
            own[0] += wave.amplitude_m * kx * cos;
            own[1] += wave.amplitude_m * ky * cos;
        }
        let mut slope =
            [own[0] * cos_from - own[1] * sin_from, own[0] * sin_from + own[1] * cos_from];
        for ramp in &self.ramps {
            let (dx, dy) = (x_m - ramp.centre_m[0], y_m - ramp.centre_m[1]);
            let away_m = dx.hypot(dy);
            if away_m >= ramp.radius_m {
                continue;
            }
            let phase = PI * away_m / ramp.radius_m;
            height += 0.5 * ramp.height_m * (1.0 + phase.cos());
            // Divided by the distance; the slope is zero at the top.
            let falls = 0.5 * ramp.height_m * PI / ramp.radius_m * phase.sin() / away_m.max(1e-9);
            slope[0] -= falls * dx;
            slope[1] -= falls * dy;
        }
        (height, slope)
    }
}

/// Steering along a path without waypoints.
struct Driver<'a> {
    path: &'a Path,
    driven_m: f64,
    phases: [f64; 3],
    outbound: bool,
}

impl Driver<'_> {
    fn start(&self) -> Planar {
        match *self.path {
            Path::Wander { centre_m: [x_m, y_m], .. } => {
                Planar { x_m, y_m, heading_rad: self.phases[0] }
            }
            Path::Bends { start_m: [x_m, y_m], .. } => Planar { x_m, y_m, heading_rad: 0.0 },
            Path::Tunnel { from_x_m, .. } => Planar { x_m: from_x_m, y_m: 0.0, heading_rad: 0.0 },
            Path::Waypoints { .. } => Planar::default(),
        }
    }

    /// Returns the curvature (1/m, left positive) of the next step of the path.
    fn curvature(&mut self, pose: &Planar, advance_m: f64) -> f64 {
        self.driven_m += advance_m;
        let most = 1.0 / TURN_RADIUS_M;
        match *self.path {
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
            Path::Waypoints { .. } => 0.0,
        }
    }
}
