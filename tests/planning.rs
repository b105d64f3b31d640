//! What is said of a drive before it is driven, against drives with all errors of the field.

#![allow(clippy::print_stdout, reason = "the tables are the point")]

mod common;

use common::{analyse, by};
use nalgebra::{SVector, Vector3};
use rayon::prelude::*;
use resect::calibration::joint::JointEstimate;
use resect::calibration::{ErrorSizes, Method};
use resect::geometry::{RigidTransform, wrap_to_pi};
use resect::planning::{Plan, Prediction, predict};
use resect::simulation::{
    ARCSECOND_RAD, EPOCH_S, ErrorKind, Preset, Scenario, Simulated, simulate_scenario,
};

/// Presets whose drives hold all eight numbers well.
const WELL_POSED: [Preset; 6] = [
    Preset::Warthog,
    Preset::Hd2Tunnel,
    Preset::FlatFloor,
    Preset::UnevenGround,
    Preset::FigureEight,
    Preset::ShortBaselines,
];

struct Realised {
    /// Found minus true (x, y, z, yaw) of stations 2 and 3.
    error: SVector<f64, 8>,
    /// How far off the far end of the track was put (m).
    far_end_m: f64,
    estimate: JointEstimate,
}

/// Where the stations stood on average over a drive.
fn mean_truth(simulated: &Simulated) -> [RigidTransform; 3] {
    let _ = EPOCH_S;
    simulated.truth.station1_from_station.map(RigidTransform::from)
}

/// A plan of a preset whose error sizes are those that the simulation draws, where the priors of the estimate are wider.
fn as_drawn(preset: Preset) -> Plan {
    let mut plan = Plan::from_preset(preset, 1);
    plan.errors = ErrorSizes {
        // From nothing to 15 ms, as likely each: root mean square.
        latency_s: 0.015 / 3.0_f64.sqrt(),
        // Tilts, and what tripods lean while they settle.
        lean_rad: (1.5_f64.powi(2) + 0.5).sqrt() * ARCSECOND_RAD,
        // Of stations and of prisms.
        range_offset_m: 0.0007 * 2.0_f64.sqrt(),
        range_scale: 5e-6,
        // A tripod gives way at any time of the drive, at once or over what is left of it: on average it is off by less than
        // one that walks from the beginning on.
        settling_rad: 30e-6 * SETTLING,
        settling_m: 0.0005 * SETTLING,
        ..plan.errors
    };
    // What is drawn, and the noise of the reading of the rig by which distances are written.
    let read_m = 1e-3 * plan.instrument.range_mm / 10.0_f64.sqrt();
    plan.rig.inter_prism_sigma_m = 0.001_f64.hypot(read_m * 0.9);
    // Nothing is hidden in simulations.
    plan.rig.clearance_m = 0.0;
    plan
}
const SETTLING: f64 = 0.85;

fn realised(plan: &Plan, prediction: &Prediction, seed: u64) -> Option<Realised> {
    realised_with(plan, prediction, seed, &ErrorKind::ALL)
}
fn realised_with(
    plan: &Plan,
    prediction: &Prediction,
    seed: u64,
    kinds: &[ErrorKind],
) -> Option<Realised> {
    let drawn_errors =
        kinds.iter().copied().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
    let scenario = Scenario { drawn_errors, ..plan.scenario().expect("a plan") };
    let simulated = simulate_scenario(&scenario, seed);
    let mut settings = by(Method::Joint);
    settings.calibration.errors = plan.errors;
    settings.calibration.inter_prism_sigma_m = plan.rig.inter_prism_sigma_m;
    let analysis = analyse(&simulated.deployment().expect("valid"), &settings);
    let calibration = &analysis.answer.as_ref().ok()?.calibration;
    if calibration.verdict != resect::calibration::Verdict::Good {
        println!(
            "    seed {seed}: {:?}: {}",
            calibration.verdict,
            calibration
                .findings
                .iter()
                .filter(|f| f.severity > resect::deployment::Severity::Note)
                .map(|f| f.message.chars().take(90).collect::<String>())
                .collect::<Vec<_>>()
                .join(" | ")
        );
        return None;
    }
    let truth = mean_truth(&simulated);
    let error = SVector::<f64, 8>::from_fn(|k, _| {
        let (found, truth) = (&calibration.station1_from_station[k / 4 + 1], &truth[k / 4 + 1]);
        match k % 4 {
            3 => wrap_to_pi(found.yaw_rad() - truth.yaw_rad()),
            axis => found.translation_m[axis] - truth.translation_m[axis],
        }
    });
    let far = &prediction.held.as_ref()?.far_end;
    let own = truth[far.station].inverse().apply(&(far.position_m - plan.stations_m[0]));
    let off: Vector3<f64> =
        calibration.station1_from_station[far.station].apply(&own) - truth[far.station].apply(&own);
    Some(Realised { error, far_end_m: off.norm(), estimate: calibration.joint()?.clone() })
}

