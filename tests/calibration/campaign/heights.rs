//! σ of heights by the drive alone, where the vehicle hardly tilts.

use rayon::prelude::*;
use resect_core::calibration::{Evidence, Method};
use resect_tools::simulation::{ErrorKind, Ground, Preset, Scenario, simulate_scenario};

use crate::common::{analyse, by};

/// Errors of heights over their σ by the drive alone, on ground with slopes of half a degree.
fn errors(seed: u64) -> Option<Vec<f64>> {
    let drawn_errors =
        ErrorKind::ALL.into_iter().filter(|kind| *kind != ErrorKind::ClockJumps).collect();
    let scenario = Preset::Warthog.scenario();
    let ground = Ground { slope_rms_rad: 0.009, ..scenario.ground };
    let simulated = simulate_scenario(&Scenario { drawn_errors, ground, ..scenario }, seed);
    let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
    let mut settings = by(Method::Joint);
    settings.calibration.evidence = Evidence { drive: true, ..Evidence::NONE };
    let analysis = analyse(&deployment, &settings);
    let calibration = &analysis.answer.as_ref().ok()?.calibration;
    let joint = calibration.joint()?;
    let heights = joint.station1_from_station.each().skip(1).map(|(station, found)| {
        let true_m = simulated.truth.station1_from_station[station].translation_m.z;
        let index = 4 * station.slot().expect("not station 1") + 2;
        (found.translation_m.z - true_m) / joint.covariance[(index, index)].sqrt()
    });
    Some(heights.collect())
}

#[test]
fn heights_without_the_rig_are_as_certain_as_they_say_where_the_vehicle_hardly_tilts() {
    let all: Vec<Vec<f64>> = (1..13).into_par_iter().filter_map(errors).collect();
    assert!(all.len() > 9, "{} estimates", all.len());
    let all: Vec<f64> = all.into_iter().flatten().collect();
    let rms = (all.iter().map(|error| error * error).sum::<f64>() / all.len() as f64).sqrt();
    println!("{} {rms:.2}", all.len());
    assert!(rms < 1.5, "{rms:.2}");
}
