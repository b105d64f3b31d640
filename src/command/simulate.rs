//! `resect simulate`: a deployment with known truth, as files.

use std::path::PathBuf;

use clap::Args;

use super::{Failure, print};
use crate::simulation::{
    ARCSECOND_RAD, ClockStep, Preset, Scenario, simulate_scenario, write_folder,
};

#[derive(Args)]
pub struct Arguments {
    /// What is driven, and where
    #[arg(long, value_enum)]
    preset: Preset,
    /// The same seed gives the same files
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder to write into
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Noise of the ranges, 1 σ (mm)
    #[arg(long, value_name = "MM")]
    range_noise: Option<f64>,
    /// Noise of both angles, 1 σ (arcseconds)
    #[arg(long, value_name = "ARCSEC")]
    angle_noise: Option<f64>,
    /// Share of readings with a gross error (0 to 1)
    #[arg(long, value_name = "SHARE")]
    outliers: Option<f64>,
    /// Lost locks of each station per minute
    #[arg(long, value_name = "PER_MIN")]
    lost_locks: Option<f64>,
    /// How often a minute each station follows a wrong prism for a while
    #[arg(long, value_name = "PER_MIN")]
    wrong_targets: Option<f64>,
    /// Readings per second of each station
    #[arg(long, value_name = "HZ")]
    rate: Option<f64>,
    /// When stations 1, 2, 3 take their first reading (ms); from the seed if not given
    #[arg(long, value_name = "MS,MS,MS", value_delimiter = ',')]
    stagger: Vec<f64>,
    /// How long is driven (s)
    #[arg(long, value_name = "S")]
    duration: Option<f64>,
    /// By how much the stamps of stations 1, 2, 3 are late (ms)
    #[arg(long, value_name = "MS,MS,MS", value_delimiter = ',', allow_negative_numbers = true)]
    clock_offset: Vec<f64>,
    /// How fast they fall behind (parts per million)
    #[arg(long, value_name = "PPM,PPM,PPM", value_delimiter = ',', allow_negative_numbers = true)]
    clock_drift: Vec<f64>,
    /// A station whose stamps jump halfway, and by how much (ms): 3,20
    #[arg(long, value_name = "STATION,MS", value_delimiter = ',', allow_negative_numbers = true)]
    clock_step: Vec<f64>,
    /// Lean of stations 1, 2, 3 about x and y: x1,y1,x2,y2,x3,y3 (arcseconds)
    #[arg(long, value_name = "ARCSEC,…", value_delimiter = ',', allow_negative_numbers = true)]
    tilt: Vec<f64>,
    /// Errors of the inter-prism distances 12, 13, 23 that are written (mm)
    #[arg(long, value_name = "MM,MM,MM", value_delimiter = ',', allow_negative_numbers = true)]
    distance_error: Vec<f64>,
    /// Error of the prism constant (mm)
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    prism_constant_error: Option<f64>,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scenario = scenario(arguments)?;
    let simulated = simulate_scenario(&scenario, arguments.seed);
    write_folder(&simulated, &arguments.out)?;
    print(&format!(
        "{}: {} readings ({} outliers, {} lost), {} control-point sets; the truth is in truth.toml\n\
         next: resect calibrate {}\n",
        arguments.out.display(),
        simulated.records.len(),
        simulated.truth.outliers,
        simulated.truth.lost_readings,
        simulated.control_points.iter().filter(|set| !set.pillars).count(),
        arguments.out.display(),
    ))?;
    Ok(())
}

/// The preset with what the flags change.
fn scenario(arguments: &Arguments) -> Result<Scenario, Failure> {
    let mut scenario = arguments.preset.scenario();
    let noise = &mut scenario.noise;
    let between = |name: &str, value: Option<f64>, low: f64, high: f64| match value {
        Some(value) if !(low..=high).contains(&value) => {
            Err(Failure::Usage(format!("--{name} is {value}; it must be from {low} to {high}")))
        }
        value => Ok(value),
    };
    let set = |name: &str, value: Option<f64>, [low, high]: [f64; 2], unit: f64, to: &mut f64| {
        between(name, value, low, high).map(|value| {
            if let Some(value) = value {
                *to = value * unit;
            }
        })
    };
    set("range-noise", arguments.range_noise, [0.0, 1000.0], 1e-3, &mut noise.range_sigma_m)?;
    let arcsecond = ARCSECOND_RAD;
    set(
        "angle-noise",
        arguments.angle_noise,
        [0.0, 3600.0],
        arcsecond,
        &mut noise.angle_sigma_rad,
    )?;
    set("outliers", arguments.outliers, [0.0, 1.0], 1.0, &mut noise.outlier_share)?;
    set("lost-locks", arguments.lost_locks, [0.0, 60.0], 1.0, &mut noise.lost_locks_per_minute)?;
    set(
        "wrong-targets",
        arguments.wrong_targets,
        [0.0, 60.0],
        1.0,
        &mut noise.wrong_targets_per_minute,
    )?;
    set("rate", arguments.rate, [0.1, 50.0], 1.0, &mut scenario.rate_hz)?;
    set("duration", arguments.duration, [10.0, 20_000.0], 1.0, &mut scenario.duration_s)?;
    let constant = &mut scenario.errors.prism_constant_m;
    set("prism-constant-error", arguments.prism_constant_error, [-100.0, 100.0], 1e-3, constant)?;
    let errors = &mut scenario.errors;
    let copy = |from: &[f64], unit: f64, to: &mut [f64]| {
        to.iter_mut().zip(from).for_each(|(to, from)| *to = from * unit);
    };
    for (name, given, wanted) in [
        ("stagger", arguments.stagger.len(), 3),
        ("clock-offset", arguments.clock_offset.len(), 3),
        ("clock-drift", arguments.clock_drift.len(), 3),
        ("clock-step", arguments.clock_step.len(), 2),
        ("tilt", arguments.tilt.len(), 6),
        ("distance-error", arguments.distance_error.len(), 3),
    ] {
        if given != 0 && given != wanted {
            let line = format!("--{name} has {given} numbers; give {wanted}, separated by commas");
            return Err(Failure::Usage(line));
        }
    }
    copy(&arguments.clock_offset, 1e-3, &mut errors.clock_offset_s);
    copy(&arguments.clock_drift, 1e-6, &mut errors.clock_drift);
    copy(&arguments.tilt, arcsecond, errors.tilt_rad.as_flattened_mut());
    copy(&arguments.distance_error, 1e-3, &mut errors.inter_prism_m);
    if let [first, second, third] = arguments.stagger[..] {
        let stagger_ms = [first, second, third];
        if let Some(wrong) = stagger_ms.iter().find(|ms| !(0.0..=5000.0).contains(*ms)) {
            let line = format!("--stagger is {wrong}; it must be from 0 to 5000");
            return Err(Failure::Usage(line));
        }
        scenario.stagger_s = Some(stagger_ms.map(|ms| ms * 1e-3));
    }
    if let [station, step_ms] = arguments.clock_step[..] {
        if ![1.0, 2.0, 3.0].contains(&station) {
            let line = format!("--clock-step names station {station}; stations are 1, 2, 3");
            return Err(Failure::Usage(line));
        }
        errors.clock_steps.push(ClockStep {
            station: station as usize - 1,
            at_s: 0.5 * scenario.duration_s,
            by_s: step_ms * 1e-3,
        });
    }
    Ok(scenario)
}
