#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    for name in ["calibration_raw.csv", "calibration_results.csv", "sensor_positions.csv"] {
        resect_fuzz::open_beside_tracks(name, bytes);
    }
});
