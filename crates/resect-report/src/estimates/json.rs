//! A judgement as JSON.

use serde_json::{Value, json};

use super::rows::Angles;
use super::verdicts::{compared, error_in_words};
use crate::json::{SCHEMA, findings};
use resect_core::calibration::Calibration;
use resect_tools::estimates::metrics::Ape;
use resect_tools::estimates::metrics::RelativeErrors;
use resect_tools::estimates::odd::{OddOne, OddSpan, SharedFault};
use resect_tools::estimates::{
    Coverage, Delta, EstimatesJudgement, GroundTruth, Judged, NoMotions, Plane,
};

/// Returns everything as one object; lengths in metres, angles in radians, times in seconds.
pub fn json(truth: &GroundTruth<'_>, judgement: &EstimatesJudgement) -> Value {
    let name = |index: usize| &judgement.judged[index].estimate.name;
    let calibration = match truth {
        GroundTruth::Deployment { analysis, .. } => {
            analysis.answer.as_ref().ok().map(|answer| &answer.calibration)
        }
        GroundTruth::Trajectory(..) => None,
    };
    json!({
        "schema": SCHEMA,
        "ground_truth": ground_truth(truth),
        "deployment": calibration.map(|_| truth.name()),
        "method": calibration.map(Calibration::answered_by),
        "verdict": calibration.map(|calibration| calibration.verdict.name()),
        "rpe_all_pairs": judgement.motions.all_pairs,
        "estimates": judgement.judged.iter().map(estimate).collect::<Vec<_>>(),
        "comparisons": judgement.comparisons.iter().map(|two| json!({
            "by": error_in_words(two.kind),
            "unit": if two.kind.is_rotation() { "rad" } else { "m" },
            "better": name(two.better),
            "worse": name(two.worse),
            "rmse": two.rmse,
            "ratio": two.rmse[0] / two.rmse[1],
            "ratio_95": two.ratio_95(),
            "confidence": two.confidence(),
            "significant": two.is_significant(),
            "verdict": if two.is_significant() { "better" } else { "inconclusive" },
            "because": compared(judgement, two, Angles::DEGREES),
            "of": if two.is_of_distances { "distance" } else { "pose" },
            "count": two.count,
            "factor": two.factor().map(|factor| factor.value),
            "factor_sigma": two.factor().map(|factor| factor.sigma),
            "sigmas": two.sigmas(),
        })).collect::<Vec<_>>(),
        "agreements": judgement.agreements.iter().map(|both| json!({
            "estimates": both.estimates.map(name),
            "difference_m": both.apart_m,
            "rmse_m": both.rmse_m,
        })).collect::<Vec<_>>(),
        "not_judged": judgement.unjudged.iter().map(|(name, why)| json!({
            "name": name,
            "why": why.to_string(),
        })).collect::<Vec<_>>(),
    })
}

fn ground_truth(truth: &GroundTruth<'_>) -> Value {
    match truth {
        GroundTruth::Deployment { deployment, .. } => json!({
            "kind": "deployment",
            "name": deployment.name,
        }),
        GroundTruth::Trajectory(truth, _) => json!({
            "kind": "trajectory",
            "name": truth.name,
            "file": truth.path,
            "topic": truth.topic,
            "poses": truth.poses.len(),
            "states_covariance": !truth.covariances.is_empty(),
            "findings": findings(truth.findings.iter()),
        }),
    }
}

