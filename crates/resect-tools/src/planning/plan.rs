//! A planned deployment as plain data.

use nalgebra::{Vector2, Vector3};
use serde::{Deserialize, Serialize};

use super::way::Piece;
use crate::simulation::{Ground, Preset, Waypoint, further_prism_m};
use resect_core::calibration::{CalibrationSettings, ErrorSizes};
use resect_core::network::{
    MOST_STATIONS, Number, Pair, PerPrism, PerStation, Prism, Station, StationPair,
};
use resect_core::pipeline::Thresholds;

/// A deployment that is not recorded yet.
///
/// Positions are in any level frame (m, z up).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Plan {
    #[serde(default)]
    pub name: String,
    /// Target for the root mean square error at the far end of the track (mm).
    #[serde(default = "target_mm")]
    pub target_mm: f64,
    /// Speed towards waypoints without a speed of their own.
    #[serde(default = "speed_m_per_s")]
    pub speed_m_per_s: f64,
    /// Smallest turning radius of the vehicle (m).
    #[serde(default = "turn_radius_m")]
    pub turn_radius_m: f64,
    /// True if the path was recorded, so that its width shows the room of the place.
    #[serde(default, skip_serializing_if = "is_false")]
    pub is_driven: bool,
    /// Positions of the instruments.
    pub stations_m: PerStation<Vector3<f64>>,
    #[serde(default)]
    pub ground: Ground,
    #[serde(default)]
    pub rig: PlannedRig,
    #[serde(default)]
    pub instrument: PlannedInstrument,
    /// Thresholds of the pipeline.
    #[serde(default)]
    pub thresholds: Thresholds,
    /// Sizes of the instruments' errors (1 σ).
    #[serde(default)]
    pub errors: ErrorSizes,
    /// Segments of the path, in order.
    pub way: Vec<Piece>,
}

/// The prisms of a planned vehicle.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlannedRig {
    /// Prisms in the frame of the vehicle, whose origin is on the ground: x ahead, y left, z up (m). The stations follow them in their
    /// order, and from the first again if there are fewer prisms. Equal positions are one prism.
    pub prisms_m: PerPrism<Vector3<f64>>,
    /// Standard deviation of the distances between them (m).
    pub inter_prism_sigma_m: f64,
    /// Largest distance between a sight and another, nearer prism whose housing or mast hides the target.
    pub clearance_m: f64,
}

/// Precision (1 σ), rate and range limits of the planned stations, in the units of data sheets.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlannedInstrument {
    pub range_mm: f64,
    pub range_ppm: f64,
    pub angle_arcsec: f64,
    /// Readings per second of each station.
    pub rate_hz: f64,
    /// Standard deviation of the stamps.
    pub stamp_jitter_ms: f64,
    /// Standard deviation of the time-correlated range errors, if [`ErrorSizes::ranges_wander`] is set.
    pub range_wander_mm: f64,
    /// Shortest and longest range at which a moving prism is tracked.
    pub reach_m: [f64; 2],
    /// Rate at which each station loses its prism for some seconds, per minute.
    pub lost_locks_per_minute: f64,
    /// Share of outliers among the readings.
    pub outlier_share: f64,
}

impl Default for PlannedRig {
    fn default() -> Self {
        let prisms_m = Preset::Warthog.scenario().prisms_m;
        let inter_prism_sigma_m = CalibrationSettings::default().inter_prism_sigma_m;
        Self { prisms_m, inter_prism_sigma_m, clearance_m: 0.08 }
    }
}

impl Default for PlannedInstrument {
    /// The Trimble S7 and its active prism, in the field.
    fn default() -> Self {
        Self {
            range_mm: 2.0,
            range_ppm: 2.0,
            angle_arcsec: 1.0,
            rate_hz: 2.5,
            stamp_jitter_ms: 2.9,
            range_wander_mm: 1.0,
            reach_m: [1.5, 700.0],
            lost_locks_per_minute: 0.4,
            outlier_share: 0.004,
        }
    }
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_false(flag: &bool) -> bool {
    !flag
}

fn target_mm() -> f64 {
    2.0
}

fn speed_m_per_s() -> f64 {
    0.8
}

fn turn_radius_m() -> f64 {
    3.5
}

impl PlannedRig {
    /// Returns true if all stations track the same prism.
    pub fn is_one_prism(&self) -> bool {
        self.prisms_m.iter().all(|prism_m| *prism_m == self.prisms_m[0])
    }

