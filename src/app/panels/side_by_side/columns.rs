//! What stands side by side, as data: the answers of the open deployments, then the pinned results.

use crate::app::model::estimates::column;
use crate::app::model::units::with_sign;
use crate::app::model::{OpenDeployment, Pin, Units};
use crate::app::state::State;
use resect_core::deployment::ControlPointSet;
use resect_core::evaluation::Spread;
use resect_core::evaluation::answer_rows::AnswerRow;
use resect_report::difference::{Deviation, ResultDifference};
use resect_report::summary::ResultSummary;

/// Stations of other readings that stand farther apart in plan than this were set up elsewhere (m).
const ELSEWHERE_M: f64 = 1.0;

pub struct Column<'a> {
    pub title: String,
    pub whose: Whose,
    /// The result, or why there is none; `None` until it is there.
    pub result: Option<Result<&'a ResultSummary, String>>,
    /// The points themselves, where they are open.
    sets: &'a [ControlPointSet],
}

/// Whose result a column shows, by its id.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Whose {
    Open(u64),
    Pinned(u64),
}

/// A number of one column, and how it differs from that of the column that the others are held against.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Cell {
    pub text: String,
    pub difference: Option<Difference>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// With its sign and unit.
    pub text: String,
    /// None also where the stations were set up elsewhere.
    pub sigmas: Option<f64>,
}

/// All columns, and the place of the one that the others are held against: the active deployment's.
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

    /// Whether a file of control points holds the same points in both.
    fn has_same_points(&self, other: &Self, file: &str) -> bool {
        let same_data =
            self.summary().zip(other.summary()).is_some_and(|(a, b)| a.has_same_data(b));
        let set = |column: &Self| column.sets.iter().find(|set| set.file == file).cloned();
        same_data || set(self).zip(set(other)).is_some_and(|(a, b)| a == b)
    }
}

/// (x, y, z, yaw) of T12, then of T13, of each column.
pub fn transforms(columns: &[Column<'_>], reference: usize, units: Units) -> Vec<Vec<Cell>> {
    let against = columns.get(reference).and_then(Column::summary);
    let cells = |(index, column): (usize, &Column<'_>)| match column.summary() {
        None => vec![Cell { text: "–".to_owned(), difference: None }; 8],
        Some(summary) => of_summary(summary, against.filter(|_| index != reference), units),
    };
    columns.iter().enumerate().map(cells).collect()
}

/// Whether a result is of a set-up at another place, so that how it differs is no error of either.
///
/// In plan, because the mirror twin of one set-up differs in height only.
fn is_elsewhere(against: &ResultSummary, summary: &ResultSummary) -> bool {
    let apart = ResultDifference::between(against, summary).stations;
    let far = apart.iter().any(|station| {
        let [x, y, _] = station.translation_m;
        x.value.hypot(y.value) > ELSEWHERE_M
    });
    far && !against.has_same_data(summary)
}

/// Whether any column is of a set-up at another place than the one that the others are held against.
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
            let station = difference.stations[k];
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
        [of(0), of(1)].concat()
    });
    let mut differences = differences.into_iter().flatten();
    texts.into_iter().map(|text| Cell { text, difference: differences.next() }).collect()
}

/// An estimate beside the transforms, with a cell of each column.
pub struct EstimateCells {
    pub subject: String,
    pub name: String,
    pub cells: Vec<Cell>,
}

/// The estimates beside the transforms that are significant in one of the columns.
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
    /// Without its folder.
    pub file: String,
    /// Whose points they are, where other points are in a file of the same name.
    pub whose: Option<String>,
    pub cells: Vec<Cell>,
}

/// The control-point metric by file. Points of one file that are not the same in two columns stand in two rows: their
/// numbers cannot be compared.
pub fn control_points(columns: &[Column<'_>], reference: usize) -> Vec<PointsRow> {
    // The column that a row began with, and the spreads in it.
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
    // Files from elsewhere have their whole path.
    let short = |file: &str| file.rsplit(['/', '\\']).next().unwrap_or(file).to_owned();
    let names: Vec<String> = rows.iter().map(|(file, ..)| short(file)).collect();
    let of_row = |(row, (_, first, spreads)): (usize, (String, usize, Vec<Option<Spread>>))| {
        let file = names[row].clone();
        let several = names.iter().filter(|name| **name == file).count() > 1;
        let whose = several.then(|| columns[first].title.clone());
        let cell = |(index, spread): (usize, &Option<Spread>)| {
            // A file that grew since is of the same name and other points.
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
