//! Errors beyond those known from the field: one kind at a time, a few times to
//! a hundred times as large, at any time, in addition to all the usual ones.
//!
//! Some errors leave no trace in the readings of a drive on flat ground: vertical index, line of sight, axis. They are at most twice as
//! large, since no estimate can detect them, which the finding "not independently checked" states.

use std::f64::consts::PI;

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;
use resect_core::geometry::ARCSECOND_RAD;
use resect_tools::simulation::{ClockStep, Curvature, Scenario, Settling, Wander};

type Spoil = fn(&mut Scenario, &mut ChaCha8Rng);

/// Kinds of errors, and the functions that apply them.
pub const KINDS: [(&str, Spoil); 22] = [
    ("turn at once", |scenario, rng| {
        let turn_rad = sign(rng) * size(50e-6, 2e-3, rng);
        settle(scenario, rng, 0.0, |settling, _| settling.turn_rad = turn_rad);
    }),
    ("turn slowly", |scenario, rng| {
        let (turn_rad, over_s) = (sign(rng) * size(50e-6, 2e-3, rng), size(10.0, 600.0, rng));
        settle(scenario, rng, over_s, |settling, _| settling.turn_rad = turn_rad);
    }),
    ("move at once", |scenario, rng| {
        let by_m = size(0.001, 0.05, rng);
        settle(scenario, rng, 0.0, |settling, rng| settling.move_m = by_m * direction(rng));
    }),
    ("move slowly", |scenario, rng| {
        let (by_m, over_s) = (size(0.001, 0.05, rng), size(10.0, 600.0, rng));
        settle(scenario, rng, over_s, |settling, rng| settling.move_m = by_m * direction(rng));
    }),
    ("lean at once", |scenario, rng| {
        let lean_rad = size(5.0, 300.0, rng) * ARCSECOND_RAD;
        settle(scenario, rng, 0.0, |settling, rng| {
            let towards = direction(rng);
            settling.lean_rad = [lean_rad * towards.x, lean_rad * towards.y];
        });
    }),
    ("knock", |scenario, rng| {
        let (turn_rad, by_m) = (sign(rng) * size(50e-6, 2e-3, rng), size(0.001, 0.05, rng));
        let lean_rad = size(5.0, 300.0, rng) * ARCSECOND_RAD;
        settle(scenario, rng, 0.0, |settling, rng| {
            settling.turn_rad = turn_rad;
            settling.move_m = by_m * direction(rng);
            settling.lean_rad = [lean_rad, -lean_rad];
        });
    }),
    ("range scale", |scenario, rng| {
        scenario.errors.range_scale[any(rng)] = sign(rng) * size(10e-6, 300e-6, rng);
    }),
    ("range scale of all", |scenario, rng| {
        scenario.errors.range_scale = [sign(rng) * size(10e-6, 300e-6, rng); 3].into();
    }),
    ("range offset", |scenario, rng| {
        scenario.errors.range_offset_m[any(rng)] = sign(rng) * size(0.002, 0.05, rng);
    }),
    ("prism constant", |scenario, rng| {
        scenario.errors.prism_constant_m = sign(rng) * size(0.001, 0.04, rng);
    }),
    ("range wander", |scenario, rng| {
        let (sigma_m, correlation_s) = (size(0.002, 0.01, rng), size(1.0, 200.0, rng));
        scenario.errors.range_wander = Some(Wander { sigma_m, correlation_s });
    }),
    ("clock jumps", |scenario, rng| {
        let jumps = rng.random_range(1..4);
        scenario.errors.clock_steps = (0..jumps)
            .map(|_| ClockStep {
                station: any(rng),
                at_s: rng.random_range(0.0..scenario.duration_s),
                by_s: sign(rng) * size(0.002, 0.2, rng),
            })
            .collect();
    }),
    ("clock drift", |scenario, rng| {
        scenario.errors.clock_drift[1 + rng.random_range(0..2)] =
            sign(rng) * size(5e-6, 300e-6, rng);
    }),
    ("clock offset", |scenario, rng| {
        scenario.errors.clock_offset_s[1 + rng.random_range(0..2)] =
            sign(rng) * size(0.01, 1.0, rng);
    }),
    ("stamp jitter", |scenario, rng| scenario.errors.stamp_jitter_s = size(0.005, 0.04, rng)),
    ("latency", |scenario, rng| {
        scenario.errors.latency_s[any(rng)] = sign(rng) * size(0.01, 0.1, rng);
    }),
    ("vertical index", |scenario, rng| {
        scenario.errors.index_rad[any(rng)] = sign(rng) * size(5.0, 20.0, rng) * ARCSECOND_RAD;
    }),
    ("collimation", |scenario, rng| {
        scenario.errors.collimation_rad[any(rng)] =
            sign(rng) * size(5.0, 20.0, rng) * ARCSECOND_RAD;
    }),
    ("tilt", |scenario, rng| {
        let tilt_rad = size(5.0, 20.0, rng) * ARCSECOND_RAD;
        let towards = direction(rng);
        scenario.errors.tilt_rad[any(rng)] = [tilt_rad * towards.x, tilt_rad * towards.y];
    }),
    ("refraction", |scenario, rng| {
        let refraction = rng.random_range(-3.0..4.0);
        scenario.errors.curvature = Some(Curvature { refraction, ..Curvature::STANDARD });
    }),
    ("inter-prism distance", |scenario, rng| {
        scenario.errors.inter_prism_m[any(rng)] = sign(rng) * size(0.003, 0.05, rng);
    }),
    ("wrong targets", |scenario, rng| {
        scenario.noise.wrong_targets_per_minute = size(0.3, 6.0, rng);
        scenario.noise.outlier_share = size(0.005, 0.1, rng);
    }),
];

fn settle(
    scenario: &mut Scenario,
    rng: &mut ChaCha8Rng,
    over_s: f64,
    shape: impl FnOnce(&mut Settling, &mut ChaCha8Rng),
) {
    let mut settling = Settling {
        station: any(rng),
        from_s: rng.random_range(0.0..scenario.duration_s),
        over_s,
        turn_rad: 0.0,
        move_m: Vector3::zeros(),
        lean_rad: [0.0; 2],
    };
    shape(&mut settling, rng);
    scenario.errors.settling.push(settling);
}

/// Draws a size, log-uniformly.
fn size(from: f64, to: f64, rng: &mut ChaCha8Rng) -> f64 {
    rng.random_range(from.ln()..to.ln()).exp()
}

pub fn sign(rng: &mut ChaCha8Rng) -> f64 {
    if rng.random_bool(0.5) { 1.0 } else { -1.0 }
}

fn any(rng: &mut ChaCha8Rng) -> usize {
    rng.random_range(0..3)
}

/// Draws a unit vector, mostly level.
pub fn direction(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    let towards_rad = rng.random_range(0.0..2.0 * PI);
    Vector3::new(towards_rad.cos(), towards_rad.sin(), rng.random_range(-0.5..0.5)).normalize()
}
