//! How much memory a long drive takes, as Linux counts it: in a binary of its own, because the count is the process's.
#![cfg(target_os = "linux")]

use resect::calibration::{CalibrationSettings, Offer, solve};
use resect::pipeline::{self, PipelineSettings};
use resect::simulation::{Preset, simulate_scenario};

/// What the kernel says of the process's memory (bytes): `VmRSS` now, `VmHWM` at most since it was last asked to forget.
fn bytes(what: &str) -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = status.lines().find_map(|line| line.strip_prefix(what)).expect("Linux");
    let kilobytes = line.split_whitespace().nth(1).and_then(|n| n.parse::<f64>().ok());
    1024.0 * kilobytes.expect("a number")
}

/// With the rows of the motion kept from pass to pass it would be 2400 bytes.
#[test]
fn the_joint_estimate_of_a_long_drive_takes_less_than_1200_bytes_a_reading() {
    let mut scenario = Preset::Warthog.scenario();
    scenario.duration_s = 12_000.0;
    let deployment = simulate_scenario(&scenario, 1).deployment().expect("valid");
    let readings: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    let triplets = pipeline::run(&deployment, &PipelineSettings::default()).triplets;
    let offer = Offer::of(&deployment, &triplets);
    std::fs::write("/proc/self/clear_refs", "5").expect("Linux");
    let before = bytes("VmRSS");
    solve(&deployment, &triplets, &CalibrationSettings::default(), &offer).expect("an answer");
    let each = (bytes("VmHWM") - before) / readings as f64;
    assert!(each < 1200.0, "{each:.0} bytes for each of {readings} readings");
}
