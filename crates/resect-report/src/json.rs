//! The JSON of `calibrate`, version 2: a contract with scripts. Lengths in m, angles in rad, metrics in mm.

mod earlier;
mod finding;
mod observability;
mod recommendation;
mod reliability;
mod schema;

pub use earlier::{EarlierError, read_earlier};
pub use finding::{finding, findings};
pub use recommendation::recommendation;
pub use schema::SCHEMA;

use serde_json::{Value, json};

use crate::difference::moved_from_published;
use crate::of_run;
use crate::rows;
use resect_core::analysis::{Analysis, Answer};
use resect_core::calibration::Estimate;
use resect_core::calibration::dynamic_gcp::DynamicGcpDetails;
use resect_core::calibration::inter_prism::{InterPrismDetails, PriorSearch};
use resect_core::calibration::joint::unknown::Unknown;
use resect_core::calibration::joint::{
    DriveClocks, JointEstimate, SetUpChange, StepSize, SurveyPoses,
};
use resect_core::calibration::two_point::PairResection;
use resect_core::calibration::{Basin, Calibration, Details, TransformSigma, recommend};
use resect_core::deployment::{Deployment, Severity};
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_core::geometry::RigidTransform;
use resect_core::network::Station;
use resect_core::pipeline::SampleFate;

/// Returns one object for one method. `load_ms` is the duration of opening.
pub fn calibration(
    deployment: &Deployment,
    analysis: &Analysis,
    answer: &Answer,
    load_ms: f64,
) -> Value {
    let Answer { calibration, evaluation, .. } = answer;
    // Doubts about the data are also among the answer's own findings.
    let of_data = deployment.findings.iter().filter(|finding| !finding.kind.is_doubt());
    let doubts = calibration.findings.iter().filter(|finding| finding.severity > Severity::Note);
    let mut object = json!({
        "schema": SCHEMA,
        "deployment": deployment.name,
        // The published method if the joint estimate failed.
        "method": calibration.answered_by().name(),
        // Frame of the tracks: each in its station's "own", or all in a "common" one.
        "track_frame": deployment.track_frame,
        // Distances of prisms 12, 13, 23, 14, 24, 34, … as measured on the vehicle.
        "inter_prism_m": deployment.rig.as_ref().map(|rig| &rig.inter_prism_m),
        "settings": analysis.settings,
        "pipeline": {
            "raw": deployment.tracks.map(|track| track.measurements.len()),
            "kept": analysis.pipeline.counts(SampleFate::Kept),
            "intervals": analysis.pipeline.kept_intervals.len(),
            "triplets": analysis.pipeline.triplets.len(),
        },
        "transforms": transforms(calibration),
        // Order: x, y, z, yaw of station 2, then of station 3, … (m, rad).
        "covariance": calibration.covariance.as_ref().map(rows::of_matrix),
        "correlation": calibration.correlation().map(|correlation| rows::of_matrix(&correlation)),
        "metrics": {
            "inter_prism_mm": evaluation.inter_prism_mm,
            "inter_prism_against_measured_mm": evaluation.against_measured_mm,
            "gcp_mm": evaluation.control_points_mm,
        },
        "diagnosis": {
            "verdict": calibration.verdict,
            "independently_checked": calibration.is_independently_checked(),
            "checked_by": calibration.checked_by,
            "findings": findings(of_data.chain(&calibration.findings)),
            // Findings that limit the answer.
            "doubts": findings(doubts),
            "observability": calibration
                .inter_prism()
                .map(|details| observability::observability(&details.observability)),
            "mirror": calibration.inter_prism().map(|details| json!({
                "cost_ratio": details.mirror.cost_ratio,
                "resolved_by": details.mirror.resolved_by.name(),
                "twin": details.mirror.twin.as_ref().map(level_transforms),
            })),
            "basins": calibration.inter_prism().map(|details| {
                details.basins.iter().map(|basin| minimum(details, basin)).collect::<Vec<_>>()
            }),
        },
        // All numbers of the answer with their descriptions, in SI units.
        "rows": analysis.rows(deployment).iter().map(row).collect::<Vec<_>>(),
        "details": method_details(deployment, &calibration.details),
        // The paper's answer to the same data, beside a joint estimate.
        "published": published(calibration),
        // Null if outputs are compared.
        "time_ms": of_run::tells_durations().then(|| json!({
            "load": load_ms,
            "pipeline": analysis.pipeline_ms,
            "prior": calibration.prior_ms,
            "solve": calibration.solve_ms,
            "total": load_ms + analysis.total_ms(),
        })),
    });
    object["recommendation"] = recommendation(&recommend(calibration, deployment));
    if deployment.tracks.iter().any(|track| track.name.is_some()) {
        let names = deployment.tracks.iter().map(|track| track.name.clone());
        object["station_names"] = names.collect();
    }
    if let Some(survey) = calibration.survey() {
        object["survey_transforms"] = survey_transforms(survey);
        if let Some(change) = &survey.change {
            object["set_up_change"] = set_up_change(change);
        }
    }
    object
}

