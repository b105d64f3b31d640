//! Random systematic errors, as large as in the field.

use resect_core::network::{Number, Pair, Per, PerPrism, PerStation, Station};
use std::f64::consts::E;

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::error_kind::ErrorKind;
use super::errors::{Centring, ChangedSetUp, ClockStep, Curvature, Settling, Wander};
use super::facet_errors::FacetErrors;
use super::random::normal;
use super::scenario::Scenario;
use resect_core::calibration::ErrorSizes;
use resect_core::calibration::joint::unknown::{self, Unknown};
use resect_core::geometry::ARCSECOND_RAD;

// Errors that are unknowns of the joint estimate are drawn from its priors ([`ErrorSizes`]), but for offsets of clocks, latencies,
// refraction and distances. The other sizes are standard deviations of normal distributions with mean zero; `[a, b]` is a uniform distribution, unless stated otherwise.

/// Offset of synchronised clocks (s): station 3 of the published drives is late by 4 ms. The prior allows for other clocks as well.
const CLOCK_OFFSET_S: f64 = 0.004;
/// Error of a written distance (m): heights of the published drives contradict them by 2 to 3 mm. The prior holds the noise of a reading of the rig
/// as well.
const DISTANCE_M: f64 = 0.002;
/// Coefficients of refraction of a station beyond the common one, upward and sideways: a gradient of the temperature of 0.2 K/m gives 1.2. The
/// prior allows for tunnels and hot ground as well.
const STATION_REFRACTION: [f64; 2] = [1.0, 0.25];
/// Tilt of a settling tripod (rad), most of which the compensator corrects.
const LEAN_RAD: f64 = ARCSECOND_RAD;
/// Share of drives in which tripods settle in steps, not slowly (assumed).
const AT_ONCE: f64 = 0.5;
/// Duration of slow settling, as a share of the rest of the drive (assumed).
const SLOW_SHARE: [f64; 2] = [0.2, 1.0];
/// Additive error of a prism (m): 0.3 mm (GPH1P) to 2 mm (360°) for centring and constant, by Leica's manual of the iCR70.
const PRISM_OFFSET_M: f64 = 0.0007;
/// Time-correlated range error (m): turning 360° prisms and tilted prisms are off by up to 2 to 5 mm (Lackner and Lienhart
/// 2016).
const WANDER_M: f64 = 0.001;
/// Correlation time of range errors (s): seconds to minutes, log-uniform.
const WANDER_CORRELATION_S: [f64; 2] = [2.0, 60.0];
/// Latency of the angles (s): 0 to about 30 ms by instrument (the Bonn rts-network's own calibration; a report on an MS50).
/// A fit to the published drives gives 0 ± 2 ms.
const LATENCY_S: [f64; 2] = [0.0, 0.015];
/// Standard deviation of stamps (s), given on arrival of a serial message, which jitters by 1 to 15 ms in the authors'
/// system.
const STAMP_JITTER_S: [f64; 2] = [0.0, 0.005];
/// Share of drives with one clock step: observed in the authors' system, with an assumed frequency.
const JUMPING_ONCE: f64 = 0.08;
/// Share of drives with two clock steps.
const JUMPING_TWICE: f64 = 0.02;
/// Size of a clock step (s), of either sign.
const JUMP_S: [f64; 2] = [0.005, 0.030];
/// Share of drives with pauses of the recording (assumed).
const PAUSING: f64 = 0.5;
/// Largest number of pauses in a drive (assumed).
const MOST_PAUSES: usize = 3;
/// Duration of a pause (s, assumed).
const PAUSE_S: [f64; 2] = [5.0, 60.0];
/// Refraction coefficient k: 0.13 is the usual value in geodesy; it changes with time of day and ground.
const REFRACTION: [f64; 2] = [0.05, 0.25];
/// Share of rigs whose distances were computed without the prism constant (assumed), and this constant (m), as on the published
/// drive of 2022-07-11.
const WITHOUT_CONSTANT: f64 = 0.5;
const RIG_CONSTANT_M: f64 = 0.010;
/// Error of the prism constant (m), for a GPH1P, from Leica's manual of the iCR70.
const PRISM_CONSTANT_M: f64 = 0.0003;
/// Errors that repeat with the incidence, root mean square along the sight, across it and upward (m): 0.5 to 1 mm on the published
/// drives, in no single order.
const FACETS_M: [f64; 3] = [0.001, 0.0005, 0.0005];
/// Centring of targets: a millimetre over a marker, and a third of it when turned to another station (assumed).
const CENTRING: Centring = Centring { marker_m: 0.001, turned_m: 0.0003 };
/// Tilt that the compensator leaves of a tripod's change between the survey and the drive (rad). It turns and moves as much as
/// during a drive (assumed).
const CHANGED_LEAN_RAD: f64 = 1.5 * ARCSECOND_RAD;

