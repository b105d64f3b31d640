//! The verdict on all estimates in one sentence.

use super::rows::{Angles, millimetres};
use super::verdicts::error_in_words;
use resect_tools::estimates::ranking::{ComparedError, PairComparison, PairVerdict};
use resect_tools::estimates::{Delta, EstimatedTrajectory, EstimatesJudgement};

/// Advice for a trajectory that is alone.
pub const ADD_A_TRUTH: &str = "One trajectory alone cannot be evaluated: add its ground truth, a deployment or another trajectory.";

/// States the best estimate by each kind of error, and the kinds that are inconclusive: "a is better in rotation and over 1 to 20 m; position is
/// inconclusive (1.9 σ)". A single estimate has its errors. `None` without any comparison.
pub fn verdict_sentence(judgement: &EstimatesJudgement, angles: Angles) -> Option<String> {
    if let [only] = &judgement.judged[..] {
        let position = format!("{} mm in position", millimetres(only.position.rmse));
        let rotation = only.rotation.map(|rotation| {
            format!(" and {} {} in rotation", angles.format(rotation.rmse), angles.unit)
        });
        let rotation = rotation.unwrap_or_default();
        return Some(format!("{}: {position}{rotation}, rmse", only.estimate.name));
    }
    let count = judgement.judged.len();
    let deltas = &judgement.motions.deltas;
    let mut better = vec![Vec::new(); count];
    let (mut inconclusive, mut alike) = (Vec::new(), Vec::new());
    let mut most_sigmas: f64 = 0.0;
    for kind in ComparedError::all(&judgement.motions) {
        match outcome(judgement, kind) {
            Some(KindOutcome::Best(index)) => better[index].push(kind),
            Some(KindOutcome::Inconclusive(sigmas)) => {
                inconclusive.push(kind);
                most_sigmas = most_sigmas.max(sigmas);
            }
            Some(KindOutcome::Alike) => alike.push(kind),
            None => {}
        }
    }
    let word = if count > 2 { "best" } else { "better" };
    let named = better.iter().zip(&judgement.judged).filter(|(kinds, _)| !kinds.is_empty());
    let mut clauses: Vec<String> = named
        .map(|(kinds, one)| format!("{} is {word} {}", one.estimate.name, in_words(kinds, deltas)))
        .collect();
    match inconclusive[..] {
        [] => {}
        [only @ (ComparedError::Position | ComparedError::Rotation)] => {
            clauses.push(format!("{} is inconclusive ({most_sigmas:.1} σ)", error_in_words(only)));
        }
        _ => {
            let most = if inconclusive.len() > 1 { "at most " } else { "" };
            let kinds = in_words(&inconclusive, deltas);
            clauses.push(format!("inconclusive {kinds} ({most}{most_sigmas:.1} σ)"));
        }
    }
    if !alike.is_empty() {
        clauses.push(format!("no difference {}", in_words(&alike, deltas)));
    }
    (!clauses.is_empty()).then(|| clauses.join("; "))
}

/// Result of all comparisons by one kind of error.
enum KindOutcome {
    /// Index of the estimate that is significantly better than each other one.
    Best(usize),
    /// The difference between the best ones (σ).
    Inconclusive(f64),
    Alike,
}

/// Returns the outcome by a kind of error; `None` without enough common instants or paths.
fn outcome(judgement: &EstimatesJudgement, kind: ComparedError) -> Option<KindOutcome> {
    let of_kind: Vec<&PairComparison> =
        judgement.comparisons.iter().filter(|two| two.kind == kind).collect();
    let wins = |index: usize, is_win: &dyn Fn(&PairComparison) -> bool| {
        of_kind.iter().filter(|two| two.better == index && is_win(two)).count()
    };
    let count = judgement.judged.len();
    let best = (0..count).find(|index| wins(*index, &PairComparison::is_significant) + 1 == count);
    if let Some(best) = best {
        return Some(KindOutcome::Best(best));
    }
    let first = (0..count).max_by_key(|index| wins(*index, &|_| true))?;
    let of_first = || of_kind.iter().filter(|two| two.better == first || two.worse == first);
    let open = of_first().filter(|two| two.verdict == PairVerdict::NotSignificant);
    let sigmas = open.filter_map(|two| Some(two.sigmas()?.abs())).min_by(f64::total_cmp);
    let is_alike = of_first().any(|two| two.verdict == PairVerdict::Alike);
    sigmas.map(KindOutcome::Inconclusive).or(is_alike.then_some(KindOutcome::Alike))
}

