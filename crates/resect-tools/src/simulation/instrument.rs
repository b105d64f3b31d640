//! Readings of the stations, each tracking a moving prism, with noise, outliers and lost locks.

use std::f64::consts::{PI, TAU};

use nalgebra::{Vector2, Vector3};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use super::errors::{CentredTargets, SystematicErrors, WanderingRange};
use super::gnss;
use super::motion::Motion;
use super::random::{Stream, normal};
use super::scenario::{Path, Scenario};
use super::simulated::{EPOCH_S, Simulated, Truth};
use super::waypoint::Waypoint;
use resect_core::deployment::{
    ControlPoint, ControlPointSet, Measurement, RawRecord, pairwise_distances,
};
use resect_core::geometry::{LevelTransform, Polar, RigidTransform};
use resect_core::network::{Number, PerPrism, PerStation};

/// Number of readings of the rig that are averaged.
const RIG_READINGS: f64 = 10.0;
/// Number of control points of a set.
const MARKERS: i32 = 10;

/// Simulates a drive of a scenario and all its readings; the same seed gives the same bytes.
pub fn measure(scenario: &Scenario, seed: u64) -> Simulated {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    let motion = Motion::drive(scenario, &mut rng);
    // Drawn even if unused: an option must not change other random numbers.
    let drawn: [f64; 2] = std::array::from_fn(|_| rng.random_range(-PI..PI));
    let mut drawn = drawn.to_vec();
    drawn.extend((drawn.len()..scenario.stations_m.len()).map(|_| rng.random_range(-PI..PI)));
    let yaws_rad = scenario.yaws_rad.as_ref().unwrap_or(&drawn);
    let others = scenario.stations_m.iter().zip(yaws_rad);
    let others = others.map(|(station_m, yaw_rad)| LevelTransform::new(*station_m, *yaw_rad));
    let station1_from_station: PerStation<LevelTransform> =
        std::iter::once(LevelTransform::IDENTITY).chain(others).collect();

    let mut recording = Recording::default();
    for (station, set_up) in station1_from_station.iter().enumerate() {
        let simulated = SimulatedStation { scenario, seed, motion: &motion, station, set_up };
        simulated.record_drive(&mut recording, &mut rng);
    }
    let Recording { mut records, outliers, lost_readings } = recording;
    records.sort_by(|a, b| a.measurement.time_s.total_cmp(&b.measurement.time_s));

    let survey = SimulatedSurvey { scenario, seed, station1_from_station: &station1_from_station };
    let mut control_points: Vec<ControlPointSet> =
        (0..scenario.control_point_sets).map(|set| survey.control_points(set, &mut rng)).collect();
    let rig_reading = read_rig(scenario, &mut rng);
    let prisms_m = scenario.prisms_m.clone();
    let inter_prism_m = pairwise_distances(prisms_m.as_slice());
    if scenario.pillars {
        control_points.push(survey.pillars(&mut rng));
    }
    let antennas = scenario
        .antennas_m
        .map(|antennas_m| gnss::measure(&antennas_m, &motion, scenario.duration_s, &mut rng));
    let station1_from_station_at_survey = scenario.errors.level_at_survey(&station1_from_station);
    let truth = Truth {
        station1_from_station,
        station1_from_station_at_survey,
        inter_prism_m,
        prisms_m,
        motion,
        outliers,
        lost_readings,
    };
    Simulated {
        scenario: scenario.clone(),
        seed,
        records,
        control_points,
        rig_reading,
        antennas,
        truth,
    }
}

/// Readings of a drive, with the numbers of outliers and of lost readings.
#[derive(Default)]
struct Recording {
    records: Vec<RawRecord>,
    outliers: usize,
    lost_readings: usize,
}

/// One station that tracks its prism.
struct SimulatedStation<'a> {
    scenario: &'a Scenario,
    seed: u64,
    motion: &'a Motion,
    station: usize,
    set_up: &'a LevelTransform,
}

