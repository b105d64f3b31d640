//! A validation as plain text and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use super::json::{SCHEMA, findings};
use super::rows;
use super::text::spread_text;
use resect_core::calibration::Estimate;
use resect_core::network::USUAL_STATIONS;
use resect_tools::validation::in_words::chance;
use resect_tools::validation::{Cause, Outcome, StationMove, Validation, level};

/// Formats verdict and reason, the difference, a test for each station, and the metric.
pub fn text(found: &Validation) -> String {
    let mut text = format!(
        "{} · {} · {}\n\n{}\n",
        found.deployment,
        found.earlier,
        found.outcome.name().to_uppercase(),
        found.why()
    );
    if let Some(difference) = &found.difference {
        text += "\nown − earlier        x (mm)            y (mm)            z (mm)          yaw (mrad)\n";
        for slot in 0..difference.values.len() / 4 {
            let parts = [0, 1, 2, 3].map(|part| {
                let k = 4 * slot + part;
                let sigma = difference.covariance[(k, k)].max(0.0).sqrt();
                Estimate { value: difference.values[k], sigma }
            });
            _ = writeln!(text, "T1{}        {}", slot + 2, four(&parts).trim_end());
        }
        _ = writeln!(text, "all {}: {}", difference.values.len(), chance(difference.p_value));
        text += "\nif it alone moved    x (mm)            y (mm)            z (mm)          yaw (mrad)         not moved     moved alone\n";
        for (station, moved) in difference.stations.iter().enumerate() {
            let parts = [0, 1, 2, 3].map(|part| moved.part(part));
            _ = writeln!(
                text,
                "station {}  {}   {:<12}  {:<12}  {}",
                station + 1,
                four(&parts),
                chance(moved.p_value),
                chance(moved.rest_p_value),
                moved.verdict()
            );
        }
    }
    if let Some(metric) = &found.metric {
        _ = writeln!(text, "\ninter-prism, earlier   {}", spread_text(&metric.earlier_mm));
        _ = writeln!(text, "inter-prism, own       {}", spread_text(&metric.own_mm));
        _ = writeln!(
            text,
            "distances differ by    {:.2} mm rms; σ allows {:.2} mm",
            metric.apart_m * 1e3,
            metric.allowed_m * 1e3
        );
    }
    if !found.caveats.is_empty() {
        text.push('\n');
    }
    for finding in &found.caveats {
        _ = writeln!(text, "  {} {finding}", finding.severity.mark());
    }
    text
}

/// Formats four numbers with σ: x, y, z in mm and yaw in mrad.
fn four(parts: &[Estimate; 4]) -> String {
    let [x, y, z, yaw] = parts.map(|part| (part.value * 1e3, part.sigma * 1e3));
    let mm = |(value, sigma): (f64, f64)| format!("{value:>+9.1} ± {sigma:<6.1}");
    format!("{}{}{}{:>+9.3} ± {:<6.3}", mm(x), mm(y), mm(z), yaw.0, yaw.1)
}

/// Returns one object for one run. Lengths in m, angles in rad, metrics in mm; undetermined values are null.
pub fn json(found: &Validation) -> Value {
    json!({
        "schema": SCHEMA,
        "earlier": found.earlier,
        "deployment": found.deployment,
        "verdict": match &found.outcome {
            Outcome::Holds => "holds",
            Outcome::DoesNotHold(_) => "does-not-hold",
            Outcome::CannotBeTold(_) => "cannot-be-told",
        },
        "why": found.why(),
        "cause": match &found.outcome {
            Outcome::DoesNotHold(cause) => Some(of_cause(cause)),
            _ => None,
        },
        "own_verdict": found.own_verdict,
        // Overall probability that a valid calibration is rejected.
        "level": level(found.difference.as_ref().map_or(USUAL_STATIONS, |found| found.stations.len())),
        // Own minus earlier: x, y, z, yaw of station 2, then of station 3, …, with the covariance.
        "difference": found.difference.as_ref().map(|difference| json!({
            "values": difference.values.as_slice(),
            "covariance": rows::of_matrix(&difference.covariance),
            "chi_square": difference.chi_square,
            "p_value": difference.p_value,
        })),
        "stations": found.difference.as_ref().map(|difference| {
            difference.stations.iter().enumerate().map(|(k, moved)| station(k, moved)).collect::<Vec<_>>()
        }),
        "metrics": found.metric.as_ref().map(|metric| json!({
            "inter_prism_mm": { "earlier": metric.earlier_mm, "own": metric.own_mm },
            "distances_apart_mm": metric.apart_m * 1e3,
            "allowed_mm": metric.allowed_m * 1e3,
            "worse": metric.is_worse(),
        })),
        "findings": findings(&found.caveats),
    })
}

fn of_cause(cause: &Cause) -> Value {
    let (is, stations) = match cause {
        Cause::Station(station) => ("station", vec![station + 1]),
        Cause::OneOf(stations) => ("one-of", stations.iter().map(|station| station + 1).collect()),
        Cause::NoneAlone => ("none-alone", Vec::new()),
        Cause::OtherSetUp => ("other-set-up", Vec::new()),
        Cause::Metric => ("metric", Vec::new()),
    };
    json!({ "is": is, "stations": stations })
}

/// Movement of a station, if it alone moved.
fn station(index: usize, moved: &StationMove) -> Value {
    let sigma = [0, 1, 2].map(|axis| moved.part(axis).sigma);
    json!({
        "station": index + 1,
        "moved_m": moved.by.xyz().as_slice(),
        "turned_rad": moved.turned_rad().value,
        "sigma": { "moved_m": sigma, "turned_rad": moved.turned_rad().sigma },
        "chi_square": moved.chi_square,
        "p_value": moved.p_value,
        "rest_p_value": moved.rest_p_value,
        "explains_more_than_chance": moved.rejects(),
        "explains_all": moved.explains_all(),
    })
}
