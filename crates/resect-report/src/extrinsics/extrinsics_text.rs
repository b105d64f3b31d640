//! An extrinsic calibration in the terminal.

use super::advice_text::{advice_in_words, direction_in_words};
use resect_core::calibration::Verdict;
use resect_tools::extrinsics::{Extrinsics, HalvesDifference, HalvesOutcome, Weakness, weakness};

const LABEL: usize = 22;
const VALUE: usize = 28;

/// A number of the calibration with its σ.
pub struct QuantityRow {
    pub label: String,
    pub value: String,
    /// Difference between the halves of the drive, such as "0.4 σ".
    pub halves: Option<String>,
}

/// Returns the numbers of the calibration.
pub fn quantities(extrinsics: &Extrinsics) -> Vec<QuantityRow> {
    let solution = &extrinsics.solution;
    let halves: &[HalvesDifference] = match &extrinsics.halves {
        HalvesOutcome::Compared(all) => all,
        HalvesOutcome::NoAnswer(_) => &[],
    };
    let row = |label: String, value: String, name: &str| {
        let half = halves.iter().find(|half| half.name == name);
        let halves = half.map(|half| format!("{:.1} σ", half.sigmas()));
        QuantityRow { label, value, halves }
    };
    let mut rows = Vec::new();
    for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
        let value_m = solution.a_from_b.translation_m[axis];
        let value = match solution.lever_sigma_m {
            Some(_) if !solution.determines_lever[axis] => "not determined".to_owned(),
            sigma_m => millis(value_m, sigma_m.map(|sigma_m| sigma_m[axis])),
        };
        let half = format!("lever arm, {letter}");
        rows.push(row(format!("lever arm, {letter} (mm)"), value, &half));
    }
    if let Some(sigma_rad) = solution.rotation_sigma_rad {
        let (roll, pitch, yaw) = solution.a_from_b.rotation.euler_angles();
        let angles = [roll, pitch, yaw].map(|angle| format!("{:+.3}", angle.to_degrees()));
        rows.push(row("roll, pitch, yaw (°)".to_owned(), angles.join("  "), ""));
        for (axis, letter) in ["x", "y", "z"].iter().enumerate() {
            let value = format!("± {:.3}", sigma_rad[axis].to_degrees());
            rows.push(row(
                format!("σ about {letter} (°)"),
                value,
                &format!("rotation about {letter}"),
            ));
        }
    }
    let clock = millis(solution.time_offset_s, solution.time_offset_sigma_s);
    rows.push(row("time offset (ms)".to_owned(), clock, "time offset"));
    if let Some(scale) = solution.scale {
        let value = format!("{:.5} ± {:.5}", scale.value, scale.sigma.max(1e-5));
        rows.push(row("scale".to_owned(), value, ""));
    }
    rows
}

/// Formats thousandths with σ; never ± 0.0.
fn millis(value: f64, sigma: Option<f64>) -> String {
    let Some(sigma) = sigma else { return format!("{:+.1} given", 1e3 * value) };
    let digits = if 1e3 * sigma < 0.95 { 2 } else { 1 };
    format!("{:+.digits$} ± {:.digits$}", 1e3 * value, (1e3 * sigma).max(0.01))
}

/// Names both bodies and the data.
pub fn headline(extrinsics: &Extrinsics) -> String {
    let [a, b] = &extrinsics.names;
    let kind = if extrinsics.solution.rotation_sigma_rad.is_some() { "poses" } else { "positions" };
    let motion = &extrinsics.motion;
    format!(
        "pose of {b} ({} {kind}) in {a} ({} poses), by {} pairs during {:.0} s and {:.0} m",
        extrinsics.poses[1],
        extrinsics.poses[0],
        extrinsics.pairs,
        motion.duration_s,
        motion.path_m,
    )
}

