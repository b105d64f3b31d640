//! A judgement for the terminal: a column for each estimate, then the verdicts on pairs and the odd spans.

use super::rows::{Angles, EMPTY, rows, why_empty};
use super::verdict_sentence::verdict_sentence;
use super::verdicts::{VERDICTS_IN_WORDS, verdicts};
use resect_tools::estimates::odd::{OddOne, OddSpan};
use resect_tools::estimates::{AgreeingPair, EstimatesJudgement, GroundTruth, Options};

const LABEL: usize = 40;
const VERDICT_LABEL: usize = 28;

/// Names the ground truth and its quality.
pub fn truth_in_words(truth: &GroundTruth<'_>) -> String {
    match truth {
        GroundTruth::Deployment { deployment, analysis } => match &analysis.answer {
            Ok(answer) => format!(
                "{} · ground truth by {}, verdict {}",
                deployment.name,
                answer.calibration.method_in_words(),
                answer.calibration.verdict_in_words()
            ),
            Err(why) => format!("{} · no ground truth: {why}", deployment.name),
        },
        GroundTruth::Trajectory(truth, _) => {
            let kind = match truth.poses.iter().all(|pose| pose.orientation.is_some()) {
                true => "poses",
                false => "positions",
            };
            let sigma = match truth.covariances.is_empty() {
                true => "it states no σ (give one by --truth-sigma)",
                false => "with its covariance",
            };
            format!("{} · ground truth of {} {kind}, {sigma}", truth.name, truth.poses.len())
        }
    }
}

/// States the span, the poses of the alignment and the plane, if the comparison is restricted to any.
fn restrictions_in_words(options: &Options, start_s: f64) -> Option<String> {
    let time = |time_s: f64| format!("{:.1} s", time_s - start_s);
    let words = [
        match (options.from_s.map(time), options.to_s.map(time)) {
            (Some(from), Some(to)) => Some(format!("compared from {from} to {to}")),
            (Some(from), None) => Some(format!("compared from {from} on")),
            (None, Some(to)) => Some(format!("compared up to {to}")),
            (None, None) => None,
        },
        options.align_first.map(|count| format!("aligned by the first {count} poses")),
        options.plane.map(|plane| format!("projected to the {} plane", plane.name())),
    ];
    let words: Vec<String> = words.into_iter().flatten().collect();
    (!words.is_empty()).then(|| words.join(", "))
}

/// Formats tables and lines.
pub fn text(truth: &GroundTruth<'_>, judgement: &EstimatesJudgement) -> String {
    let start_s = truth.start_s().unwrap_or_default();
    let all = &judgement.judged;
    let mut lines = Vec::new();
    // The table of a single estimate has its errors.
    if all.len() > 1
        && let Some(verdict) = verdict_sentence(judgement, Angles::DEGREES)
    {
        lines.extend([verdict, String::new()]);
    }
    lines.push(truth_in_words(truth));
    lines.extend(all.first().and_then(|judged| restrictions_in_words(&judged.options, start_s)));
    lines.push(String::new());
    let names: Vec<String> = all.iter().map(|one| one.estimate.name.clone()).collect();
    let table = if all.is_empty() { Vec::new() } else { rows(judgement, Angles::DEGREES) };
    let each: Vec<&str> = names.iter().map(|name| &**name).collect();
    let empty = why_empty(&table, &each);
    let texts = names.iter().chain(table.iter().flat_map(|row| &row.cells));
    let width = texts.map(|text| text.chars().count()).fold(22, usize::max) + 2;
    let body = table.into_iter().map(|row| (row.label, row.cells));
    for (label, cells) in std::iter::once((String::new(), names)).chain(body) {
        let cells = cells.iter().map(|cell| format!("{cell:>width$}"));
        lines.push(format!("{label:<LABEL$}{}", cells.collect::<String>()).trim_end().to_owned());
    }
    lines.extend(empty);
    lines.extend(verdict_lines(judgement));
    if !judgement.agreements.is_empty() {
        lines.push(String::new());
        lines.extend(judgement.agreements.iter().map(|both| agreed(judgement, both)));
    }
    let time = |time_s: f64| format!("{:.1}", time_s - start_s);
    let spans = all.iter().flat_map(|one| one.odd.iter().map(move |span| (one, span)));
    let odd: Vec<String> = spans
        .map(|(one, span)| {
            let [from, to] = span.span_s.map(time);
            format!(
                "{}, {from} to {to} s: {}",
                one.estimate.name,
                contradiction(span, Angles::DEGREES)
            )
        })
        .collect();
    if !odd.is_empty() {
        lines.push(String::new());
        lines.extend(odd);
    }
    let of_truth = match truth {
        GroundTruth::Trajectory(truth, _) => &truth.findings[..],
        GroundTruth::Deployment { .. } => &[],
    };
    let findings = all.iter().flat_map(|one| one.estimate.findings.iter().chain(&one.fit.findings));
    let said: Vec<String> = of_truth
        .iter()
        .chain(findings)
        .map(|finding| format!("{} {finding}", finding.severity.mark()))
        .collect();
    let left_out = judgement.unjudged.iter().map(|(_, why)| format!("x {why}"));
    let said: Vec<String> = said.into_iter().chain(left_out).collect();
    if !said.is_empty() {
        lines.push(String::new());
        lines.extend(said);
    }
    lines.push(String::new());
    lines.join("\n")
}

