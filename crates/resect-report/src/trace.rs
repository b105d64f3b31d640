//! The trace of the joint estimate's solver, as a text table and as JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use resect_core::calibration::joint::{Trace, TraceEvent, TraceRow};

/// Formats a row a step, with the events before it.
pub fn text(trace: &Trace) -> String {
    let mut text = format!("solver: the joint estimate {}\n\n", trace.status.in_words());
    if trace.rows.is_empty() {
        return text;
    }
    text +=
        "step  phase          cost (σ²)  step² (σ²)  constant (σ)  share  matrix  weights < ½\n";
    for (index, row) in trace.rows.iter().enumerate() {
        text += &events_text(&row.events);
        let TraceRow { cost, squared_length, largest_step_sigmas, downweighted, .. } = row;
        _ = writeln!(
            text,
            "{:>4}  {:<13}{:>11}{:>12}{:>14}{:>7.2}  {:<6}{:>13}",
            index + 1,
            row.phase.name(),
            cell(*cost, |cost| format!("{cost:.1}")),
            cell(*squared_length, |length| format!("{length:.2e}")),
            cell(*largest_step_sigmas, |sigmas| format!("{sigmas:.2}")),
            row.share,
            if row.is_matrix_reused { "reused" } else { "new" },
            cell(*downweighted, |share| format!("{:.1} %", 100.0 * share)),
        );
    }
    text + &events_text(&trace.last_events)
}

fn cell(value: Option<f64>, format: impl FnOnce(f64) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), format)
}

fn events_text(events: &[TraceEvent]) -> String {
    events.iter().map(|event| format!("      · {}\n", event.in_words())).collect()
}

/// Returns the trace as an object.
pub fn json(trace: &Trace) -> Value {
    let words = |events: &[TraceEvent]| events.iter().map(TraceEvent::in_words).collect::<Vec<_>>();
    let row = |row: &TraceRow| {
        json!({
            "phase": row.phase.name(),
            "cost": row.cost,
            "squared_length": row.squared_length,
            "largest_step_sigmas": row.largest_step_sigmas,
            "share": row.share,
            "matrix_reused": row.is_matrix_reused,
            "downweighted": row.downweighted,
            "range_m": row.levels.range_m(),
            "angle_rad": row.levels.angle_rad,
            "stamp_s": row.levels.jitter_s,
            "jerk_m_per_s3": row.levels.jerk_m_per_s3,
            "events": words(&row.events),
        })
    };
    json!({
        "status": trace.status.code(),
        "steps": trace.rows.iter().map(row).collect::<Vec<_>>(),
        "last_events": words(&trace.last_events),
    })
}
