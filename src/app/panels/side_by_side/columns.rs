//! Columns of the comparison as data: results of the open deployments, then the pinned results.

use crate::app::model::estimates::column;
use crate::app::model::units::with_sign;
use crate::app::model::{OpenDeployment, Pin, Units};
use crate::app::state::State;
use resect_core::deployment::ControlPointSet;
use resect_core::evaluation::Spread;
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_core::network::USUAL_STATIONS;
use resect_report::difference::{Deviation, ResultDifference};
use resect_report::summary::ResultSummary;

/// Stations that differ by more than this in plan belong to different set-ups (m).
const ELSEWHERE_M: f64 = 1.0;

pub struct Column<'a> {
    pub title: String,
    pub whose: Whose,
    /// The result, or the reason why there is none; `None` until it is computed.
    pub result: Option<Result<&'a ResultSummary, String>>,
    /// The control points themselves, if their deployment is open.
    sets: &'a [ControlPointSet],
}

/// The deployment or pin of a column, by id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    Open(u64),
    Pinned(u64),
}

/// A number of a column with its difference from the reference column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    pub text: String,
    pub difference: Option<Difference>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Difference with sign and unit.
    pub text: String,
    /// `None` without σ, and if the set-ups differ.
    pub sigmas: Option<f64>,
}

/// Returns all columns and the index of the reference column, which is the active deployment's.
pub fn columns(state: &State) -> (Vec<Column<'_>>, usize) {
    let open =
        state.deployments.open.iter().zip(state.names()).map(|(open, name)| of_open(open, name));
    let columns = open.chain(state.results.pins.iter().map(of_pin)).collect();
    let active = state.active().map(|open| open.id);
    let reference = state.deployments.open.iter().position(|open| Some(open.id) == active);
    (columns, reference.unwrap_or(0))
}

fn of_open(open: &OpenDeployment, title: String) -> Column<'_> {
    let result = open.analysis.as_ref().and_then(|analysis| match &analysis.answer {
        Ok(_) => open.summary.as_deref().map(Ok),
        Err(error) => Some(Err(error.finding().to_string())),
    });
    Column { title, whose: Whose::Open(open.id), result, sets: &open.deployment.control_points }
}

fn of_pin(pin: &Pin) -> Column<'_> {
    let title = format!("Pinned {}", pin.name);
    Column { title, whose: Whose::Pinned(pin.id), result: Some(Ok(&pin.summary)), sets: &[] }
}

impl<'a> Column<'a> {
    pub fn summary(&self) -> Option<&'a ResultSummary> {
        self.result.as_ref()?.as_ref().ok().copied()
    }

    /// Returns true if a file of control points contains the same points in both columns.
    fn has_same_points(&self, other: &Self, file: &str) -> bool {
        let same_data =
            self.summary().zip(other.summary()).is_some_and(|(a, b)| a.has_same_data(b));
        let set = |column: &Self| column.sets.iter().find(|set| set.file == file).cloned();
        same_data || set(self).zip(set(other)).is_some_and(|(a, b)| a == b)
    }
}

