//! Fits of a simulated odometry with known clock, lever arm and body rotation.

use std::sync::Arc;

use nalgebra::{UnitQuaternion, Vector3};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::statistics::tables::NORMAL_95;

use super::{ClockChange, Fit, fit};
use crate::estimates::simulated_odometry::{CLOCK_S, drive, normal, trajectory};
use crate::estimates::{GroundTruth, Options};

fn fitted(truth: &[EstimatedPose], estimate: &EstimatedTrajectory) -> Fit {
    let truth = GroundTruth::Trajectory(Arc::new(trajectory("truth", truth.to_vec())), None);
    fit(&truth, estimate, &Options::default()).expect("aligned").0
}

/// Errors over σ of clock, lever arm and body rotation.
type OverSigma = [Vec<f64>; 3];

fn over_sigma(seeds: std::ops::Range<u64>) -> OverSigma {
    let mut all: OverSigma = Default::default();
    for seed in seeds {
        let mut drive = drive(seed);
        let estimate = drive.odometry();
        let fit = fitted(&drive.truth, &estimate);
        let sigma_s = fit.time_offset_sigma_s.expect("estimated");
        all[0].push((fit.time_offset_s - CLOCK_S) / sigma_s);
        let sigma_m = fit.lever_arm_sigma_m.expect("estimated");
        let off_m = fit.lever_arm_m.expect("estimated") - drive.lever_m;
        all[1].extend(off_m.component_div(&sigma_m).iter());
        let sigma_rad = fit.body_rotation_sigma_rad.expect("estimated");
        let off = fit.body_rotation.expect("estimated") * drive.body.inverse();
        all[2].extend(off.scaled_axis().component_div(&sigma_rad).iter());
        assert!(sigma_s < 1e-3 && sigma_rad.max() < 1e-3, "{sigma_s} {sigma_rad}");
        assert!(sigma_m.xy().max() < 5e-3 && fit.clock_change.is_none(), "{fit:?}");
    }
    all
}

/// The frame of the odometry turns by degrees. Clock, lever arm and body rotation are found to milliseconds, millimetres and tenths of a
/// milliradian, with errors of the size of their σ.
#[test]
fn a_drifting_odometry_has_honest_sigmas() {
    for over_sigma in over_sigma(0..10) {
        let squares: f64 = over_sigma.iter().map(|value| value * value).sum();
        let rms = (squares / over_sigma.len() as f64).sqrt();
        assert!((0.3..1.5).contains(&rms), "{rms}");
    }
}

#[test]
#[ignore = "a minute"]
fn regions_of_a_hundred_drifting_odometries_cover_the_truth() {
    for (name, over_sigma) in
        ["time offset", "lever arm", "body rotation"].iter().zip(over_sigma(0..100))
    {
        let covered = over_sigma.iter().filter(|value| value.abs() < NORMAL_95).count();
        let covered = covered as f64 / over_sigma.len() as f64;
        assert!(covered > 0.92, "{name}: {covered}");
    }
}

/// Interpolation averages the noise of two poses, and so prefers times between them. A ground truth at the times of every second pose
/// must not be moved there.
#[test]
fn a_ground_truth_in_phase_with_the_estimate_has_no_biased_clock() {
    let mut drive = drive(5);
    let estimate = drive.odometry();
    let in_phase: Vec<EstimatedPose> = drive.truth.iter().copied().skip(1).step_by(4).collect();
    let fit = fitted(&in_phase, &estimate);
    let (off_s, sigma_s) =
        (fit.time_offset_s - CLOCK_S, fit.time_offset_sigma_s.expect("estimated"));
    assert!(off_s.abs() < 3.0 * sigma_s && sigma_s < 0.002, "{off_s} ± {sigma_s}");
}

