//! The table of errors: a row for each number, a column for each estimate.

use resect_tools::estimates::metrics::RelativeErrors;
use resect_tools::estimates::{Coverage, EstimatesJudgement, Judged, RELATIVE_M};

/// Larger lengths are given in metres (m): frames that differ by map coordinates.
const LARGEST_IN_MM_M: f64 = 1e3;

/// Reasons of empty cells.
const SPARSER: &str = "the poses of the other trajectory are counted, because it is sparser";
const LEVER_NOT_ESTIMATED: &str = "the body is given, or orientations are missing";
const SCALE_NOT_ESTIMATED: &str = "the alignment estimates no scale";
pub const NO_ORIENTATION: &str = "the estimate or the ground truth has no orientations";
const FEW_PAIRS: &str = "too few pairs of poses with orientation are so far apart";
const WITH_ORIENTATION: &str = "with orientations, the errors in mm and of rotation replace it";
const NO_SIGMA: &str = "the ground truth states no σ at its poses";

/// Unit of rotations: its number in a radian, and its name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angles {
    pub per_radian: f64,
    pub unit: &'static str,
}

impl Angles {
    /// Degrees, as in evo.
    pub const DEGREES: Self = Self { per_radian: 180.0 / std::f64::consts::PI, unit: "°" };

    /// Returns the number of an angle (rad) in this unit.
    pub fn format(self, angle_rad: f64) -> String {
        format!("{:.3}", self.per_radian * angle_rad)
    }
}

/// A row of the table.
pub struct ErrorRow {
    /// The error with its unit.
    pub label: String,
    /// A cell for each estimate; [`EMPTY`] if it has no value.
    pub cells: Vec<String>,
    /// The reason why a cell is empty.
    pub why_empty: &'static str,
}

/// Text of a cell without a value.
pub const EMPTY: &str = "–";

/// Rows so far.
struct ErrorRows<'a> {
    judgement: &'a EstimatesJudgement,
    rows: Vec<ErrorRow>,
}

impl ErrorRows<'_> {
    /// Adds a row, unless all its cells are empty.
    fn add(
        &mut self,
        label: &str,
        why_empty: &'static str,
        cell: &dyn Fn(&Judged) -> Option<String>,
    ) {
        let cells: Vec<Option<String>> = self.judgement.judged.iter().map(cell).collect();
        if cells.iter().any(Option::is_some) {
            let cells = cells.into_iter().map(|cell| cell.unwrap_or(EMPTY.into())).collect();
            self.rows.push(ErrorRow { label: label.to_owned(), cells, why_empty });
        }
    }
}

/// Returns the rows. Those without any value are left out.
pub fn rows(judgement: &EstimatesJudgement, angles: Angles) -> Vec<ErrorRow> {
    let mut rows = ErrorRows { judgement, rows: Vec::new() };
    add_coverage(&mut rows);
    add_fit(&mut rows);
    add_absolute_errors(&mut rows, angles);
    add_relative_errors(&mut rows, angles);
    add_significance(&mut rows, angles);
    rows.rows
}

/// Returns a line for each reason of an empty cell: "– in APE rotation, rmse (°): …".
pub fn why_empty(rows: &[ErrorRow]) -> Vec<String> {
    let mut by_reason: Vec<(&str, Vec<&str>)> = Vec::new();
    for row in rows.iter().filter(|row| row.cells.iter().any(|cell| cell == EMPTY)) {
        match by_reason.iter_mut().find(|(reason, _)| *reason == row.why_empty) {
            Some((_, labels)) => labels.push(&row.label),
            None => by_reason.push((row.why_empty, vec![&row.label])),
        }
    }
    let line = |(reason, labels): (&str, Vec<&str>)| match labels[..] {
        [only] => format!("{EMPTY} in {only}: {reason}"),
        [first, .., last] => format!("{EMPTY} in {first} to {last}: {reason}"),
        [] => String::new(),
    };
    by_reason.into_iter().map(line).collect()
}

/// Returns the number of a length (m) in millimetres, or the length in metres with its unit if it is large.
pub fn millimetres(value_m: f64) -> String {
    if value_m < LARGEST_IN_MM_M {
        format!("{:.1}", 1e3 * value_m)
    } else {
        format!("{value_m:.0} m")
    }
}

fn add_coverage(rows: &mut ErrorRows<'_>) {
    let counted = |poses: bool, without: bool| {
        move |one: &Judged| {
            let (is_of_poses, count) = match one.coverage {
                Coverage::PosesWithoutTruth(count) => (true, count),
                Coverage::TruthsWithoutPose(count) => (false, count),
            };
            let shown = if without { count } else { one.errors.len() };
            (is_of_poses == poses).then(|| shown.to_string())
        }
    };
    rows.add("poses with ground truth", SPARSER, &counted(true, false));
    rows.add("poses without", SPARSER, &counted(true, true));
    rows.add("ground-truth points with a pose", SPARSER, &counted(false, false));
    rows.add("ground-truth points without", SPARSER, &counted(false, true));
}