    /// Returns the prism that each of some stations follows, and the positions of these prisms (m).
    pub fn followed(&self, stations: usize) -> (PerStation<Prism>, PerPrism<Vector3<f64>>) {
        let mut different_m: PerPrism<Vector3<f64>> = PerPrism::default();
        let followed = PerStation::from_fn(stations, |station: Station| {
            let prism_m = self.prisms_m[station.index() % self.prisms_m.len()];
            let same = different_m.each().find(|(_, other_m)| **other_m == prism_m);
            if let Some((prism, _)) = same {
                return prism;
            }
            different_m.push(prism_m);
            Prism::at(different_m.len() - 1)
        });
        (followed, different_m)
    }
}

/// Largest coordinate of a plan (m): beyond it the earth's curvature matters.
const FURTHEST_M: f64 = 20_000.0;
/// Distance of further stations from the end of the path, and from each other (m).
const BEYOND_M: f64 = 10.0;
/// Largest length of the path (m): some hours of driving.
const LONGEST_WAY_M: f64 = 20_000.0;

impl Plan {
    /// Returns the first invalid value, with a remedy.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        let within = |name: &str, value: f64, [low, high]: [f64; 2], remedy| match (low..=high)
            .contains(&value)
        {
            true => Ok(()),
            false => Err((format!("{name} is {value}"), remedy)),
        };
        let PlannedInstrument { range_mm, range_ppm, angle_arcsec, .. } = self.instrument;
        let one = &self.instrument;
        for (name, value, limits, remedy) in [
            ("target_mm", self.target_mm, [0.01, 1e4], "give millimetres, from 0.01 to 10000"),
            ("speed_m_per_s", self.speed_m_per_s, [0.01, 20.0], "give 0.01 to 20 m/s"),
            ("turn_radius_m", self.turn_radius_m, [0.1, 100.0], "give 0.1 to 100 m"),
            ("range_mm", range_mm, [0.01, 1e3], "give 0.01 to 1000 mm"),
            ("range_ppm", range_ppm, [0.0, 1e3], "give 0 to 1000 ppm"),
            ("angle_arcsec", angle_arcsec, [0.01, 3600.0], "give 0.01 to 3600 arcseconds"),
            ("rate_hz", one.rate_hz, [0.5, 50.0], "give 0.5 to 50 readings per second"),
            ("stamp_jitter_ms", one.stamp_jitter_ms, [0.0, 100.0], "give 0 to 100 ms"),
            ("range_wander_mm", one.range_wander_mm, [0.0, 100.0], "give 0 to 100 mm"),
            ("lost_locks_per_minute", one.lost_locks_per_minute, [0.0, 5.0], "give 0 to 5"),
            ("outlier_share", one.outlier_share, [0.0, 0.5], "give a share from 0 to 0.5"),
            ("slope_rms_rad", self.ground.slope_rms_rad, [0.0, 0.5], "give 0 to 0.5 rad"),
            (
                "inter_prism_sigma_m",
                self.rig.inter_prism_sigma_m,
                [0.0, 1.0],
                "give metres, from 0 to 1",
            ),
            ("clearance_m", self.rig.clearance_m, [0.0, 1.0], "give metres, from 0 to 1"),
        ] {
            within(name, value, limits, remedy)?;
        }
        let [nearest_m, furthest_m] = one.reach_m;
        if !(0.0..furthest_m).contains(&nearest_m) {
            let what = format!("reach_m is [{nearest_m}, {furthest_m}]");
            return Err((what, "give the shortest and the longest tracking range in metres"));
        }
        let [shortest_m, longest_m] = self.ground.wavelengths_m;
        if !(0.1..longest_m).contains(&shortest_m) || longest_m > 1e4 {
            let what = format!("wavelengths_m is [{shortest_m}, {longest_m}]");
            return Err((what, "give the shortest and the longest, from 0.1 to 10000 m"));
        }
        self.check_places()
    }

