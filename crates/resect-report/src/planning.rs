//! A plan and its prediction, as plain text and as JSON.

use std::fmt::Write;

use nalgebra::Vector3;
use serde_json::{Value, json};

use super::json::{SCHEMA, findings};
use super::rows;
use super::text::{all_stations, sigma_text};
use resect_core::calibration::inter_prism::observability::{Direction, Observability};
use resect_core::network::{Number, Station};
use resect_core::statistics::median;
use resect_tools::planning::locks::{Lock, WhyNotRead};
use resect_tools::planning::{Held, Improvement, Plan, Prediction};

/// Formats verdict and reasons, the route, each σ with its largest source, and the best improvements.
pub fn text(plan: &Plan, found: &Prediction, better: &[Improvement]) -> String {
    let name = if plan.name.is_empty() { "plan" } else { &plan.name };
    let mut text = format!("{name} · plan · verdict: {}\n\n", found.verdict.name().to_uppercase());
    let of_stations: Vec<String> =
        found.kept.iter().zip(&found.readings).map(|(kept, all)| format!("{kept}/{all}")).collect();
    _ = writeln!(
        text,
        "route         {:.0} m in {:.0} s; usable readings ({}): {}",
        found.length_m,
        found.duration_s,
        all_stations(of_stations.len()),
        of_stations.join(", "),
    );
    if let Some(held) = &found.held {
        text += "\npredicted σ   x (mm)         y (mm)         z (mm)         yaw (mrad)     main sources\n";
        for station in held.sigma.numbers().skip(1) {
            text += &sigma_row(held, station);
        }
        let (far, at) = (&held.far_end, &held.far_end.position_m);
        _ = writeln!(
            text,
            "\nfar end       σ {:.1} mm, target {:.1} mm: station {}'s prism at ({:.1}, {:.1}, {:.1})",
            far.sigma_m * 1e3,
            plan.target_mm,
            far.station + 1,
            at.x,
            at.y,
            at.z,
        );
    }
    text += &vehicle(found);
    if let Some(ratio) = found.mirror_cost_ratio {
        _ = writeln!(text, "mirror        cost ratio of the mirrored solution {ratio:.2}");
    }
    text.push('\n');
    for finding in &found.findings {
        _ = writeln!(text, "  {} {finding}", finding.severity.mark());
    }
    if !better.is_empty() {
        text += "\nlargest improvements at the far end\n";
    }
    for one in better {
        _ = writeln!(text, "  {}", one.sentence);
    }
    text
}

fn sigma_row(held: &Held, station: Station) -> String {
    let sigma = &held.sigma[station];
    let mut row = format!("T1{station}        ");
    for axis in 0..3 {
        _ = write!(row, "{:>9}      ", sigma_text(Some(sigma.translation_m[axis]), 1));
    }
    _ = write!(row, "{:>9}         ", sigma_text(Some(sigma.yaw_rad), 3));
    let mut parts: Vec<&str> = Vec::new();
    for source in held.dominant.chunks(4).nth(station.index() - 1).unwrap_or_default() {
        if !parts.contains(&source.name) {
            parts.push(source.name);
        }
    }
    row + &parts.join(", ") + "\n"
}

/// Formats the standard deviations of the vehicle's poses along the route; empty if no motion is known.
fn vehicle(found: &Prediction) -> String {
    let positions_m = || found.way.iter().filter_map(|at| at.position_sigma_m);
    let Some(middle_m) = median(positions_m()) else { return String::new() };
    let mut text = format!(
        "vehicle       position {:.1} mm (median), {:.1} mm at most",
        middle_m * 1e3,
        positions_m().fold(0.0, f64::max) * 1e3
    );
    if let Some(middle_rad) = median(found.way.iter().filter_map(|at| at.rotation_sigma_rad)) {
        _ = write!(text, "; rotation {:.1} mrad (median)", middle_rad * 1e3);
    }
    text + "\n"
}