/// (x, y, z, yaw) of T12, then of T13, …, for each column.
pub fn transforms(columns: &[Column<'_>], reference: usize, units: Units) -> Vec<Vec<Cell>> {
    let against = columns.get(reference).and_then(Column::summary);
    let cells = |(index, column): (usize, &Column<'_>)| match column.summary() {
        None => {
            vec![Cell { text: "–".to_owned(), difference: None }; 4 * (stations(columns) - 1)]
        }
        Some(summary) => {
            let mut cells = of_summary(summary, against.filter(|_| index != reference), units);
            cells.resize_with(4 * (stations(columns) - 1), || Cell {
                text: "–".to_owned(),
                difference: None,
            });
            cells
        }
    };
    columns.iter().enumerate().map(cells).collect()
}

/// Returns the largest number of stations of a result.
pub fn stations(columns: &[Column<'_>]) -> usize {
    let each = columns.iter().filter_map(Column::summary).map(|summary| 1 + summary.stations.len());
    each.max().unwrap_or(USUAL_STATIONS)
}

/// Returns true if a result belongs to a set-up at another place, so that its difference is no error.
///
/// Compares in plan, because the mirror twin of a set-up differs in height only.
fn is_elsewhere(against: &ResultSummary, summary: &ResultSummary) -> bool {
    let apart = ResultDifference::between(against, summary).stations;
    let far = apart.iter().any(|station| {
        let [x, y, _] = station.translation_m;
        x.value.hypot(y.value) > ELSEWHERE_M
    });
    far && !against.has_same_data(summary)
}

/// Returns true if any column belongs to a set-up at another place than the reference column's.
pub fn any_elsewhere(columns: &[Column<'_>], reference: usize) -> bool {
    let against = columns.get(reference).and_then(Column::summary);
    let of = |summary| against.is_some_and(|against| is_elsewhere(against, summary));
    columns.iter().filter_map(Column::summary).any(of)
}

fn of_summary(summary: &ResultSummary, against: Option<&ResultSummary>, units: Units) -> Vec<Cell> {
    let numbers = summary.stations.iter().flat_map(|station| {
        let sigma = |place: usize| station.sigma.map(|sigma| sigma[place]);
        let axis = |axis: usize| units.length_estimate(station.translation_m[axis], sigma(axis));
        [axis(0), axis(1), axis(2), units.angle_estimate(station.yaw_rad(), sigma(3))]
    });
    let texts = column(&numbers.collect::<Vec<_>>());
    let differences = against.map(|against| {
        let difference = ResultDifference::between(against, summary);
        let both = |k: usize| against.stations[k].sigma.and(summary.stations[k].sigma).is_some();
        let is_elsewhere = is_elsewhere(against, summary);
        let of = |k: usize| {
            let station = &difference.stations[k];
            let told = |text: String, deviation: Deviation| Difference {
                text,
                sigmas: deviation.sigmas.filter(|_| both(k) && !is_elsewhere),
            };
            let length = |along: Deviation| {
                told(format!("{} mm", units.length_difference(along.value)), along)
            };
            let [x, y, z] = station.translation_m.map(length);
            let yaw = station.yaw_rad;
            [x, y, z, told(units.angle_difference_in_words(yaw.value), yaw)]
        };
        (0..difference.stations.len()).flat_map(of).collect::<Vec<_>>()
    });
    let mut differences = differences.into_iter().flatten();
    texts.into_iter().map(|text| Cell { text, difference: differences.next() }).collect()
}

/// An estimate other than the transforms, with one cell per column.
pub struct EstimateCells {
    pub subject: String,
    pub name: String,
    pub cells: Vec<Cell>,
}

/// Estimates other than the transforms that are significant in at least one column.
pub fn estimates(columns: &[Column<'_>], reference: usize, units: Units) -> Vec<EstimateCells> {
    let of =
        |index: usize| columns[index].summary().map_or(&[][..], |summary| &summary.estimates[..]);
    let mut numbers: Vec<&AnswerRow> = Vec::new();
    for row in (0..columns.len()).flat_map(of).filter(|row| row.is_significant) {
        if !numbers.iter().any(|known| known.is_same_number(row)) {
            numbers.push(row);
        }
    }
    let cells = |number: &AnswerRow| {
        let row = |index: usize| of(index).iter().find(|row| row.is_same_number(number));
        let against = row(reference);
        let cell = |index: usize| match row(index) {
            None => Cell { text: "–".to_owned(), difference: None },
            Some(own) => Cell {
                text: units.deviation(own).in_words(),
                difference: against.filter(|_| index != reference).map(|against| Difference {
                    text: units.difference(own, against),
                    sigmas: None,
                }),
            },
        };
        (0..columns.len()).map(cell).collect()
    };
    let with_cells = |number: &AnswerRow| EstimateCells {
        subject: number.subject.clone(),
        name: number.name.clone(),
        cells: cells(number),
    };
    numbers.into_iter().map(with_cells).collect()
}

/// The inter-prism metric of each column.
pub fn inter_prism(columns: &[Column<'_>], reference: usize) -> Vec<Cell> {
    let spread = |column: &Column<'_>| column.summary().and_then(|summary| summary.inter_prism_mm);
    let against = columns.get(reference).and_then(spread);
    let cell = |(index, column): (usize, &Column<'_>)| {
        spread_cell(spread(column), against.filter(|_| index != reference))
    };
    columns.iter().enumerate().map(cell).collect()
}

/// The control-point metric of a file.
pub struct PointsRow {
    /// File name without its folder.
    pub file: String,
    /// Title of the column with these points, if other points are in a file of the same name.
    pub whose: Option<String>,
    pub cells: Vec<Cell>,
}

/// The control-point metric by file. If a file's points differ between two columns, they have separate rows, because their numbers cannot
/// be compared.
pub fn control_points(columns: &[Column<'_>], reference: usize) -> Vec<PointsRow> {
    // Each row with the column that started it and the spread in each column.
    let mut rows: Vec<(String, usize, Vec<Option<Spread>>)> = Vec::new();
    for (index, column) in columns.iter().enumerate() {
        for metric in column.summary().into_iter().flat_map(|summary| &summary.control_points_mm) {
            let known = rows.iter_mut().find(|(file, first, _)| {
                *file == metric.file && columns[*first].has_same_points(column, file)
            });
            let spreads = match known {
                Some((_, _, spreads)) => spreads,
                None => {
                    rows.push((metric.file.clone(), index, vec![None; columns.len()]));
                    &mut rows.last_mut().expect("just pushed").2
                }
            };
            spreads[index] = Some(metric.spread);
        }
    }
    // Files from other folders have full paths.
    let short = |file: &str| file.rsplit(['/', '\\']).next().unwrap_or(file).to_owned();
    let names: Vec<String> = rows.iter().map(|(file, ..)| short(file)).collect();
    let of_row = |(row, (_, first, spreads)): (usize, (String, usize, Vec<Option<Spread>>))| {
        let file = names[row].clone();
        let several = names.iter().filter(|name| **name == file).count() > 1;
        let whose = several.then(|| columns[first].title.clone());
        let cell = |(index, spread): (usize, &Option<Spread>)| {
            // A file that grew has the same name and other points.
            let same = |against: &Spread| spread.is_some_and(|own| own.n == against.n);
            spread_cell(*spread, spreads[reference].filter(same).filter(|_| index != reference))
        };
        let cells = spreads.iter().enumerate().map(cell).collect();
        PointsRow { file, whose, cells }
    };
    rows.into_iter().enumerate().map(of_row).collect()
}

fn spread_cell(spread: Option<Spread>, against: Option<Spread>) -> Cell {
    let Some(own) = spread else { return Cell { text: "–".to_owned(), difference: None } };
    let text = format!("{:.2} / {:.2}", own.median, own.iqr);
    let difference = against.map(|against| Difference {
        text: format!("{} mm", with_sign(own.median - against.median, 2)),
        sigmas: None,
    });
    Cell { text, difference }
}
