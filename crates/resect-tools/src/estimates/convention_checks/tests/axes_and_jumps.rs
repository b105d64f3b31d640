//! Mirrored positions, jumps, clocks that change, and conventions of the ground truth's file.

use super::*;
use crate::estimates::Unjudged;

/// Positions and orientations as a file with a convention has them.
fn written(flag: &str) -> Vec<EstimatedPose> {
    let convention: Convention = flag.parse().expect(flag);
    let to_file = convention.position_axes.matrix().transpose() / convention.length_m;
    changed(|pose| {
        let mut position_m = to_file * pose.position_m;
        if convention.is_left_handed {
            position_m.y = -position_m.y;
        }
        let orientation = pose.orientation.map(|orientation| convention.as_written(orientation));
        EstimatedPose { position_m, orientation, ..pose }
    })
}

#[test]
fn mirrored_positions_are_named_with_the_axis() {
    for flag in ["left-handed", "axes=x-yz", "axes=xy-z", "axes=yxz"] {
        assert_recognised(written(flag), flag);
    }
    // Another unit is named first, and its flag stays.
    let (_, message) = said(written("left-handed,cm"), "cm");
    assert!(message.contains("--convention left-handed,cm"), "{message}");
    // Positions alone: the axis that leaves the estimate upright.
    let positions =
        written("axes=xy-z").into_iter().map(|pose| EstimatedPose { orientation: None, ..pose });
    let (_, message) = said(positions.collect(), "");
    assert!(message.contains("mirrored") && message.contains("axes=xy-z"), "{message}");
}

#[test]
fn mirrored_estimates_do_not_agree_against_the_ground_truth() {
    let mirrored = |seed| {
        let pose = |mut pose: EstimatedPose| {
            pose.position_m.z = -pose.position_m.z;
            pose
        };
        sound(seed).into_iter().map(pose).collect()
    };
    let judgement = judged(vec![mirrored(1), mirrored(2)], Options::default());
    assert!(judgement.agreements.is_empty(), "{:?}", judgement.agreements);
    let against_truth =
        |span: &crate::estimates::odd::OddSpan| matches!(span.odd_one, OddOne::TruthAgainst(_));
    assert!(!judgement.judged.iter().any(|judged| judged.odd.iter().any(against_truth)));
}

#[test]
fn parts_of_poses_that_are_held_are_recognised() {
    let poses = sound(1);
    let positions = |index: usize| EstimatedPose {
        position_m: poses[index - index % 5].position_m,
        ..poses[index]
    };
    let orientations = |index: usize| EstimatedPose {
        orientation: poses[index - index % 5].orientation,
        ..poses[index]
    };
    assert_recognised((0..POSES).map(positions).collect(), "held=positions");
    assert_recognised((0..POSES).map(orientations).collect(), "held=orientations");
}

#[test]
fn outliers_and_resets_are_named_instead_of_their_effects() {
    let mut outliers = sound(1);
    outliers.iter_mut().step_by(50).for_each(|pose| pose.position_m = Vector3::repeat(9999.0));
    let mut reset = sound(1);
    reset[700..].iter_mut().for_each(|pose| pose.position_m += Vector3::new(40.0, -9.0, 0.0));
    for (poses, words) in [(outliers, "17.3 km from the poses before"), (reset, "jumps once")] {
        let judgement = judged(vec![poses], Options::default());
        let Some((_, why @ Unjudged::OtherConvention(_))) = judgement.unjudged.first() else {
            panic!("{words}: {:?}", judgement.judged[0].fit.findings)
        };
        assert!(why.to_string().contains(words), "{why}");
    }
    // A loop closure of decimetres is an error of the estimate.
    let mut closed = sound(1);
    closed[700..].iter_mut().for_each(|pose| pose.position_m.x += 0.3);
    assert!(!said(closed, "").0.contains(&kinds::ESTIMATE_JUMPS));
}

