//! The trace of the joint estimate's solver, as a text table and as JSON.

use serde_json::{Value, json};

use resect_core::calibration::joint::{Trace, TraceEvent, TraceRow};

/// Heads of the table's columns.
pub const COLUMNS: [&str; 8] =
    ["step", "phase", "cost (σ²)", "step² (σ²)", "constant (σ)", "share", "matrix", "weights < ½"];

/// Formats a row a step, with the events before it.
pub fn text(trace: &Trace) -> String {
    let mut text = format!("{}\n\n", status(trace));
    if trace.rows.is_empty() {
        return text;
    }
    let line = |[step, phase, cost, square, constant, share, matrix, weights]: [&str; 8]| {
        format!(
            "{step:>4}  {phase:<13}{cost:>11}{square:>12}{constant:>14}{share:>7}  {matrix:<6}{weights:>13}\n"
        )
    };
    text += &line(COLUMNS);
    for (index, row) in trace.rows.iter().enumerate() {
        text += &events_text(&row.events);
        text += &line(cells(index, row).each_ref().map(String::as_str));
    }
    text + &events_text(&trace.last_events)
}

/// Returns the status in words: "solver: the joint estimate converged".
pub fn status(trace: &Trace) -> String {
    format!("solver: the joint estimate {}", trace.status.in_words())
}

/// Returns the cells of a step, in the order of [`COLUMNS`].
pub fn cells(index: usize, row: &TraceRow) -> [String; COLUMNS.len()] {
    let TraceRow { cost, squared_length, largest_step_sigmas, downweighted, .. } = row;
    [
        (index + 1).to_string(),
        row.phase.name().to_owned(),
        cell(*cost, |cost| format!("{cost:.1}")),
        cell(*squared_length, |length| format!("{length:.2e}")),
        cell(*largest_step_sigmas, |sigmas| format!("{sigmas:.2}")),
        format!("{:.2}", row.share),
        if row.is_matrix_reused { "reused" } else { "new" }.to_owned(),
        cell(*downweighted, |share| format!("{:.1} %", 100.0 * share)),
    ]
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
            "horizontal_angle_rad": row.levels.horizontal_rad,
            "vertical_angle_rad": row.levels.vertical_rad,
            "stamp_s": row.levels.jitter_s,
            "horizontal_jerk_m_per_s3": row.levels.horizontal_jerk_m_per_s3,
            "vertical_jerk_m_per_s3": row.levels.vertical_jerk_m_per_s3,
            "events": words(&row.events),
        })
    };
    json!({
        "status": trace.status.code(),
        "steps": trace.rows.iter().map(row).collect::<Vec<_>>(),
        "last_events": words(&trace.last_events),
    })
}
