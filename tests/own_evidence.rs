//! No verdict against one's own evidence: what an answer itself shows to be wrong caps it at weak, and is said first.

mod common;

use common::{analyse, answer, field_data};
use nalgebra::{Rotation3, Vector3};
use resect::analysis::Settings;
use resect::calibration::{Calibration, CalibrationSettings, Method, Verdict};
use resect::deployment::{Deployment, Sample, open};
use resect::geometry::Polar;

const FOOT_M: f64 = 0.3048;

fn solved(deployment: &Deployment, calibration: CalibrationSettings) -> Calibration {
    let settings = Settings { calibration, ..Settings::default() };
    answer(&analyse(deployment, &settings)).calibration.clone()
}

fn sample() -> Deployment {
    Sample::Warthog.open().expect("built in")
}

/// Weak or worse, and what is said first is why; only other doubts, or the mistake that explains it, go before.
#[track_caller]
fn assert_doubted(calibration: &Calibration, why: &str) {
    let said: Vec<_> = calibration.findings.iter().map(ToString::to_string).collect();
    assert!(calibration.verdict >= Verdict::Weak, "{said:#?}");
    assert!(said[..3].iter().any(|line| line.contains(why)), "`{why}` is not first in {said:#?}");
}

/// Nothing of all this is said of data that is right.
#[test]
fn what_is_right_is_not_doubted() {
    let calibration = solved(&sample(), CalibrationSettings::robust());
    assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);
}

#[test]
fn an_estimate_that_did_not_converge_is_not_good() {
    let mut feet = sample();
    feet.rig.as_mut().expect("a rig").prisms_m = None;
    feet.control_points.clear();
    for m in feet.tracks.iter_mut().flat_map(|track| &mut track.measurements) {
        m.range_m /= FOOT_M;
    }
    let calibration = solved(&feet, CalibrationSettings::robust());
    assert_doubted(&calibration, "did not converge");
}

#[test]
fn a_fifth_of_the_triplets_left_out_is_too_much() {
    let mut wrong = sample();
    let track = &mut wrong.tracks[2].measurements;
    let count = track.len();
    // For a quarter of the drive station 3 follows something nearer.
    track[count / 3..count / 3 + count / 4].iter_mut().for_each(|m| m.range_m -= 0.3);
    assert_doubted(&solved(&wrong, CalibrationSettings::robust()), "cannot be right were left out");
}

#[test]
fn a_distance_that_its_measurement_does_not_allow_is_a_doubt() {
    let mut wrong = sample();
    wrong.rig.as_mut().expect("a rig").inter_prism_m[1] += 0.02;
    assert_doubted(&solved(&wrong, CalibrationSettings::robust()), "prisms 1–3 would be");
}

#[test]
fn a_lean_that_no_compensator_leaves_is_a_doubt() {
    let mut wrong = sample();
    let lean = Rotation3::from_axis_angle(&Vector3::x_axis(), 1e-3);
    for m in &mut wrong.tracks[1].measurements {
        let polar =
            Polar { range_m: m.range_m, azimuth_rad: m.azimuth_rad, zenith_rad: m.zenith_rad };
        let leaning = Polar::from_cartesian(lean * polar.to_cartesian());
        (m.azimuth_rad, m.zenith_rad) = (leaning.azimuth_rad, leaning.zenith_rad);
    }
    assert_doubted(&solved(&wrong, CalibrationSettings::robust()), "station 2 would lean");
}

/// The same drive, the same distances, and two methods from points: neither holds it together.
#[test]
fn what_leaves_the_prisms_10_mm_apart_is_good_by_no_method() {
    let Some(path) = field_data("2022-07-11-2") else { return };
    let deployment = open(&path).expect("the field data");
    for method in [Method::TwoPoint, Method::StaticGcp] {
        let settings = CalibrationSettings { method: Some(method), ..Default::default() };
        let calibration = solved(&deployment, settings);
        assert_eq!(calibration.verdict, Verdict::Weak, "{:?}", calibration.findings);
        let said: Vec<_> = calibration.findings.iter().map(ToString::to_string).collect();
        assert!(
            said.iter().any(|line| line.contains("inter-prism distances are off")),
            "{said:#?}"
        );
    }
}

/// A clock that is estimated explains what the published answer cannot fit: the refined one is not blamed for it, and its
/// twin and cost are its own.
#[test]
fn a_refined_answer_is_judged_as_itself() {
    let mut late = sample();
    late.tracks[2].measurements.iter_mut().for_each(|m| m.time_s += 0.04);
    let plain = solved(&late, CalibrationSettings::default());
    let robust = solved(&late, CalibrationSettings::robust());
    let fits_poorly =
        |c: &Calibration| c.findings.iter().any(|f| f.message.contains("distances fit poorly"));
    assert!(fits_poorly(&plain), "{:?}", plain.findings);
    assert!(!fits_poorly(&robust), "{:?}", robust.findings);
    assert_eq!(robust.verdict, Verdict::Good, "{:?}", robust.findings);
    let rms_mm =
        |c: &Calibration| 1e3 * c.inter_prism().expect("method D").basin.mean_square_m2.sqrt();
    assert!(
        rms_mm(&plain) > 5.0 && rms_mm(&robust) < 3.0,
        "{} {}",
        rms_mm(&plain),
        rms_mm(&robust)
    );
    let details = robust.inter_prism().expect("method D");
    let (basin, transforms) = (&details.basin, &robust.station1_from_station);
    for station in 1..3 {
        let apart_m =
            basin.station1_from_station[station].translation_m - transforms[station].translation_m;
        assert!(apart_m.norm() < 1e-6, "{apart_m}");
    }
    let direct = details.mirror.twin.as_ref().map(|twin| details.cost_ratio(twin));
    assert_eq!(direct.map(|ratio| ratio > 10.0), Some(true), "{direct:?}");
}

#[test]
fn a_switch_that_does_nothing_is_said_to() {
    let both = CalibrationSettings { weigh_by_noise: true, ..CalibrationSettings::robust() };
    let said = |settings| format!("{:?}", solved(&sample(), settings).findings);
    assert!(said(both).contains("changes nothing here"));
    assert!(!said(CalibrationSettings::robust()).contains("changes nothing here"));
}