fn estimate(judged: &Judged) -> Value {
    let Judged { estimate, fit, .. } = judged;
    let against_sigma = judged.against_sigma;
    let (without_truth, without_pose) = match judged.coverage {
        Coverage::PosesWithoutTruth(count) => (Some(count), None),
        Coverage::TruthsWithoutPose(count) => (None, Some(count)),
    };
    let quaternion = |q: nalgebra::UnitQuaternion<f64>| [q.i, q.j, q.k, q.w];
    let turn = nalgebra::UnitQuaternion::from(fit.truth_from_estimate.rotation);
    json!({
        "name": estimate.name,
        "file": estimate.path,
        "poses": estimate.poses.len(),
        "poses_with_ground_truth": judged.errors.len(),
        "poses_without_ground_truth": without_truth,
        "ground_truth_without_poses": without_pose,
        "alignment": {
            "by": judged.alignment,
            "translation_m": fit.truth_from_estimate.translation_m.as_slice(),
            "quaternion_xyzw": quaternion(turn),
            "scale": fit.scale,
            "first_poses": judged.options.align_first,
        },
        "span_s": [judged.options.from_s, judged.options.to_s],
        "plane": judged.options.plane.map(Plane::name),
        "time_offset_s": fit.time_offset_s,
        "time_offset_sigma_s": fit.time_offset_sigma_s,
        "time_offset_determined": fit.determines_time_offset,
        "lever_arm_m": fit.lever_arm_m.map(|lever| lever.data.0[0]),
        "lever_arm_sigma_m": fit.lever_arm_sigma_m.map(|sigma| sigma.data.0[0]),
        "body_quaternion_xyzw": fit.body_rotation.map(quaternion),
        "body_rotation_sigma_rad": fit.body_rotation_sigma_rad.map(|sigma| sigma.data.0[0]),
        "ape_position_m": ape(&judged.position),
        "ape_position_at_first_pose_m": judged.unaligned.at_first_pose.as_ref().map(ape),
        "ape_position_not_aligned_m": ape(&judged.unaligned.in_own_frame),
        "ape_rotation_rad": judged.rotation.as_ref().map(ape),
        "rpe": judged.relative.iter().map(|errors| relative(errors, judged.rotation.is_some())).collect::<Vec<_>>(),
        "ground_truth_sigma_m": against_sigma.map(|it| it.sigma_m),
        "ground_truth_sigma_rad": against_sigma.and_then(|it| it.sigma_rad),
        "undecided_share": against_sigma.map(|it| it.undecided),
        "undecided_rotation_share": against_sigma.and_then(|it| it.undecided_rotation),
        "ground_truth_share_of_square": against_sigma.map(|it| it.of_truth),
        "odd_spans": judged.odd.iter().map(odd).collect::<Vec<_>>(),
        "findings": findings(estimate.findings.iter().chain(&fit.findings)),
    })
}

/// Without orientations, only the distances between the ends of the motions are compared.
fn relative(errors: &Result<RelativeErrors, (Delta, NoMotions)>, has_poses: bool) -> Value {
    let (delta, why) = match errors {
        Ok(errors) => (errors.delta, None),
        Err((delta, why)) => (*delta, Some(why.to_string())),
    };
    let errors = errors.as_ref().ok();
    let rotation = errors.and_then(|errors| errors.rotation.as_ref());
    json!({
        "delta": delta.value(),
        "unit": delta.unit(),
        "median": errors.map(|errors| errors.size),
        "of": if has_poses { "pose" } else { "distance" },
        "position_m": errors.map(|errors| ape(&errors.position)),
        "rotation_rad": rotation.map(ape),
        "why_none": why,
    })
}

fn ape(sizes: &Ape) -> Value {
    json!({
        "count": sizes.count,
        "rmse": sizes.rmse,
        "rmse_sigma": sizes.rmse_sigma,
        "mean": sizes.mean,
        "median": sizes.median,
        "std": sizes.std,
        "min": sizes.min,
        "max": sizes.max,
    })
}

fn odd(span: &OddSpan) -> Value {
    json!({
        "span_s": span.span_s,
        "position_m": span.position_m,
        "rotation_rad": span.rotation_rad,
        "wrong": match span.odd_one {
            OddOne::Estimate => "estimate",
            OddOne::Undecided | OddOne::EstimateOrAll(_) | OddOne::Convention => "undecided",
            OddOne::Readings | OddOne::TruthAgainst(_) | OddOne::LeftOut => "ground-truth",
        },
        "station": span.station.map(|station| station + 1),
        "because": match span.odd_one {
            OddOne::Estimate if span.by_readings && span.by_rig => "the readings agree with the rig",
            OddOne::Estimate if span.by_readings => "the readings agree with each other",
            OddOne::Estimate => "another estimate agrees with the ground truth",
            OddOne::Convention => "the estimate seems to have another convention",
            OddOne::Undecided => "neither has redundant readings",
            OddOne::EstimateOrAll(SharedFault::Clock) => {
                "a shift of the clock that all stations share explains it as well"
            }
            OddOne::EstimateOrAll(SharedFault::Turn) => {
                "a turn of all stations by one angle explains it as well"
            }
            OddOne::Readings if span.by_rig => "the readings contradict the rig",
            OddOne::Readings => "the readings contradict each other",
            OddOne::TruthAgainst(_) => "several estimates agree against it",
            OddOne::LeftOut => "readings that cannot be right were left out: there is none",
        },
    })
}
