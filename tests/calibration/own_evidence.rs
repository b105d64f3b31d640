//! Verdicts consistent with their own evidence: a fault that a calibration
//! itself reveals limits its verdict to weak, and is reported first.

use crate::common::{analyse, answer, by, of_field};
use nalgebra::{Rotation3, Vector3};
use resect_core::analysis::Analysis;
use resect_core::calibration::{Calibration, ErrorSizes, Method, Verdict, Witness};
use resect_core::deployment::Deployment;
use resect_core::deployment::kinds;
use resect_core::evaluation::answer_rows::{RowGroup, estimate_rows};
use resect_core::geometry::FOOT_M;
use resect_core::geometry::Polar;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, Scenario, Settling, simulate_scenario};

fn solved(deployment: &Deployment, method: Method) -> Calibration {
    answer(&analyse(deployment, &by(method))).calibration.clone()
}

fn sample() -> Deployment {
    Sample::Warthog.open().expect("built in")
}

/// Asserts a verdict of weak or worse, with this reason first; only other doubts, or the mistake behind it, may precede it.
#[track_caller]
fn assert_doubted(calibration: &Calibration, why: &str) {
    let said: Vec<_> = calibration.findings.iter().map(ToString::to_string).collect();
    assert!(calibration.verdict >= Verdict::Weak, "{said:#?}");
    assert!(said[..3].iter().any(|line| line.contains(why)), "`{why}` is not first in {said:#?}");
}

/// Correct data has no such finding.
#[test]
fn what_is_right_is_not_doubted() {
    let calibration = solved(&sample(), Method::Joint);
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
    let calibration = solved(&feet, Method::Joint);
    assert_doubted(&calibration, "did not converge");
    // The answer is that of method D, with its σ.
    assert!(calibration.joint().is_none());
    let words = "method D (the joint estimate did not converge)";
    assert_eq!(calibration.method_in_words(), words);
    let by_d = solved(&feet, Method::InterPrism);
    assert_eq!(calibration.station1_from_station, by_d.station1_from_station);
    assert_eq!(calibration.covariance, by_d.covariance);
}

#[test]
fn a_wrong_control_point_is_named_and_moves_nothing() {
    let mut wrong = sample();
    let right = solved(&wrong, Method::Joint);
    let point = &mut wrong.control_points[0].points[2];
    let marker = point.marker;
    point.readings[1].as_mut().expect("measured").range_m += 0.3;
    for settings in ["drive,control-points,rig", "control-points"] {
        let mut by_points = by(Method::Joint);
        by_points.calibration.evidence = settings.parse().expect("names");
        let calibration = answer(&analyse(&wrong, &by_points)).calibration.clone();
        assert_eq!(calibration.verdict, Verdict::Weak, "{settings}");
        let mut findings = calibration.findings.iter();
        let outlier = findings.find(|finding| finding.kind == kinds::CONTROL_POINT_OUTLIER);
        let outlier = outlier.unwrap_or_else(|| panic!("{settings}: {:?}", calibration.findings));
        assert!(outlier.to_string().contains(&format!("marker {marker} of")), "{outlier}");
        for station in 1..3 {
            let [wrong, right] = [&calibration, &right].map(|it| it.station1_from_station[station]);
            let moved_m = (wrong.translation_m - right.translation_m).norm();
            assert!(moved_m < 0.003, "{settings}: {moved_m} m");
        }
    }
}

/// The sample with station 2 turned by 2 mrad between its control points and its drive.
fn turned_after_the_survey() -> Deployment {
    let mut turned = sample();
    for point in turned.control_points.iter_mut().flat_map(|set| &mut set.points) {
        point.readings[1].iter_mut().for_each(|polar| polar.azimuth_rad += 2e-3);
    }
    turned
}

#[test]
fn a_set_up_that_changed_after_the_survey_is_named_and_contradicts_nothing() {
    let calibration = solved(&turned_after_the_survey(), Method::Joint);
    let findings = &calibration.findings;
    let changed = findings.iter().find(|finding| finding.kind == kinds::SET_UP_CHANGED);
    let changed = changed.unwrap_or_else(|| panic!("no change in {findings:#?}"));
    assert!(changed.is_about_station(1), "{changed}");
    let turned_rad = changed.value("turned").expect("a turn");
    assert!((turned_rad.abs() - 2e-3).abs() < 3e-4, "{changed}");
    let contradictions = [kinds::METHODS_DISAGREE, kinds::CONTROL_POINTS_CONTRADICT];
    let has_none = !findings.iter().any(|finding| contradictions.contains(&finding.kind));
    assert!(has_none, "{findings:#?}");
    assert!(!calibration.checked_by.contains(&Witness::ControlPoints));
    // Without a change, survey and drive confirm each other.
    let unchanged = solved(&sample(), Method::Joint);
    assert!(unchanged.survey().is_some_and(|survey| survey.change.is_none()));
    assert!(unchanged.checked_by.contains(&Witness::ControlPoints));
}