impl SimulatedStation<'_> {
    /// Adds the readings of the whole drive.
    fn record_drive(&self, recording: &mut Recording, rng: &mut ChaCha8Rng) {
        let Self { scenario, seed, station, .. } = *self;
        let (errors, noise) = (&scenario.errors, &scenario.noise);
        // Drawn even if unused: an option must not change other random numbers.
        let drawn_s = rng.random_range(0.0..1.0 / scenario.rate_hz);
        let stagger_s = scenario.stagger_s.as_ref().map_or(drawn_s, |given| given[station]);
        let silences = spans(scenario.duration_s, noise.lost_locks_per_minute, 1.5..14.0, rng);
        let mistaken = spans(
            scenario.duration_s,
            noise.wrong_targets_per_minute,
            1.0..4.0,
            &mut ChaCha8Rng::seed_from_u64(seed ^ (0x7a26e7 + station as u64)),
        );
        let mut wandering =
            errors.range_wander.map(|wander| WanderingRange::new(wander, seed, station));
        let mut jittering = Stream::StampJitter(station).rng(seed);
        let readings = ((scenario.duration_s - stagger_s) * scenario.rate_hz) as usize;
        for k in 0..readings {
            let jitter_s = 0.001 * normal(rng);
            let t = (stagger_s + k as f64 / scenario.rate_hz + jitter_s).max(0.0);
            let within =
                |spans: &[[f64; 2]]| spans.iter().any(|[from, to]| (*from..*to).contains(&t));
            let is_mistaken = within(&mistaken);
            let prism = scenario.prism_of(if is_mistaken { station + 1 } else { station });
            let mut seen = self.read_prism(prism, t);
            seen.range_m += wandering.as_mut().map_or(0.0, |range| range.at_m(t));
            let mut polar = noisy(seen, scenario, 1.0, rng);
            let stamp_error_s = errors.stamp_jitter_s * normal(&mut jittering);
            let blundered = rng.random_bool(noise.outlier_share);
            if blundered {
                blunder(&mut polar, rng);
            }
            if within(&scenario.pauses_s) {
                continue;
            }
            recording.outliers += usize::from(is_mistaken) + usize::from(blundered);
            if within(&silences) {
                recording.lost_readings += 1;
                continue;
            }
            let stamp_s = EPOCH_S + errors.stamp_s(station, t) + stamp_error_s;
            recording.records.push(self.record(&polar, stamp_s));
        }
    }

    /// Returns the reading of a prism at a time of the drive (s), with systematic errors and without noise.
    fn read_prism(&self, prism: usize, t: f64) -> Polar {
        let errors = &self.scenario.errors;
        let see = |time_s: f64| {
            let point_m = self.motion.position_m(&self.scenario.prisms_m[prism], time_s);
            let frame = errors.settled(self.station, self.set_up, time_s);
            sight(errors, self.station, self.set_up, &frame, &point_m)
        };
        // Range and angles may be measured at different times.
        let angles = see(t - errors.latency_s[self.station]);
        let sight = Polar { range_m: see(t).range_m, ..angles };
        let reading = errors.misread(self.station, Some(prism), sight);
        let Some(facets) = &errors.facets else { return reading };
        let (origin_m, world_from_vehicle) = self.motion.pose(t);
        let prism_m = origin_m + world_from_vehicle * self.scenario.prisms_m[prism];
        let to_station = world_from_vehicle.tr_mul(&(self.set_up.translation_m - prism_m));
        facets[prism].misread(&to_station, reading)
    }

    fn record(&self, polar: &Polar, stamp_s: f64) -> RawRecord {
        let measurement = Measurement {
            time_s: stamp_s,
            range_m: polar.range_m - self.scenario.prism_constant_m,
            azimuth_rad: polar.azimuth_rad.rem_euclid(TAU),
            zenith_rad: polar.zenith_rad,
        };
        let station = self.station as i64 + 1;
        RawRecord { station, status: 0, place: 0, measurement, own_clock_s: None }
    }
}

/// Simulates a static reading of the rig from a few metres away; the vehicle stands level, with a random heading.
fn read_rig(scenario: &Scenario, rng: &mut ChaCha8Rng) -> PerPrism<Polar> {
    let heading: f64 = rng.random_range(0.0..TAU);
    let beside = LevelTransform::new(Vector3::new(3.5, -0.6, -1.7), heading);
    let errors = &scenario.errors;
    let set_up = LevelTransform::IDENTITY;
    scenario.prisms_m.map_each(|prism, prism_m| {
        let prism = prism.index();
        let place = beside.apply(prism_m);
        let seen = sight(errors, 0, &set_up, &set_up.into(), &place);
        let mut reading = errors.misread(0, Some(prism), seen);
        if let Some(facets) = &errors.facets {
            reading = facets[prism].misread(&beside.inverse().rotate(&-place), reading);
        }
        noisy(reading, scenario, 1.0 / RIG_READINGS.sqrt(), rng)
    })
}

/// Returns the sight to a point (m, station 1's set-up frame) in the axes of a station whose frame has moved to `frame`.
fn sight(
    errors: &SystematicErrors,
    station: usize,
    set_up: &LevelTransform,
    frame: &RigidTransform,
    point_m: &Vector3<f64>,
) -> Polar {
    let axes = errors.frame_from_axes(station, set_up);
    Polar::from_cartesian(axes.inverse() * frame.inverse().apply(point_m))
}

fn noisy(mut polar: Polar, scenario: &Scenario, share: f64, rng: &mut ChaCha8Rng) -> Polar {
    polar.range_m += share * scenario.noise.range_sigma_m * normal(rng);
    polar.azimuth_rad += share * scenario.noise.angle_sigma_rad * normal(rng);
    polar.zenith_rad += share * scenario.noise.angle_sigma_rad * normal(rng);
    polar
}

/// Adds a gross error, as of a false reflection, to the range or to an angle.
fn blunder(polar: &mut Polar, rng: &mut ChaCha8Rng) {
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    match rng.random_range(0..3) {
        0 => polar.range_m += sign * rng.random_range(1.0..4.0),
        1 => polar.azimuth_rad += sign * rng.random_range(0.01..0.06),
        _ => polar.zenith_rad += sign * rng.random_range(0.01..0.04),
    }
}

