//! Conventions of simulated drives: each is recognised with its flag, and sound estimates have no suspicion.

mod axes_and_jumps;

use std::path::PathBuf;
use std::sync::Arc;

use nalgebra::{Rotation3, UnitQuaternion, Vector3};

use super::exchanged::exchanged;
use crate::estimates::conventions::{Convention, SignedAxes};
use crate::estimates::odd::OddOne;
use crate::estimates::{
    EstimatedPose, EstimatedTrajectory, EstimatesJudgement, GroundTruth, Options, judge,
};
use crate::findings::kinds;
use resect_core::deployment::FindingKind;

/// Poses of the drive and their interval (s).
const POSES: usize = 1500;
const STEP_S: f64 = 0.1;
const START_S: f64 = 1_760_000_000.0;

fn trajectory(name: &str, poses: Vec<EstimatedPose>) -> EstimatedTrajectory {
    EstimatedTrajectory {
        name: name.to_owned(),
        path: PathBuf::from(format!("{name}.tum")),
        topic: None,
        frames: None,
        poses,
        covariances: Vec::new(),
        origin: None,
        findings: Vec::new(),
    }
}

/// Figures of eight in rough terrain, with varying speed.
fn truth() -> Vec<EstimatedPose> {
    let pose = |index: usize| {
        let since_s = STEP_S * index as f64;
        let phase = 0.11 * since_s + 0.6 * (0.05 * since_s).sin();
        let position_m = Vector3::new(
            12.0 * phase.sin() + 2.0 * (0.031 * since_s).cos(),
            7.0 * (2.0 * phase).sin(),
            0.8 * (0.13 * since_s).sin(),
        );
        let orientation = UnitQuaternion::from_euler_angles(
            0.2 * (0.41 * since_s).sin(),
            0.15 * (0.53 * since_s).cos(),
            2.0 * phase + 0.4 * (0.2 * since_s).sin(),
        );
        EstimatedPose { time_s: START_S + since_s, position_m, orientation: Some(orientation) }
    };
    (0..POSES).map(pose).collect()
}

/// Noise with a standard deviation of one, from sums of a linear congruential generator.
struct Noise(u64);

impl Noise {
    fn next(&mut self) -> f64 {
        let mut uniform = || {
            self.0 = self
                .0
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 11) as f64 / (1_u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    }

    fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| self.next())
    }
}

/// A sound estimate: another frame, a lever arm, a turned body, and noise.
fn sound(seed: u64) -> Vec<EstimatedPose> {
    let mut noise = Noise(seed);
    let frame = UnitQuaternion::from_euler_angles(0.02, -0.03, 0.7);
    let body = UnitQuaternion::from_euler_angles(0.1, -0.2, 0.3);
    let lever_m = Vector3::new(0.4, -0.2, 0.3);
    let estimated = |pose: &EstimatedPose| {
        let orientation = pose.orientation.expect("known");
        let body_m = pose.position_m + orientation * lever_m;
        let turned = UnitQuaternion::from_scaled_axis(0.003 * noise.vector());
        EstimatedPose {
            time_s: pose.time_s + 0.02,
            position_m: frame * body_m + Vector3::new(5.0, -3.0, 1.0) + 0.01 * noise.vector(),
            orientation: Some(turned * frame * orientation * body),
        }
    };
    truth().iter().map(estimated).collect()
}

fn changed(change: impl Fn(EstimatedPose) -> EstimatedPose) -> Vec<EstimatedPose> {
    sound(1).into_iter().map(change).collect()
}

fn judged(estimates: Vec<Vec<EstimatedPose>>, options: Options) -> EstimatesJudgement {
    let truth = GroundTruth::Trajectory(Arc::new(trajectory("reference", truth())), None);
    let named = estimates.into_iter().enumerate();
    let estimates =
        named.map(|(index, poses)| (trajectory(&format!("slam{index}"), poses), options)).collect();
    judge(&truth, estimates)
}

/// Returns the kinds and messages of an estimate's findings, or the reason why it was not judged.
fn said(poses: Vec<EstimatedPose>, convention: &str) -> (Vec<FindingKind>, String) {
    let convention: Convention = convention.parse().expect(convention);
    let judgement = judged(vec![poses], Options { convention, ..Options::default() });
    match (judgement.judged.first(), judgement.unjudged.first()) {
        (Some(judged), _) => {
            let findings = &judged.fit.findings;
            let messages: Vec<String> = findings.iter().map(ToString::to_string).collect();
            (findings.iter().map(|finding| finding.kind).collect(), messages.join("\n"))
        }
        (None, Some((_, why))) => (Vec::new(), why.to_string()),
        (None, None) => panic!("no answer"),
    }
}

