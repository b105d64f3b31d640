//! The paper in plain loops (`examples/paper.rs`) compared with the program's method D.

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_io::sample::Sample;

#[allow(dead_code, reason = "the example's own command line")]
#[path = "../../examples/paper.rs"]
mod example;

#[test]
fn plain_loops_and_the_program_agree_to_a_micrometre() {
    for (sample, name) in [(Sample::Warthog, "warthog"), (Sample::Hd2Tunnel, "hd2-tunnel")] {
        let mut settings = Settings::default();
        settings.calibration.method = Some(Method::InterPrism);
        let deployment = sample.open().expect("the sample");
        let answer = Analyst::new(deployment.into()).run(&settings).answer.expect("an answer");
        let samples = concat!(env!("CARGO_MANIFEST_DIR"), "/crates/resect-io/assets/samples");
        let folder = std::path::Path::new(samples).join(name);
        let plain = example::calibrate(&folder, 0.01).expect("an answer");
        for station in 1..3 {
            let program = answer.calibration.station1_from_station[station];
            let off_m = (plain[station].translation_m - program.translation_m).norm();
            let off_rad = plain[station].yaw_rad - program.yaw_rad();
            assert!(off_m < 1e-6, "{name}, station {}: {off_m} m", station + 1);
            assert!(off_rad.abs() < 1e-6, "{name}, station {}: {off_rad} rad", station + 1);
        }
    }
}
