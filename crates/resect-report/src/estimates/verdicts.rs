//! The table of verdicts: for each pair of estimates, a row for each kind of error.

use resect_core::statistics::estimate::SUPPORTED_SIGMAS;
use resect_tools::estimates::ranking::{ComparedError, PairComparison, PairVerdict};
use resect_tools::estimates::{Delta, EstimatesJudgement};

use super::rows::{Angles, EMPTY, NO_ORIENTATION, millimetres};

/// Verdicts on one pair of estimates.
pub struct PairTable {
    /// Indices of the estimates, and their names.
    pub estimates: [usize; 2],
    pub names: [String; 2],
    pub rows: Vec<VerdictRow>,
}

/// Verdict on one pair by one kind of error.
pub struct VerdictRow {
    /// The error with its unit.
    pub label: String,
    /// Error of each estimate; [`EMPTY`] if there is none.
    pub cells: [String; 2],
    /// "b better, 5.1 σ: 2.02 times (1.62 to 2.52)", "inconclusive, …", or [`EMPTY`].
    pub verdict: String,
    /// The same with its evidence in one sentence, or the reason of empty cells.
    pub reason: String,
    /// Index of the significantly better estimate.
    pub better: Option<usize>,
}

/// Explains the numbers of the table.
pub const VERDICTS_IN_WORDS: &str = "Root mean square errors at the same instants and over the same paths, measured along the ground \
                                     truth. The factor is that of a typical block of time, with its 95 % interval; one is better from 3 σ on.";

/// Returns a table for each pair of estimates.
pub fn verdicts(judgement: &EstimatesJudgement, angles: Angles) -> Vec<PairTable> {
    let count = judgement.judged.len();
    let pairs = (0..count).flat_map(|first| (first + 1..count).map(move |second| [first, second]));
    let table = |estimates: [usize; 2]| PairTable {
        estimates,
        names: estimates.map(|index| judgement.judged[index].estimate.name.clone()),
        rows: ComparedError::all(&judgement.motions)
            .into_iter()
            .filter(|kind| !kind.is_rotation() || has_rotation(judgement, estimates))
            .map(|kind| row(judgement, estimates, kind, angles))
            .collect(),
    };
    pairs.map(table).collect()
}

/// Returns true if one of two estimates has orientations.
fn has_rotation(judgement: &EstimatesJudgement, estimates: [usize; 2]) -> bool {
    estimates.into_iter().any(|index| judgement.judged[index].rotation.is_some())
}

fn row(
    judgement: &EstimatesJudgement,
    estimates: [usize; 2],
    kind: ComparedError,
    angles: Angles,
) -> VerdictRow {
    let is_of_pair = |two: &&PairComparison| {
        two.kind == kind && estimates.contains(&two.better) && estimates.contains(&two.worse)
    };
    let Some(two) = judgement.comparisons.iter().find(is_of_pair) else {
        return VerdictRow {
            label: label(kind, false, angles),
            cells: [EMPTY, EMPTY].map(str::to_owned),
            verdict: EMPTY.to_owned(),
            reason: absent(judgement, estimates, kind).to_owned(),
            better: None,
        };
    };
    let [better, worse] = two.rmse.map(|rmse| match kind.is_rotation() {
        true => angles.format(rmse),
        false => millimetres(rmse),
    });
    VerdictRow {
        label: label(kind, two.is_of_distances, angles),
        cells: if two.better == estimates[0] { [better, worse] } else { [worse, better] },
        verdict: verdict(judgement, two),
        reason: compared(judgement, two, angles),
        better: two.is_significant().then_some(two.better),
    }
}

/// Reason for the absence of a comparison.
fn absent(
    judgement: &EstimatesJudgement,
    estimates: [usize; 2],
    kind: ComparedError,
) -> &'static str {
    let have_rotation =
        estimates.into_iter().all(|index| judgement.judged[index].rotation.is_some());
    match kind {
        ComparedError::Rotation | ComparedError::RotationOver(_) if !have_rotation => {
            NO_ORIENTATION
        }
        ComparedError::Position | ComparedError::Rotation => "the two have no instants in common",
        ComparedError::PositionOver(delta) | ComparedError::RotationOver(delta) => match delta {
            Delta::RotationDegrees(_) => "the two have no common motions by angle",
            _ => "no common motion is so long",
        },
    }
}