/// Returns one object for one plan. Lengths in m, angles in rad, times in s of the drive; undetermined values are null.
///
/// `plan` is the input, with the fields of its file. `verdict` and `findings` are for people. `held` has the predicted
/// `covariance` of (x, y, z, yaw) of stations 2, 3, … along the axes of the plan, and `sigma` by station. In it,
/// `dominant` is the largest source of each of these σ, with that source's σ. `far_end` has the `station` whose prism
/// has the largest σ, with that position and σ. `observability` has the eight directions with `hold` free, weak or held,
/// and the motion of each station along them. `mirror_cost_ratio` is the cost of the mirror twin over that of the answer.
/// `way` has length and duration of the route, and `vehicle`: its position about once a second, with σ of position and
/// rotation. `readings` has the number of readings of each station, and `kept` the number that the pipeline keeps.
/// `locks` has ranges, rates and failures of each station's tracking: the spans without usable readings, and `why`.
/// `improvements` are ranked, each with its `kind`, `sentence`, σ at the far end `before_m` and `after_m`, additional
/// time `more_s`, and the resulting `plan`.
pub fn json(plan: &Plan, found: &Prediction, better: &[Improvement]) -> Value {
    json!({
        "schema": SCHEMA,
        "plan": plan,
        "verdict": found.verdict,
        "findings": findings(&found.findings),
        "held": found.held.as_ref().map(held),
        "observability": found.observability.as_ref().map(observability),
        "mirror_cost_ratio": found.mirror_cost_ratio,
        "way": {
            "length_m": found.length_m,
            "duration_s": found.duration_s,
            "vehicle": found.way.iter().map(|at| json!({
                "time_s": at.time_s,
                "position_m": place(&at.position_m),
                "position_sigma_m": at.position_sigma_m,
                "rotation_sigma_rad": at.rotation_sigma_rad,
            })).collect::<Vec<_>>(),
        },
        "readings": found.readings,
        "kept": found.kept,
        "locks": found.locks.map(lock),
        "improvements": better.iter().map(|one| json!({
            "kind": one.kind.name(),
            "sentence": one.sentence,
            "before_m": one.before_m,
            "after_m": one.after_m,
            "more_s": one.more_s,
            "plan": one.plan,
        })).collect::<Vec<_>>(),
    })
}

fn place(at: &Vector3<f64>) -> &[f64] {
    at.as_slice()
}

fn held(held: &Held) -> Value {
    json!({
        "covariance": rows::of_matrix(&held.covariance),
        "sigma": held.sigma.iter().skip(1).map(|sigma| json!({
            "translation_m": sigma.translation_m.as_slice(),
            "yaw_rad": sigma.yaw_rad,
        })).collect::<Vec<_>>(),
        "dominant": held
            .dominant
            .iter()
            .map(|one| json!({ "what": one.name, "sigma": one.sigma }))
            .collect::<Vec<_>>(),
        "far_end": {
            "station": held.far_end.station + 1,
            "position_m": place(&held.far_end.position_m),
            "sigma_m": held.far_end.sigma_m,
        },
    })
}

fn observability(found: &Observability) -> Value {
    let direction = |one: &Direction| {
        json!({
            "hold": one.hold.name(),
            "words": one.words,
            "relative": one.relative,
            "sigma_m": one.sigma_m,
            // Motion of the stations after the first along the direction, for one metre.
            "motion": one.motion.iter().skip(1).map(|moved| json!({
                "translation_m": moved.translation_m.as_slice(),
                "yaw_rad": moved.yaw_rad,
            })).collect::<Vec<_>>(),
        })
    };
    json!({
        "drive": found.drive.name(),
        "advice": found.advice,
        "directions": found.directions.iter().map(direction).collect::<Vec<_>>(),
    })
}

fn lock(lock: &Lock) -> Value {
    json!({
        "range_m": lock.range_m,
        "fastest_range_m_per_s": lock.fastest_range_m_per_s,
        "fastest_azimuth_deg_per_s": lock.fastest_azimuth_deg_per_s,
        "fastest_zenith_deg_per_s": lock.fastest_zenith_deg_per_s,
        "failures": lock.failures.iter().map(|failure| json!({
            "why": match failure.why {
                WhyNotRead::TooNear => "too-near",
                WhyNotRead::TooFar => "too-far",
                WhyNotRead::Hidden(_) => "hidden",
                WhyNotRead::TooFast(_) => "too-fast",
            },
            "by_prism": match failure.why {
                WhyNotRead::Hidden(prism) => Some(prism.number()),
                _ => None,
            },
            "span_s": failure.span_s,
            "readings": failure.readings,
            "position_m": place(&failure.position_m),
        })).collect::<Vec<_>>(),
    })
}
