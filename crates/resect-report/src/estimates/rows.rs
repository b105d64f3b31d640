//! The table of errors: a row for each number, a column for each estimate.

use std::borrow::Cow;

use resect_tools::estimates::metrics::{Ape, RelativeErrors};
use resect_tools::estimates::{
    Body, Coverage, Delta, EstimatesJudgement, Judged, NoMotions, RelativeOptions,
};

/// Larger lengths are given in metres (m): frames that differ by map coordinates.
const LARGEST_IN_MM_M: f64 = 1e3;

/// Reasons of empty cells.
const SPARSER: &str = "the poses of the other trajectory are counted, because it is sparser";
const LEVER_NOT_ESTIMATED: &str = "the body is given, or orientations are missing";
const SCALE_NOT_ESTIMATED: &str = "the alignment estimates no scale";
pub const NO_ORIENTATION: &str = "the estimate or the ground truth has no orientations";
const ONLY_DISTANCE: &str =
    "the estimate or the ground truth has no orientations; the error of the distance replaces it";
const WITH_ORIENTATION: &str = "with orientations, the errors in mm and of rotation replace it";
const NO_SIGMA_OF_ROTATION: &str = "the ground truth states no σ of rotations at its poses";
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
    /// The same without σ of errors.
    pub values: Vec<String>,
    /// The reason of each empty cell; nothing for the others.
    pub why_empty: Vec<String>,
}

/// Text of a cell without a value.
pub const EMPTY: &str = "–";

/// A value, or the reason why there is none.
type Cell = Result<String, Cow<'static, str>>;

/// Size of errors, or the reason why there is none.
type ErrorCell = Result<Ape, Cow<'static, str>>;

/// Rows so far.
struct ErrorRows<'a> {
    judgement: &'a EstimatesJudgement,
    rows: Vec<ErrorRow>,
}

impl ErrorRows<'_> {
    /// Adds a row.
    fn add(&mut self, label: &str, cell: &dyn Fn(&Judged) -> Cell) {
        let cells: Vec<Cell> = self.judgement.judged.iter().map(cell).collect();
        let why = |cell: &Cell| cell.as_ref().err().map(ToString::to_string).unwrap_or_default();
        let why_empty = cells.iter().map(why).collect();
        let cells: Vec<String> =
            cells.into_iter().map(|cell| cell.unwrap_or(EMPTY.into())).collect();
        self.rows.push(ErrorRow {
            label: label.to_owned(),
            why_empty,
            values: cells.clone(),
            cells,
        });
    }

    /// Adds a row of root mean square errors with the σ that clock, lever arm and body give them.
    fn add_rmse(
        &mut self,
        label: &str,
        formatted: &dyn Fn(f64) -> String,
        error: &dyn Fn(&Judged) -> ErrorCell,
    ) {
        self.add(label, &|judged| Ok(formatted(error(judged)?.rmse)));
        let Some(row) = self.rows.last_mut() else { return };
        for (cell, judged) in row.cells.iter_mut().zip(&self.judgement.judged) {
            if let Some(sigma) = error(judged).ok().and_then(|ape| ape.rmse_sigma) {
                // Rounded up, because nothing is known exactly.
                let digits = formatted(sigma);
                let is_zero = digits.chars().all(|digit| matches!(digit, '0' | '.'));
                let digits =
                    if is_zero { digits[..digits.len() - 1].to_owned() + "1" } else { digits };
                *cell += &format!(" ± {digits}");
            }
        }
    }

    /// Adds a row that not every comparison has, unless all its cells are empty.
    fn add_if_any(
        &mut self,
        label: &str,
        why_empty: &'static str,
        cell: &dyn Fn(&Judged) -> Option<String>,
    ) {
        if self.judgement.judged.iter().any(|judged| cell(judged).is_some()) {
            self.add(label, &|judged| cell(judged).ok_or(why_empty.into()));
        }
    }
}

/// Returns the rows. Only those are left out that other options would have, such as the scale of a rigid alignment.
pub fn rows(judgement: &EstimatesJudgement, angles: Angles) -> Vec<ErrorRow> {
    let mut rows = ErrorRows { judgement, rows: Vec::new() };
    add_coverage(&mut rows);
    add_fit(&mut rows);
    add_absolute_errors(&mut rows, angles);
    add_relative_errors(&mut rows, angles);
    add_significance(&mut rows, angles);
    rows.rows
}