/// Names kinds of error: "in position, rotation and over 1 to 20 m"; `deltas` are all sizes of motions that were compared.
fn in_words(kinds: &[ComparedError], deltas: &[Delta]) -> String {
    let mut words = Vec::new();
    for (kind, name) in
        [(ComparedError::Position, "position"), (ComparedError::Rotation, "rotation")]
    {
        if kinds.contains(&kind) {
            words.push(name.to_owned());
        }
    }
    let over = |kind: fn(Delta) -> ComparedError| -> Vec<usize> {
        (0..deltas.len()).filter(|index| kinds.contains(&kind(deltas[*index]))).collect()
    };
    let of_both = [over(ComparedError::PositionOver), over(ComparedError::RotationOver)];
    if of_both[0] == of_both[1] {
        words.extend(sizes(&of_both[0], deltas).map(|sizes| format!("over {sizes}")));
    } else {
        for (indices, name) in of_both.iter().zip(["position", "rotation"]) {
            words.extend(sizes(indices, deltas).map(|sizes| format!("{name} over {sizes}")));
        }
    }
    let preposition = if words.iter().all(|word| word.starts_with("over")) { "" } else { "in " };
    match words.split_last() {
        Some((last, [])) => format!("{preposition}{last}"),
        Some((last, others)) => format!("{preposition}{} and {last}", others.join(", ")),
        None => String::new(),
    }
}

/// Names sizes of motions by their indices: "1 to 20 m", or "1, 10 m" if some between them are missing.
fn sizes(indices: &[usize], deltas: &[Delta]) -> Option<String> {
    let (first, last) = (*indices.first()?, *indices.last()?);
    let units = |index: &usize| deltas[*index].unit();
    if indices.iter().any(|index| units(index) != units(&first)) {
        let each: Vec<String> = indices.iter().map(|index| deltas[*index].to_string()).collect();
        return Some(each.join(", "));
    }
    let values: Vec<String> =
        indices.iter().map(|index| deltas[*index].value().to_string()).collect();
    let (others, largest) = (&values[..values.len() - 1], deltas[last]);
    Some(match (last - first + 1 == indices.len(), others) {
        (_, []) => largest.to_string(),
        (true, [smallest, ..]) => format!("{smallest} to {largest}"),
        (false, others) => format!("{}, {largest}", others.join(", ")),
    })
}

/// States the facts of a trajectory: "1361 poses over 137 s (10.0 Hz), 57.1 m, without σ".
pub fn trajectory_in_words(trajectory: &EstimatedTrajectory) -> String {
    let poses = &trajectory.poses;
    let kind = if trajectory.has_orientations() { "poses" } else { "positions" };
    let span_s = match (poses.first(), poses.last()) {
        (Some(first), Some(last)) => last.time_s - first.time_s,
        _ => 0.0,
    };
    let rate = match span_s > 0.0 {
        true => format!(" ({:.1} Hz)", (poses.len() - 1) as f64 / span_s),
        false => String::new(),
    };
    let steps_m = poses.windows(2).map(|two| (two[1].position_m - two[0].position_m).norm());
    let sigma = if trajectory.covariances.is_empty() { "without σ" } else { "with σ" };
    let count = poses.len();
    format!("{count} {kind} over {span_s:.0} s{rate}, {:.1} m, {sigma}", steps_m.sum::<f64>())
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_tools::estimates::RelativeOptions;

    #[test]
    fn kinds_of_error_are_grouped_by_the_size_of_their_motions() {
        use ComparedError::{Position, PositionOver, Rotation, RotationOver};
        let usual = RelativeOptions::default();
        let words = |kinds: &[ComparedError]| in_words(kinds, &usual.deltas);
        let [shortest, .., longest] = usual.deltas[..] else { panic!("several sizes") };
        let all = ComparedError::all(&usual);
        assert_eq!(words(&all), "in position, rotation and over 1 to 100 m");
        assert_eq!(words(&[Position]), "in position");
        assert_eq!(words(&[Rotation, PositionOver(shortest)]), "in rotation and position over 1 m");
        let both = [PositionOver(shortest), RotationOver(shortest)];
        assert_eq!(words(&both), "over 1 m");
        let ends = [RotationOver(shortest), RotationOver(longest)];
        assert_eq!(words(&ends), "in rotation over 1, 100 m");
        let mixed = [Delta::PathM(5.0), Delta::TimeS(10.0)];
        let both = mixed.map(PositionOver);
        assert_eq!(in_words(&both, &mixed), "in position over 5 m, 10 s");
    }
}
