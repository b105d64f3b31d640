//! A finding as JSON.

use resect_core::deployment::{Finding, Subject};
use resect_core::network::{Number, Pair};
use serde_json::{Map, Value, json};

/// Returns code, severity, message, subject and quantities. Names of quantities end with their unit; a quantity with a
/// standard deviation is an object of `value` and `sigma`.
pub fn finding(finding: &Finding) -> Value {
    let quantities: Map<String, Value> = finding
        .quantities
        .iter()
        .map(|quantity| {
            let value = match quantity.sigma {
                Some(sigma) => json!({ "value": quantity.value, "sigma": sigma }),
                None => json!(quantity.value),
            };
            (quantity.key(), value)
        })
        .collect();
    json!({
        "code": finding.kind.code,
        "severity": finding.severity,
        "message": finding.to_string(),
        "subject": finding.subject.as_ref().map(subject),
        "quantities": quantities,
    })
}

/// Findings in their order.
pub fn findings<'a>(findings: impl IntoIterator<Item = &'a Finding>) -> Vec<Value> {
    findings.into_iter().map(finding).collect()
}

/// Stations and prisms are numbered from 1.
fn subject(subject: &Subject) -> Value {
    match subject {
        Subject::Station(station) => json!({ "station": station + 1 }),
        Subject::OfStation { station, part } => json!({ "station": station + 1, "part": part }),
        Subject::Pair(pair) => {
            let Pair { first, second } = Pair::at(*pair);
            json!({ "prisms": [first.number(), second.number()] })
        }
        Subject::File(file) => json!({ "file": file }),
        Subject::Point { file, marker } => json!({ "file": file, "marker": marker }),
        Subject::Named(name) => json!({ "name": name }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_core::calibration::Estimate;
    use resect_core::deployment::Unit;
    use resect_core::deployment::kinds;

    #[test]
    fn quantities_are_named_with_their_unit_and_have_their_sigma() {
        let late = Finding::new(kinds::CLOCK_OFFSET_SUSPECTED, "late")
            .about(Subject::Station(2))
            .estimate("offset", &Estimate { value: 0.01, sigma: 0.001 }, Unit::Second)
            .count("readings", 7);
        let expected = json!({
            "code": "clock-offset-suspected",
            "severity": "warning",
            "message": "late",
            "subject": { "station": 3 },
            "quantities": { "offset_s": { "value": 0.01, "sigma": 0.001 }, "readings": 7.0 },
        });
        assert_eq!(finding(&late), expected);
    }
}
