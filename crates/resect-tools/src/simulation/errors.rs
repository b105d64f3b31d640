//! Systematic errors of instruments and rig: none unless a scenario sets them.
//!
//! Stations and prisms are numbered from 0 here, and from 1 in `truth.toml`.

use nalgebra::{Rotation3, Vector3};
use rand_chacha::ChaCha8Rng;
use serde::{Serialize, Serializer};

use super::facet_errors::FacetErrors;
use super::random::{Stream, normal};
use resect_core::calibration::joint::Sight;
use resect_core::calibration::joint::unknown::{Effect, Unknown};
use resect_core::geometry::{LevelTransform, Polar, RigidTransform};
use resect_core::network::{
    Number, Pair, Per, PerPair, PerPrism, PerStation, Station, USUAL_STATIONS,
};

/// Systematic errors of the instruments and the rig.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SystematicErrors {
    /// Offset of each station's clock (s), added to every stamp.
    #[serde(skip_serializing_if = "are_nothing")]
    pub clock_offset_s: PerStation<f64>,
    /// Drift of each station's clock (s/s): stamps are later by this times the time of the drive.
    #[serde(skip_serializing_if = "are_nothing")]
    pub clock_drift: PerStation<f64>,
    /// Standard deviation of the independent error of each stamp (s).
    #[serde(skip_serializing_if = "is_nothing")]
    pub stamp_jitter_s: f64,
    /// Latency of each station's angles (s): they are measured this much before the range.
    ///
    /// The stamp is the time of the range: range at t, angles at t − latency.
    #[serde(skip_serializing_if = "are_nothing")]
    pub latency_s: PerStation<f64>,
    /// Error of the prism constant, added to every range (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub prism_constant_m: f64,
    /// Additive error of each station's ranges (m).
    #[serde(skip_serializing_if = "are_nothing")]
    pub range_offset_m: PerStation<f64>,
    /// Relative scale error of each station's ranges, positive for ranges that are too long.
    #[serde(skip_serializing_if = "are_nothing")]
    pub range_scale: PerStation<f64>,
    /// Additive range error of each of the vehicle's prisms, the same for all stations (m).
    #[serde(skip_serializing_if = "are_nothing")]
    pub prism_offset_m: PerPrism<f64>,
    /// Vertical index error of each station, added to its zenith angles (rad).
    #[serde(skip_serializing_if = "are_nothing")]
    pub index_rad: PerStation<f64>,
    /// Collimation error of each station: deviation of the line of sight from the normal to the horizontal axis (rad).
    ///
    /// The error of the azimuth is this divided by the sine of the zenith angle.
    #[serde(skip_serializing_if = "are_nothing")]
    pub collimation_rad: PerStation<f64>,
    /// Errors of the readings that have no formula of their own here.
    #[serde(skip_serializing_if = "is_nothing")]
    pub further: Vec<FurtherError>,
    /// Tilt of each station's vertical axis about its own x and y (rad).
    #[serde(skip_serializing_if = "are_nothing")]
    pub tilt_rad: PerStation<[f64; 2]>,
    /// Errors of the written distances 12, 13, 23, … between the prisms (m).
    #[serde(skip_serializing_if = "are_nothing")]
    pub inter_prism_m: PerPair<f64>,
    /// Error of the prism constant with which the written distances are computed from the reading of the rig (m).
    #[serde(skip_serializing_if = "is_nothing")]
    pub rig_constant_m: f64,
    /// Time-correlated errors of every station's ranges.
    #[serde(skip_serializing_if = "is_nothing")]
    pub range_wander: Option<Wander>,
    /// Curvature of the earth and refraction of light.
    #[serde(skip_serializing_if = "is_nothing")]
    pub curvature: Option<Curvature>,
    /// Positions of targets beside their markers.
    #[serde(skip_serializing_if = "is_nothing")]
    pub centring: Option<Centring>,
    /// Steps of clocks.
    #[serde(skip_serializing_if = "is_nothing")]
    pub clock_steps: Vec<ClockStep>,
    /// Settling of stations; several entries of one station add up.
    #[serde(skip_serializing_if = "is_nothing")]
    pub settling: Vec<Settling>,
    /// Changes of set-ups between the survey of the control points and the drive; several entries of one station add up.
    #[serde(skip_serializing_if = "is_nothing")]
    pub set_up_changes: Vec<ChangedSetUp>,
    /// Errors of the readings of each of the vehicle's prisms that repeat with the incidence.
    #[serde(skip_serializing_if = "is_nothing")]
    pub facets: Option<PerPrism<FacetErrors>>,
}

/// An error of the readings by its row in the table of unknowns.
#[derive(Clone, Debug, Serialize)]
pub struct FurtherError {
    #[serde(serialize_with = "name_of")]
    pub unknown: &'static Unknown,
    pub sizes: PerStation<f64>,
}

impl PartialEq for FurtherError {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.unknown, other.unknown) && self.sizes == other.sizes
    }
}

