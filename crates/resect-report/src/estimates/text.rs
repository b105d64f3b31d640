//! A judgement for the terminal: a column for each estimate, then the ranking and the odd spans.

use resect_core::calibration::Calibration;
use resect_core::estimates::metrics::RelativeErrors;
use resect_core::estimates::odd::{OddOne, OddSpan};
use resect_core::estimates::ranking::PairComparison;
use resect_core::estimates::{EstimatesJudgement, Judged};

const LABEL: usize = 30;

/// Formats tables and lines; `start_s` is the start of the drive, to which spans are relative.
pub fn text(
    deployment: &str,
    calibration: &Calibration,
    judgement: &EstimatesJudgement,
    start_s: f64,
) -> String {
    let mut lines = vec![
        format!(
            "{deployment} · ground truth by {}, verdict {}",
            calibration.method_in_words(),
            calibration.verdict_in_words()
        ),
        String::new(),
    ];
    let all = &judgement.judged;
    let width = all.iter().map(|one| one.estimate.name.chars().count()).fold(22, usize::max) + 2;
    let names = all.iter().map(|one| one.estimate.name.clone()).collect();
    let table = if all.is_empty() { Vec::new() } else { rows(judgement, Angles::DEGREES) };
    for (label, cells) in std::iter::once((String::new(), names)).chain(table) {
        let cells = cells.iter().map(|cell| format!("{cell:>width$}"));
        lines.push(format!("{label:<LABEL$}{}", cells.collect::<String>()).trim_end().to_owned());
    }
    if !judgement.comparisons.is_empty() {
        lines.push(String::new());
        lines.extend(judgement.comparisons.iter().map(|two| compared(judgement, two)));
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

/// Unit of rotations: its number in a radian, and its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    pub per_radian: f64,
    pub unit: &'static str,
}

impl Angles {
    /// Degrees, as in evo.
    pub const DEGREES: Self = Self { per_radian: 180.0 / std::f64::consts::PI, unit: "°" };
}

/// Returns the rows: a label with its unit, and a cell for each estimate. Rows without any value are left out.
pub fn rows(judgement: &EstimatesJudgement, angles: Angles) -> Vec<(String, Vec<String>)> {
    let Angles { per_radian, unit } = angles;
    let mut rows = Vec::new();
    let mut row = |label: &str, cell: &dyn Fn(&Judged) -> Option<String>| {
        let cells: Vec<Option<String>> = judgement.judged.iter().map(cell).collect();
        if cells.iter().any(Option::is_some) {
            let cells = cells.into_iter().map(|cell| cell.unwrap_or("–".into())).collect();
            rows.push((label.to_owned(), cells));
        }
    };
    row("poses with ground truth", &|one| Some(one.errors.len().to_string()));
    row("poses without", &|one| Some(one.without_truth.to_string()));
    // This row is only needed if the alignments differ.
    let is_one_way = judgement.judged.windows(2).all(|two| two[0].alignment == two[1].alignment);
    row("aligned by", &|one| (!is_one_way).then(|| one.alignment.in_words().to_owned()));
    let with_sigma = |value: f64, sigma: Option<f64>| {
        let sigma = sigma.map(|sigma| format!(" ± {:.1}", 1e3 * sigma));
        format!("{:+.1}{}", 1e3 * value, sigma.unwrap_or(" given".into()))
    };
    row("time offset (ms)", &|one| {
        Some(with_sigma(one.fit.time_offset_s, one.fit.time_offset_sigma_s))
    });
    for (axis, name) in
        ["lever arm, x (mm)", "lever arm, y (mm)", "lever arm, z (mm)"].iter().enumerate()
    {
        row(name, &|one| {
            let lever_m = one.fit.lever_arm_m?;
            Some(with_sigma(lever_m[axis], one.fit.lever_arm_sigma_m.map(|sigma| sigma[axis])))
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
    row(&format!("APE rotation, rmse ({unit})"), &|one| {
        Some(format!("{:.3}", per_radian * one.rotation?.rmse))
    });
    // Errors of fewer pairs are mostly chance; the JSON has all, with their count.
    const FEWEST: usize = 10;
    let well = |relative: RelativeErrors| (relative.position.count >= FEWEST).then_some(relative);
    for path_m in resect_core::estimates::RELATIVE_M {
        let of = |one: &Judged| one.relative.iter().find(|r| r.path_m == path_m).copied();
        row(&format!("RPE over {path_m} m, rmse (mm)"), &|one| {
            Some(millimetres(well(of(one)?)?.position.rmse))
        });
        row(&format!("RPE over {path_m} m, rmse ({unit})"), &|one| {
            Some(format!("{:.3}", per_radian * well(of(one)?)?.rotation.rmse))
        });
    }
    row("ground truth's σ (mm)", &|one| Some(millimetres(one.against_sigma.sigma_m)));
    row(&format!("ground truth's σ ({unit})"), &|one| {
        Some(format!("{:.3}", per_radian * one.against_sigma.sigma_rad?))
    });
    row("error not significant", &|one| {
        Some(format!("{:.0} % of poses", 100.0 * one.against_sigma.undecided))
    });
    row("ground truth's share of error²", &|one| {
        Some(format!("up to {:.0} %", 100.0 * one.against_sigma.of_truth))
    });
    rows
}

/// States the better of two estimates, by how much, and if the difference is significant.
pub fn compared(judgement: &EstimatesJudgement, two: &PairComparison) -> String {
    const ALIKE: f64 = 1e-3;
    let name = |index: usize| &judgement.judged[index].estimate.name;
    let (better, worse) = (name(two.better), name(two.worse));
    let [a, b] = two.rmse_m.map(|rmse| 1e3 * rmse);
    let apart = format!("{a:.1} against {b:.1} mm rmse over their common poses");
    match (two.ratio_95, two.confidence) {
        (Some([low, high]), _) if low > 1.0 - ALIKE && high < 1.0 + ALIKE => {
            format!("no difference between {better} and {worse}: {apart}")
        }
        (Some([low, high]), Some(_)) if two.is_significant() => format!(
            "{better} is significantly better than {worse}: {apart}, ratio {:.2} (95 %: {low:.2} to {high:.2})",
            a / b
        ),
        (Some([low, high]), Some(confidence)) => format!(
            "no significant difference between {better} and {worse}: {apart}, ratio {:.2} (95 %: {low:.2} to {high:.2}); \
             {better} is better in {:.0} % of the bootstrap samples",
            a / b,
            100.0 * confidence
        ),
        _ => format!(
            "inconclusive for {better} and {worse}: {apart}; their common time is too short"
        ),
    }
}

/// States the size of a contradiction in a span, and its cause.
pub fn contradiction(span: &OddSpan, Angles { per_radian, unit }: Angles) -> String {
    let turn = span.rotation_rad.filter(|turn| turn.to_degrees() >= 0.05);
    let turn = turn.map(|turn| format!(", {:.1} {unit}", per_radian * turn));
    let what = if span.by_rig { "the rig" } else { "each other" };
    let who = match span.odd_one {
        OddOne::Estimate => format!("the estimate is wrong: the readings agree with {what}"),
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
