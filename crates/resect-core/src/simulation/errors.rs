//! What can be wrong with instruments and rig beyond noise: nothing, unless a scenario asks for it.
//!
//! Stations and prisms are 0 to 2 here, and 1 to 3 where `truth.toml` lists the errors for people.

use nalgebra::{Rotation3, Vector3};
use rand_chacha::ChaCha8Rng;
use serde::{Serialize, Serializer};

use super::random::{Stream, normal};
use crate::geometry::{LevelTransform, Polar, RigidTransform};

/// Errors that no reading shows by itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SystematicErrors {
    /// How late each station's stamps are (s).
    #[serde(skip_serializing_if = "is_nothing")]
    pub clock_offset_s: [f64; 3],
    /// How fast each station's stamps fall behind (s per s).
    #[serde(skip_serializing_if = "is_nothing")]
    pub clock_drift: [f64; 3],
    /// Error of every stamp on its own, 1 σ (s).
    #[serde(skip_serializing_if = "is_nothing")]
    pub stamp_jitter_s: f64,
    /// How much earlier each station takes the angles of a reading than its range (s).
    ///
    /// The stamp is that of the range: range at t, angles at t − latency.
    #[serde(skip_serializing_if = "is_nothing")]
    pub latency_s: [f64; 3],
    /// Added to every range beside the prism constant (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub prism_constant_m: f64,
    /// Added to every range of each station (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub range_offset_m: [f64; 3],
    /// Share of itself by which each station measures a range too long.
    #[serde(skip_serializing_if = "is_nothing")]
    pub range_scale: [f64; 3],
    /// Added to every range to each of the vehicle's prisms, whichever station measures it (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub prism_offset_m: [f64; 3],
    /// Added to each station's zenith angles (rad).
    #[serde(skip_serializing_if = "is_nothing")]
    pub index_rad: [f64; 3],
    /// How far each station's line of sight is off square to its horizontal axis (rad).
    ///
    /// It adds this much over the sine of the zenith angle to the azimuth.
    #[serde(skip_serializing_if = "is_nothing")]
    pub collimation_rad: [f64; 3],
    /// How far each station leans about its own x and y (rad).
    #[serde(skip_serializing_if = "is_nothing")]
    pub tilt_rad: [[f64; 2]; 3],
    /// Added to the distances 12, 13, 23 that are written (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub inter_prism_m: [f64; 3],
    /// What makes the ranges of every station wander during the drive.
    #[serde(skip_serializing_if = "is_nothing")]
    pub range_wander: Option<Wander>,
    /// The roundness of the earth and the bending of light.
    #[serde(skip_serializing_if = "is_nothing")]
    pub curvature: Option<Curvature>,
    /// Jumps of clocks.
    #[serde(skip_serializing_if = "is_nothing")]
    pub clock_steps: Vec<ClockStep>,
    /// Stations that do not stay where they were set up; what happens to one station adds up.
    #[serde(skip_serializing_if = "is_nothing")]
    pub settling: Vec<Settling>,
}

/// A clock that jumps: all stamps from a time on are later by so much.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClockStep {
    #[serde(serialize_with = "number")]
    pub station: usize,
    pub at_s: f64,
    pub by_s: f64,
}

/// A tripod that gives way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settling {
    #[serde(serialize_with = "number")]
    pub station: usize,
    /// When the settling begins (s of the drive).
    pub from_s: f64,
    /// How long it takes, evenly (s); 0 is at once.
    pub over_s: f64,
    /// How far the station turns about its own z (rad).
    pub turn_rad: f64,
    /// How far the station moves, in station 1's set-up frame (m).
    pub move_m: Vector3<f64>,
    /// How far the station leans about its own x and y (rad).
    pub lean_rad: [f64; 2],
}

impl Settling {
    /// How much of it has happened (0 to 1).
    fn share_at(&self, time_s: f64) -> f64 {
        if time_s < self.from_s {
            0.0
        } else if self.over_s > 0.0 {
            ((time_s - self.from_s) / self.over_s).min(1.0)
        } else {
            1.0
        }
    }
}

/// Errors of ranges that last: an Ornstein–Uhlenbeck process, of its own for each station.
///
/// Tilted and 360° prisms make such errors while the vehicle turns. Targets that stand still are spared.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wander {
    /// 1 σ at any one time (m).
    pub sigma_m: f64,
    /// Time after which 1/e of an error is left (s).
    pub correlation_s: f64,
}