/// Returns a line for each reason of empty cells: "– of vio in APE rotation, rmse (°): …", without names if it is that of all.
pub fn why_empty(rows: &[ErrorRow], names: &[&str]) -> Vec<String> {
    let mut by_reason: Vec<(String, &str, Vec<usize>)> = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let mut reasons: Vec<&str> =
            row.why_empty.iter().map(|why| &**why).filter(|why| !why.is_empty()).collect();
        reasons.sort_unstable();
        reasons.dedup();
        for reason in reasons {
            let of_reason = names.iter().zip(&row.why_empty).filter(|(_, why)| *why == reason);
            let of_reason: Vec<&str> = of_reason.map(|(name, _)| *name).collect();
            let estimates = match of_reason.len() == names.len() {
                true => String::new(),
                false => format!(" of {}", of_reason.join(", ")),
            };
            let known =
                by_reason.iter_mut().find(|(of, why, _)| *of == estimates && *why == reason);
            match known {
                Some((.., indices)) => indices.push(index),
                None => by_reason.push((estimates, reason, vec![index])),
            }
        }
    }
    let line = |(estimates, reason, indices): (String, &str, Vec<usize>)| {
        let runs: Vec<String> =
            indices.chunk_by(|a, b| a + 1 == *b).map(|run| in_words(rows, run)).collect();
        format!("{EMPTY}{estimates} in {}: {reason}", runs.join("; "))
    };
    by_reason.into_iter().map(line).collect()
}

/// Names consecutive rows.
fn in_words(rows: &[ErrorRow], run: &[usize]) -> String {
    match run {
        [first, .., last] => format!("{} to {}", rows[*first].label, rows[*last].label),
        [only] => rows[*only].label.clone(),
        [] => String::new(),
    }
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
    rows.add_if_any("poses with ground truth", SPARSER, &counted(true, false));
    rows.add_if_any("poses without", SPARSER, &counted(true, true));
    rows.add_if_any("ground-truth points with a pose", SPARSER, &counted(false, false));
    rows.add_if_any("ground-truth points without", SPARSER, &counted(false, true));
}

fn add_fit(rows: &mut ErrorRows<'_>) {
    // This row is only needed if the alignments differ.
    let judged = &rows.judgement.judged;
    let is_one_way = judged.windows(2).all(|two| two[0].alignment == two[1].alignment);
    rows.add_if_any("aligned by", "", &|one| {
        (!is_one_way).then(|| one.alignment.in_words().to_owned())
    });
    let with_sigma = |value: f64, sigma: Option<f64>| {
        // Never ± 0.0.
        let digits = if sigma.is_some_and(|sigma| 1e3 * sigma < 0.95) { 2 } else { 1 };
        let sigma = sigma.map(|sigma| format!(" ± {:.digits$}", 1e3 * sigma));
        format!("{:+.digits$}{}", 1e3 * value, sigma.unwrap_or(" given".into()))
    };
    rows.add("time offset (ms)", &|one| {
        Ok(match one.fit.determines_time_offset {
            true => with_sigma(one.fit.time_offset_s, one.fit.time_offset_sigma_s),
            false => "not determined".to_owned(),
        })
    });
    for (axis, name) in ["x", "y", "z"].iter().enumerate() {
        rows.add(&format!("lever arm, {name} (mm)"), &|one| {
            let lever_m = one.fit.lever_arm_m.ok_or(LEVER_NOT_ESTIMATED)?;
            if !one.fit.determines_lever_arm(axis) {
                return Ok("not determined".to_owned());
            }
            Ok(with_sigma(lever_m[axis], one.fit.lever_arm_sigma_m.map(|sigma| sigma[axis])))
        });
    }
    for (axis, name) in ["roll", "pitch", "yaw"].iter().enumerate() {
        rows.add_if_any(&format!("body, {name} (°)"), NO_ORIENTATION, &|one| {
            let [value, sigma] = one
                .fit
                .body_angles_rad()
                .map(|angles| [angles[axis].value, angles[axis].sigma].map(f64::to_degrees))?;
            let sigma = match (sigma > 0.0, one.options.body) {
                (true, _) => format!(" ± {sigma:.3}"),
                (false, Body::Same) => " given".to_owned(),
                (false, Body::Found | Body::Lever(_)) => " (mean)".to_owned(),
            };
            Some(format!("{value:+.3}{sigma}"))
        });
    }
    rows.add_if_any("scale", SCALE_NOT_ESTIMATED, &|one| {
        let sigma = one.fit.estimated_scale.map(|scale| format!(" ± {:.5}", scale.sigma.max(1e-5)));
        let sigma = sigma.unwrap_or_default();
        (one.fit.scale != 1.0).then(|| format!("{:.5}{sigma}", one.fit.scale))
    });
}

