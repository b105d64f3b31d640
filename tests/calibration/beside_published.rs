//! The joint estimate is the default; the paper's calibration beside it is unchanged.

use crate::common::{analyse, answer, by, field_data, published};
use resect_core::analysis::{Analyst, Settings};
use resect_core::calibration::joint::SolverStatus;
use resect_core::calibration::{Calibration, JointFailure, Method, Verdict};
use resect_core::deployment::kinds;
use resect_core::deployment::{Deployment, Finding, Remedy};
use resect_core::progress::Progress;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_tools::simulation::{Preset, simulate};

fn calibration(deployment: &Deployment, settings: &Settings) -> Calibration {
    answer(&analyse(deployment, settings)).calibration.clone()
}

/// Asserts bit-identical numbers, and the same verdict.
#[track_caller]
fn assert_same(a: &Calibration, b: &Calibration) {
    assert_eq!(a.method, b.method);
    assert_eq!(a.station1_from_station, b.station1_from_station);
    assert_eq!(a.covariance, b.covariance);
    assert_eq!((a.verdict, &a.findings), (b.verdict, &b.findings));
    assert_eq!(a.checked_by, b.checked_by);
}

fn sample() -> Deployment {
    Sample::Warthog.open().expect("built in")
}

#[test]
fn without_a_method_the_answer_is_the_joint_estimate() {
    let found = calibration(&sample(), &Settings::default());
    assert_eq!(found.method, Method::Joint);
    assert_same(&found, &calibration(&sample(), &by(Method::Joint)));
    let joint = found.joint().expect("a joint estimate");
    assert!(found.clocks().is_some() && joint.distances_m().is_some());
    assert!(found.inter_prism().is_some(), "three prisms");
}

#[test]
fn the_papers_answer_stands_beside_it_to_the_last_bit() {
    let mut deployments = vec![sample(), Sample::Hd2Tunnel.open().expect("built in")];
    deployments.extend(field_data("2022-07-11-2").map(|path| open(&path).expect("opens")));
    for deployment in &deployments {
        let joint = calibration(deployment, &Settings::default());
        let beside = joint.published.as_deref().expect("the paper's method has an answer");
        let alone = calibration(deployment, &published());
        assert_same(beside, &alone);
        assert!(alone.published.is_none(), "only a joint estimate carries another answer");
        assert_ne!(joint.station1_from_station, alone.station1_from_station);
    }
}

#[test]
fn the_papers_method_answers_where_the_joint_estimate_is_not_determined() {
    let mut line =
        resect_io::simulation_files::open(&simulate(Preset::StraightLine, 1)).expect("valid");
    line.control_points.clear();
    let found = calibration(&line, &Settings::default());
    let status = found.joint_failure().map(JointFailure::status);
    assert_eq!(status, Some(SolverStatus::UnobservableStart));
    assert_eq!((found.method, found.answered_by()), (Method::Joint, Method::InterPrism));
    let alone = calibration(&line, &published());
    assert_eq!(found.station1_from_station, alone.station1_from_station);
    assert_eq!(found.covariance, alone.covariance);
    // No advice leads in a circle.
    let advises_joint = |finding: &Finding| finding.remedies.contains(&Remedy::JointEstimate);
    assert!(!found.findings.iter().any(advises_joint), "{:?}", found.findings);
}

#[test]
fn control_points_determine_what_a_drive_of_plain_shape_leaves_open() {
    for (preset, shape) in
        [(Preset::StraightLine, kinds::DRIVE_STRAIGHT_LINE), (Preset::Circle, kinds::DRIVE_CIRCLE)]
    {
        let simulated = simulate(preset, 1);
        let deployment = resect_io::simulation_files::open(&simulated).expect("valid");
        let found = calibration(&deployment, &Settings::default());
        assert_eq!(found.answered_by(), Method::Joint, "{preset:?}");
        let covariance = found.covariance.as_ref().expect("determined");
        for station in [1, 2] {
            let truth = simulated.truth.station1_from_station[station];
            let off_m = found.station1_from_station[station].translation_m - truth.translation_m;
            for axis in 0..3 {
                let index = 4 * (station - 1) + axis;
                let sigma_m = covariance[(index, index)].sqrt();
                assert!(sigma_m < 0.003 && off_m[axis].abs() < 4.0 * sigma_m, "{off_m} {sigma_m}");
            }
        }
        // A station that moved along an open direction since the survey would not show.
        assert_eq!(found.verdict, Verdict::Weak, "{:?}", found.findings);
        assert!(found.findings.iter().any(|finding| finding.kind == shape), "{:?}", found.findings);
        let mut by_drive = Settings::default();
        by_drive.calibration.evidence.control_points = false;
        let by_drive = calibration(&deployment, &by_drive);
        let status = by_drive.joint_failure().map(JointFailure::status);
        assert_eq!(status, Some(SolverStatus::UnobservableStart), "{preset:?}");
    }
}

#[test]
fn of_one_prism_the_joint_estimate_has_the_clocks_and_c_beside_it() {
    let deployment =
        resect_io::simulation_files::open(&simulate(Preset::SinglePrism, 5)).expect("valid");
    let joint = calibration(&deployment, &Settings::default());
    assert_eq!(joint.method, Method::Joint);
    assert!(joint.clocks().is_some());
    let beside = joint.published.as_deref().expect("C has an answer");
    assert_same(beside, &calibration(&deployment, &by(Method::DynamicGcp)));
    assert!(beside.clocks().is_none(), "as published, C knows no clocks");
}

/// The window shows it before the joint estimate is available.
#[test]
fn the_papers_answer_can_be_had_first() {
    let mut analyst = Analyst::new(sample().into());
    let progress = Progress::default();
    let first = analyst.run_published_while(&Settings::default(), &progress);
    let first = first.expect("nobody cancels it").expect("the default is the joint estimate");
    let joint = analyst.run(&Settings::default());
    assert_same(
        &answer(&first).calibration,
        answer(&joint).calibration.published.as_deref().expect("beside it"),
    );
    let none = analyst.run_published_while(&published(), &progress).expect("nobody cancels it");
    assert!(none.is_none(), "there is nothing to follow");
}
