//! The paper's studies on simulated deployments and on the field data.

use resect_tools::findings::kinds;
use std::sync::Arc;

use crate::common::of_field;
use resect_core::analysis::Settings;
use resect_core::calibration::Method;
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_report::study;
use resect_tools::experiment::{
    Parameter, Splits, StudyError, Sweep, ablate, compare, sweep, sweep_answers,
};
use resect_tools::simulation::{Preset, simulate};

fn sample() -> Vec<Arc<Deployment>> {
    vec![Arc::new(Sample::Warthog.open().expect("built in"))]
}

#[test]
#[cfg_attr(not(field_data), ignore = "needs ../shared/datasets")]
fn the_disagreement_of_b_and_d_about_station_2_is_plain() {
    let path = of_field("2022-07-11-2");
    let deployments = [Arc::new(open(&path).expect("opens"))];
    let result =
        compare(&deployments, &Settings::default(), None, &Progress::default()).expect("compares");
    let compared = &result.deployments[0];
    let between = |station: usize| {
        compared
            .disagreements
            .iter()
            .find(|d| d.methods == [Method::StaticGcp, Method::InterPrism] && d.station == station)
    };
    let disagreement = between(2).expect("they disagree");
    assert!((disagreement.yaw_rad - 0.87e-3).abs() < 0.02e-3, "{disagreement:?}");
    // σ of D has the errors of instruments, which this drive alone does not show.
    assert!(disagreement.yaw_sigmas.expect("both have σ") > 8.0);
    assert_eq!(between(3), None, "about station 3 they agree");
    // The table, the findings and the plot contain the words.
    let words = "B and D disagree about the yaw of station 2";
    assert!(study::table(&result.study).contains(words));
    let folder = tempfile::tempdir().expect("a folder");
    study::write(&result.study, folder.path()).expect("writable");
    let svg = std::fs::read_to_string(folder.path().join("comparison.svg")).expect("written");
    assert!(svg.contains(words));
    let png = std::fs::read(folder.path().join("comparison.png")).expect("written");
    assert!(png.starts_with(b"\x89PNG"));
}

#[test]
fn methods_that_agree_are_not_said_to_disagree_and_gnss_is_a_line() {
    let result =
        compare(&sample(), &Settings::default(), None, &Progress::default()).expect("compares");
    assert!(result.deployments[0].disagreements.is_empty());
    let solved = result.deployments[0].answers.iter().filter(|answer| answer.is_ok()).count();
    assert_eq!(solved, 4, "A, B, D and the joint estimate");
    let gnss = result.study.levels.iter().find(|level| level.label.contains("GNSS"));
    // Simulated with 6 mm horizontally and 12 mm vertically per antenna.
    assert!((4.0..10.0).contains(&gnss.expect("three antennas").value), "{gnss:?}");
    // The stations are more accurate.
    let d = result.study.groups[3].boxes[1].as_ref().expect("distances");
    assert!(d.median < 0.5 * gnss.expect("three antennas").value);
}

#[test]
fn the_outlier_filter_pays_and_all_twelve_boxes_are_there() {
    let study =
        ablate(&sample(), &Settings::default(), None, None, &Progress::default()).expect("ablates");
    assert_eq!((study.groups.len(), study.series.len()), (4, 3));
    let p95 = |group: usize, series: usize| {
        study.groups[group].boxes[series].as_ref().expect("a box").q95
    };
    // Linear interpolation confines a gross error to its neighbours, Gaussian processes need the filter.
    for (series, share) in [(0, 0.95), (1, 0.2), (2, 0.2)] {
        assert!(p95(1, series) < share * p95(0, series), "series {series}");
    }
    // One format for each reader.
    let csv = study::csv(&study);
    assert_eq!(csv.lines().count(), 13);
    assert_eq!(study::json(&study)["groups"][3]["boxes"][2]["series"], "GP, motion model");
}