fn add_fit(rows: &mut ErrorRows<'_>) {
    // This row is only needed if the alignments differ.
    let judged = &rows.judgement.judged;
    let is_one_way = judged.windows(2).all(|two| two[0].alignment == two[1].alignment);
    rows.add("aligned by", "", &|one| (!is_one_way).then(|| one.alignment.in_words().to_owned()));
    let with_sigma = |value: f64, sigma: Option<f64>| {
        // Never ± 0.0.
        let digits = if sigma.is_some_and(|sigma| 1e3 * sigma < 0.95) { 2 } else { 1 };
        let sigma = sigma.map(|sigma| format!(" ± {:.digits$}", 1e3 * sigma));
        format!("{:+.digits$}{}", 1e3 * value, sigma.unwrap_or(" given".into()))
    };
    rows.add("time offset (ms)", "", &|one| {
        Some(match one.fit.determines_time_offset {
            true => with_sigma(one.fit.time_offset_s, one.fit.time_offset_sigma_s),
            false => "not determined".to_owned(),
        })
    });
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        rows.add(&format!("lever arm, {name} (mm)"), LEVER_NOT_ESTIMATED, &|one| {
            let lever_m = one.fit.lever_arm_m?;
            if !one.fit.determines_lever_arm(axis) {
                return Some("not determined".to_owned());
            }
            Some(with_sigma(lever_m[axis], one.fit.lever_arm_sigma_m.map(|sigma| sigma[axis])))
        });
    }
    rows.add("scale", SCALE_NOT_ESTIMATED, &|one| {
        (one.fit.scale != 1.0).then(|| format!("{:.5}", one.fit.scale))
    });
}

fn add_absolute_errors(rows: &mut ErrorRows<'_>, angles: Angles) {
    for name in ["rmse", "mean", "median", "std", "min", "max"] {
        rows.add(&format!("APE position, {name} (mm)"), "", &|one| {
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
    rows.add("APE aligned at the first pose, rmse (mm)", NO_ORIENTATION, &|one| {
        Some(millimetres(one.unaligned.at_first_pose?.rmse))
    });
    rows.add("APE not aligned, rmse (mm)", "", &|one| {
        Some(millimetres(one.unaligned.in_own_frame.rmse))
    });
    rows.add(&format!("APE rotation, rmse ({})", angles.unit), NO_ORIENTATION, &|one| {
        Some(angles.format(one.rotation?.rmse))
    });
}

/// Adds the conclusive relative errors; the JSON has the others too, with their count.
fn add_relative_errors(rows: &mut ErrorRows<'_>, angles: Angles) {
    for path_m in RELATIVE_M {
        let of = |one: &Judged, poses: bool| -> Option<[f64; 2]> {
            let is_wanted = |relative: &&RelativeErrors| {
                relative.path_m == path_m
                    && relative.are_conclusive()
                    && relative.rotation.is_some() == poses
            };
            let relative = one.relative.iter().find(is_wanted)?;
            Some([relative.position.rmse, relative.rotation.map_or(0.0, |angle| angle.rmse)])
        };
        rows.add(&format!("RPE over {path_m} m, rmse (mm)"), FEW_PAIRS, &|one| {
            Some(millimetres(of(one, true)?[0]))
        });
        rows.add(&format!("RPE over {path_m} m, rmse ({})", angles.unit), FEW_PAIRS, &|one| {
            Some(angles.format(of(one, true)?[1]))
        });
        rows.add(&format!("RPE over {path_m} m, distance (mm)"), WITH_ORIENTATION, &|one| {
            Some(millimetres(of(one, false)?[0]))
        });
    }
}

fn add_significance(rows: &mut ErrorRows<'_>, angles: Angles) {
    rows.add("ground truth's σ (mm)", NO_SIGMA, &|one| {
        Some(millimetres(one.against_sigma?.sigma_m))
    });
    rows.add(&format!("ground truth's σ ({})", angles.unit), NO_SIGMA, &|one| {
        Some(angles.format(one.against_sigma?.sigma_rad?))
    });
    rows.add("error not significant", NO_SIGMA, &|one| {
        Some(format!("{:.0} % of poses", 100.0 * one.against_sigma?.undecided))
    });
    rows.add("ground truth's share of error²", NO_SIGMA, &|one| {
        Some(format!("up to {:.0} %", 100.0 * one.against_sigma?.of_truth))
    });
}