fn name_of<S: Serializer>(unknown: &&'static Unknown, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(unknown.name)
}

impl FurtherError {
    /// Returns the displacement of a reading by the error (m, the station's own axes).
    fn displacement_m(&self, station: usize, sight: &Sight) -> Vector3<f64> {
        match self.unknown.effect {
            Effect::Reading(error) => -(error.correction_m)(sight) * self.sizes[station],
            _ => Vector3::zeros(),
        }
    }
}

/// A step of a clock: all stamps from `at_s` on are later by `by_s`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ClockStep {
    #[serde(serialize_with = "number")]
    pub station: usize,
    pub at_s: f64,
    pub by_s: f64,
}

/// Settling of a tripod.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settling {
    #[serde(serialize_with = "number")]
    pub station: usize,
    /// Start (s of the drive).
    pub from_s: f64,
    /// Duration, at a constant rate (s); 0 for a step.
    pub over_s: f64,
    /// Rotation about the station's own z (rad).
    pub turn_rad: f64,
    /// Displacement (m, station 1's set-up frame).
    pub move_m: Vector3<f64>,
    /// Tilt about the station's own x and y (rad).
    pub lean_rad: [f64; 2],
}

impl Settling {
    /// Returns the share of the settling that has happened by a time of the drive (0 to 1).
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

/// Change of a station's set-up between the survey and the drive: drive less survey.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChangedSetUp {
    #[serde(serialize_with = "number")]
    pub station: usize,
    /// Rotation about the station's own z (rad).
    pub turn_rad: f64,
    /// Displacement (m, station 1's set-up frame).
    pub move_m: Vector3<f64>,
    /// Tilt about the station's own x and y (rad).
    pub lean_rad: [f64; 2],
}

/// Centring of the targets at control points: standard deviations on each axis (m).
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Centring {
    /// Displacement of a target from its marker, the same for all stations.
    pub marker_m: f64,
    /// Further displacement when the target is turned to a station.
    pub turned_m: f64,
}

/// Generator of the positions of the targets of one set.
pub struct CentredTargets {
    centring: Centring,
    rng: ChaCha8Rng,
}

impl CentredTargets {
    pub fn new(centring: Centring, seed: u64, set: usize) -> Self {
        Self { centring, rng: Stream::Centring(set).rng(seed) }
    }

    /// Returns the positions of the next target (m) when it is turned to each of the stations.
    pub fn positions_m(
        &mut self,
        marker_m: &Vector3<f64>,
        stations: usize,
    ) -> PerStation<Vector3<f64>> {
        let Self { centring, rng } = self;
        let mut displaced = |sigma_m: f64| sigma_m * Vector3::from_fn(|_, _| normal(rng));
        let target_m = marker_m + displaced(centring.marker_m);
        PerStation::from_fn(stations, |_| target_m + displaced(centring.turned_m))
    }
}

/// Time-correlated errors of ranges: an independent Ornstein–Uhlenbeck process for each station.
///
/// Tilted and 360° prisms cause such errors while the vehicle turns. Readings of static targets have none.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Wander {
    /// Standard deviation at any time (m).
    pub sigma_m: f64,
    /// Correlation time, after which an error has decayed to 1/e (s).
    pub correlation_s: f64,
}

/// Generator of the time-correlated range errors of one station.
pub struct WanderingRange {
    wander: Wander,
    rng: ChaCha8Rng,
    last: Option<(f64, f64)>,
}

impl WanderingRange {
    pub fn new(wander: Wander, seed: u64, station: usize) -> Self {
        Self { wander, rng: Stream::RangeWander(station).rng(seed), last: None }
    }

    /// Returns the error (m) at a time (s). Times must not decrease from call to call.
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

/// Curvature of the earth, with each station levelled by its own plumb line, and refraction, which bends light down.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Curvature {
    pub earth_radius_m: f64,
    /// Refraction coefficient k: curvature of a line of sight over that of the earth.
    pub refraction: f64,
}

impl Curvature {
    /// Mean radius of the earth, and Gauss's k, which surveyors use if no better value is known.
    pub const STANDARD: Self = Self { earth_radius_m: 6_371_000.0, refraction: 0.13 };
}

impl SystematicErrors {
    /// Replaces the error of an unknown that has no formula of its own here.
    pub fn set_further(&mut self, unknown: &'static Unknown, sizes: PerStation<f64>) {
        self.further.retain(|own| !std::ptr::eq(own.unknown, unknown));
        self.further.push(FurtherError { unknown, sizes });
    }

    /// Returns the stamp of a reading at a time of the drive (s), without jitter.
    pub fn stamp_s(&self, station: usize, time_s: f64) -> f64 {
        let steps = self.clock_steps.iter();
        let stepped_s: f64 = steps
            .filter(|step| step.station == station && time_s >= step.at_s)
            .map(|step| step.by_s)
            .sum();
        time_s + self.clock_offset_s[station] + self.clock_drift[station] * time_s + stepped_s
    }

