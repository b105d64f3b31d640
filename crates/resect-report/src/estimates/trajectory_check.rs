//! Content of trajectories as text and JSON (`resect check`).

use std::fmt::Write;

use serde_json::{Value, json};

use crate::json::{SCHEMA, findings};
use resect_core::deployment::{EstimatedTrajectory, FrameNames};
use resect_tools::estimates::trajectory_summary::{Step, TrajectorySummary, summarise};

/// Number of gaps that the text lists.
const LISTED_GAPS: usize = 5;

/// Formats the content of a trajectory; its findings are below it. Times are seconds since its start.
pub fn trajectory_text(trajectory: &EstimatedTrajectory) -> String {
    let summary = summarise(trajectory);
    let TrajectorySummary { span_s: [start_s, end_s], low_m, high_m, .. } = summary;
    let rate = summary.rate_hz.map_or(String::new(), |rate_hz| format!(", {rate_hz:.2} Hz"));
    let mut text = format!("{}\n", trajectory.name);
    let mut line = |label: &str, content: &str| _ = writeln!(text, "  {label:<14}{content}");
    line("frame", &frames(trajectory));
    line("poses", &format!("{} over {:.1} s{rate}", summary.poses, end_s - start_s));
    line("stamps", &format!("{start_s:.3} to {end_s:.3} s"));
    line("path", &format!("{:.1} m", summary.path_m));
    let position = |axis: usize| format!("{:.1} to {:.1}", low_m[axis], high_m[axis]);
    line("extent", &format!("x {}, y {}, z {} m", position(0), position(1), position(2)));
    line("gaps", &gaps(&summary, start_s));
    let usual = summary.usual_speed_m_per_s;
    let usual = usual.map_or("–".to_owned(), |speed| format!("95 % up to {speed:.2} m/s"));
    line("speed", &usual);
    let fastest = |step: &Step| {
        let (speed, since_s) = (step.speed_m_per_s(), step.time_s - start_s);
        format!(
            "{speed:.2} m/s ({:.3} m in {:.3} s) at {since_s:.1} s",
            step.length_m, step.lasts_s
        )
    };
    let steps: Vec<String> = summary.fastest.iter().map(fastest).collect();
    line("largest jumps", &if steps.is_empty() { "–".to_owned() } else { steps.join(", ") });
    line("orientations", if summary.has_orientations { "unit quaternions" } else { "none" });
    let sigma = summary.sigma_m.map_or("none".to_owned(), |sigma_m| {
        format!("of each pose, median σ {:.1} mm along an axis", 1e3 * sigma_m)
    });
    line("covariance", &sigma);
    for finding in &trajectory.findings {
        _ = writeln!(text, "  {} {finding}", finding.severity.mark());
    }
    text
}

/// Names the frames: "base_link in odom".
fn frames(trajectory: &EstimatedTrajectory) -> String {
    match &trajectory.frames {
        None => "not stated in the file".to_owned(),
        Some(FrameNames { parent, child: None }) => parent.clone(),
        Some(FrameNames { parent, child: Some(child) }) => format!("{child} in {parent}"),
    }
}

fn gaps(summary: &TrajectorySummary, start_s: f64) -> String {
    let in_words = |step: &Step| format!("{:.2} s at {:.1} s", step.lasts_s, step.time_s - start_s);
    let listed: Vec<String> = summary.gaps.iter().take(LISTED_GAPS).map(in_words).collect();
    match (summary.gaps.len(), &summary.longest_interval) {
        (0, None) => "–".to_owned(),
        (0, Some(longest)) => format!("none, longest interval {:.2} s", longest.lasts_s),
        (count, _) if count > LISTED_GAPS => {
            format!("{count} intervals beyond 5 times the median: {}, …", listed.join(", "))
        }
        (count, _) => format!("{count} beyond 5 times the median: {}", listed.join(", ")),
    }
}

/// Returns the content of trajectories as one object.
pub fn trajectories_json(trajectories: &[EstimatedTrajectory]) -> Value {
    let step = |step: &Step| json!({"time_s": step.time_s, "lasts_s": step.lasts_s, "length_m": step.length_m});
    let steps = |all: &[Step]| all.iter().map(step).collect::<Vec<Value>>();
    let content = |trajectory: &EstimatedTrajectory| {
        let summary = summarise(trajectory);
        json!({
            "name": trajectory.name,
            "file": trajectory.path,
            "topic": trajectory.topic,
            "frame": trajectory.frames.as_ref().map(|frames| &frames.parent),
            "child_frame": trajectory.frames.as_ref().and_then(|frames| frames.child.as_ref()),
            "poses": summary.poses,
            "span_s": summary.span_s,
            "path_m": summary.path_m,
            "rate_hz": summary.rate_hz,
            "longest_interval_s": summary.longest_interval.map(|step| step.lasts_s),
            "gaps": steps(&summary.gaps),
            "usual_speed_m_per_s": summary.usual_speed_m_per_s,
            "fastest_steps": steps(&summary.fastest),
            "low_m": summary.low_m.as_slice(),
            "high_m": summary.high_m.as_slice(),
            "has_orientations": summary.has_orientations,
            "sigma_m": summary.sigma_m,
            "findings": findings(trajectory.findings.iter()),
        })
    };
    json!({"schema": SCHEMA, "trajectories": trajectories.iter().map(content).collect::<Vec<Value>>()})
}