/// Asserts that a suspicion names the flag, and that nothing is suspected with it.
fn assert_recognised(poses: Vec<EstimatedPose>, flag: &str) {
    let (_, message) = said(poses.clone(), "");
    assert!(message.contains(&format!("--convention {flag}")), "{flag}: {message}");
    let (kinds, message) = said(poses, flag);
    assert!(kinds.is_empty() && message.is_empty(), "{flag}: {message}");
}

fn world_of(letters: &str) -> UnitQuaternion<f64> {
    let axes = SignedAxes::parse(letters).expect(letters);
    UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes.matrix()))
}

#[test]
fn sound_estimates_have_no_suspicion() {
    for seed in 1..6 {
        let (kinds, message) = said(sound(seed), "");
        assert!(kinds.is_empty() && message.is_empty(), "{message}");
    }
    // A standstill repeats its poses, and begins at the origin.
    let mut standing = sound(1);
    let first_m = standing[0].position_m;
    for pose in &mut standing {
        pose.position_m -= first_m;
    }
    for index in 0..200 {
        standing[index] = EstimatedPose { time_s: standing[index].time_s, ..standing[0] };
    }
    let kinds = said(standing, "").0;
    assert!(!kinds.contains(&kinds::ESTIMATE_POSES_HELD), "{kinds:?}");
    assert!(!kinds.contains(&kinds::ESTIMATE_POSES_UNSET), "{kinds:?}");
}

#[test]
fn orders_inverses_and_worlds_of_orientations_are_recognised() {
    let turned = |change: &dyn Fn(UnitQuaternion<f64>) -> UnitQuaternion<f64>| {
        changed(|pose| EstimatedPose { orientation: pose.orientation.map(change), ..pose })
    };
    for flag in [
        "wxyz",
        "inverse",
        "wxyz,inverse",
        "world=ned",
        "inverse,world=optical",
        "euler=xyz",
        "euler=clockwise",
    ] {
        let convention: Convention = flag.parse().expect(flag);
        assert_recognised(turned(&|orientation| convention.as_written(orientation)), flag);
    }
    // A permutation of the body's axes is its rotation in the vehicle, and no other convention.
    let camera = world_of("optical");
    let (kinds, message) = said(turned(&|orientation| orientation * camera), "");
    assert!(kinds.is_empty(), "{message}");
    // The numbers with the convention and as read.
    let convention: Convention = "inverse".parse().expect("a convention");
    let (_, message) = said(turned(&|orientation| convention.as_written(orientation)), "");
    assert!(message.contains("scatter by 0.3° instead of 1"), "{message}");
}

#[test]
fn a_wrong_stated_convention_is_replaced() {
    let (_, message) = said(sound(1), "inverse");
    assert!(message.contains("--convention xyzw"), "{message}");
    let convention: Convention = "inverse,world=ned".parse().expect("a convention");
    let turned = changed(|pose| EstimatedPose {
        orientation: pose.orientation.map(|orientation| convention.as_written(orientation)),
        ..pose
    });
    let (_, message) = said(turned, "wxyz,length=1");
    assert!(message.contains("--convention inverse,world=ned"), "{message}");
}

#[test]
fn orientations_are_compared_by_the_lever_arm_to_a_single_prism() {
    let mut prism = trajectory("prism", truth());
    prism.poses.iter_mut().for_each(|pose| pose.orientation = None);
    let truth = GroundTruth::Trajectory(Arc::new(prism), None);
    let messages = |poses: Vec<EstimatedPose>| -> String {
        let judgement = judge(&truth, vec![(trajectory("slam", poses), Options::default())]);
        let findings = judgement.judged[0].fit.findings.iter().map(ToString::to_string);
        findings.collect::<Vec<_>>().join("\n")
    };
    assert_eq!(messages(sound(1)), "");
    let inverse = changed(|pose| EstimatedPose {
        orientation: pose.orientation.map(|orientation| orientation.inverse()),
        ..pose
    });
    let message = messages(inverse);
    assert!(message.contains("--convention inverse") && message.contains(" mm "), "{message}");
    // Without a lever arm, the direction of travel remains.
    let forward = |inverse: bool| {
        let poses = sound(1);
        let turned = |index: usize| {
            let way_m = poses[(index + 5).min(POSES - 1)].position_m
                - poses[index.saturating_sub(5)].position_m;
            let yaw = UnitQuaternion::from_euler_angles(0.0, 0.0, way_m.y.atan2(way_m.x));
            let orientation = Some(if inverse { yaw.inverse() } else { yaw });
            EstimatedPose { orientation, ..poses[index] }
        };
        messages((0..POSES).map(turned).collect())
    };
    assert_eq!(forward(false), "");
    let message = forward(true);
    assert!(message.contains("--convention inverse") && message.contains("travel"), "{message}");
}