#[test]
fn a_changed_set_up_is_in_the_rows_and_in_the_json() {
    let turned = turned_after_the_survey();
    let analysis = analyse(&turned, &by(Method::Joint));
    let rows = estimate_rows(&turned, &answer(&analysis).calibration);
    let survey = || rows.iter().filter(|row| row.group == RowGroup::Survey);
    assert_eq!(survey().count(), 8);
    let yaw = survey().find(|row| row.subject == "T12" && row.name == "yaw survey − drive");
    let yaw = yaw.expect("the yaw of station 2");
    assert!((yaw.value.abs() - 2e-3).abs() < 3e-4 && yaw.is_significant, "{yaw:?}");

    let json = |analysis: &Analysis, deployment: &Deployment| {
        resect_report::json::calibration(deployment, analysis, answer(analysis), 0.0)
    };
    let changed = json(&analysis, &turned);
    assert_eq!(changed["set_up_change"]["station"], 2);
    let survey_yaw_rad = changed["survey_transforms"][0]["yaw_rad"].as_f64().expect("a yaw");
    let drive_yaw_rad = changed["transforms"][0]["yaw_rad"].as_f64().expect("a yaw");
    assert!((survey_yaw_rad - drive_yaw_rad - yaw.value).abs() < 1e-12);
    assert!(changed["survey_transforms"][1]["sigma"]["yaw_rad"].is_f64());

    let unchanged = json(&analyse(&sample(), &by(Method::Joint)), &sample());
    assert!(unchanged.get("survey_transforms").is_some());
    assert!(unchanged.get("set_up_change").is_none());
    let by_d = json(&analyse(&sample(), &by(Method::InterPrism)), &sample());
    assert!(by_d.get("survey_transforms").is_none());
}

#[test]
fn a_fifth_of_the_triplets_left_out_is_too_much() {
    let mut wrong = sample();
    // Every eighth reading of station 3 is of a nearer object, and spoils the triplets on both sides.
    wrong.tracks[2].measurements.iter_mut().step_by(8).for_each(|m| m.range_m -= 0.3);
    assert_doubted(&solved(&wrong, Method::Joint), "outlying triplets were left out");
}

#[test]
fn a_distance_that_its_measurement_does_not_allow_is_a_doubt() {
    let mut wrong = sample();
    wrong.rig.as_mut().expect("a rig").inter_prism_m[1] += 0.02;
    assert_doubted(&solved(&wrong, Method::Joint), "prisms 1–3 would be");
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
    assert_doubted(&solved(&wrong, Method::Joint), "implausible at");
}

/// The same drive, the same distances, and two methods from control points, neither of which fits the rig.
#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn what_leaves_the_prisms_10_mm_apart_is_good_by_no_method() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("the field data");
    for method in [Method::TwoPoint, Method::StaticGcp] {
        let calibration = solved(&deployment, method);
        assert_eq!(calibration.verdict, Verdict::Weak, "{:?}", calibration.findings);
        let said: Vec<_> = calibration.findings.iter().map(ToString::to_string).collect();
        assert!(
            said.iter().any(|line| line.contains("inter-prism distances are off")),
            "{said:#?}"
        );
    }
}

/// An estimated clock explains the misfit of the published calibration:
/// the joint estimate is not blamed for it, and has its own twin and cost.
#[test]
fn a_joint_estimate_is_judged_as_itself() {
    let mut late = sample();
    late.tracks[2].measurements.iter_mut().for_each(|m| m.time_s += 0.04);
    let plain = solved(&late, Method::InterPrism);
    let joint = solved(&late, Method::Joint);
    let fits_poorly =
        |c: &Calibration| c.findings.iter().any(|f| f.kind == kinds::DISTANCES_FIT_POORLY);
    assert!(fits_poorly(&plain), "{:?}", plain.findings);
    assert!(!fits_poorly(&joint), "{:?}", joint.findings);
    assert_eq!(joint.verdict, Verdict::Good, "{:?}", joint.findings);
    let rms_mm =
        |c: &Calibration| 1e3 * c.inter_prism().expect("method D").basin.mean_square_m2.sqrt();
    assert!(rms_mm(&plain) > 5.0 && rms_mm(&joint) < 3.0, "{} {}", rms_mm(&plain), rms_mm(&joint));
    let details = joint.inter_prism().expect("method D");
    let (basin, transforms) = (&details.basin, &joint.station1_from_station);
    for station in 1..3 {
        let apart_m =
            basin.station1_from_station[station].translation_m - transforms[station].translation_m;
        assert!(apart_m.norm() < 1e-6, "{apart_m}");
    }
    let direct = details.mirror.twin.as_ref().map(|twin| details.cost_ratio(twin));
    assert_eq!(direct.map(|ratio| ratio > 10.0), Some(true), "{direct:?}");
}