#[test]
#[ignore = "explore"]
fn explore() {
    let count = 48;
    for preset in WELL_POSED {
        let plan = as_drawn(preset);
        let started = std::time::Instant::now();
        let prediction = predict(&plan).expect("a prediction");
        let ms = started.elapsed().as_secs_f64() * 1e3;
        let held = prediction.held.as_ref().expect("held");
        let all: Vec<Realised> = (0..count)
            .into_par_iter()
            .filter_map(|seed| realised(&plan, &prediction, seed))
            .collect();
        let n = all.len() as f64;
        println!(
            "{} {:.0} s {:.0} m, predict {ms:.0} ms, {} drives; kept {:?}/{:?}",
            preset.name(),
            prediction.duration_s,
            prediction.length_m,
            all.len(),
            prediction.kept,
            prediction.readings
        );
        print!("  realised/predicted:");
        for k in 0..8 {
            let rms = (all.iter().map(|r| r.error[k].powi(2)).sum::<f64>() / n).sqrt();
            print!(" {:.2}", rms / held.covariance[(k, k)].sqrt());
        }
        println!();
        print!("  own/predicted:");
        for k in 0..8 {
            let rms = (all.iter().map(|r| r.estimate.covariance[(k, k)]).sum::<f64>() / n).sqrt();
            print!(" {:.2}", rms / held.covariance[(k, k)].sqrt());
        }
        println!();
        let far = (all.iter().map(|r| r.far_end_m.powi(2)).sum::<f64>() / n).sqrt();
        println!("  far {:.2} mm predicted {:.2}", far * 1e3, held.far_end.sigma_m * 1e3);
        let inverse = held.covariance.cholesky().expect("definite").inverse();
        let chi = all.iter().map(|r| r.error.dot(&(inverse * r.error))).sum::<f64>() / n / 8.0;
        println!(
            "  mahalanobis/8 {chi:.2}  dominant {:?}",
            [0, 2, 3]
                .map(|k| (held.dominant[k].what, held.dominant[k].part / held.dominant[k].whole))
        );
        let levels: Vec<_> = all.iter().map(|r| r.estimate.levels).collect();
        let mean = |f: &dyn Fn(&resect::calibration::joint::Levels) -> f64| {
            levels.iter().map(f).sum::<f64>() / n
        };
        println!(
            "  levels: range {:.2} angle {:.2}\" jitter {:.2} ms jerk {:.3}; wander {:.2} mm",
            mean(&|l| l.range),
            mean(&|l| l.angle_rad) * 206265.0,
            mean(&|l| l.jitter_s) * 1e3,
            mean(&|l| l.jerk_m_per_s3),
            all.iter().map(|r| r.estimate.wander.sigma_m).sum::<f64>() / n * 1e3
        );
        println!("  mirror {:?} verdict {:?}", prediction.mirror_cost_ratio, prediction.verdict);
        for f in &prediction.findings {
            println!("    {f}");
        }
    }
}

