//! What is said of a drive before it is driven, against drives with all errors of the field.

#![allow(clippy::print_stdout, reason = "the tables are the point")]

mod common;

use common::{analyse, by};
use nalgebra::{SVector, Vector3};
use rayon::prelude::*;
use resect::calibration::Method;
use resect::calibration::joint::JointEstimate;
use resect::geometry::{RigidTransform, wrap_to_pi};
use resect::planning::{Plan, Prediction, predict};
use resect::simulation::{EPOCH_S, ErrorKind, Preset, Scenario, Simulated, simulate_scenario};

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

fn realised(plan: &Plan, prediction: &Prediction, seed: u64) -> Option<Realised> {
    let drawn_errors =
        ErrorKind::ALL.into_iter().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
    let scenario = Scenario { drawn_errors, ..plan.scenario().expect("a plan") };
    let simulated = simulate_scenario(&scenario, seed);
    let analysis = analyse(&simulated.deployment().expect("valid"), &by(Method::Joint));
    let calibration = &analysis.answer.as_ref().ok()?.calibration;
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
    let count = 24;
    for preset in WELL_POSED {
        let plan = Plan::from_preset(preset, 1);
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