/// Returns the standard deviation of an unknown by default; zero without a prior.
fn prior_sigma(unknown: &Unknown) -> f64 {
    unknown.prior.map_or(0.0, |prior| (prior.sigma)(&ErrorSizes::default()))
}

/// Draws the errors of one kind as large as in the field, and replaces those of that kind in the scenario.
pub fn draw(kind: ErrorKind, scenario: &mut Scenario, rng: &mut ChaCha8Rng) {
    let duration_s = scenario.duration_s;
    let (stations, prisms) = (scenario.stations(), scenario.prisms_m.len());
    let errors = &mut scenario.errors;
    match kind {
        ErrorKind::Settling => errors.settling = settling(stations, duration_s, rng),
        ErrorKind::RangeOffset => draw_range_offsets(scenario, rng),
        ErrorKind::RangeScale => {
            errors.range_scale = each_normal(stations, prior_sigma(&unknown::RANGE_SCALE), rng);
        }
        ErrorKind::RangeWander => {
            let sigma_m = (WANDER_M * normal(rng)).abs();
            let correlation_s = E.powf(between(WANDER_CORRELATION_S.map(f64::ln), rng));
            errors.range_wander = Some(Wander { sigma_m, correlation_s });
        }
        ErrorKind::Latency => {
            errors.latency_s = PerStation::from_fn(stations, |_| between(LATENCY_S, rng));
        }
        ErrorKind::StampJitter => errors.stamp_jitter_s = between(STAMP_JITTER_S, rng),
        ErrorKind::ClockOffset => {
            // Station 1's clock is the reference.
            errors.clock_offset_s = relative_to_first(stations, CLOCK_OFFSET_S, rng);
            errors.clock_drift =
                relative_to_first(stations, prior_sigma(&unknown::CLOCK_DRIFT), rng);
        }
        ErrorKind::ClockJumps => {
            let chance = rng.random_range(0.0..1.0);
            let jumps = usize::from(chance < JUMPING_TWICE + JUMPING_ONCE)
                + usize::from(chance < JUMPING_TWICE);
            errors.clock_steps = (0..jumps)
                .map(|_| {
                    let station = rng.random_range(0..stations);
                    let at_s = rng.random_range(0.0..duration_s);
                    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
                    ClockStep { station, at_s, by_s: sign * between(JUMP_S, rng) }
                })
                .collect();
            let pauses =
                if rng.random_bool(PAUSING) { rng.random_range(1..=MOST_PAUSES) } else { 0 };
            scenario.pauses_s = (0..pauses)
                .map(|_| {
                    let from_s = rng.random_range(0.0..duration_s);
                    [from_s, (from_s + between(PAUSE_S, rng)).min(duration_s)]
                })
                .collect();
        }
        ErrorKind::Index => {
            errors.index_rad = each_normal(stations, prior_sigma(&unknown::VERTICAL_INDEX), rng);
        }
        ErrorKind::Collimation => {
            errors.collimation_rad = each_normal(stations, prior_sigma(&unknown::COLLIMATION), rng);
        }
        ErrorKind::Tilt => {
            errors.tilt_rad =
                PerStation::from_fn(stations, |_| normals(prior_sigma(&unknown::LEAN_X), rng));
        }
        ErrorKind::Curvature => {
            let refraction = between(REFRACTION, rng);
            errors.curvature = Some(Curvature { refraction, ..Curvature::STANDARD });
            let unknowns = [&unknown::REFRACTION_UPWARD, &unknown::REFRACTION_SIDEWAYS];
            for (unknown, sigma) in unknowns.into_iter().zip(STATION_REFRACTION) {
                errors.set_further(unknown, each_normal(stations, sigma, rng));
            }
        }
        ErrorKind::Distances => {
            errors.inter_prism_m = each_normal(Pair::count(prisms), DISTANCE_M, rng);
            let is_without = rng.random_bool(WITHOUT_CONSTANT);
            errors.rig_constant_m = if is_without { -RIG_CONSTANT_M } else { 0.0 };
        }
        ErrorKind::PrismConstant => errors.prism_constant_m = PRISM_CONSTANT_M * normal(rng),
        ErrorKind::Facets => draw_facets(FACETS_M, scenario, rng),
        ErrorKind::Centring => errors.centring = Some(CENTRING),
        ErrorKind::SetUpChange => errors.set_up_changes = changed_set_ups(stations, rng),
    }
}

