//! Errors of several drives: a table with a row for each drive and estimate, boxes, and JSON.

use std::fmt::Write;

use serde_json::{Value, json};

use super::json::json as judgement_json;
use super::latex::escaped;
use super::rows::{Angles, EMPTY, ErrorRow, rows};
use crate::json::SCHEMA;
use resect_core::analysis::Settings;
use resect_tools::estimates::{EstimatesJudgement, GroundTruth, Judged};
use resect_tools::experiment::{Group, Quantiles, Series, Study};
use resect_tools::palette;

/// Errors of the estimates of one drive.
pub struct DriveErrors {
    name: String,
    rows: Vec<DriveRow>,
    evaluation: Option<Value>,
}

/// Label of a number, and the number or the reason why there is none.
type LabelledCell = (String, Result<String, String>);

/// Errors of one estimate in one drive.
struct DriveRow {
    estimate: String,
    /// The cell of each column, or the reason why it is empty; the reason why there are no errors.
    cells: Result<Vec<LabelledCell>, String>,
    /// All rows of the estimate's own table.
    numbers: Vec<DriveNumber>,
    /// Position errors (mm); `None` without any.
    errors_mm: Option<Quantiles>,
}

/// A number of an estimate's own table, or the reason why there is none.
struct DriveNumber {
    label: String,
    /// With its σ, as in the table.
    cell: String,
    why_empty: String,
}

/// Rows of an estimate's table that are columns here.
const COLUMNS: [&str; 5] =
    ["APE position, rmse", "APE position, median", "APE position, max", "APE rotation", "RPE"];
/// Reasons of cells that the drive's own table does not have.
const NO_DISTANCE: &str = "with orientations, the errors in mm and of rotation replace it";
const NO_POSE: &str =
    "the estimate or the ground truth has no orientations; the error of the distance replaces it";

impl DriveErrors {
    pub fn new(name: &str) -> Self {
        Self { name: name.to_owned(), rows: Vec::new(), evaluation: None }
    }

    /// Adds all estimates of a judgement, also those that could not be judged.
    pub fn add(&mut self, truth: &GroundTruth<'_>, judgement: &EstimatesJudgement) {
        let table = rows(judgement, Angles::DEGREES);
        let shown = || table.iter().filter(|row| COLUMNS.iter().any(|c| row.label.starts_with(c)));
        for (index, judged) in judgement.judged.iter().enumerate() {
            let cell = |row: &ErrorRow| {
                let cell = match row.why_empty[index].is_empty() {
                    true => Ok(row.values[index].clone()),
                    false => Err(row.why_empty[index].clone()),
                };
                (column(&row.label), cell)
            };
            self.rows.push(DriveRow {
                estimate: judged.estimate.name.clone(),
                cells: Ok(shown().map(cell).collect()),
                numbers: table.iter().map(|row| DriveNumber::of(row, index)).collect(),
                errors_mm: errors_mm(judged),
            });
        }
        for (name, why) in &judgement.unjudged {
            self.fail(std::slice::from_ref(name), &why.to_string());
        }
        self.evaluation = Some(judgement_json(truth, judgement));
    }

    /// Returns true if any of the estimates has errors.
    pub fn has_errors(&self) -> bool {
        self.rows.iter().any(|row| row.cells.is_ok())
    }

    /// Adds estimates without errors.
    pub fn fail(&mut self, estimates: &[String], why: &str) {
        self.rows.extend(estimates.iter().map(|estimate| DriveRow {
            estimate: estimate.clone(),
            cells: Err(why.to_owned()),
            numbers: Vec::new(),
            errors_mm: None,
        }));
    }
}

impl DriveNumber {
    fn of(row: &ErrorRow, index: usize) -> Self {
        Self {
            label: row.label.trim().to_owned(),
            cell: row.cells[index].clone(),
            why_empty: row.why_empty[index].clone(),
        }
    }

    /// Returns the number and its σ; empty without them.
    fn value_and_sigma(&self) -> [&str; 2] {
        if !self.why_empty.is_empty() {
            return ["", ""];
        }
        let (value, sigma) = self.cell.split_once(" ± ").unwrap_or((&self.cell, ""));
        [value, sigma].map(|text| if text.parse::<f64>().is_ok() { text } else { "" })
    }
}

fn errors_mm(judged: &Judged) -> Option<Quantiles> {
    Quantiles::of(judged.errors.iter().map(|error| 1e3 * error.position_m.norm()))
}