/// Returns the transforms when the control points were measured, in the form of `transforms`.
fn survey_transforms(survey: &SurveyPoses) -> Value {
    let (transforms, sigma) = (survey.transforms(), survey.sigma());
    let others = transforms.each().skip(1);
    others.map(|(k, transform)| transform_of(k.number(), transform, Some(sigma[k]))).collect()
}

/// Returns the change of a set-up from the survey to the drive; its station is null if the data does not decide which one changed.
fn set_up_change(change: &SetUpChange) -> Value {
    json!({
        "station": change.station.map(Station::number),
        "turned_rad": estimate(&change.turned_rad),
        "moved_m": estimates(&change.moved_m),
    })
}

fn row(row: &AnswerRow) -> Value {
    json!({
        "group": row.group.name(),
        "subject": row.subject,
        "name": row.name,
        "symbol": row.symbol,
        "unit": row.quantity.si_unit(),
        "value": row.value,
        "sigma": row.sigma,
        // Standard deviation before this drive.
        "prior_sigma": row.prior,
        "reference": row.reference.as_ref().map(|reference| json!({
            "name": reference.name,
            "value": reference.value,
        })),
        "significant": row.is_significant,
    })
}

/// Returns the paper's answer beside a joint estimate, with the difference of the two; `None` without it.
fn published(joint: &Calibration) -> Option<Value> {
    let published = joint.published.as_deref()?;
    let moved = moved_from_published(joint).map(|stations| {
        let each = stations.into_iter().map(|station| {
            json!({
                "station": station.station,
                "translation_m": station.translation_m.map(|along| along.value),
                "translation_sigmas": station.translation_m.map(|along| along.sigmas),
                "distance_m": station.distance_m.value,
                "distance_sigmas": station.distance_m.sigmas,
                "yaw_rad": station.yaw_rad.value,
                "yaw_sigmas": station.yaw_rad.sigmas,
            })
        });
        each.collect::<Vec<_>>()
    });
    Some(json!({
        "method": published.method.name(),
        "verdict": published.verdict,
        "independently_checked": published.is_independently_checked(),
        "findings": findings(&published.findings),
        "transforms": transforms(published),
        "covariance": published.covariance.as_ref().map(rows::of_matrix),
        // Joint estimate minus the paper's answer, in m, rad and σ of both combined; null if one of them failed.
        "moved": moved,
    }))
}

/// Returns a local minimum of the cost.
fn minimum(details: &InterPrismDetails, basin: &Basin) -> Value {
    json!({
        "is": details.role(basin),
        "rms_mm": basin.mean_square_m2.sqrt() * 1e3,
        "cost_ratio": details.cost_ratio(basin),
        "transforms": level_transforms(basin),
    })
}

/// Returns the transforms of a minimum, without σ.
fn level_transforms(basin: &Basin) -> Vec<Value> {
    (1..basin.station1_from_station.len())
        .map(|station| {
            let transform = &basin.station1_from_station[station];
            json!({
                "from": station + 1,
                "to": 1,
                "translation_m": transform.translation_m.as_slice(),
                "yaw_rad": transform.yaw_rad,
            })
        })
        .collect()
}

