//! A judgement for the terminal: a column an estimate, then who is better, and where something is odd.

use crate::calibration::Calibration;
use crate::estimates::odd::OddOne;
use crate::estimates::{Judged, Judgement};

const LABEL: usize = 30;

/// Tables and lines; `start_s` is when the drive began, from which spans are counted.
pub fn text(
    deployment: &str,
    calibration: &Calibration,
    judgement: &Judgement,
    start_s: f64,
) -> String {
    let mut lines = vec![
        format!(
            "{deployment} · ground truth by {}, verdict {}",
            calibration.method.in_words(),
            calibration.verdict_in_words()
        ),
        String::new(),
    ];
    let all = &judgement.judged;
    let width = all.iter().map(|one| one.estimate.name.chars().count()).fold(22, usize::max) + 2;
    let mut row = |label: &str, cell: &dyn Fn(&Judged) -> Option<String>| {
        let cells: Vec<Option<String>> = all.iter().map(cell).collect();
        if cells.iter().any(Option::is_some) {
            let cells =
                cells.into_iter().map(|cell| format!("{:>width$}", cell.unwrap_or("–".into())));
            lines.push(format!("{label:<LABEL$}{}", cells.collect::<String>()));
        }
    };
    if !all.is_empty() {
        row("", &|one| Some(one.estimate.name.clone()));
        row("poses with ground truth", &|one| {
            Some(format!("{} of {}", one.errors.len(), one.estimate.poses.len()))
        });
        row("time offset (s)", &|one| {
            let found = one.fit.time_offset_sigma_s.map(|sigma| format!(" ± {sigma:.4}"));
            Some(format!("{:+.4}{}", one.fit.time_offset_s, found.unwrap_or(" given".into())))
        });
        for (axis, name) in
            ["lever arm, x (m)", "lever arm, y (m)", "lever arm, z (m)"].iter().enumerate()
        {
            row(name, &|one| {
                let lever_m = one.fit.lever_arm_m?;
                let found = one.fit.lever_arm_sigma_m.map(|sigma| format!(" ± {:.3}", sigma[axis]));
                Some(format!("{:+.3}{}", lever_m[axis], found.unwrap_or(" given".into())))
            });
        }
        row("scale", &|one| (one.fit.scale != 1.0).then(|| format!("{:.5}", one.fit.scale)));
        let millimetres = |value: f64| format!("{:.1}", 1e3 * value);
        for name in ["rmse", "mean", "median", "std", "min", "max"] {
            row(&format!("APE position, {name} (mm)"), &|one| {
                let ape = &one.position;
                Some(millimetres(match name {
                    "rmse" => ape.rmse,
                    "mean" => ape.mean,
                    "median" => ape.median,
                    "std" => ape.std,
                    "min" => ape.min,
                    _ => ape.max,
                }))
            });
        }
        row("APE rotation, rmse (°)", &|one| {
            Some(format!("{:.3}", one.rotation?.rmse.to_degrees()))
        });
        for path_m in crate::estimates::RELATIVE_M {
            let of = |one: &Judged| one.relative.iter().find(|r| r.path_m == path_m).copied();
            row(&format!("RPE over {path_m} m, rmse (mm)"), &|one| {
                Some(millimetres(of(one)?.position.rmse))
            });
            row(&format!("RPE over {path_m} m, rmse (°)"), &|one| {
                Some(format!("{:.3}", of(one)?.rotation.rmse.to_degrees()))
            });
        }
        row("ground truth's σ (mm)", &|one| Some(millimetres(one.against_sigma.sigma_m)));
        row("ground truth's σ (°)", &|one| {
            Some(format!("{:.3}", one.against_sigma.sigma_rad?.to_degrees()))
        });
        row("error it cannot tell from none", &|one| {
            Some(format!("{:.0} % of poses", 100.0 * one.against_sigma.undecided))
        });
        row("its share of the square error", &|one| {
            Some(format!("up to {:.0} %", 100.0 * one.against_sigma.of_truth))
        });
    }
    ranking(judgement, &mut lines);
    odd(judgement, start_s, &mut lines);
    let findings = all.iter().flat_map(|one| one.estimate.findings.iter().chain(&one.fit.findings));
    let said: Vec<String> =
        findings.map(|finding| format!("{} {finding}", finding.severity.mark())).collect();
    let left_out = judgement.unjudged.iter().map(|(_, why)| format!("x {why}"));
    let said: Vec<String> = said.into_iter().chain(left_out).collect();
    if !said.is_empty() {
        lines.push(String::new());
        lines.extend(said);
    }
    lines.push(String::new());
    lines.join("\n")
}

fn ranking(judgement: &Judgement, lines: &mut Vec<String>) {
    if judgement.comparisons.is_empty() {
        return;
    }
    lines.push(String::new());
    let name = |index: usize| &judgement.judged[index].estimate.name;
    for two in &judgement.comparisons {
        let (better, worse) = (name(two.better), name(two.worse));
        let [a, b] = two.rmse_m.map(|rmse| 1e3 * rmse);
        let apart = format!("{a:.1} against {b:.1} mm rmse where both have poses");
        lines.push(match (two.ratio_95, two.confidence) {
            (Some([low, high]), Some(_)) if two.is_significant() => format!(
                "{better} is better than {worse}: {apart}, a ratio of {:.2} (95 %: {low:.2} to {high:.2})",
                a / b
            ),
            (Some([low, high]), Some(confidence)) => format!(
                "not decided between {better} and {worse}: {apart}, a ratio of {:.2} (95 %: {low:.2} to {high:.2}); \
                 {better} is better in {:.0} % of draws",
                a / b,
                100.0 * confidence
            ),
            _ => format!("not decided between {better} and {worse}: {apart}; the time in common is too short"),
        });
    }
}

fn odd(judgement: &Judgement, start_s: f64, lines: &mut Vec<String>) {
    let spans = judgement.judged.iter().flat_map(|one| one.odd.iter().map(move |span| (one, span)));
    let said: Vec<String> = spans
        .map(|(one, span)| {
            let [from, to] = span.span_s.map(|time_s| time_s - start_s);
            let turn = span.rotation_rad.map(|turn| format!(", {:.1}°", turn.to_degrees()));
            let who = match span.odd_one {
                OddOne::Estimate => {
                    "the estimate is wrong: the readings agree with the rig".to_owned()
                }
                OddOne::Readings => {
                    "the ground truth is wrong: its readings contradict the rig there".to_owned()
                }
                OddOne::TruthAgainst(count) => {
                    format!(
                        "the ground truth is the odd one out: {count} estimates agree against it"
                    )
                }
            };
            format!(
                "{}, {from:.1} to {to:.1} s: up to {:.0} mm{} apart; {who}",
                one.estimate.name,
                1e3 * span.position_m,
                turn.unwrap_or_default()
            )
        })
        .collect();
    if !said.is_empty() {
        lines.push(String::new());
        lines.extend(said);
    }
}