#[test]
#[ignore = "explore"]
fn which_kind() {
    let plan = as_drawn(Preset::FlatFloor);
    let prediction = predict(&plan).expect("a prediction");
    let held = prediction.held.as_ref().expect("held");
    println!("{:?}", (0..8).map(|k| held.covariance[(k, k)].sqrt() * 1e3).collect::<Vec<_>>());
    println!("{:?}", held.dominant.map(|d| (d.what, d.part / d.whole)));
    let mut sets: Vec<(String, Vec<ErrorKind>)> = vec![("all".into(), ErrorKind::ALL.to_vec())];
    sets.push(("none".into(), vec![]));
    for kind in [ErrorKind::Settling, ErrorKind::RangeWander] {
        sets.push((format!("only {}", kind.name()), vec![kind]));
    }
    sets.remove(0);
    sets.remove(0);
    for (name, kinds) in sets {
        let all: Vec<Realised> = (1000..1200u64)
            .into_par_iter()
            .filter_map(|seed| realised_with(&plan, &prediction, seed, &kinds))
            .collect();
        let n = all.len() as f64;
        print!("{name:<30}");
        for k in 0..8 {
            let rms = (all.iter().map(|r| r.error[k].powi(2)).sum::<f64>() / n).sqrt();
            let mean = all.iter().map(|r| r.error[k]).sum::<f64>() / n;
            let s = held.covariance[(k, k)].sqrt();
            print!(" {:.2} ({:+.2})", rms / s, mean / s);
        }
        println!();
    }
}

#[test]
#[ignore = "explore"]
fn sigma_over_time() {
    for preset in [Preset::Warthog, Preset::FlatFloor, Preset::UnevenGround, Preset::FigureEight] {
        for (name, settling, distance) in [
            ("default", 1.0, 0.001),
            ("still", 0.05, 0.001),
            ("still, distances", 0.05, 0.0003),
            ("distances", 1.0, 0.0003),
        ] {
            print!("{} {name}:", preset.name());
            for share in [0.1, 0.2, 0.3, 0.5, 0.75, 1.0] {
                let mut plan = Plan::from_preset(preset, 1);
                plan.errors.settling_rad *= settling;
                plan.errors.settling_m *= settling;
                plan.rig.inter_prism_sigma_m = distance;
                let resect::planning::Piece::Waypoints(all) = &mut plan.way[0] else { panic!() };
                let n = (all.len() as f64 * share) as usize;
                all.truncate(n);
                let Ok(p) = predict(&plan) else {
                    print!(" none");
                    continue;
                };
                print!(
                    " {:.0} s {:?} {:?};",
                    p.duration_s,
                    p.verdict,
                    p.held.as_ref().map(|h| (h.far_end.sigma_m * 1e4).round() / 10.0)
                );
            }
            println!();
        }
    }
}
#[test]
#[ignore = "explore"]
fn poor() {
    for preset in [Preset::StraightLine, Preset::Circle, Preset::LShape, Preset::SinglePrism] {
        let plan = Plan::from_preset(preset, 1);
        let p = predict(&plan).expect("predicted");
        println!(
            "{} {:?} {:?} {:?} {:?}",
            preset.name(),
            p.verdict,
            p.held.as_ref().map(|h| h.far_end),
            p.mirror_cost_ratio,
            p.observability.map(|o| o.directions.map(|d| (d.hold.name(), d.relative, d.sigma_m)))
        );
        for f in &p.findings {
            println!("    {f}");
        }
    }
}
#[test]
#[ignore = "explore"]
fn better() {
    for preset in [Preset::StraightLine, Preset::Warthog, Preset::FigureEight, Preset::Hd2Tunnel] {
        let plan = Plan::from_preset(preset, 1);
        let started = std::time::Instant::now();
        let all = resect::planning::improvements(&plan).expect("improvements");
        println!("{} {:.1} s", preset.name(), started.elapsed().as_secs_f64());
        for one in &all {
            println!("    {}", one.sentence);
        }
    }
}
