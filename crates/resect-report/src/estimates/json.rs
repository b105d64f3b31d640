//! A judgement as JSON.

use serde_json::{Value, json};

use crate::json::{SCHEMA, findings};
use resect_core::calibration::Calibration;
use resect_core::estimates::metrics::Ape;
use resect_core::estimates::odd::{OddOne, OddSpan};
use resect_core::estimates::{EstimatesJudgement, Judged};

/// Returns everything as one object; lengths in metres, angles in radians, times in seconds.
pub fn json(deployment: &str, calibration: &Calibration, judgement: &EstimatesJudgement) -> Value {
    let name = |index: usize| &judgement.judged[index].estimate.name;
    json!({
        "schema": SCHEMA,
        "deployment": deployment,
        "method": calibration.answered_by(),
        "verdict": calibration.verdict.name(),
        "estimates": judgement.judged.iter().map(estimate).collect::<Vec<_>>(),
        "comparisons": judgement.comparisons.iter().map(|two| json!({
            "better": name(two.better),
            "worse": name(two.worse),
            "rmse_m": two.rmse_m,
            "ratio": two.rmse_m[0] / two.rmse_m[1],
            "ratio_95": two.ratio_95,
            "confidence": two.confidence,
            "significant": two.is_significant(),
        })).collect::<Vec<_>>(),
        "not_judged": judgement.unjudged.iter().map(|(name, why)| json!({
            "name": name,
            "why": why.to_string(),
        })).collect::<Vec<_>>(),
    })
}

fn estimate(judged: &Judged) -> Value {
    let Judged { estimate, fit, against_sigma, .. } = judged;
    let quaternion = |q: nalgebra::UnitQuaternion<f64>| [q.i, q.j, q.k, q.w];
    let turn = nalgebra::UnitQuaternion::from(fit.station1_from_estimate.rotation);
    json!({
        "name": estimate.name,
        "file": estimate.path,
        "poses": estimate.poses.len(),
        "poses_with_ground_truth": judged.errors.len(),
        "poses_without_ground_truth": judged.without_truth,
        "alignment": {
            "by": judged.alignment,
            "translation_m": fit.station1_from_estimate.translation_m.as_slice(),
            "quaternion_xyzw": quaternion(turn),
            "scale": fit.scale,
        },
        "time_offset_s": fit.time_offset_s,
        "time_offset_sigma_s": fit.time_offset_sigma_s,
        "lever_arm_m": fit.lever_arm_m.map(|lever| lever.data.0[0]),
        "lever_arm_sigma_m": fit.lever_arm_sigma_m.map(|sigma| sigma.data.0[0]),
        "body_quaternion_xyzw": fit.body_rotation.map(quaternion),
        "body_rotation_sigma_rad": fit.body_rotation_sigma_rad,
        "ape_position_m": ape(&judged.position),
        "ape_rotation_rad": judged.rotation.as_ref().map(ape),
        "rpe": judged.relative.iter().map(|relative| json!({
            "path_m": relative.path_m,
            "position_m": ape(&relative.position),
            "rotation_rad": ape(&relative.rotation),
        })).collect::<Vec<_>>(),
        "ground_truth_sigma_m": against_sigma.sigma_m,
        "ground_truth_sigma_rad": against_sigma.sigma_rad,
        "undecided_share": against_sigma.undecided,
        "undecided_rotation_share": against_sigma.undecided_rotation,
        "ground_truth_share_of_square": against_sigma.of_truth,
        "odd_spans": judged.odd.iter().map(odd).collect::<Vec<_>>(),
        "findings": findings(estimate.findings.iter().chain(&fit.findings)),
    })
}

fn ape(sizes: &Ape) -> Value {
    json!({
        "count": sizes.count,
        "rmse": sizes.rmse,
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
            OddOne::Readings | OddOne::TruthAgainst(_) | OddOne::LeftOut => "ground-truth",
        },
        "station": span.station.map(|station| station + 1),
        "because": match span.odd_one {
            OddOne::Estimate if span.by_rig => "the readings agree with the rig",
            OddOne::Estimate => "the readings agree with each other",
            OddOne::Readings if span.by_rig => "the readings contradict the rig",
            OddOne::Readings => "the readings contradict each other",
            OddOne::TruthAgainst(_) => "several estimates agree against it",
            OddOne::LeftOut => "readings that cannot be right were left out: there is none",
        },
    })
}