fn add_absolute_errors(rows: &mut ErrorRows<'_>, angles: Angles) {
    rows.add_rmse("APE position, rmse (mm)", &millimetres, &|judged| Ok(judged.position));
    for name in ["mean", "median", "std", "min", "max"] {
        rows.add(&format!("APE position, {name} (mm)"), &|judged| {
            let ape = &judged.position;
            Ok(millimetres(match name {
                "mean" => ape.mean,
                "median" => ape.median,
                "std" => ape.std,
                "min" => ape.min,
                _ => ape.max,
            }))
        });
    }
    rows.add("APE aligned at the first pose, rmse (mm)", &|judged| {
        Ok(millimetres(judged.unaligned.at_first_pose.ok_or(NO_ORIENTATION)?.rmse))
    });
    rows.add("APE not aligned, rmse (mm)", &|judged| {
        Ok(millimetres(judged.unaligned.in_own_frame.rmse))
    });
    let formatted = |angle_rad| angles.format(angle_rad);
    rows.add_rmse(&format!("APE rotation, rmse ({})", angles.unit), &formatted, &|judged| {
        Ok(judged.rotation.ok_or(NO_ORIENTATION)?)
    });
}

/// Adds the relative errors of each motion. Of the usual ones only those are shown that are conclusive; the JSON has the others
/// too, with their count.
fn add_relative_errors(rows: &mut ErrorRows<'_>, angles: Angles) {
    let RelativeOptions { deltas, all_pairs } = &rows.judgement.motions;
    let are_usual = *deltas == RelativeOptions::default().deltas;
    let pairs = if *all_pairs { ", all pairs" } else { "" };
    for (index, delta) in deltas.iter().enumerate() {
        let errors = |judged: &Judged| -> Result<RelativeErrors, Cow<'static, str>> {
            let errors = judged.relative[index].clone();
            let errors = errors.map_err(|(_, why): (Delta, NoMotions)| why.to_string())?;
            match errors.why_inconclusive().filter(|_| are_usual) {
                Some(why) => Err(why.into()),
                None => Ok(errors),
            }
        };
        let has_pose = |judged: &Judged| judged.rotation.is_some();
        let has_poses = rows.judgement.judged.iter().any(has_pose);
        let label = format!("RPE over {delta}{pairs}");
        if has_poses {
            rows.add_rmse(&format!("{label}, rmse (mm)"), &millimetres, &|judged| {
                judged.rotation.ok_or(ONLY_DISTANCE)?;
                Ok(errors(judged)?.position)
            });
        }
        let formatted = |angle_rad| angles.format(angle_rad);
        rows.add_rmse(&format!("{label}, rmse ({})", angles.unit), &formatted, &|judged| {
            judged.rotation.ok_or(NO_ORIENTATION)?;
            Ok(errors(judged)?.rotation.ok_or(NO_ORIENTATION)?)
        });
        if !rows.judgement.judged.iter().all(has_pose) {
            let label = format!("{label}, distance (mm)");
            rows.add_rmse(&label, &millimetres, &|judged| match has_pose(judged) {
                true => Err(WITH_ORIENTATION.into()),
                false => Ok(errors(judged)?.position),
            });
        }
    }
}

fn add_significance(rows: &mut ErrorRows<'_>, angles: Angles) {
    rows.add("ground truth's σ (mm)", &|judged| {
        Ok(millimetres(judged.against_sigma.ok_or(NO_SIGMA)?.sigma_m))
    });
    rows.add(&format!("ground truth's σ ({})", angles.unit), &|judged| {
        let sigma_rad = judged.against_sigma.ok_or(NO_SIGMA)?.sigma_rad;
        Ok(angles.format(sigma_rad.ok_or(NO_SIGMA_OF_ROTATION)?))
    });
    rows.add("error not significant", &|judged| {
        Ok(format!("{:.0} % of poses", 100.0 * judged.against_sigma.ok_or(NO_SIGMA)?.undecided))
    });
    rows.add("ground truth's share of error²", &|judged| {
        Ok(format!("up to {:.0} %", 100.0 * judged.against_sigma.ok_or(NO_SIGMA)?.of_truth))
    });
}
