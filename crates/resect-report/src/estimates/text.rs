//! A judgement for the terminal: a column for each estimate, then the ranking and the odd spans.

use super::rows::{Angles, rows, why_empty};
use resect_core::estimates::odd::{OddOne, OddSpan};
use resect_core::estimates::ranking::{ComparedError, PairComparison};
use resect_core::estimates::{AgreeingPair, EstimatesJudgement, GroundTruth};

const LABEL: usize = 40;

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
        GroundTruth::Trajectory(truth) => {
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

/// Formats tables and lines.
pub fn text(truth: &GroundTruth<'_>, judgement: &EstimatesJudgement) -> String {
    let start_s = truth.start_s().unwrap_or_default();
    let mut lines = vec![truth_in_words(truth), String::new()];
    let all = &judgement.judged;
    let width = all.iter().map(|one| one.estimate.name.chars().count()).fold(22, usize::max) + 2;
    let names = all.iter().map(|one| one.estimate.name.clone()).collect();
    let table = if all.is_empty() { Vec::new() } else { rows(judgement, Angles::DEGREES) };
    let empty = why_empty(&table);
    let body = table.into_iter().map(|row| (row.label, row.cells));
    for (label, cells) in std::iter::once((String::new(), names)).chain(body) {
        let cells = cells.iter().map(|cell| format!("{cell:>width$}"));
        lines.push(format!("{label:<LABEL$}{}", cells.collect::<String>()).trim_end().to_owned());
    }
    lines.extend(empty);
    let ranking: Vec<String> = stated(judgement)
        .map(|two| compared(judgement, two, Angles::DEGREES))
        .chain(judgement.agreements.iter().map(|both| agreed(judgement, both)))
        .collect();
    if !ranking.is_empty() {
        lines.push(String::new());
        lines.extend(ranking);
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
        GroundTruth::Trajectory(truth) => &truth.findings[..],
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

/// Comparisons that are stated in words: by absolute errors always, by relative errors if they significantly favour another
/// estimate than the absolute ones.
pub fn stated(judgement: &EstimatesJudgement) -> impl Iterator<Item = &PairComparison> {
    judgement.comparisons.iter().filter(|two| {
        let absolute = match two.kind {
            ComparedError::Position | ComparedError::Rotation => return true,
            ComparedError::PositionOverPath(_) => ComparedError::Position,
            ComparedError::RotationOverPath(_) => ComparedError::Rotation,
        };
        let is_same_winner = |other: &PairComparison| {
            other.kind == absolute
                && other.is_significant()
                && (other.better, other.worse) == (two.better, two.worse)
        };
        two.is_significant() && !judgement.comparisons.iter().any(is_same_winner)
    })
}

/// Short name of a kind of error: "position", "rotation over 5 m".
pub fn error_in_words(kind: ComparedError) -> String {
    match kind {
        ComparedError::Position => "position".to_owned(),
        ComparedError::Rotation => "rotation".to_owned(),
        ComparedError::PositionOverPath(path_m) => format!("position over {path_m} m"),
        ComparedError::RotationOverPath(path_m) => format!("rotation over {path_m} m"),
    }
}

/// States the better of two estimates by one kind of error, by how much, and if the difference is significant.
pub fn compared(judgement: &EstimatesJudgement, two: &PairComparison, angles: Angles) -> String {
    const ALIKE: f64 = 1e-3;
    let name = |index: usize| &judgement.judged[index].estimate.name;
    let (better, worse) = (name(two.better), name(two.worse));
    let kind = error_in_words(two.kind);
    let ratio = two.rmse[0] / two.rmse[1];
    let apart = if two.kind.is_rotation() {
        let [a, b] = two.rmse.map(|rmse| angles.per_radian * rmse);
        format!("{a:.3} against {b:.3} {} rmse", angles.unit)
    } else {
        let [a, b] = two.rmse.map(|rmse| 1e3 * rmse);
        format!("{a:.1} against {b:.1} mm rmse")
    };
    match (two.ratio_95, two.confidence) {
        (Some([low, high]), _) if low > 1.0 - ALIKE && high < 1.0 + ALIKE => {
            format!("no difference in {kind} between {better} and {worse}: {apart}")
        }
        (Some([low, high]), Some(_)) if two.is_significant() => format!(
            "{better} is significantly better than {worse} in {kind}: {apart} over their common times, ratio {ratio:.2} \
             (95 %: {low:.2} to {high:.2})"
        ),
        (Some([low, high]), Some(confidence)) => format!(
            "no significant difference in {kind} between {better} and {worse}: {apart}, ratio {ratio:.2} (95 %: {low:.2} to \
             {high:.2}); {better} is better in {:.0} % of the bootstrap samples",
            100.0 * confidence
        ),
        _ => format!(
            "inconclusive in {kind} for {better} and {worse}: {apart}; their common time is too short"
        ),
    }
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
        OddOne::Undecided => {
            "one of the two is wrong; another estimate at these times would show which".to_owned()
        }
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
