//! Calibrates readings that JavaScript writes into the module's memory.
//!
//! A reading is five numbers: station (1, 2, 3), time (s), range (m), azimuth (rad), zenith angle (rad).

use std::cell::RefCell;

use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::Method;
use resect_core::deployment::{Deployment, Measurement, Rig, Track, TrackFrame};

thread_local! {
    static READINGS: RefCell<Vec<[f64; 5]>> = const { RefCell::new(Vec::new()) };
    static ANSWER: RefCell<[f64; 8]> = const { RefCell::new([f64::NAN; 8]) };
}

/// Makes room for `count` readings and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn readings(count: usize) -> *mut [f64; 5] {
    READINGS.with_borrow_mut(|readings| {
        *readings = vec![[0.0; 5]; count];
        readings.as_mut_ptr()
    })
}

/// Returns the address of x, y, z (m) and yaw (rad) of station 2 in station 1's frame, then of station 3; NaN without a calibration.
/// `joint` is 0 for method D and 1 for the joint estimate.
#[unsafe(no_mangle)]
pub extern "C" fn calibrate(joint: u32, alpha_m: f64, beta_m: f64, gamma_m: f64) -> *const [f64; 8] {
    let deployment = READINGS.with_borrow(|readings| deployment(readings, [alpha_m, beta_m, gamma_m]));
    let mut settings = Settings::default();
    settings.calibration.method = Some(if joint == 1 { Method::Joint } else { Method::InterPrism });
    let analysis = Analyst::new(deployment.into()).run(&settings);
    ANSWER.with_borrow_mut(|answer| {
        *answer = [f64::NAN; 8];
        if let Ok(solved) = &analysis.answer {
            for (index, transform) in solved.calibration.station1_from_station.iter().skip(1).enumerate() {
                answer[4 * index..4 * index + 3].copy_from_slice(transform.translation_m.as_slice());
                answer[4 * index + 3] = transform.yaw_rad();
            }
        }
        std::ptr::from_ref(answer)
    })
}

fn deployment(readings: &[[f64; 5]], inter_prism_m: [f64; 3]) -> Deployment {
    let track = |station: usize| Track {
        measurements: (readings.iter())
            .filter(|reading| reading[0] as usize == station + 1)
            .map(|&[_, time_s, range_m, azimuth_rad, zenith_rad]| Measurement { time_s, range_m, azimuth_rad, zenith_rad })
            .collect(),
        prism_constant_m: 0.010,
        ..Track::default()
    };
    Deployment {
        name: "wasm".to_owned(),
        tracks: [track(0), track(1), track(2)].into(),
        track_frame: TrackFrame::Own,
        control_points: Vec::new(),
        rig: Some(Rig { inter_prism_m: inter_prism_m.into(), prisms_m: None, in_vehicle_m: None, inter_antenna_m: None }),
        prisms: None,
        gnss: None,
        time_corrections: [Vec::new(), Vec::new(), Vec::new()].into(),
        overrides: Default::default(),
        as_read: Default::default(),
        ingredients: Vec::new(),
        findings: Vec::new(),
        ground_truth: None,
        restarts_s: Vec::new(),
    }
}