/// Returns `station1_from_station` of stations 2, 3, …
pub fn transforms(calibration: &Calibration) -> Vec<Value> {
    let others = calibration.station1_from_station.each().skip(1);
    let transform = |(station, transform): (Station, &RigidTransform)| {
        let sigma = calibration.sigma.as_ref().map(|sigma| sigma[station]);
        transform_of(station.number(), transform, sigma)
    };
    others.map(transform).collect()
}

/// Returns the transform from the station with this number to station 1, with its σ if known.
pub fn transform_of(
    number: usize,
    station1_from_station: &RigidTransform,
    sigma: Option<TransformSigma>,
) -> Value {
    json!({
        "from": number,
        "to": 1,
        "translation_m": station1_from_station.translation_m.as_slice(),
        "yaw_rad": station1_from_station.yaw_rad(),
        "tilt_rad": station1_from_station.tilt_rad(),
        "matrix": rows::of_matrix(&station1_from_station.matrix()),
        "sigma": sigma.map(|sigma| json!({
            "translation_m": sigma.translation_m.as_slice(),
            "yaw_rad": sigma.yaw_rad,
        })),
    })
}

/// Returns the details of a method.
fn method_details(deployment: &Deployment, details: &Details) -> Value {
    let mm = |metres: &[f64]| metres.iter().map(|m| m * 1e3).collect::<Vec<_>>();
    match details {
        Details::TwoPoint(details) => {
            let pair = |pair: &PairResection| {
                json!({
                    "file": pair.file,
                    "markers": pair.markers,
                    "baseline_m": pair.baseline_m,
                    "baseline_errors_mm": mm(pair.baseline_errors_m.as_slice()),
                    "left_out_mm": mm(&pair.left_out_m),
                    "left_out_from_known_mm": pair
                        .left_out
                        .iter()
                        .map(|left_out| json!({ "marker": left_out.marker, "mm": left_out.from_known_m * 1e3 }))
                        .collect::<Vec<_>>(),
                })
            };
            json!({
                "pairs": details.pairs.iter().map(pair).collect::<Vec<_>>(),
                "chosen": details.chosen,
            })
        }
        Details::StaticGcp(details) => json!({
            "points": &details.shared_points.as_slice()[1..],
            "rms_mm": details.rms_m * 1e3,
            "world_from_station1": details.world_from_station1.map(|world| json!({
                "translation_m": world.translation_m.as_slice(),
                "yaw_rad": world.yaw_rad(),
                "tilt_rad": world.tilt_rad(),
            })),
        }),
        Details::DynamicGcp(details) => dynamic_gcp(details),
        Details::InterPrism(details) => inter_prism(details),
        Details::Joint(details) => {
            let mut value = method_details(deployment, &details.published);
            let joint = |found: &JointEstimate| joint(deployment, found);
            value["joint"] = json!(details.estimate.as_ref().ok().map(joint));
            value
        }
    }
}

fn dynamic_gcp(details: &DynamicGcpDetails) -> Value {
    json!({ "rms_mm": details.rms_m * 1e3, "blocks": details.blocks })
}

fn inter_prism(details: &InterPrismDetails) -> Value {
    json!({ "prior_search": details.prior_search.as_ref().map(prior_search) })
}

fn estimate(estimate: &Estimate) -> Value {
    json!({ "value": estimate.value, "sigma": estimate.sigma })
}

fn estimates(all: &[Estimate]) -> Vec<Value> {
    all.iter().map(estimate).collect()
}

