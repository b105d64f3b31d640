//! Memory of the joint estimate of a long drive.

use resect_core::calibration::{CalibrationSettings, Offer, solve};
use resect_core::pipeline;
use resect_core::pipeline::PipelineSettings;
use resect_tools::simulation::{Preset, simulate_scenario};

use crate::{ALLOCATED, process};

/// Bytes that the joint estimate stores for the first half hour of a drive, and for its first seven hours, for any total length.
const KEPT_BYTES: f64 = 90e6;

/// With the results of all segments stored it would be 400 bytes more, with the rows of the motion 2400. The estimate takes all readings; of
/// those in the intervals of the paper alone, which are 79 % of them, it took 211 bytes each.
#[test]
fn the_joint_estimate_of_a_long_drive_takes_less_than_270_bytes_a_reading() {
    process::alone(
        "long_drive::the_joint_estimate_of_a_long_drive_takes_less_than_270_bytes_a_reading",
        |_| measure(),
    );
}

fn measure() {
    let mut scenario = Preset::Warthog.scenario();
    scenario.duration_s = 36_000.0;
    let deployment =
        resect_io::simulation_files::open(&simulate_scenario(&scenario, 1)).expect("valid");
    let readings: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    let triplets = pipeline::run(&deployment, &PipelineSettings::default()).triplets;
    let offer = Offer::of(&deployment, &triplets);
    ALLOCATED.reset_peak_usage();
    let before = ALLOCATED.current_usage() as f64;
    solve(&deployment, &triplets, &CalibrationSettings::default(), &offer).expect("an answer");
    let took = ALLOCATED.peak_usage() as f64 - before;
    let each = (took - KEPT_BYTES) / readings as f64;
    assert!(each < 270.0, "{each:.0} bytes for each of {readings} readings: {:.0} MB", took / 1e6);
}
