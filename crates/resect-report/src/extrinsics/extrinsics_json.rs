//! An extrinsic calibration as JSON.

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::advice_text::advice_in_words;
use super::extrinsics_text::conclusion;
use crate::json::{SCHEMA, findings};
use resect_tools::extrinsics::{Extrinsics, HalvesOutcome};

/// Returns the calibration as one JSON object; lengths in m, angles in rad, times in s.
pub fn extrinsics_json(extrinsics: &Extrinsics) -> Value {
    let solution = &extrinsics.solution;
    let turn = nalgebra::UnitQuaternion::from_rotation_matrix(&solution.a_from_b.rotation);
    let sign = if turn.w < 0.0 { -1.0 } else { 1.0 };
    let quaternion = [turn.i, turn.j, turn.k, turn.w].map(|value| sign * value);
    let vector = |vector: Vector3<f64>| [vector.x, vector.y, vector.z];
    let halves = match &extrinsics.halves {
        HalvesOutcome::Compared(all) => all
            .iter()
            .map(|half| {
                json!({
                    "name": half.name,
                    "difference": half.difference,
                    "sigma": half.sigma,
                    "sigmas": half.sigmas(),
                })
            })
            .collect(),
        HalvesOutcome::NoAnswer(_) => Vec::new(),
    };
    let [a, b] = &extrinsics.names;
    json!({
        "schema": SCHEMA,
        "body": a,
        "other": b,
        "pairs": extrinsics.pairs,
        "body_from_other": {
            "translation_m": vector(solution.a_from_b.translation_m),
            "translation_sigma_m": solution.lever_sigma_m.map(vector),
            "translation_determined": solution.determines_lever,
            "quaternion_xyzw": quaternion,
            "rotation_sigma_rad": solution.rotation_sigma_rad.map(vector),
        },
        "translation_covariance_m2": solution
            .lever_covariance_m2
            .map(|it| [0, 1, 2].map(|row| [0, 1, 2].map(|column| it[(row, column)]))),
        "time_offset_s": solution.time_offset_s,
        "time_offset_sigma_s": solution.time_offset_sigma_s,
        "scale": solution.scale.map(|scale| scale.value),
        "scale_sigma": solution.scale.map(|scale| scale.sigma),
        "directions": extrinsics
            .directions
            .iter()
            .map(|axis| {
                json!({
                    "direction": vector(axis.direction),
                    "sigma_m": axis.sigma_m,
                    "determined": axis.is_determined(),
                })
            })
            .collect::<Vec<_>>(),
        "halves": halves,
        "verdict": extrinsics.verdict,
        "because": conclusion(extrinsics),
        "next": extrinsics
            .advice
            .iter()
            .map(|advised| advice_in_words(advised, a))
            .collect::<Vec<_>>(),
        "findings": findings(extrinsics.findings.iter()),
    })
}