/// Returns the short name of a column, with its unit behind a line break.
fn column(label: &str) -> String {
    let short = label.replace("APE position, ", "APE ").replace("APE rotation, ", "APE ");
    let short = short.replace("RPE over ", "RPE ").replace(", rmse (", " (");
    short.replace(" (", "\n").trim_end_matches(')').to_owned()
}

/// Formats a row for each drive and estimate; below are the reasons of empty cells.
pub fn drives_text(drives: &[DriveErrors]) -> String {
    let all = || drives.iter().flat_map(|drive| drive.rows.iter().map(move |row| (drive, row)));
    let columns = columns_of(drives);
    let mut lines: Vec<Vec<String>> = [0, 1]
        .map(|line| {
            let heads = [["drive", "estimate"], ["", ""]][line].map(str::to_owned).into_iter();
            let heading = |label: &&String| label.split('\n').nth(line).unwrap_or("").to_owned();
            heads.chain(columns.iter().map(heading)).collect()
        })
        .to_vec();
    let mut reasons: Vec<(String, Vec<String>)> = Vec::new();
    for (drive, row) in all() {
        let mut line = vec![drive.name.clone(), row.estimate.clone()];
        let mut empty: Vec<(&str, Vec<String>)> = Vec::new();
        for label in &columns {
            let cell = match &row.cells {
                Ok(cells) => match cells.iter().find(|(of_cell, _)| of_cell == *label) {
                    Some((_, cell)) => cell.as_deref().map_err(String::as_str),
                    None if label.contains("distance") => Err(NO_DISTANCE),
                    None => Err(NO_POSE),
                },
                Err(why) => Err(&**why),
            };
            if let Err(why) = cell {
                let label = label.replace('\n', " (") + ")";
                match empty.iter_mut().find(|(known, _)| *known == why) {
                    Some((_, labels)) => labels.push(label),
                    None => empty.push((why, vec![label])),
                }
            }
            line.push(cell.unwrap_or(EMPTY).to_owned());
        }
        if let Err(why) = &row.cells {
            empty = vec![(why, Vec::new())];
        }
        lines.push(line);
        for (why, labels) in empty {
            let cells = match &labels[..] {
                [] => String::new(),
                labels => format!(" in {}", labels.join(", ")),
            };
            let name = format!("{}, {}", drive.name, row.estimate);
            let key = format!("{cells}: {why}");
            match reasons.iter_mut().find(|(known, _)| *known == key) {
                Some((_, names)) => names.push(name),
                None => reasons.push((key, vec![name])),
            }
        }
    }
    let mut text = aligned(&lines);
    for (key, names) in reasons {
        _ = writeln!(text, "{EMPTY} of {}{key}", names.join("; "));
    }
    text
}

/// Returns the columns of all drives.
fn columns_of(drives: &[DriveErrors]) -> Vec<&String> {
    let mut columns: Vec<&String> = Vec::new();
    let rows = drives.iter().flat_map(|drive| &drive.rows);
    for (label, _) in rows.filter_map(|row| row.cells.as_ref().ok()).flatten() {
        if !columns.contains(&label) {
            columns.push(label);
        }
    }
    in_order(&columns)
}

/// Formats a line for each number of each estimate and drive: value, σ, and the reason why it is empty.
pub fn drives_csv(drives: &[DriveErrors]) -> String {
    let quoted = |text: &str| format!("\"{}\"", text.replace('"', "\"\""));
    let mut text = "drive,estimate,quantity,value,sigma,why_empty\n".to_owned();
    for (drive, row) in
        drives.iter().flat_map(|drive| drive.rows.iter().map(move |row| (drive, row)))
    {
        let names = format!("{},{}", quoted(&drive.name), quoted(&row.estimate));
        if let Err(why) = &row.cells {
            _ = writeln!(text, "{names},,,,{}", quoted(why));
        }
        for number in &row.numbers {
            let [value, sigma] = number.value_and_sigma();
            let why = match (value.is_empty(), number.why_empty.is_empty()) {
                (false, _) => String::new(),
                (true, true) => quoted(&number.cell),
                (true, false) => quoted(&number.why_empty),
            };
            _ = writeln!(text, "{names},{},{value},{sigma},{why}", quoted(&number.label));
        }
    }
    text
}