/// The errors of one station's ranges over time.
pub struct WanderingRange {
    wander: Wander,
    rng: ChaCha8Rng,
    last: Option<(f64, f64)>,
}

impl WanderingRange {
    pub fn new(wander: Wander, seed: u64, station: usize) -> Self {
        Self { wander, rng: Stream::RangeWander(station).rng(seed), last: None }
    }

    /// The error (m) at a time (s), which is not before the last one that was asked for.
    pub fn at_m(&mut self, time_s: f64) -> f64 {
        let Wander { sigma_m, correlation_s } = self.wander;
        let drawn_m = sigma_m * normal(&mut self.rng);
        let error_m = self.last.map_or(drawn_m, |(last_s, last_m)| {
            let kept = (-(time_s - last_s).max(0.0) / correlation_s).exp();
            kept * last_m + (1.0 - kept * kept).sqrt() * drawn_m
        });
        self.last = Some((time_s, error_m));
        error_m
    }
}

/// Stations on a round earth, each level by its own plumb line, and light that bends down on its way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Curvature {
    pub earth_radius_m: f64,
    /// Curvature of a sight over that of the earth, k.
    pub refraction: f64,
}

impl Curvature {
    /// The mean earth, and Gauss's k, which surveyors use where nothing better is known.
    pub const STANDARD: Self = Self { earth_radius_m: 6_371_000.0, refraction: 0.13 };
}

impl SystematicErrors {
    /// What is stamped on a reading at a time of the drive (s), but for the jitter.
    pub fn stamp_s(&self, station: usize, time_s: f64) -> f64 {
        let steps = self.clock_steps.iter();
        let stepped_s: f64 = steps
            .filter(|step| step.station == station && time_s >= step.at_s)
            .map(|step| step.by_s)
            .sum();
        time_s + self.clock_offset_s[station] + self.clock_drift[station] * time_s + stepped_s
    }

    /// The frame that a station's set-up frame has become by a time of the drive (s), into the frame of station 1's set-up.
    pub fn settled(
        &self,
        station: usize,
        station1_from_set_up: &LevelTransform,
        time_s: f64,
    ) -> RigidTransform {
        let (mut turned_rad, mut moved_m) = (Vector3::zeros(), Vector3::zeros());
        for settling in self.settling.iter().filter(|settling| settling.station == station) {
            let share = settling.share_at(time_s);
            let [x, y] = settling.lean_rad;
            turned_rad += share * Vector3::new(x, y, settling.turn_rad);
            moved_m += share * settling.move_m;
        }
        let set_up = RigidTransform::from(*station1_from_set_up);
        RigidTransform {
            rotation: set_up.rotation * Rotation3::new(turned_rad),
            translation_m: set_up.translation_m + moved_m,
        }
    }

    /// How the axes of a station lean against its frame: its plumb line is not station 1's, nor are its axes upright.
    pub fn frame_from_axes(
        &self,
        station: usize,
        station1_from_set_up: &LevelTransform,
    ) -> Rotation3<f64> {
        let [x, y] = self.tilt_rad[station];
        let tilt = Rotation3::new(Vector3::new(x, y, 0.0));
        self.curvature.map_or(tilt, |curvature| {
            // Up is away from the centre of the earth: it leans the way one has gone.
            let gone = station1_from_set_up.translation_m / curvature.earth_radius_m;
            let lean = Vector3::new(-gone.y, gone.x, 0.0);
            Rotation3::new(station1_from_set_up.inverse().rotate(&lean)) * tilt
        })
    }

    /// What an instrument makes of a sight along its axes, to one of the vehicle's prisms or to another target.
    pub fn misread(&self, station: usize, prism: Option<usize>, sight: Polar) -> Polar {
        let Polar { range_m, azimuth_rad, zenith_rad } = sight;
        let bent_rad = self.curvature.map_or(0.0, |curvature| {
            curvature.refraction * range_m / (2.0 * curvature.earth_radius_m)
        });
        Polar {
            range_m: range_m
                + (self.range_scale[station] * range_m
                    + self.range_offset_m[station]
                    + prism.map_or(0.0, |prism| self.prism_offset_m[prism])
                    + self.prism_constant_m),
            azimuth_rad: azimuth_rad + self.collimation_rad[station] / zenith_rad.sin(),
            // The light comes in from above the straight line, so the target seems higher.
            zenith_rad: zenith_rad + self.index_rad[station] - bent_rad,
        }
    }
}

fn is_nothing<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// A station as people number it.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn number<S: Serializer>(station: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(*station as u64 + 1)
}