#[test]
fn units_and_small_scales_are_recognised() {
    for (factor, flag) in
        [(1000.0, "mm"), (100.0, "cm"), (1.0 / 0.3048, "ft"), (1.0 / 0.0254, "in")]
    {
        let scaled = changed(|pose| EstimatedPose { position_m: factor * pose.position_m, ..pose });
        assert_recognised(scaled, flag);
    }
    let short = changed(|pose| EstimatedPose { position_m: 0.3048 * pose.position_m, ..pose });
    assert!(said(short, "").1.contains("--truth-convention ft"));
    for factor in [1.05, 0.9996] {
        let scaled = changed(|pose| EstimatedPose { position_m: factor * pose.position_m, ..pose });
        let (kinds, message) = said(scaled, "");
        assert_eq!(kinds, [kinds::ESTIMATE_SCALE_DIFFERS], "{message}");
        let percent =
            message.split("distances are ").nth(1).and_then(|rest| rest.split(' ').next());
        let percent: f64 = percent.and_then(|percent| percent.parse().ok()).expect("a number");
        let expected = 100.0 * (factor - 1.0_f64).abs();
        assert!((percent / expected - 1.0).abs() < 0.1, "{message}");
        assert_eq!(message.contains("UTM"), factor < 1.0, "{message}");
    }
}

#[test]
fn units_and_rates_of_the_clock_are_recognised() {
    for (factor, flag) in [(1e3, "ms"), (1e6, "us"), (1e9, "ns")] {
        let scaled =
            changed(|pose| EstimatedPose { time_s: factor * (pose.time_s - START_S), ..pose });
        let (_, message) = said(scaled.clone(), "");
        assert!(message.contains(&format!("--convention {flag}")), "{message}");
        // The origin of the stamps is another one, which is a finding of its own.
        let (kinds, message) = said(scaled, flag);
        assert_eq!(kinds, [kinds::ESTIMATE_CLOCK_FAR_OFF], "{message}");
    }
    for factor in [0.5, 2.0, 1.0 / 0.96] {
        let scaled = changed(|pose| EstimatedPose {
            time_s: START_S + factor * (pose.time_s - START_S),
            ..pose
        });
        let (_, message) = said(scaled, "");
        let read = message.split("time=").nth(1).and_then(|rest| rest.split(')').next());
        let read: f64 = read.and_then(|read| read.parse().ok()).unwrap_or_default();
        assert!((read * factor - 1.0).abs() < 1e-3, "{factor}: {message}");
    }
}

#[test]
fn repeated_interpolated_and_unset_poses_are_recognised() {
    let poses = sound(1);
    let held_poses: Vec<EstimatedPose> = (0..POSES)
        .map(|index| EstimatedPose { time_s: poses[index].time_s, ..poses[index - index % 5] })
        .collect();
    let (kinds, message) = said(held_poses.clone(), "");
    assert!(kinds.contains(&kinds::ESTIMATE_POSES_HELD), "{message}");
    assert!(message.contains("300 different poses, each held for 0.50 s"), "{message}");
    assert_eq!(said(held_poses, "held").0, [], "the first of each is right");

    let interpolated: Vec<EstimatedPose> = (0..POSES - 10)
        .map(|index| {
            let (start, end) = (&poses[index - index % 10], &poses[index - index % 10 + 10]);
            let share = (index % 10) as f64 / 10.0;
            EstimatedPose {
                position_m: start.position_m.lerp(&end.position_m, share),
                ..poses[index]
            }
        })
        .collect();
    let (kinds, message) = said(interpolated, "");
    assert!(kinds.contains(&kinds::ESTIMATE_POSES_INTERPOLATED), "{message}");
    assert!(message.contains("over 1.0"), "{message}");

    for zeros in [0..40, 700..730] {
        let mut unset = poses.clone();
        for pose in &mut unset[zeros.clone()] {
            pose.position_m = Vector3::zeros();
            pose.orientation = Some(UnitQuaternion::identity());
        }
        let (_, message) = said(unset.clone(), "");
        assert!(message.contains(&format!("{} poses", zeros.len())), "{message}");
        assert!(message.contains("never set (--convention unset"), "{message}");
        assert_eq!(message.contains("before the start"), zeros.start == 0);
        assert_eq!(said(unset, "unset").0, []);
    }
}