#[test]
fn bursts_planes_and_late_orientations_are_notes() {
    let burst = |(index, pose): (usize, EstimatedPose)| EstimatedPose {
        time_s: pose.time_s + if index % 2 == 0 { 0.09 } else { 0.0 },
        ..pose
    };
    let (_, message) = said(sound(1).into_iter().enumerate().map(burst).collect(), "");
    assert!(message.contains("bursts: many follow after 0.010 s instead of 0.100 s"), "{message}");
    let mut planar = sound(1);
    planar.iter_mut().for_each(|pose| pose.position_m.z = 0.0);
    assert!(said(planar, "").0.contains(&kinds::ESTIMATE_PLANAR));
    let poses = sound(1);
    let late = |index: usize| EstimatedPose {
        orientation: poses[index.saturating_sub(2)].orientation,
        ..poses[index]
    };
    let (kinds, message) = said((0..POSES).map(late).collect(), "");
    assert!(kinds.contains(&kinds::ESTIMATE_ORIENTATIONS_LATE), "{message}");
    assert!(message.contains(" ms later than its positions"), "{message}");
}

/// Ground truth of positions alone.
fn said_against_positions(poses: Vec<EstimatedPose>) -> String {
    let positions = truth().into_iter().map(|pose| EstimatedPose { orientation: None, ..pose });
    let truth = trajectory("reference", positions.collect());
    let truth = GroundTruth::Trajectory(Arc::new(truth), None);
    let judgement = judge(&truth, vec![(trajectory("slam", poses), Options::default())]);
    let findings = &judgement.judged.first().expect("judged").fit.findings;
    findings.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

#[test]
fn clocks_that_change_are_named_against_positions() {
    let timed = |later_s: &dyn Fn(f64) -> f64| {
        changed(|pose| EstimatedPose {
            time_s: pose.time_s + later_s(pose.time_s - START_S),
            ..pose
        })
    };
    assert_eq!(said_against_positions(sound(1)), "");
    let set = said_against_positions(timed(&|time_s| if time_s > 80.0 { 0.3 } else { 0.0 }));
    assert!(set.contains("its clock is set forward by 0.30 s"), "{set}");
    let drifts = said_against_positions(timed(&|time_s| 2e-3 * time_s));
    assert!(drifts.contains("gains +2.0"), "{drifts}");
}

/// Reason or findings for a sound estimate against a ground truth whose poses are changed.
fn said_of_truth(change: impl Fn(EstimatedPose) -> EstimatedPose) -> String {
    let poses = truth().into_iter().map(change).collect();
    let mut truth = trajectory("reference", poses);
    crate::estimates::add_findings_of_truth(&mut truth, &Convention::AS_READ);
    let truth = GroundTruth::Trajectory(Arc::new(truth), None);
    let judgement = judge(&truth, vec![(trajectory("slam", sound(1)), Options::default())]);
    let findings = judgement.judged.iter().flat_map(|judged| &judged.fit.findings);
    let why = judgement.unjudged.iter().map(|(_, why)| why.to_string());
    findings.map(ToString::to_string).chain(why).collect::<Vec<_>>().join("\n")
}

#[test]
fn conventions_of_the_ground_truths_file_are_not_blamed_on_the_estimate() {
    for flag in ["wxyz", "inverse", "world=ned"] {
        let convention: Convention = flag.parse().expect(flag);
        let message = said_of_truth(|pose| EstimatedPose {
            orientation: pose.orientation.map(|orientation| convention.as_written(orientation)),
            ..pose
        });
        assert!(message.contains(&format!("--truth-convention {flag}")), "{flag}: {message}");
    }
    let message = said_of_truth(|pose| {
        let inverse = pose.orientation.expect("turned").inverse();
        let position_m = -(inverse * pose.position_m);
        EstimatedPose { position_m, orientation: Some(inverse), ..pose }
    });
    assert!(message.contains("--truth-convention inverse-poses"), "{message}");
    let message = said_of_truth(|pose| match pose.time_s - START_S {
        0.0..20.0 => EstimatedPose {
            position_m: Vector3::zeros(),
            orientation: Some(UnitQuaternion::identity()),
            ..pose
        },
        _ => pose,
    });
    assert!(message.contains("--truth-convention unset"), "{message}");
}