/// On a smooth drive with equal stamps, the noise of the interpolated ground truth is least between two of its poses. The clock must not go there,
/// and noise of velocities is no information on it: it was off by 0.04 s, up to 9 σ.
#[test]
fn a_smooth_drive_with_equal_stamps_has_an_honest_clock() {
    let over_sigma = |seed: u64| {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let mut walk_m = Vector3::zeros();
        let both = (0..2400).map(|index| {
            let time_s = 0.1 * f64::from(index);
            let on_eight = |time_s: f64| {
                Vector3::new(20.0 * (0.05 * time_s).sin(), 8.0 * (0.1 * time_s).sin(), 0.0)
            };
            let ahead_m = on_eight(time_s + 0.01) - on_eight(time_s - 0.01);
            let yaw_rad = ahead_m.y.atan2(ahead_m.x);
            walk_m += 0.002 * normal(&mut random);
            let truth_m = on_eight(time_s) + 0.003 * normal(&mut random);
            let estimate = EstimatedPose {
                time_s,
                position_m: on_eight(time_s) + walk_m,
                orientation: Some(UnitQuaternion::from_euler_angles(0.0, 0.0, yaw_rad)),
            };
            (estimate, EstimatedPose { time_s, position_m: truth_m, orientation: None })
        });
        let (estimate, truth): (Vec<EstimatedPose>, Vec<EstimatedPose>) = both.unzip();
        let fit = fitted(&truth, &trajectory("eight", estimate));
        fit.time_offset_s / fit.time_offset_sigma_s.expect("estimated")
    };
    let squares: f64 = (0..8).map(|seed| over_sigma(seed).powi(2)).sum();
    let rms = (squares / 8.0).sqrt();
    assert!((0.4..1.6).contains(&rms), "{rms}");
}

/// A camera that turns wrongly is moved as well, since what it sees a metre ahead stays in place. Such errors looked like a lever arm, up to 7 σ.
#[test]
fn errors_of_orientation_and_position_with_a_common_cause_are_no_lever_arm() {
    let over_sigma = |seed: u64| {
        let drive = drive(seed);
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        let (seen_m, mut turned) = (Vector3::x(), Vector3::zeros());
        let poses = drive.truth.iter().step_by(2).map(|pose| {
            turned += -0.1 * turned + 0.01 * 0.2_f64.sqrt() * normal(&mut random);
            let orientation = pose.orientation.expect("known");
            let wrong = UnitQuaternion::from_scaled_axis(turned) * orientation;
            let position_m = pose.position_m + orientation * seen_m - wrong * seen_m
                + 0.002 * normal(&mut random);
            EstimatedPose { position_m, orientation: Some(wrong), ..*pose }
        });
        let fit = fitted(&drive.truth, &trajectory("camera", poses.collect()));
        let sigma_m = fit.lever_arm_sigma_m.expect("estimated");
        fit.lever_arm_m.expect("estimated").component_div(&sigma_m).norm_squared()
    };
    let rms = ((0..4).map(over_sigma).sum::<f64>() / 12.0).sqrt();
    assert!(rms < 2.0, "{rms}");
}

#[test]
fn a_clock_that_is_set_forward_is_found_with_time_and_size() {
    let mut drive = drive(3);
    let mut estimate = drive.odometry();
    estimate.poses.iter_mut().filter(|pose| pose.time_s > 90.0).for_each(|pose| pose.time_s += 0.1);
    let fit = fitted(&drive.truth, &estimate);
    let Some(ClockChange::Step { time_s, by_s }) = fit.clock_change else { panic!("{fit:?}") };
    assert!((time_s - 90.0).abs() < 3.0 && (by_s + 0.1).abs() < 0.02, "{time_s} {by_s}");
    assert!(fit.time_offset_sigma_s.is_some_and(|sigma_s| sigma_s > 0.02), "{fit:?}");
}

/// A drive to and fro at even speed looks alike after each round.
#[test]
fn an_offset_that_is_not_unique_is_refused() {
    let round = |time_s: f64| {
        let phase = time_s * 0.4;
        let position_m = Vector3::new(3.0 * phase.cos(), 2.0 * phase.sin(), 0.3 * phase.sin());
        EstimatedPose { time_s, position_m, orientation: None }
    };
    let poses =
        |from: u32, to: u32| (from..to).map(|index| round(f64::from(index) * 0.1)).collect();
    let truth = GroundTruth::Trajectory(Arc::new(trajectory("truth", poses(0, 2000))), None);
    let why = fit(&truth, &trajectory("rounds", poses(500, 1500)), &Options::default());
    let why = why.map(|(fit, _)| fit).expect_err("ambiguous").to_string();
    assert!(why.contains("as well as"), "{why}");
}