    fn check_places(&self) -> Result<(), (String, &'static str)> {
        let far = |p: &Vector3<f64>| !p.iter().all(|value| value.abs() <= FURTHEST_M);
        if let Some(station) = self.stations_m.iter().position(far) {
            let what = format!("station {} has no valid position", station + 1);
            return Err((what, "give metres in a level frame, up to 20 km from its origin"));
        }
        let (stations, prisms) = (self.stations_m.len(), self.rig.prisms_m.len());
        if !(2..=MOST_STATIONS).contains(&stations) || !(1..=MOST_STATIONS).contains(&prisms) {
            let counted = |count: usize, word: &str| match count {
                1 => format!("1 {word}"),
                _ => format!("{count} {word}s"),
            };
            let (stations, prisms) = (counted(stations, "station"), counted(prisms, "prism"));
            let what = format!("the plan has {stations} and {prisms}");
            return Err((what, "give 2 to 8 positions of stations, and 1 to 8 of prisms"));
        }
        for [a, b] in StationPair::among(stations).map(StationPair::indices) {
            if (self.stations_m[a] - self.stations_m[b]).norm() < 0.1 {
                let what = format!("stations {} and {} have the same position", a + 1, b + 1);
                return Err((what, "give different positions"));
            }
        }
        for [a, b] in Pair::among(prisms).map(Pair::indices) {
            let apart_m = (self.rig.prisms_m[a] - self.rig.prisms_m[b]).norm();
            if apart_m != 0.0 && !(0.01..=50.0).contains(&apart_m) {
                let what = format!("prisms {} and {} are {apart_m} m apart", a + 1, b + 1);
                return Err((what, "give prism positions in metres, one prism as equal positions"));
            }
        }
        if self.rig.prisms_m.iter().any(far) {
            return Err((
                "a prism has no valid position".to_owned(),
                "give metres in the vehicle's frame",
            ));
        }
        if !(-FURTHEST_M..=FURTHEST_M).contains(&self.ground.height_m) {
            return Err((format!("height_m is {}", self.ground.height_m), "give metres"));
        }
        for ramp in &self.ground.ramps {
            let numbers = [ramp.centre_m[0], ramp.centre_m[1], ramp.height_m];
            let is_sound = numbers.iter().all(|n| n.abs() <= FURTHEST_M)
                && (0.5..=1000.0).contains(&ramp.radius_m)
                && ramp.height_m.abs() <= ramp.radius_m;
            if !is_sound {
                let what = "a ramp has no valid position, or is higher than its radius".to_owned();
                return Err((what, "give a centre, a radius from 0.5 m, and a smaller height"));
            }
        }
        for piece in &self.way {
            piece.check()?;
        }
        let waypoints = self.waypoints();
        if waypoints.iter().any(|at| !(at.x_m.abs() <= FURTHEST_M && at.y_m.abs() <= FURTHEST_M)) {
            let what = "a waypoint has no valid position".to_owned();
            return Err((what, "give metres in the frame of the stations"));
        }
        let length_m = super::way::length_m(&waypoints);
        if !(1.0..=LONGEST_WAY_M).contains(&length_m) {
            let what = format!("the way is {:.1} m long", length_m.abs());
            return Err((what, "give waypoints or manoeuvres of 1 m to 20 km in total"));
        }
        Ok(())
    }
}

impl Plan {
    /// Adds stations beyond the end of the path, or removes the last ones.
    pub fn set_stations(&mut self, count: usize) {
        let (end_m, along) = self.end().unwrap_or((Vector2::zeros(), Vector2::x()));
        let height_m = self.stations_m[Station::FIRST].z;
        let mut further = 0..;
        self.stations_m.resize_with(count, || {
            let beyond_m = BEYOND_M * f64::from(further.next().unwrap_or(0) + 1);
            (end_m + along * beyond_m).push(height_m)
        });
    }

    /// Adds prisms at free places of the vehicle, or removes the last ones.
    pub fn set_prisms(&mut self, count: usize) {
        while self.rig.prisms_m.len() < count {
            let prism_m = further_prism_m(&self.rig.prisms_m);
            self.rig.prisms_m.push(prism_m);
        }
        self.rig.prisms_m.resize_with(count, Vector3::zeros);
    }

    /// Lays the whole path out as waypoints, in the frame of the plan.
    pub fn waypoints(&self) -> Vec<Waypoint> {
        self.way.iter().flat_map(Piece::waypoints).collect()
    }

    /// Returns the end of the path and the direction of travel there; `None` for a path without length.
    pub fn end(&self) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let waypoints = self.waypoints();
        let last_m = waypoints.last()?.place_m();
        let before = waypoints.iter().rev().map(|at| last_m - at.place_m());
        let along = before.into_iter().find(|away| away.norm() > 1e-3)?;
        Some((last_m, along.normalize()))
    }
}
