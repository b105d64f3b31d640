//! Extrinsic calibrations of simulated bodies with known pose, clock and scale.

use nalgebra::{UnitQuaternion, Vector3};
use resect_core::calibration::Verdict;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};

use super::{AdvisedMotion, Extrinsics, NoExtrinsics, estimate_extrinsics};
use crate::estimates::Options;
use crate::estimates::conventions::Convention;
use crate::estimates::simulated_odometry::{CLOCK_S, Drive, drive, normal, trajectory};

fn estimated(a: EstimatedTrajectory, b: EstimatedTrajectory) -> Extrinsics {
    estimate_extrinsics([a, b], &Options::default(), Convention::AS_READ).expect("fits")
}

/// Positions of an antenna on the vehicle.
fn antenna(drive: &Drive, antenna_m: &Vector3<f64>, seed: u64) -> EstimatedTrajectory {
    let mut random = rand::SeedableRng::seed_from_u64(seed);
    let place = |pose: &EstimatedPose| EstimatedPose {
        time_s: pose.time_s,
        position_m: pose.position_m
            + pose.orientation.expect("known") * antenna_m
            + 0.01 * normal(&mut random),
        orientation: None,
    };
    let poses: Vec<EstimatedPose> = drive.truth.iter().step_by(4).map(place).collect();
    trajectory("antenna", poses)
}

/// Asserts that the errors are within 4 σ.
fn assert_lever(extrinsics: &Extrinsics, true_m: &Vector3<f64>) {
    let off_m = extrinsics.solution.a_from_b.translation_m - true_m;
    let sigma_m = extrinsics.solution.lever_sigma_m.expect("estimated");
    for axis in 0..3 {
        assert!(off_m[axis].abs() < 4.0 * sigma_m[axis], "{off_m} {sigma_m}");
    }
}

#[test]
fn two_bodies_have_their_pose_clock_and_scale() {
    let mut drive = drive(11);
    let body_b = drive.odometry();
    let extrinsics = estimated(trajectory("a", drive.truth.clone()), body_b);
    assert_lever(&extrinsics, &drive.lever_m);
    let solution = &extrinsics.solution;
    let turn = UnitQuaternion::from(solution.a_from_b.rotation) * drive.body.inverse();
    let sigma_rad = solution.rotation_sigma_rad.expect("estimated");
    assert!(turn.angle() < 4.0 * sigma_rad.norm() && sigma_rad.max() < 1e-3, "{turn} {sigma_rad}");
    let sigma_s = solution.time_offset_sigma_s.expect("estimated");
    assert!((solution.time_offset_s - CLOCK_S).abs() < 4.0 * sigma_s, "{solution:?}");
    let scale = solution.scale.expect("estimated");
    assert!(scale.sigmas_from(1.0).abs() < 4.0 && scale.sigma < 3e-3, "{scale:?}");
    assert!(extrinsics.halves.contradiction().is_none(), "{:?}", extrinsics.halves);
}

/// The antenna is at the same place by the poses of the body and by those of another one, whose frame is turned.
#[test]
fn an_antenna_has_its_place_in_the_body() {
    let mut drive = drive(12);
    let antenna_m = Vector3::new(0.4, -0.1, 0.9);
    let extrinsics = estimated(drive.odometry(), antenna(&drive, &antenna_m, 1));
    assert_lever(&extrinsics, &(drive.body.inverse() * (antenna_m - drive.lever_m)));
    let solution = &extrinsics.solution;
    assert!(solution.rotation_sigma_rad.is_none());
    let sigma_s = solution.time_offset_sigma_s.expect("estimated");
    assert!((solution.time_offset_s + CLOCK_S).abs() < 4.0 * sigma_s, "{solution:?}");
}

/// A vehicle on flat ground turns about one axis, along which the antenna's place remains open. Tilts would determine it, and are advised.
#[test]
fn a_direction_that_the_motion_does_not_determine_is_named_with_the_motion_that_does() {
    let mut drive = drive(13);
    for pose in &mut drive.truth {
        let (_, _, yaw_rad) = pose.orientation.expect("known").euler_angles();
        pose.orientation = Some(UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad));
        pose.position_m.z = 0.0;
    }
    drive.body = UnitQuaternion::identity();
    let antenna = antenna(&drive, &Vector3::new(0.4, -0.1, 0.9), 2);
    let extrinsics = estimated(trajectory("a", drive.truth.clone()), antenna);
    assert_eq!(extrinsics.verdict, Verdict::Degenerate, "{extrinsics:?}");
    let open = extrinsics.directions[0];
    assert!(open.direction.z > 0.99 && !open.is_determined(), "{open:?}");
    assert!(extrinsics.directions[1].sigma_m < 0.02, "{:?}", extrinsics.directions);
    let [AdvisedMotion::Turn { direction, is_main_axis: true, by_rad, .. }, ..] =
        extrinsics.advice[..]
    else {
        panic!("{:?}", extrinsics.advice)
    };
    assert!(direction.z > 0.99 && by_rad > 0.05, "{direction} {by_rad}");
}

/// One half with another clock contradicts the other.
#[test]
fn halves_that_contradict_each_other_are_no_good_calibration() {
    let mut drive = drive(14);
    let mut body_b = drive.odometry();
    body_b.poses.iter_mut().filter(|pose| pose.time_s > 100.0).for_each(|pose| pose.time_s += 0.05);
    let extrinsics = estimated(trajectory("a", drive.truth.clone()), body_b);
    assert_eq!(extrinsics.verdict, Verdict::Ambiguous, "{extrinsics:?}");
    let half = extrinsics.halves.contradiction().expect("a contradiction");
    assert_eq!(half.name, "time offset");
    assert!((half.difference + 0.05).abs() < 0.01, "{half:?}");
}

#[test]
fn trajectories_without_orientations_and_copies_are_refused_with_the_remedy() {
    let mut drive = drive(15);
    let antenna = antenna(&drive, &Vector3::x(), 3);
    let refused = |a: EstimatedTrajectory, b: EstimatedTrajectory| {
        estimate_extrinsics([a, b], &Options::default(), Convention::AS_READ).expect_err("refused")
    };
    let why = refused(antenna.clone(), drive.odometry());
    assert!(matches!(why, NoExtrinsics::Exchanged { .. }), "{why}");
    let other = super::tests::antenna(&drive, &Vector3::y(), 4);
    let why = refused(antenna, EstimatedTrajectory { path: "other".into(), ..other });
    assert!(matches!(why, NoExtrinsics::NoOrientations { .. }), "{why}");
    let odometry = drive.odometry();
    let copied = EstimatedTrajectory { path: "copy".into(), ..odometry.clone() };
    assert!(matches!(refused(odometry, copied), NoExtrinsics::Same(..)));
}