fn label(kind: ComparedError, is_of_distances: bool, angles: Angles) -> String {
    let unit = angles.unit;
    match kind {
        ComparedError::Position => "APE position (mm)".to_owned(),
        ComparedError::Rotation => format!("APE rotation ({unit})"),
        ComparedError::PositionOver(delta) if is_of_distances => {
            format!("RPE over {delta}, distance (mm)")
        }
        ComparedError::PositionOver(delta) => format!("RPE over {delta} (mm)"),
        ComparedError::RotationOver(delta) => format!("RPE over {delta} ({unit})"),
    }
}

/// Short name of a kind of error: "position", "rotation over 5 m".
pub fn error_in_words(kind: ComparedError) -> String {
    match kind {
        ComparedError::Position => "position".to_owned(),
        ComparedError::Rotation => "rotation".to_owned(),
        ComparedError::PositionOver(delta) => format!("position over {delta}"),
        ComparedError::RotationOver(delta) => format!("rotation over {delta}"),
    }
}

/// "2.02 times (1.6 to 2.5)": the factor between both errors with its 95 % interval, which is not symmetric.
fn factor_in_words(two: &PairComparison) -> Option<String> {
    let (factor, [low, high]) = (two.factor()?, two.factor_95()?);
    let [factor, low, high] = [factor.value, low, high].map(two_digits);
    Some(format!("{factor} times ({low} to {high})"))
}

/// Formats a factor with two or three significant digits.
fn two_digits(factor: f64) -> String {
    match factor {
        factor if factor < 0.01 => "0".to_owned(),
        factor if factor < 10.0 => format!("{factor:.2}"),
        factor if factor < 100.0 => format!("{factor:.1}"),
        factor if factor < 1000.0 => format!("{factor:.0}"),
        _ => "1000 or more".to_owned(),
    }
}

/// The shortest form has the significance first, because a narrow pane cuts off the end.
fn verdict(judgement: &EstimatesJudgement, two: &PairComparison) -> String {
    let numbers = factor_in_words(two)
        .zip(two.sigmas())
        .map(|(factor, sigmas)| format!(", {sigmas:.1} σ: {factor}"));
    let numbers = numbers.unwrap_or_default();
    match two.verdict {
        PairVerdict::Better => {
            format!("{} better{numbers}", judgement.judged[two.better].estimate.name)
        }
        PairVerdict::NotSignificant => format!("inconclusive{numbers}"),
        PairVerdict::Alike => "no difference".to_owned(),
        PairVerdict::FewPaths => match two.count {
            1 => "inconclusive: only 1 path".to_owned(),
            count => format!("inconclusive: only {count} paths"),
        },
        PairVerdict::SparsePoses => "inconclusive: poses too sparse".to_owned(),
        PairVerdict::FewBlocks => "inconclusive: common time too short".to_owned(),
    }
}

/// States the better of two estimates by one kind of error, by how much, and if the difference is significant.
pub fn compared(judgement: &EstimatesJudgement, two: &PairComparison, angles: Angles) -> String {
    let name = |index: usize| &judgement.judged[index].estimate.name;
    let (better, worse) = (name(two.better), name(two.worse));
    let kind = error_in_words(two.kind);
    let [a, b] = two.rmse.map(|rmse| match two.kind.is_rotation() {
        true => format!("{} {}", angles.format(rmse), angles.unit),
        false => format!("{} mm", millimetres(rmse)),
    });
    let is_over_paths = !matches!(two.kind, ComparedError::Position | ComparedError::Rotation);
    let of = if is_over_paths { "common paths" } else { "common instants" };
    let apart = format!("{a} against {b} rmse of {} {of}", two.count);
    let factor = factor_in_words(two)
        .zip(two.sigmas())
        .map(|(factor, sigmas)| format!("{factor}, {sigmas:.1} σ"))
        .unwrap_or_default();
    match two.verdict {
        PairVerdict::Better => {
            format!("{better} is significantly better than {worse} in {kind}: {apart}, {factor}")
        }
        PairVerdict::NotSignificant => format!(
            "no significant difference in {kind} between {better} and {worse}: {apart}, {factor}, below {SUPPORTED_SIGMAS} σ"
        ),
        PairVerdict::Alike => {
            format!("no difference in {kind} between {better} and {worse}: {apart}")
        }
        PairVerdict::FewPaths => {
            format!(
                "inconclusive in {kind} for {better} and {worse}: {apart}; at least 10 are needed"
            )
        }
        PairVerdict::SparsePoses => format!(
            "inconclusive in {kind} for {better} and {worse}: {apart}; poses are further apart than the paths are long"
        ),
        PairVerdict::FewBlocks => format!(
            "inconclusive in {kind} for {better} and {worse}: {apart}; their common time is too short"
        ),
    }
}
