//! Calibrates a deployment from code: `cargo run --release --example calibrate -- FOLDER`, or the built-in sample.

#![allow(clippy::print_stdout, reason = "an example prints")]

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::progress::Progress;
use resect_io::sample::Sample;
use resect_io::source::Source;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let deployment = match std::env::args().nth(1) {
        Some(path) => Source::at(path).open(&Progress::default())?,
        None => Sample::Warthog.open()?,
    };
    let mut analyst = Analyst::new(deployment.into());
    let mut settings = Settings::default();
    for method in [Method::Joint, Method::InterPrism] {
        settings.calibration.method = Some(method);
        let answer = analyst.run(&settings).answer?;
        let calibration = &answer.calibration;
        println!("{}: {}", calibration.answered_by().label(), calibration.verdict_in_words());
        for (station, transform) in calibration.station1_from_station.iter().enumerate().skip(1) {
            let sigma = calibration.sigma.as_ref().map(|sigma| sigma[station]);
            let sigma_mm = sigma.map_or(f64::NAN, |sigma| 1e3 * sigma.translation_m.max());
            let [x, y, z] = transform.translation_m.into();
            println!("  station {}: {x:.4} {y:.4} {z:.4} m, σ up to {sigma_mm:.1} mm", station + 1);
        }
        for finding in &calibration.findings {
            println!("  {finding}");
        }
    }
    Ok(())
}