/// Returns the calibration of the drive through the tunnel, with station
/// 2's azimuths rotated by an angle (mrad) at each share of the drive.
fn turned(by_mrad: impl Fn(f64) -> f64) -> Calibration {
    let mut tunnel = Sample::Hd2Tunnel.open().expect("built in");
    let (from_s, to_s) = (tunnel.start_s().expect("readings"), tunnel.end_s().expect("readings"));
    for m in &mut tunnel.tracks[1].measurements {
        m.azimuth_rad += 1e-3 * by_mrad((m.time_s - from_s) / (to_s - from_s));
    }
    solved(&tunnel, Method::Joint)
}

/// Returns the time of an event in a finding's text (s).
fn after_s(said: &str) -> f64 {
    let time = said.split_once("about ").and_then(|(_, rest)| rest.split_once(" s into the drive"));
    time.and_then(|(time, _)| time.parse().ok()).unwrap_or_else(|| panic!("{said}"))
}

/// Along a tunnel a rotation resembles a translation, which hides it from a comparison of two halves.
#[test]
fn a_station_that_turns_half_way_through_a_tunnel_is_told() {
    let calibration = turned(|share| if share > 0.5 { 0.5 } else { 0.0 });
    assert_doubted(&calibration, "station 2 turned by");
    let said = calibration.findings[0].to_string();
    assert!((after_s(&said) - 200.0).abs() < 15.0, "{said}");
}

#[test]
fn a_station_that_turns_slowly_is_told() {
    let calibration = turned(|share| 0.4 * share);
    assert_doubted(&calibration, "station 2 turned by");
}

/// The longer a drive, the smaller the share of it that an instant is.
#[test]
fn a_station_that_turns_within_an_hour_is_told_when() {
    let mut hour = Preset::Warthog.scenario();
    hour.duration_s = 3600.0;
    hour.errors.settling = vec![Settling {
        station: 1,
        from_s: 1733.0,
        over_s: 0.0,
        turn_rad: 3e-4,
        move_m: Vector3::zeros(),
        lean_rad: [0.0; 2],
    }];
    let deployment =
        resect_io::simulation_files::open(&simulate_scenario(&hour, 5)).expect("valid");
    let calibration = solved(&deployment, Method::Joint);
    let told = calibration.findings.iter().map(ToString::to_string);
    let told: Vec<String> = told.filter(|line| line.contains("station 2 turned by")).collect();
    assert_eq!(told.len(), 1, "{:#?}", calibration.findings);
    assert!((after_s(&told[0]) - 1733.0).abs() < 20.0, "{told:?}");
    assert_eq!(calibration.verdict, Verdict::Weak);
}

/// Ranges 0.1 m too long for the first forty seconds: only the rest fits.
#[test]
fn what_was_left_out_in_a_row_is_told() {
    let mut moved = sample();
    let from_s = moved.start_s().expect("readings");
    for m in &mut moved.tracks[2].measurements {
        if m.time_s < from_s + 40.0 {
            m.range_m += 0.1;
        }
    }
    let calibration = solved(&moved, Method::Joint);
    assert_doubted(&calibration, "of the drive do not fit the rest and were left out");
}

/// Errors whose size the settings set to zero are tested against the data; those that are really zero pass.
#[test]
fn a_size_that_the_data_contradicts_is_told() {
    let told = |scenario: &Scenario, set: fn(&mut ErrorSizes)| {
        let mut settings = by(Method::Joint);
        set(&mut settings.calibration.errors);
        let deployment =
            resect_io::simulation_files::open(&simulate_scenario(scenario, 3)).expect("valid");
        answer(&analyse(&deployment, &settings)).calibration.clone()
    };
    let right = Preset::Warthog.scenario();
    let none: fn(&mut ErrorSizes) =
        |sizes| (sizes.latency_s, sizes.range_scale, sizes.clock_drift) = (0.0, 0.0, 0.0);
    let calibration = told(&right, none);
    assert_eq!(calibration.verdict, Verdict::Good, "{:?}", calibration.findings);

    let mut late = right.clone();
    late.errors.latency_s[2] = 0.03;
    assert_doubted(&told(&late, none), "station 3's angles are older than its ranges by +");
    let mut long = right;
    long.errors.range_scale[1] = 200e-6;
    assert_doubted(&told(&long, none), "station 2's ranges are off by +");
}

/// Two stations that track each other's prism for a while look like another rig.
#[test]
fn distances_that_are_off_together_are_a_doubt() {
    let mut wrong = sample();
    let inter_prism_m = &mut wrong.rig.as_mut().expect("a rig").inter_prism_m;
    for distance_m in &mut inter_prism_m.as_mut_slice()[1..] {
        *distance_m += 0.012;
    }
    wrong.rig.as_mut().expect("a rig").prisms_m = None;
    assert_doubted(&solved(&wrong, Method::Joint), " σ: a station followed another prism");
}