#[test]
fn long_gaps_cost_accuracy() {
    let range = Sweep { parameter: Parameter::TauS, from: 0.5, to: 5.0, steps: 4 };
    let study = sweep(&sample(), &Settings::default(), &range, None, None, &Progress::default())
        .expect("sweeps");
    let q95: Vec<f64> =
        study.groups.iter().map(|g| g.boxes[0].as_ref().expect("a box").q95).collect();
    assert!(q95[3] > q95[0], "{q95:?}");
    assert_eq!(study.groups[0].label, "0.5");
}

#[test]
fn splits_are_seeded_and_judge_unseen_data() {
    let run = |seed, repeats| {
        let splits = Some(Splits { repeats, seed });
        compare(&sample(), &Settings::default(), splits, &Progress::default())
            .expect("compares")
            .study
    };
    let (first, again, other) = (run(1, 4), run(1, 4), run(2, 4));
    assert_eq!(first.groups, again.groups);
    assert!(first.groups != other.groups);
    let whole = compare(&sample(), &Settings::default(), None, &Progress::default())
        .expect("compares")
        .study;
    let n = |study: &resect_tools::experiment::Study, group: usize, metric: usize| {
        study.groups[group].boxes[metric].as_ref().expect("a box").n as f64
    };
    // Four quarters.
    let share = n(&first, 3, 1) / n(&whole, 3, 1);
    assert!((0.85..1.15).contains(&share), "{share}");
}

#[test]
fn what_cannot_be_judged_is_left_out_and_said() {
    let mut without_rig = Deployment::clone(&sample()[0]);
    without_rig.rig = None;
    without_rig.control_points.clear();
    let both = [Arc::clone(&sample()[0]), Arc::new(without_rig)];
    let study =
        ablate(&both, &Settings::default(), None, None, &Progress::default()).expect("one is left");
    assert!(
        study.findings.iter().any(|f| f.kind == kinds::DEPLOYMENT_LEFT_OUT),
        "{:?}",
        study.findings
    );
    let error = ablate(&both[1..], &Settings::default(), None, None, &Progress::default())
        .expect_err("none is left");
    assert!(matches!(error, StudyError::Nothing(why) if why.contains("inter-prism distances")));
}

#[test]
fn a_cancelled_study_stops() {
    let progress = Progress::default();
    progress.cancel();
    let result = ablate(&sample(), &Settings::default(), None, None, &progress);
    assert_eq!(result, Err(StudyError::Cancelled));
}

#[test]
fn ten_deployments_are_compared_as_one() {
    let deployments: Vec<Arc<Deployment>> = [
        Preset::Warthog,
        Preset::Hd2Tunnel,
        Preset::FlatFloor,
        Preset::UnevenGround,
        Preset::FigureEight,
        Preset::LShape,
        Preset::SinglePrism,
        Preset::Warthog,
        Preset::Hd2Tunnel,
        Preset::StraightLine,
    ]
    .into_iter()
    .zip(1..)
    .map(|(preset, seed)| {
        Arc::new(resect_io::simulation_files::open(&simulate(preset, seed)).expect("valid"))
    })
    .collect();
    let progress = Progress::default();
    let result = compare(&deployments, &Settings::default(), None, &progress).expect("compares");
    assert_eq!(result.deployments.len(), 10);
    assert_eq!(progress.share(), Some(1.0));
    assert_eq!(result.study.groups[2].note, "1 of 10 deployments");
}

/// The thresholds of the paper decide the answer of method D only.
#[test]
fn the_joint_estimate_does_not_follow_a_threshold_and_method_d_does() {
    let range = Sweep { parameter: Parameter::TauL, from: 1.0, to: 15.0, steps: 4 };
    let study = sweep_answers(&sample(), &Settings::default(), &range, &Progress::default())
        .expect("sweeps");
    let spread_mm = |series: usize| {
        let medians_mm =
            study.groups.iter().map(|group| group.boxes[series].as_ref().expect("a box").median);
        let [least, most] =
            [f64::min, f64::max].map(|pick| medians_mm.clone().reduce(pick).expect("four values"));
        most - least
    };
    assert!(spread_mm(1) < 1e-9, "{}", spread_mm(1));
    assert!(spread_mm(0) > 1e-3, "{}", spread_mm(0));
}