/// Formats the calibration for the terminal.
pub fn extrinsics_text(extrinsics: &Extrinsics) -> String {
    let [a, _] = &extrinsics.names;
    let mut lines = vec![
        headline(extrinsics),
        String::new(),
        format!("{:LABEL$}{:>VALUE$}  halves differ by", "", "").trim_end().to_owned(),
    ];
    for QuantityRow { label, value, halves } in quantities(extrinsics) {
        let halves = halves.map(|halves| format!("  {halves}")).unwrap_or_default();
        lines.push(format!("{label:<LABEL$}{value:>VALUE$}{halves}"));
    }
    lines.push(String::new());
    lines.push(format!(
        "verdict: {}: {}",
        extrinsics.verdict.name().to_uppercase(),
        conclusion(extrinsics)
    ));
    lines.extend(
        extrinsics.advice.iter().map(|advised| format!("next: {}.", advice_in_words(advised, a))),
    );
    let findings = extrinsics.findings.iter();
    let findings = findings.map(|finding| format!("{} {finding}", finding.severity.mark()));
    let findings: Vec<String> = findings.collect();
    if !findings.is_empty() {
        let truth =
            &extrinsics.names[usize::from(extrinsics.solution.rotation_sigma_rad.is_none())];
        lines.extend([String::new(), format!("Findings, with {truth} as the ground truth:")]);
        lines.extend(findings);
    }
    lines.push(String::new());
    lines.join("\n")
}

/// Returns the reason of the verdict.
pub fn conclusion(extrinsics: &Extrinsics) -> String {
    let body = &extrinsics.names[0];
    let undetermined: Vec<String> = extrinsics
        .directions
        .iter()
        .filter(|direction| !direction.is_determined())
        .map(|direction| direction_in_words(&direction.direction, body))
        .collect();
    let halves = &extrinsics.halves;
    match (extrinsics.verdict, halves) {
        (Verdict::Degenerate, _) => {
            format!("the motion does not determine the lever arm along {}", undetermined.join(", "))
        }
        (Verdict::Ambiguous, _) if extrinsics.other_offset_s.is_some() => {
            let offset =
                extrinsics.other_offset_s.map(|offset| millis(offset.value, Some(offset.sigma)));
            format!(
                "by the drive the time offset is {} ms, which contradicts the given one; leave it out to estimate it",
                offset.unwrap_or_default()
            )
        }
        (Verdict::Ambiguous, _) => match halves.contradiction() {
            Some(half) => format!(
                "the halves of the drive contradict each other in {} by {:.1} σ, so σ is too small; check the clocks and both \
                 trajectories{}",
                half.name,
                half.sigmas(),
                match &undetermined[..] {
                    [] => String::new(),
                    all => format!("; the lever arm along {} is not determined", all.join(", ")),
                }
            ),
            None => "the halves of the drive contradict each other".to_owned(),
        },
        (Verdict::Weak, HalvesOutcome::NoAnswer(why)) => {
            format!("half of the drive alone gives no answer that checks the whole: {why}")
        }
        (Verdict::Weak, _) => match weakness(&extrinsics.solution, &extrinsics.directions) {
            Some(Weakness::Lever(weakest)) => format!(
                "σ of the lever arm is {:.0} mm along {}",
                1e3 * weakest.sigma_m,
                direction_in_words(&weakest.direction, body)
            ),
            Some(Weakness::Rotation(sigma_rad)) => {
                format!("σ of the rotation is {:.2}°", sigma_rad.to_degrees())
            }
            Some(Weakness::TimeOffset(sigma_s)) => {
                format!("σ of the time offset is {:.1} ms", 1e3 * sigma_s)
            }
            None => "σ are large".to_owned(),
        },
        (Verdict::Good, _) => match halves.largest() {
            Some(half) => format!(
                "every direction is determined, and the halves of the drive agree (at most {:.1} σ)",
                half.sigmas()
            ),
            None => "every direction is determined".to_owned(),
        },
    }
}