/// Draws errors of the ranges of stations and prisms. The prior is of both together.
fn draw_range_offsets(scenario: &mut Scenario, rng: &mut ChaCha8Rng) {
    let (stations, prisms) = (scenario.stations(), scenario.prisms_m.len());
    let both_m2 = prior_sigma(&unknown::RANGE_OFFSET).powi(2);
    let station_m = (both_m2 - PRISM_OFFSET_M.powi(2)).max(0.0).sqrt();
    let is_one_prism = scenario.is_one_prism();
    let errors = &mut scenario.errors;
    errors.range_offset_m = each_normal(stations, station_m, rng);
    errors.prism_offset_m = each_normal(prisms, PRISM_OFFSET_M, rng);
    // A prism that all stations track has one offset.
    if is_one_prism {
        errors.prism_offset_m = PerPrism::repeat(prisms, errors.prism_offset_m[0]);
    }
}

/// Draws the errors of the prisms that repeat with the incidence; `rms_m` are root mean squares along the sight, across it and
/// upward (m).
pub fn draw_facets(rms_m: [f64; 3], scenario: &mut Scenario, rng: &mut ChaCha8Rng) {
    let prisms = scenario.prisms_m.len();
    let facets = PerPrism::from_fn(prisms, |_| FacetErrors::draw(rms_m, rng));
    let is_one = scenario.is_one_prism();
    scenario.errors.facets =
        Some(if is_one { PerPrism::repeat(prisms, facets[0]) } else { facets });
}

fn settling(stations: usize, duration_s: f64, rng: &mut ChaCha8Rng) -> Vec<Settling> {
    let (sizes, at_once) = (ErrorSizes::default(), rng.random_bool(AT_ONCE));
    (0..stations)
        .map(|station| {
            let from_s = rng.random_range(0.0..duration_s);
            let slow_s = between(SLOW_SHARE, rng) * (duration_s - from_s);
            Settling {
                station,
                from_s,
                over_s: if at_once { 0.0 } else { slow_s },
                turn_rad: sizes.settling_rad * normal(rng),
                move_m: Vector3::from(normals(sizes.settling_m, rng)),
                lean_rad: normals(LEAN_RAD, rng),
            }
        })
        .collect()
}

fn changed_set_ups(stations: usize, rng: &mut ChaCha8Rng) -> Vec<ChangedSetUp> {
    let sizes = ErrorSizes::default();
    (0..stations)
        .map(|station| ChangedSetUp {
            station,
            turn_rad: sizes.settling_rad * normal(rng),
            move_m: Vector3::from(normals(sizes.settling_m, rng)),
            lean_rad: normals(CHANGED_LEAN_RAD, rng),
        })
        .collect()
}

impl Scenario {
    /// Returns the scenario with errors of all kinds, as large as in the field.
    pub fn with_field_errors(self, seed: u64) -> Self {
        Self { drawn_errors: ErrorKind::ALL.to_vec(), ..self }.draw_errors(seed)
    }

    /// Draws the kinds of errors listed in `drawn_errors`, and empties the list.
    pub fn draw_errors(mut self, seed: u64) -> Self {
        for kind in std::mem::take(&mut self.drawn_errors) {
            draw(kind, &mut self, &mut kind.rng(seed));
        }
        self
    }
}

/// Draws a normal number for each station, prism or pair.
fn each_normal<N: Number>(count: usize, sigma: f64, rng: &mut ChaCha8Rng) -> Per<N, f64> {
    Per::from_fn(count, |_| sigma * normal(rng))
}

/// Draws a normal number for each station but the first, whose number is zero.
fn relative_to_first(stations: usize, sigma: f64, rng: &mut ChaCha8Rng) -> PerStation<f64> {
    PerStation::from_fn(stations, |station| match station {
        Station::FIRST => 0.0,
        _ => sigma * normal(rng),
    })
}

fn normals<const N: usize>(sigma: f64, rng: &mut ChaCha8Rng) -> [f64; N] {
    std::array::from_fn(|_| sigma * normal(rng))
}

fn between([from, to]: [f64; 2], rng: &mut ChaCha8Rng) -> f64 {
    rng.random_range(from..to)
}
