//! The published run of 2022-07-11 compared with an independent implementation (`../shared/datasets/README.md`).

use crate::common::{analyse, answer, assert_close, by, field_data, of_field, published};
use nalgebra::Vector3;
use resect_core::analysis::Settings;
use resect_core::calibration::{Alignment, Details, Method, PriorMethod, ResolvedBy, Verdict};
use resect_core::deployment::Finding;
use resect_core::deployment::kinds;
use resect_core::geometry::{LevelTransform, RigidTransform};
use resect_core::network::Prism;
use resect_core::progress::Progress;
use resect_io::findings::kinds as file_kinds;
use resect_io::open::open;
use resect_io::source::{Extras, Source};

const NEAR: [f64; 3] = [0.003, 0.003, 0.010];
const NEAR_RAD: f64 = 1e-4;

fn transform(x: f64, y: f64, z: f64, yaw: f64) -> LevelTransform {
    LevelTransform::new(Vector3::new(x, y, z), yaw)
}

fn settings(filters: bool, prior: PriorMethod) -> Settings {
    let mut settings = published();
    settings.pipeline.outlier_filter = filters;
    settings.pipeline.interval_filter = filters;
    settings.calibration.prior = prior;
    settings
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn defaults_reproduce_the_reference() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &published());
    assert_eq!(analysis.pipeline.triplets.len(), 2032);
    assert_eq!(analysis.pipeline.kept_intervals.len(), 11);
    let answer = answer(&analysis);
    let [_, t12, t13] =
        answer.calibration.station1_from_station.as_array().expect("three stations");
    assert_close(t12, &transform(5.3191, -2.5264, -0.2885, -0.51872), NEAR, NEAR_RAD);
    assert_close(t13, &transform(-5.4514, -0.0256, -0.2655, -0.45934), NEAR, NEAR_RAD);

    let inter_prism = answer.evaluation.inter_prism_mm.expect("a rig is there");
    assert!((inter_prism.median - 1.31).abs() < 0.05, "{inter_prism:?}");
    assert!((inter_prism.iqr - 2.53).abs() < 0.05, "{inter_prism:?}");
    // The pillars are not among the control points of the metric: three sets, not four.
    let medians: Vec<f64> =
        answer.evaluation.control_points_mm.iter().map(|m| m.spread.median.round()).collect();
    assert_eq!(medians, [35.0, 83.0, 123.0]);
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_mirror_is_found_and_told_apart_by_the_rig() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &published());
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.inter_prism().expect("method D").mirror.resolved_by, ResolvedBy::Rig);
    assert!(
        (calibration.inter_prism().expect("method D").mirror.cost_ratio.expect("a twin") - 4.74)
            .abs()
            < 0.1
    );
    let twin = &calibration
        .inter_prism()
        .expect("method D")
        .mirror
        .twin
        .as_ref()
        .expect("a twin")
        .station1_from_station;
    assert_close(&twin[1], &transform(5.3185, -2.5388, 0.4829, -0.5189), NEAR, NEAR_RAD);
    assert_close(&twin[2], &transform(-5.4454, -0.0384, 0.4509, -0.4596), NEAR, NEAR_RAD);
    assert!(calibration.findings.iter().any(|f| f.kind == kinds::MIRROR_UNRESOLVED
        || f.kind == kinds::MIRROR_RESOLVED_BY_COST
        || f.kind == kinds::MIRROR_RESOLVED_BY_RIG
        || f.kind == kinds::MIRROR_RESOLVED_BY_CONTROL_POINTS));
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn control_points_that_contradict_are_not_passed_over() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &published());
    let calibration = &answer(&analysis).calibration;
    assert_eq!(calibration.verdict, Verdict::Weak);
    assert!(calibration.findings.iter().any(|f| f.kind == kinds::CONTROL_POINTS_CONTRADICT));
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn without_filters_neither_prior_falls_into_the_mirror() {
    let path = of_field("2022-07-11-2");
    let mut deployment = open(&path).expect("opens");
    let blind = {
        // Without any independent evidence the cost decides.
        let mut blind = deployment.clone();
        blind.control_points.clear();
        if let Some(rig) = &mut blind.rig {
            rig.prisms_m = None;
        }
        blind
    };
    deployment.findings.clear();
    for deployment in [&deployment, &blind] {
        for prior in [PriorMethod::ClosedForm, PriorMethod::Search] {
            let analysis = analyse(deployment, &settings(false, prior));
            assert_eq!(analysis.pipeline.triplets.len(), 3886);
            assert_eq!(analysis.pipeline.kept_intervals.len(), 25);
            let [_, t12, t13] = answer(&analysis)
                .calibration
                .station1_from_station
                .as_array()
                .expect("three stations");
            assert_close(t12, &transform(5.3189, -2.5262, -0.2885, -0.5187), NEAR, NEAR_RAD);
            assert_close(t13, &transform(-5.4503, -0.0272, -0.2660, -0.4594), NEAR, NEAR_RAD);
        }
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn both_priors_end_in_the_same_answer() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let [closed, search] = [PriorMethod::ClosedForm, PriorMethod::Search]
        .map(|prior| analyse(&deployment, &settings(true, prior)));
    let found = &answer(&search).calibration.station1_from_station;
    for (a, b) in answer(&closed).calibration.station1_from_station.iter().zip(found) {
        assert_close(a, b, [1e-6; 3], 1e-8);
    }
    let search = answer(&search).calibration.inter_prism().expect("method D");
    let search = search.prior_search.as_ref().expect("it searched");
    assert!(search.agreed);
    assert!(search.steps.iter().all(|runs| runs.len() > 5));
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn all_bags_give_the_numbers_of_the_table() {
    let folder = of_field("2022-07-11-2");
    let reference = analyse(&open(&folder).expect("opens"), &published());
    let reference = &answer(&reference).calibration.station1_from_station;
    for bag in [
        "2022-07-11-2.bag",
        "2022-07-11-2-bz2.bag",
        "2022-07-11-2-lz4.bag",
        "2022-07-11-2-ros2-sqlite3",
        "2022-07-11-2-ros2-mcap",
        "2022-07-11-2-ros2-mcap/metadata.yaml",
    ] {
        let Some(path) = field_data("2022-07-11-2-bags").map(|folder| folder.join(bag)) else {
            return;
        };
        let extras = Extras { rig: Some(folder.clone()), ..Extras::default() };
        let source = Source::at(path).with(extras);
        let deployment = source.open(&Progress::default()).expect("opens");
        // Six messages of the ROS 1 bags report a lost lock.
        let lost =
            deployment.findings.iter().filter(|f| f.kind == file_kinds::RECORDS_DROPPED).count();
        assert_eq!(lost, if bag.ends_with(".bag") { 3 } else { 0 }, "{bag}: a finding a station");
        // Both of their times are equal.
        let said = |f: &Finding| f.kind == kinds::STAMPS_ARE_STATION_CLOCKS;
        assert!(deployment.findings.iter().any(said), "{bag}");
        let analysis = analyse(&deployment, &published());
        assert_eq!(analysis.pipeline.triplets.len(), 2032, "{bag}");
        for (a, b) in answer(&analysis).calibration.station1_from_station.iter().zip(reference) {
            assert_close(a, b, [1e-6; 3], 1e-8);
        }
    }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn a_bag_alone_says_what_it_lacks() {
    let folder = of_field("2022-07-11-2-bags");
    let deployment = open(&folder.join("2022-07-11-2.bag")).expect("opens");
    assert!(deployment.rig.is_none());
    let error = analyse(&deployment, &published()).answer.expect_err("no rig").to_string();
    assert!(error.contains("inter-prism distances are not known"), "{error}");
    // Several bags of the same drive are read once, whatever their container.
    let copies = open(&folder).expect("opens");
    assert!(copies.findings.iter().any(|finding| finding.kind == file_kinds::COPIES_LEFT_OUT));
    assert_eq!(
        copies.tracks.map(|track| track.measurements.len()),
        deployment.tracks.map(|track| track.measurements.len())
    );
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn a_cut_bag_gives_its_beginning_and_says_so() {
    let folder = of_field("2022-07-11-2-bags");
    let temporary = tempfile::tempdir().expect("a folder");
    for bag in [
        "2022-07-11-2.bag",
        "2022-07-11-2-bz2.bag",
        "2022-07-11-2-lz4.bag",
        "2022-07-11-2-ros2-sqlite3/2022-07-11-2-ros2-sqlite3.db3",
        "2022-07-11-2-ros2-mcap/2022-07-11-2-ros2-mcap.mcap",
    ] {
        let bytes = std::fs::read(folder.join(bag)).expect("readable");
        let name = bag.rsplit('/').next().expect("a name");
        let path = temporary.path().join(name);
        let mut before = 0;
        for share in [0.0001, 0.01, 0.1, 0.5, 0.9, 0.98] {
            let length = (bytes.len() as f64 * share) as usize;
            std::fs::write(&path, &bytes[..length]).expect("writable");
            match open(&path) {
                Ok(deployment) => {
                    let tracks = &deployment.tracks;
                    let readings = tracks.iter().map(|t| t.measurements.len()).sum();
                    assert!(readings >= before, "{bag} {share}: {readings} after {before}");
                    let said = |f: &Finding| f.kind == file_kinds::BAG_DAMAGED;
                    assert!(deployment.findings.iter().any(said), "{:?}", deployment.findings);
                    before = readings;
                }
                Err(error) => assert!(error.to_string().contains(name), "{share}: {error}"),
            }
        }
        assert!(before > 2000, "{bag}: {before}");
        std::fs::remove_file(&path).expect("removable");
    }
}

/// A millimetre and 0.02 mrad, the tolerances of the issue.
const B_NEAR: ([f64; 3], f64) = ([1e-3; 3], 2e-5);

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn static_control_points_reproduce_the_reference() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    for alignment in [Alignment::Level, Alignment::Rigid] {
        let mut settings = by(Method::StaticGcp);
        settings.calibration.alignment = alignment;
        let analysis = analyse(&deployment, &settings);
        let answer = answer(&analysis);
        let [_, t12, t13] =
            answer.calibration.station1_from_station.as_array().expect("three stations");
        let (metres, radians) = B_NEAR;
        assert_close(t12, &turned(5.3205, -2.5267, -0.2926, -0.51959, t12), metres, radians);
        assert_close(t13, &turned(-5.4499, -0.0271, -0.2627, -0.45931, t13), metres, radians);
        let tilt_arcsec = t12.tilt_rad().to_degrees() * 3600.0;
        assert!((tilt_arcsec > 1.0) == (alignment == Alignment::Rigid), "{tilt_arcsec}");
        assert!(tilt_arcsec < 10.0);
    }
    let analysis = analyse(&deployment, &by(Method::StaticGcp));
    let answer = answer(&analysis);
    let mut all_mm: Vec<f64> = deployment
        .control_points
        .iter()
        .filter(|set| !set.pillars)
        .flat_map(|set| set.disagreements_m(&answer.calibration.station1_from_station))
        .map(|m| m * 1e3)
        .collect();
    all_mm.sort_by(f64::total_cmp);
    assert!((all_mm[all_mm.len() / 2] - 3.1).abs() < 0.1, "{}", all_mm[all_mm.len() / 2]);
    let inter_prism = answer.evaluation.inter_prism_mm.expect("a rig is there");
    assert!((inter_prism.median - 10.7).abs() < 0.1, "{inter_prism:?}");
    assert!((inter_prism.iqr - 18.1).abs() < 0.2, "{inter_prism:?}");
    // Station 2 turned since the survey, so that the drive does not fit, and a finding reports that.
    assert_eq!(answer.calibration.verdict, Verdict::Weak);
    assert!(answer.calibration.findings.iter().any(|f| f.kind == kinds::DRIVE_FITS_POORLY));
}

/// Returns a level reference with the tilt of the compared transform: only four parameters of the reference are known.
fn turned(x: f64, y: f64, z: f64, yaw: f64, tilted: &RigidTransform) -> RigidTransform {
    let level = RigidTransform::from(transform(x, y, z, yaw));
    let level_of_tilted = RigidTransform::from(transform(0.0, 0.0, 0.0, tilted.yaw_rad()));
    let tilt = level_of_tilted.inverse().rotation * tilted.rotation;
    RigidTransform { rotation: level.rotation * tilt, ..level }
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn two_point_resection_agrees_with_the_control_points() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &by(Method::TwoPoint));
    let a = &answer(&analysis).calibration;
    let reference = analyse(&deployment, &by(Method::StaticGcp));
    let b = &answer(&reference).calibration;
    for station in 1..3 {
        let (a, b) = (&a.station1_from_station[station], &b.station1_from_station[station]);
        assert_close(a, b, [0.015; 3], 1e-4);
    }
    let Details::TwoPoint(details) = &a.details else { panic!("method A") };
    // Four pillars: six pairs, each with two excluded points, which three pairs of stations compare.
    assert_eq!(details.pairs.len(), 6);
    assert!(details.pairs.iter().all(|pair| pair.left_out_m.len() == 6));
    // Every pair agrees with B as well, within its stated σ.
    for pair in &details.pairs {
        for station in 1..3 {
            let b = &b.station1_from_station[station];
            assert_close(&pair.station1_from_station[station], b, [0.015; 3], 1e-4);
        }
    }
    assert!(a.findings.iter().any(|f| f.kind == kinds::KNOWN_DISTANCE_OFF), "{:?}", a.findings);
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_methods_that_the_data_lacks_say_what() {
    let path = of_field("2022-07-11-2");
    let deployment = open(&path).expect("opens");
    let analysis = analyse(&deployment, &by(Method::DynamicGcp));
    let error = analysis.answer.expect_err("three prisms").to_string();
    assert!(error.contains("method C (dynamic-gcp) needs one prism"), "{error}");
    assert_eq!(Prism::count(&analysis.offer.followed), 3);
    let lacks = analysis.offer.lacks.iter().filter(|lack| lack.is_some()).count();
    assert_eq!(lacks, 1);
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn halves_of_the_drive_agree_within_what_the_joint_estimate_states() {
    let path = of_field("2022-07-11-2");
    let whole = open(&path).expect("opens");
    let readings = &whole.tracks[0].measurements;
    let middle_s = readings[readings.len() / 2].time_s;
    let half = |first: bool| {
        let mut deployment = whole.clone();
        for track in &mut deployment.tracks {
            track.measurements.retain(|m| (m.time_s < middle_s) == first);
        }
        answer(&analyse(&deployment, &by(Method::Joint))).calibration.clone()
    };
    let [a, b] = [half(true), half(false)];
    for station in 1..3 {
        let off = a.station1_from_station[station].translation_m
            - b.station1_from_station[station].translation_m;
        let yaw_rad =
            a.station1_from_station[station].yaw_rad() - b.station1_from_station[station].yaw_rad();
        let [sigma_a, sigma_b] =
            [&a, &b].map(|half| half.sigma.as_ref().expect("both halves hold all")[station]);
        let together = |a: f64, b: f64| a.hypot(b);
        for axis in 0..3 {
            let sigma_m = together(sigma_a.translation_m[axis], sigma_b.translation_m[axis]);
            let sigmas = off[axis].abs() / sigma_m;
            assert!(sigmas < 3.5, "station {}, axis {axis}: {sigmas:.1} σ", station + 1);
        }
        let sigmas = yaw_rad.abs() / together(sigma_a.yaw_rad, sigma_b.yaw_rad);
        assert!(sigmas < 3.5, "yaw of station {}: {sigmas:.1} σ", station + 1);
    }
}