/// Returns the details of a joint estimate: instruments of all stations, clocks of all but the first.
fn joint(deployment: &Deployment, found: &JointEstimate) -> Value {
    let sigma_by_source: serde_json::Map<String, Value> = found
        .budget
        .iter()
        .map(|(what, variances)| {
            (what.replace([' ', '-'], "_"), json!(variances.map(|v| v.max(0.0).sqrt()).as_slice()))
        })
        .collect();
    let steps: Vec<Value> = found
        .steps
        .iter()
        .map(|step| match &step.size {
            StepSize::Clock(by_s) => json!({
                "station": step.station.number(), "after_s": step.after_s, "clock_s": estimate(by_s),
            }),
            StepSize::Station { turned_rad, moved_m } => json!({
                "station": step.station.number(),
                "after_s": step.after_s,
                "slowly": step.slowly,
                "turned_rad": estimate(turned_rad),
                "moved_m": estimates(moved_m),
            }),
        })
        .collect();
    let drive = |drive: &DriveClocks| {
        json!({
            "from_s": drive.span_s[0],
            "to_s": drive.span_s[1],
            "clock_offsets_s": estimates(&drive.offsets_s.as_slice()[1..]),
        })
    };
    let mut value = json!({
        "clock_offsets_s": estimates(&found.clock_offsets_s.as_slice()[1..]),
        "drives": found.drives.iter().map(drive).collect::<Vec<_>>(),
        "noise": {
            "range_m": found.levels.range_m(),
            "horizontal_angle_rad": found.levels.horizontal_rad,
            "vertical_angle_rad": found.levels.vertical_rad,
            "stamp_s": found.levels.jitter_s,
            "horizontal_jerk_m_per_s3": found.levels.horizontal_jerk_m_per_s3,
            "vertical_jerk_m_per_s3": found.levels.vertical_jerk_m_per_s3,
            "range_wander_m": found.slow_ranges.sigma_m,
            "range_wander_correlation_s": found.slow_ranges.correlation_s,
            "slow_across_m": found.slow_across.sigma_m,
            "slow_across_correlation_s": found.slow_across.correlation_s,
            "slow_upward_m": found.slow_upward.sigma_m,
            "slow_upward_correlation_s": found.slow_upward.correlation_s,
        },
        "readings": found.solution.readings().as_slice(),
        "steps": steps,
        // Order: x, y, z (m) and yaw (rad) of station 2, then of station 3, ….
        "sigma_by_source": sigma_by_source,
        "reliability": reliability::reliability(deployment, found),
        // Without convergence there is no joint estimate.
        "converged": true,
    });
    for (key, list) in lists_of_unknowns(found) {
        value[key] = list;
    }
    value
}

/// Returns the estimates of the unknowns by their names in files, each a list by owner; null without an owner.
fn lists_of_unknowns(found: &JointEstimate) -> Vec<(&'static str, Value)> {
    let unknowns: Vec<&Unknown> = found.layout().unknowns().collect();
    let named = unknowns.chunk_by(|a, b| a.key == b.key).filter_map(|all| Some((all[0].key?, all)));
    named
        .map(|(key, all)| {
            let own: Vec<Vec<Value>> = all
                .iter()
                .map(|unknown| found.estimates(unknown).map(|one| estimate(&one)).collect())
                .collect();
            let list = match &own[..] {
                [only] if only.is_empty() => Value::Null,
                [only] => json!(only),
                several => {
                    let owners = 0..several[0].len();
                    owners
                        .map(|owner| {
                            several.iter().map(|all| all[owner].clone()).collect::<Value>()
                        })
                        .collect()
                }
            };
            (key, list)
        })
        .collect()
}

fn prior_search(search: &PriorSearch) -> Value {
    let steps: Vec<Value> = search
        .steps
        .iter()
        .zip(search.best)
        .map(|(runs, best)| {
            let runs: Vec<Value> = runs
                .iter()
                .map(|run| {
                    json!({
                        "tau_v_m_per_s": run.tau_v_m_per_s,
                        "triplets": run.triplets,
                        "rms_mm": run.rms_m * 1e3,
                        "median_mm": run.metric_m * 1e3,
                        "agreeing": run.agreeing,
                    })
                })
                .collect();
            json!({ "runs": runs, "best": best })
        })
        .collect();
    json!({ "steps": steps, "agreed": search.agreed })
}