/// Draws spans of a drive (s), `per_minute` of them on average.
fn spans(
    duration_s: f64,
    per_minute: f64,
    lengths_s: std::ops::Range<f64>,
    rng: &mut ChaCha8Rng,
) -> Vec<[f64; 2]> {
    let mut spans = Vec::new();
    let mut t = 0.0;
    loop {
        let wait_min = -rng.random_range(1e-9..1.0_f64).ln() / per_minute;
        t += 60.0 * wait_min;
        if t >= duration_s {
            return spans;
        }
        let length_s = rng.random_range(lengths_s.clone());
        spans.push([t, t + length_s]);
        t += length_s;
    }
}

/// The readings of static targets by stations that stand as they did at the survey.
struct SimulatedSurvey<'a> {
    scenario: &'a Scenario,
    seed: u64,
    /// Poses at the set-up for the drive.
    station1_from_station: &'a PerStation<LevelTransform>,
}

impl SimulatedSurvey<'_> {
    fn targets(&self, set: usize) -> CentredTargets {
        CentredTargets::new(self.scenario.errors.centring.unwrap_or_default(), self.seed, set)
    }

    /// Returns one reading of the target at a marker (m) by each station.
    fn read_target(
        &self,
        marker_m: &Vector3<f64>,
        targets: &mut CentredTargets,
        rng: &mut ChaCha8Rng,
    ) -> PerStation<Option<Polar>> {
        let errors = &self.scenario.errors;
        let positions_m = targets.positions_m(marker_m, self.station1_from_station.len());
        self.station1_from_station.map_each(|station, set_up| {
            let station = station.index();
            let frame = errors.at_survey(station, set_up);
            let seen = sight(errors, station, set_up, &frame, &positions_m[station]);
            Some(noisy(errors.misread(station, None, seen), self.scenario, 1.0, rng))
        })
    }

    /// Simulates readings of four pillars on a line past the stations, with coordinates known to a millimetre.
    fn pillars(&self, rng: &mut ChaCha8Rng) -> ControlPointSet {
        let station1_from_line = LevelTransform::new(Vector3::new(-80.0, -35.0, -0.4), 0.35);
        let mut targets = self.targets(self.scenario.control_point_sets);
        let points = [0.0, 71.3, 168.9, 241.6]
            .into_iter()
            .zip([0.0, 0.41, 0.93, 1.58])
            .enumerate()
            .map(|(index, (along_m, height_m))| {
                let known_m = Vector3::new(along_m, 0.0, height_m);
                let surveyed_m = known_m + 0.001 * Vector3::from_fn(|_, _| normal(rng));
                let marker_m = station1_from_line.apply(&surveyed_m);
                let readings = self.read_target(&marker_m, &mut targets, rng);
                let marker = index as i64 + 1;
                let face_one = readings.map(|_| None);
                ControlPoint { marker, readings, face_one, known_m: Some(known_m) }
            })
            .collect();
        ControlPointSet { file: "Two_points.txt".to_owned(), points, pillars: true }
    }

    /// Simulates one reading of each of ten targets from every station.
    fn control_points(&self, set: usize, rng: &mut ChaCha8Rng) -> ControlPointSet {
        let mut targets = self.targets(set);
        let points = (0..MARKERS)
            .map(|marker| {
                let marker_m = self.draw_marker_m(marker, rng);
                let readings = self.read_target(&marker_m, &mut targets, rng);
                let marker = i64::from(marker) + 1;
                let face_one = readings.map(|_| None);
                ControlPoint { marker, readings, face_one, known_m: None }
            })
            .collect();
        ControlPointSet { file: format!("GCP_raw_{}.txt", set + 1), points, pillars: false }
    }

    /// Draws the position of a marker (m): on poles around the area, or along the walls of a tunnel.
    fn draw_marker_m(&self, marker: i32, rng: &mut ChaCha8Rng) -> Vector3<f64> {
        let index = f64::from(marker) + rng.random_range(0.0..0.8);
        let out = rng.random_range(0.7..1.5);
        let height_m = rng.random_range(-0.6..0.6);
        let around = |[x_m, y_m]: [f64; 2], radius_m: f64| {
            let (sin, cos) = (TAU * index / f64::from(MARKERS)).sin_cos();
            Vector3::new(x_m + radius_m * out * cos, y_m + radius_m * out * sin, height_m)
        };
        match &self.scenario.path {
            Path::Wander { centre_m, radius_m } => around(*centre_m, *radius_m),
            Path::Tunnel { from_x_m, to_x_m, amplitude_m, .. } => {
                let x_m = from_x_m + (to_x_m - from_x_m) * index / f64::from(MARKERS);
                let side = if marker % 2 == 0 { 1.0 } else { -1.0 };
                Vector3::new(x_m, side * (amplitude_m + out), height_m)
            }
            Path::Bends { start_m, .. } => around(*start_m, 20.0),
            Path::Waypoints { waypoints, .. } => {
                let sum_m: Vector2<f64> = waypoints.iter().map(Waypoint::place_m).sum();
                around((sum_m / waypoints.len().max(1) as f64).into(), 20.0)
            }
        }
    }
}