#[test]
fn two_bodies_in_one_file_are_recognised() {
    let mut noise = Noise(9);
    let arm_m = Vector3::new(0.9, 0.3, 0.8);
    for share in [0.0, 1.0] {
        let poses = sound(1).into_iter().enumerate().map(|(index, pose)| {
            let is_second = if share == 0.0 { index % 2 == 1 } else { noise.next() > 0.3 };
            let offset_m = pose.orientation.expect("known") * arm_m;
            let position_m = pose.position_m + if is_second { offset_m } else { Vector3::zeros() };
            EstimatedPose { position_m, ..pose }
        });
        let (kinds, message) = said(poses.collect(), "");
        assert!(kinds.contains(&kinds::ESTIMATE_BODIES_MIXED), "{message}");
    }
}

/// An estimate whose frame jumps: it is wrong, and its copies agree with it.
fn wrong(seed: u64) -> Vec<EstimatedPose> {
    let shifted = |(index, pose): (usize, EstimatedPose)| {
        let is_off = (600..640).contains(&index);
        let shift_m = if is_off { Vector3::new(0.8, 0.3, 0.0) } else { Vector3::zeros() };
        EstimatedPose { position_m: pose.position_m + shift_m, ..pose }
    };
    sound(seed).into_iter().enumerate().map(shifted).collect()
}

#[test]
fn copies_count_once_among_those_that_agree() {
    let source = wrong(1);
    let frame = UnitQuaternion::from_euler_angles(0.1, 0.2, 1.0);
    let rounded = |value: f64| (500.0 * value).round() / 500.0;
    let map = |change: &dyn Fn(&EstimatedPose) -> EstimatedPose| {
        source.iter().map(change).collect::<Vec<_>>()
    };
    let copies = [
        ("itself", source.clone()),
        ("half the rate", source.iter().step_by(2).copied().collect()),
        (
            "rounded",
            map(&|pose| EstimatedPose { position_m: pose.position_m.map(rounded), ..*pose }),
        ),
        ("another clock", map(&|pose| EstimatedPose { time_s: pose.time_s + 0.037, ..*pose })),
        (
            "another frame",
            map(&|pose| EstimatedPose {
                position_m: frame * pose.position_m,
                orientation: pose.orientation.map(|orientation| frame * orientation),
                ..*pose
            }),
        ),
        (
            "another body",
            map(&|pose| EstimatedPose {
                position_m: pose.position_m
                    + pose.orientation.expect("known") * Vector3::new(0.3, 0.1, -0.2),
                ..*pose
            }),
        ),
    ];
    for (name, copy) in copies {
        let judgement = judged(vec![source.clone(), copy], Options::default());
        let [first, second] = &judgement.judged[..] else { panic!("two are judged") };
        let is_copy =
            |finding: &resect_core::deployment::Finding| finding.kind == kinds::ESTIMATE_COPY;
        assert!(second.fit.findings.iter().any(is_copy), "{name}");
        assert!(!first.fit.findings.iter().any(is_copy), "{name}");
        assert!(!first.odd.is_empty() && judgement.agreements.is_empty(), "{name}");
        let against_truth = |odd: OddOne| matches!(odd, OddOne::TruthAgainst(_));
        let spans = first.odd.iter().chain(&second.odd);
        assert!(spans.map(|span| span.odd_one).all(|odd| !against_truth(odd)), "{name}");
    }
    // Independent estimates with the same jump agree against the ground truth.
    let judgement = judged(vec![wrong(1), wrong(2)], Options::default());
    for judged in &judgement.judged {
        assert_eq!(judged.fit.findings, []);
        assert!(judged.odd.iter().any(|span| span.odd_one == OddOne::TruthAgainst(2)));
    }
}

#[test]
fn an_exchange_is_a_note() {
    let [estimate, reference] =
        ["warthog_groundtruth", "fast_lio"].map(|name| trajectory(name, sound(1)));
    assert!(exchanged(&estimate, &reference) && !exchanged(&reference, &estimate));
    let judgement = judge(
        &GroundTruth::Trajectory(Arc::new(reference), None),
        vec![(estimate, Options::default())],
    );
    let kinds: Vec<FindingKind> =
        judgement.judged[0].fit.findings.iter().map(|finding| finding.kind).collect();
    assert_eq!(kinds, [kinds::ESTIMATE_EXCHANGED]);
}