/// Formats the table for LaTeX, with σ (package `booktabs`).
pub fn drives_latex(drives: &[DriveErrors]) -> String {
    let columns = columns_of(drives);
    let heads = columns.iter().map(|label| escaped(&(label.replace('\n', " (") + ")")));
    let mut text = format!("\\begin{{tabular}}{{ll{}}}\n\\toprule\n", "r".repeat(columns.len()));
    let heads: Vec<String> =
        ["drive", "estimate"].map(str::to_owned).into_iter().chain(heads).collect();
    _ = writeln!(text, "{} \\\\\n\\midrule", heads.join(" & "));
    for (drive, row) in
        drives.iter().flat_map(|drive| drive.rows.iter().map(move |row| (drive, row)))
    {
        let cell = |label: &&String| {
            let number = row.numbers.iter().find(|number| column(&number.label) == **label);
            number.map_or_else(|| escaped(EMPTY), |number| escaped(&number.cell))
        };
        let names = [&drive.name, &row.estimate].map(|name| escaped(name));
        let cells: Vec<String> = names.into_iter().chain(columns.iter().map(cell)).collect();
        _ = writeln!(text, "{} \\\\", cells.join(" & "));
    }
    text + "\\bottomrule\n\\end{tabular}\n"
}

/// Returns columns of one error side by side, also if the first drive does not have all of them: mm, °, distance.
fn in_order<'a>(columns: &[&'a String]) -> Vec<&'a String> {
    let error = |label: &str| label.split(['\n', ',']).next().unwrap_or_default().to_owned();
    let first = |label: &str| columns.iter().position(|column| error(column) == error(label));
    let rank = |label: &str| (label.contains("distance"), label.ends_with('°'));
    let mut ordered = columns.to_vec();
    ordered.sort_by_key(|label| (first(label), rank(label)));
    ordered
}

/// Formats a table: the first two columns begin at their left ends, the others end at their right ends.
fn aligned(lines: &[Vec<String>]) -> String {
    let count = lines.first().map_or(0, Vec::len);
    let width = |column: usize| lines.iter().map(|line| line[column].chars().count()).max();
    let widths: Vec<usize> = (0..count).map(|column| width(column).unwrap_or(0)).collect();
    let mut text = String::new();
    for line in lines {
        let cells =
            line.iter().zip(&widths).enumerate().map(|(column, (cell, &width))| match column {
                0 | 1 => format!("{cell:<width$}  "),
                _ => format!("{cell:>width$}  "),
            });
        _ = writeln!(text, "{}", cells.collect::<String>().trim_end());
    }
    text
}

/// Returns the position errors as boxes: a group for each drive, a series for each estimate.
pub fn drives_study(drives: &[DriveErrors]) -> Study {
    let mut names: Vec<&String> = Vec::new();
    for row in drives.iter().flat_map(|drive| &drive.rows) {
        if !names.contains(&&row.estimate) {
            names.push(&row.estimate);
        }
    }
    let group = |drive: &DriveErrors| {
        let quantiles = |name: &&String| {
            let row = drive.rows.iter().find(|row| row.estimate == **name);
            let row = row.ok_or("not in this drive")?;
            row.errors_mm.ok_or_else(|| "not evaluated".to_owned())
        };
        let boxes = names.iter().map(quantiles).collect();
        Group { label: drive.name.clone(), note: String::new(), boxes }
    };
    let series = names
        .iter()
        .enumerate()
        .map(|(index, name)| Series { name: (*name).clone(), rgb: palette::estimate(index) });
    Study {
        name: "drives".to_owned(),
        title: "Position errors of the estimates".to_owned(),
        subtitle: "each against the ground truth of its drive".to_owned(),
        value_label: "position error (mm)".to_owned(),
        group_label: String::new(),
        series: series.collect(),
        groups: drives.iter().map(group).collect(),
        levels: Vec::new(),
        findings: Vec::new(),
        settings: Settings::default(),
    }
}

/// Returns the evaluation of each drive, and the reasons of estimates without errors.
pub fn drives_json(drives: &[DriveErrors]) -> Value {
    let drive = |drive: &DriveErrors| {
        let failed = drive.rows.iter().filter_map(|row| Some((row, row.cells.as_ref().err()?)));
        let failed = failed.map(|(row, why)| json!({"name": row.estimate, "why": why}));
        json!({
            "name": drive.name,
            "evaluation": drive.evaluation,
            "failed": failed.collect::<Vec<Value>>(),
        })
    };
    json!({"schema": SCHEMA, "drives": drives.iter().map(drive).collect::<Vec<Value>>()})
}
