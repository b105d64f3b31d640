//! The JSON of `calibrate`: a contract with scripts, version 1. Lengths m, angles rad, metrics mm.

use serde_json::{Value, json};

use crate::analysis::{Analysis, Answer};
use crate::calibration::{Basin, Calibration};
use crate::deployment::Deployment;

const SCHEMA: u32 = 1;

/// One object for one method. `load_ms` is how long opening took.
pub fn calibration(
    deployment: &Deployment,
    analysis: &Analysis,
    answer: &Answer,
    load_ms: f64,
) -> Value {
    let Answer { calibration, evaluation } = answer;
    let findings: Vec<String> = deployment
        .findings
        .iter()
        .chain(&calibration.findings)
        .map(|finding| finding.message.clone())
        .collect();
    json!({
        "schema": SCHEMA,
        "deployment": deployment.name,
        "method": calibration.method.name(),
        "settings": analysis.settings,
        "pipeline": {
            "raw": deployment.tracks.each_ref().map(|track| track.measurements.len()),
            "kept": analysis.pipeline.kept(),
            "intervals": analysis.pipeline.kept_intervals.len(),
            "triplets": analysis.pipeline.triplets.len(),
        },
        "transforms": [transform(calibration, 1), transform(calibration, 2)],
        "metrics": {
            "inter_prism_mm": evaluation.inter_prism_mm,
            "gcp_mm": evaluation.control_points_mm,
        },
        "diagnosis": {
            "verdict": calibration.verdict,
            "findings": findings,
            "mirror": {
                "cost_ratio": calibration.mirror.cost_ratio,
                "resolved_by": calibration.mirror.resolved_by.name(),
                "twin": calibration.mirror.twin.map(|twin| twin_transforms(&twin)),
            },
        },
        "time_ms": {
            "load": load_ms,
            "pipeline": analysis.pipeline_ms,
            "prior": calibration.prior_ms,
            "solve": calibration.solve_ms,
            "total": load_ms + analysis.total_ms(),
        },
    })
}

/// The mirror twin's transforms, without σ.
fn twin_transforms(twin: &Basin) -> Vec<Value> {
    (1..3)
        .map(|station| {
            let transform = &twin.station1_from_station[station];
            json!({
                "from": station + 1,
                "to": 1,
                "translation_m": transform.translation_m.as_slice(),
                "yaw_rad": transform.yaw_rad,
            })
        })
        .collect()
}

fn transform(calibration: &Calibration, station: usize) -> Value {
    let transform = &calibration.station1_from_station()[station];
    let matrix = transform.matrix();
    let rows: Vec<Vec<f64>> = (0..4).map(|row| matrix.row(row).iter().copied().collect()).collect();
    let sigma = calibration.sigma.map(|sigma| {
        let sigma = sigma[station - 1];
        json!({ "translation_m": sigma.translation_m.as_slice(), "yaw_rad": sigma.yaw_rad })
    });
    json!({
        "from": station + 1,
        "to": 1,
        "translation_m": transform.translation_m.as_slice(),
        "yaw_rad": transform.yaw_rad,
        "matrix": rows,
        "sigma": sigma,
    })
}
