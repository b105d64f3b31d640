//! Rows of an answer as the cells of a table.

use nalgebra::{Dim, Matrix, RawStorage};
use resect_core::calibration::Quantity;
use resect_core::calibration::joint::reliability::GroupReliability;
use resect_core::deployment::ControlPointSet;
use resect_core::evaluation::answer_rows::AnswerRow;
pub use resect_core::statistics::estimate::decimals_of;

/// Rows as a table: a line for each name, a column for each subject.
pub struct Pivot<'a> {
    pub subjects: Vec<&'a str>,
    pub lines: Vec<PivotLine<'a>>,
}

/// The same number for each subject; `None` for subjects without it.
pub struct PivotLine<'a> {
    pub name: &'a str,
    pub quantity: Quantity,
    pub cells: Vec<Option<&'a AnswerRow>>,
}

/// Arranges rows by name and subject, both in the order in which they occur.
pub fn pivot<'a>(rows: impl IntoIterator<Item = &'a AnswerRow>) -> Pivot<'a> {
    let rows: Vec<&AnswerRow> = rows.into_iter().collect();
    let mut subjects: Vec<&str> = Vec::new();
    for row in &rows {
        if !subjects.contains(&row.subject.as_str()) {
            subjects.push(&row.subject);
        }
    }
    let mut lines: Vec<PivotLine> = Vec::new();
    for row in rows {
        let column = subjects.iter().position(|subject| *subject == row.subject);
        let line = match lines.iter_mut().position(|line| line.name == row.name) {
            Some(line) => &mut lines[line],
            None => {
                let cells = vec![None; subjects.len()];
                lines.push(PivotLine { name: &row.name, quantity: row.quantity, cells });
                lines.last_mut().expect("just added")
            }
        };
        if let Some(column) = column {
            line.cells[column] = Some(row);
        }
    }
    Pivot { subjects, lines }
}

/// Formats the deviation from the reference with σ, in the unit of small errors: "+0.12 ± 0.34".
pub fn deviation(row: &AnswerRow) -> String {
    let (scale, _) = row.quantity.told();
    let value = row.deviation() * scale;
    let Some(sigma) = row.sigma.map(|sigma| sigma * scale) else { return signed(value, 2) };
    let decimals = decimals_of(sigma).unwrap_or(1);
    format!("{} ± {sigma:.decimals$}", signed(value, decimals))
}

/// Formats the standard deviation before the drive, in the same unit; a dash without one.
pub fn prior(row: &AnswerRow) -> String {
    let (scale, _) = row.quantity.told();
    row.prior
        .map(|prior| prior * scale)
        .map_or("–".to_owned(), |prior| format!("{prior:.*}", decimals_of(prior).unwrap_or(1)))
}

/// Returns the control point with the largest normalised residual of a group: "point 7 of GCP.txt".
pub fn largest_residual(sets: &[ControlPointSet], group: &GroupReliability) -> Option<String> {
    let (set, point) = group.largest_at()?;
    let set = sets.get(set)?;
    Some(format!("point {} of {}", set.points.get(point)?.marker, set.file))
}

/// Formats a number with its sign; zero has none.
pub fn signed(value: f64, decimals: usize) -> String {
    let text = format!("{value:+.decimals$}");
    if text.bytes().all(|byte| !matches!(byte, b'1'..=b'9')) { text[1..].to_owned() } else { text }
}

/// Returns the rows of a matrix.
pub fn of_matrix<D: Dim>(matrix: &Matrix<f64, D, D, impl RawStorage<f64, D, D>>) -> Vec<Vec<f64>> {
    (0..matrix.nrows()).map(|row| matrix.row(row).iter().copied().collect()).collect()
}