/// The verdicts on each pair, below a line that explains them.
fn verdict_lines(judgement: &EstimatesJudgement) -> Vec<String> {
    let tables = verdicts(judgement, Angles::DEGREES);
    let mut lines = Vec::new();
    for (index, table) in tables.iter().enumerate() {
        lines.push(String::new());
        if index == 0 {
            lines.push(VERDICTS_IN_WORDS.to_owned());
        }
        let width = table.names.iter().map(|name| name.chars().count()).fold(10, usize::max) + 2;
        let line = |label: &str, [first, second]: &[String; 2], verdict: &str| {
            let line = format!("{label:<VERDICT_LABEL$}{first:>width$}{second:>width$}  {verdict}");
            line.trim_end().to_owned()
        };
        lines.push(line("", &table.names, "verdict"));
        lines.extend(table.rows.iter().map(|row| {
            let verdict = if row.verdict == EMPTY { &row.reason } else { &row.verdict };
            line(&row.label, &row.cells, verdict)
        }));
    }
    lines
}

/// States that two estimates agree with each other against the ground truth.
pub fn agreed(judgement: &EstimatesJudgement, both: &AgreeingPair) -> String {
    let [a, b] = both.estimates.map(|index| &judgement.judged[index].estimate.name);
    let [of_a, of_b] = both.rmse_m.map(|rmse_m| 1e3 * rmse_m);
    format!(
        "{a} and {b} differ by {:.1} mm from each other and by {of_a:.1} and {of_b:.1} mm from the ground truth: the ground truth \
         is the odd one out, unless both share an error",
        1e3 * both.apart_m
    )
}

/// States the size of a contradiction in a span, and its cause.
pub fn contradiction(span: &OddSpan, Angles { per_radian, unit }: Angles) -> String {
    let turn = span.rotation_rad.filter(|turn| turn.to_degrees() >= 0.05);
    let turn = turn.map(|turn| format!(", {:.1} {unit}", per_radian * turn));
    let what = if span.by_rig { "the rig" } else { "each other" };
    let who = match span.odd_one {
        OddOne::Estimate if span.by_readings => {
            format!("the estimate is wrong: the readings agree with {what}")
        }
        OddOne::Estimate => {
            "the estimate is wrong: another estimate agrees with the ground truth".to_owned()
        }
        OddOne::Convention => {
            "the estimate's file seems to have another convention: see its findings".to_owned()
        }
        OddOne::Undecided => {
            "one of the two is wrong; another estimate at these times would show which".to_owned()
        }
        OddOne::EstimateOrAll(fault) => format!(
            "one of the two is wrong: the readings agree with {what}, but {} explains it as well; another \
             estimate at these times would show which",
            fault.in_words()
        ),
        OddOne::Readings => match span.station {
            Some(station) => format!(
                "the ground truth is wrong: the readings of station {} contradict {} there",
                station + 1,
                if span.by_rig { "the rig" } else { "those of the others" }
            ),
            None => format!("the ground truth is wrong: its readings contradict {what} there"),
        },
        OddOne::LeftOut => {
            let whose = span.station.map_or("its readings".to_owned(), |station| {
                format!("the readings of station {}", station + 1)
            });
            return format!("no ground truth: {whose} are inconsistent there and were left out");
        }
        OddOne::TruthAgainst(count) => {
            format!("the ground truth is wrong: {count} estimates agree and contradict it")
        }
    };
    format!("difference up to {:.0} mm{}; {who}", 1e3 * span.position_m, turn.unwrap_or_default())
}