    /// Returns the pose of a station's frame at a time of the drive (s), settling included, in the frame of station 1's
    /// set-up.
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

    /// Returns the pose of a station's frame at the survey, in the frame of station 1's set-up for the drive.
    pub fn at_survey(
        &self,
        station: usize,
        station1_from_set_up: &LevelTransform,
    ) -> RigidTransform {
        let (mut turned_rad, mut moved_m) = (Vector3::zeros(), Vector3::zeros());
        for change in self.set_up_changes.iter().filter(|change| change.station == station) {
            let [x, y] = change.lean_rad;
            turned_rad += Vector3::new(x, y, change.turn_rad);
            moved_m += change.move_m;
        }
        let set_up = RigidTransform::from(*station1_from_set_up);
        RigidTransform {
            rotation: set_up.rotation * Rotation3::new(-turned_rad),
            translation_m: set_up.translation_m - moved_m,
        }
    }

    /// Returns the level poses of the stations at the survey, in station 1's frame of that time.
    pub fn level_at_survey(
        &self,
        station1_from_station: &PerStation<LevelTransform>,
    ) -> PerStation<LevelTransform> {
        let poses = station1_from_station.map_each(|station, set_up| {
            let pose = self.at_survey(station.index(), set_up);
            LevelTransform::new(pose.translation_m, pose.yaw_rad())
        });
        let survey_from_drive = poses[Station::FIRST].inverse();
        poses.map_each(|station, pose| match station {
            Station::FIRST => LevelTransform::IDENTITY,
            _ => survey_from_drive.then_from(pose),
        })
    }

    /// Returns the rotation from a station's axes to its frame: the tilt, and the difference between its plumb line and
    /// station 1's.
    pub fn frame_from_axes(
        &self,
        station: usize,
        station1_from_set_up: &LevelTransform,
    ) -> Rotation3<f64> {
        let [x, y] = self.tilt_rad[station];
        let tilt = Rotation3::new(Vector3::new(x, y, 0.0));
        self.curvature.map_or(tilt, |curvature| {
            // Up points away from the earth's centre, so it leans in the direction of the displacement from station 1.
            let gone = station1_from_set_up.translation_m / curvature.earth_radius_m;
            let lean = Vector3::new(-gone.y, gone.x, 0.0);
            Rotation3::new(station1_from_set_up.inverse().rotate(&lean)) * tilt
        })
    }

    /// Returns the reading of a true sight in a station's axes. `prism` is one of the vehicle's, `None` for another target.
    pub fn misread(&self, station: usize, prism: Option<usize>, sight: Polar) -> Polar {
        let Polar { range_m, azimuth_rad, zenith_rad } = sight;
        let bent_rad = self.curvature.map_or(0.0, |curvature| {
            curvature.refraction * range_m / (2.0 * curvature.earth_radius_m)
        });
        let reading = Polar {
            range_m: range_m
                + (self.range_scale[station] * range_m
                    + self.range_offset_m[station]
                    + prism.map_or(0.0, |prism| self.prism_offset_m[prism])
                    + self.prism_constant_m),
            azimuth_rad: azimuth_rad + self.collimation_rad[station] / zenith_rad.sin(),
            // The light arrives from above the straight line, so the target appears higher.
            zenith_rad: zenith_rad + self.index_rad[station] - bent_rad,
        };
        if self.further.is_empty() {
            return reading;
        }
        let point_m = reading.to_cartesian();
        let sight = Sight::to(&point_m);
        let displacements_m = self.further.iter().map(|own| own.displacement_m(station, &sight));
        Polar::from_cartesian(point_m + displacements_m.sum::<Vector3<f64>>())
    }
}

impl Default for SystematicErrors {
    /// No errors of the usual numbers of stations and prisms.
    fn default() -> Self {
        let stations = USUAL_STATIONS;
        let none = PerStation::repeat(stations, 0.0);
        Self {
            clock_offset_s: none.clone(),
            clock_drift: none.clone(),
            stamp_jitter_s: 0.0,
            latency_s: none.clone(),
            prism_constant_m: 0.0,
            range_offset_m: none.clone(),
            range_scale: none.clone(),
            prism_offset_m: PerPrism::repeat(stations, 0.0),
            index_rad: none.clone(),
            collimation_rad: none,
            further: Vec::new(),
            tilt_rad: PerStation::repeat(stations, [0.0; 2]),
            inter_prism_m: PerPair::repeat(Pair::count(stations), 0.0),
            rig_constant_m: 0.0,
            range_wander: None,
            curvature: None,
            centring: None,
            clock_steps: Vec::new(),
            settling: Vec::new(),
            set_up_changes: Vec::new(),
            facets: None,
        }
    }
}

fn are_nothing<N: Number, T: Default + PartialEq>(values: &Per<N, T>) -> bool {
    values.iter().all(is_nothing)
}

fn is_nothing<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// Serializes a station as its number from 1.
#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde asks for it")]
fn number<S: Serializer>(station: &usize, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(*station as u64 + 1)
}
