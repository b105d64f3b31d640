//! Tests of a survey for errors of a station that its adjustment has no unknowns for.
//!
//! Residuals of single readings do not show them well, because the markers and the other stations follow. So the equations get a column
//! for each parameter of such an error, at the solution. Elimination of all unknowns leaves the information Ω about it, and the gradient. With the variance Q that
//! settling allows, the estimate has the precision `(Ω⁻¹ + Q)⁻¹`, and its χ² is compared with the largest of as many tests by
//! chance (a score test: Rao 1948).

use nalgebra::DMatrix;

use super::step_fit::fit;
use super::survey::{RangesTest, SurveyConflict, SurveyTests};
use super::survey_adjustment::Adjustment;
use super::survey_markers::Observed;
use super::tested_error::TestedError;
use crate::calibration::{ErrorSizes, Estimate};
use crate::network::{Number, Station};
use crate::statistics::tables::{largest_chi_square_of_4, largest_normal, student_sigmas};

/// Fewest markers of a set by which a station's pose is tested.
const FEWEST_MARKERS: usize = 3;
/// Largest offset of ranges, and largest displacement and rotation of a station, that are fitted (m, rad).
const MOST: f64 = 1.0;

/// Tests the survey at its solution.
pub fn tests(adjustment: &mut Adjustment, sizes: &ErrorSizes) -> SurveyTests {
    adjustment.tested = tested_errors(adjustment);
    let fits = fits(adjustment, sizes).unwrap_or_default();
    let tested = std::mem::take(&mut adjustment.tested);
    let count =
        |parameters: usize| tested.iter().filter(|error| error.parameters() == parameters).count();
    let numbers = adjustment.noise_numbers;
    let critical_sigmas = student_sigmas(largest_normal(count(1)), numbers.x - 1.0);
    let critical_square = largest_chi_square_of_4(count(4), numbers.min() - 4.0);
    let excess = |fit: &ErrorFit| match fit.error {
        TestedError::Ranges(_) => fit.by_the_rest(1.0, numbers.x) / critical_sigmas.powi(2),
        TestedError::Pose(..) => fit.by_the_rest(4.0, numbers.min()) / critical_square,
    };
    let significant = fits.iter().filter(|fit| excess(fit) > 1.0);
    let largest = significant.max_by(|a, b| excess(a).total_cmp(&excess(b)));
    let conflict = largest.map(|ErrorFit { error, size, .. }| match *error {
        TestedError::Ranges(station) => SurveyConflict::Ranges { station, excess_m: size[0] },
        TestedError::Pose(station, set) => SurveyConflict::Moved {
            station,
            set,
            turned_rad: size[3],
            moved_m: [size[0], size[1], size[2]],
        },
    });
    let of_ranges = fits.into_iter().filter_map(|fit| {
        let TestedError::Ranges(station) = fit.error else { return None };
        let influence = fit.influence.column(0).into_owned();
        Some(RangesTest { station, sigma_m: fit.size[0].sigma, critical_sigmas, influence })
    });
    SurveyTests { conflict, of_ranges: of_ranges.collect() }
}

/// An error fitted alone.
struct ErrorFit {
    error: TestedError,
    chi_square: f64,
    size: Vec<Estimate>,
    /// Gradient of the survey's cost by the constants for each parameter.
    influence: DMatrix<f64>,
}

impl ErrorFit {
    /// χ² by the noise that remains with the error: without it, its residuals count as noise. The noise is estimated from `numbers`.
    fn by_the_rest(&self, parameters: f64, numbers: f64) -> f64 {
        let rest = numbers - self.chi_square;
        if rest > 0.0 { self.chi_square * (numbers - parameters) / rest } else { f64::INFINITY }
    }
}

/// The errors that the readings can show.
fn tested_errors(adjustment: &Adjustment) -> Vec<TestedError> {
    let stations = || (0..adjustment.layout.stations()).map(Station::at);
    let markers = |station: Station, set: usize| {
        let is_read = |reading: &Observed| reading.station == station;
        let markers = adjustment.markers[set].iter();
        markers.filter(|marker| marker.readings.iter().any(is_read)).count()
    };
    let sets = 0..adjustment.markers.len();
    let mut tested: Vec<TestedError> = Vec::new();
    for station in stations() {
        let read: Vec<usize> =
            sets.clone().filter(|set| markers(station, *set) >= FEWEST_MARKERS).collect();
        if !read.is_empty() {
            tested.push(TestedError::Ranges(station));
        }
        // Of two sets one is enough: a change is relative.
        let changing = if read.len() > 2 { &read[..] } else { read.get(1..).unwrap_or(&[]) };
        tested.extend(changing.iter().map(|set| TestedError::Pose(station, *set)));
    }
    tested
}

/// Fits each error alone; `None` if the equations have no solution.
fn fits(adjustment: &Adjustment, sizes: &ErrorSizes) -> Option<Vec<ErrorFit>> {
    let equations = adjustment.linearise();
    let constants = adjustment.layout.constants;
    let columns = equations.gradient.len() - constants;
    let known = equations.information.view((0, 0), (constants, constants)) + &adjustment.precision;
    let across = equations.information.view((0, constants), (constants, columns)).into_owned();
    let regression = known.cholesky()?.solve(&across);
    let gradient =
        equations.gradient.rows(0, constants) + &adjustment.precision * adjustment.deviation();
    let information =
        equations.information.view((constants, constants), (columns, columns)).into_owned()
            - across.tr_mul(&regression);
    let right = regression.tr_mul(&gradient) - equations.gradient.rows(constants, columns);
    let mut first = 0;
    let mut fits = Vec::new();
    for error in &adjustment.tested {
        let size = error.parameters();
        let information = information.view((first, first), (size, size)).into_owned();
        let usual = DMatrix::from_diagonal(&error.usual(sizes).map(f64::recip));
        // (Ω⁻¹ + Q)⁻¹ = Q⁻¹ − Q⁻¹ (Ω + Q⁻¹)⁻¹ Q⁻¹
        let shrink = &usual * (information + &usual).cholesky()?.inverse();
        let precision = &usual - &shrink * &usual;
        let right = shrink * right.rows(first, size);
        let most = vec![MOST.powi(2); size];
        let fit = fit(&DMatrix::identity(size, size), &precision, &right, &most);
        fits.extend(fit.map(|(chi_square, fitted)| ErrorFit {
            error: *error,
            chi_square,
            size: fitted,
            influence: across.columns(first, size).into_owned(),
        }));
        first += size;
    }
    Some(fits)
}

#[cfg(test)]
mod tests {
    use super::super::adjust_survey::tests::{adjusted, exact_survey};
    use super::*;
    use crate::deployment::ControlPointSet;
    use crate::geometry::Polar;

    /// The exact survey with changed readings of station 2 in some sets.
    fn changed(sets: &[ControlPointSet], change: impl Fn(usize, &mut Polar)) -> SurveyTests {
        let mut sets = sets.to_vec();
        for (index, set) in sets.iter_mut().enumerate() {
            let readings = set.points.iter_mut().filter_map(|point| point.readings[1].as_mut());
            readings.for_each(|reading| change(index, reading));
        }
        adjusted(&sets).tests
    }

    #[test]
    fn ranges_of_a_station_that_are_off_are_found_with_their_size() {
        let exact = exact_survey();
        assert_eq!(changed(&exact, |_, _| ()).conflict, None);
        let tests = changed(&exact, |_, reading| reading.range_m += 0.02);
        let Some(SurveyConflict::Ranges { station, excess_m }) = tests.conflict else {
            panic!("{tests:?}");
        };
        assert_eq!(station.index(), 1);
        assert!(excess_m.sigmas_from(0.02).abs() < 1.0 && excess_m.sigma < 0.004, "{excess_m:?}");
        assert_eq!(tests.of_ranges.len(), 3);
    }

    #[test]
    fn a_station_that_turned_between_two_sets_is_named_with_the_set() {
        let [mut first] = <[ControlPointSet; 1]>::try_from(exact_survey()).expect("one set");
        let second = ControlPointSet { points: first.points.split_off(6), ..first.clone() };
        let sets = [first, second];
        assert_eq!(changed(&sets, |_, _| ()).conflict, None);
        // Azimuths increase clockwise, so a frame that turned by +0.5 mrad sees everything at larger ones.
        let tests = changed(&sets, |set, reading| {
            reading.azimuth_rad += if set == 1 { 5e-4 } else { 0.0 };
        });
        let Some(SurveyConflict::Moved { station, set, turned_rad, .. }) = tests.conflict else {
            panic!("{tests:?}");
        };
        assert_eq!((station.index(), set), (1, 1));
        assert!(turned_rad.sigmas_from(5e-4).abs() < 2.0, "{turned_rad:?}");
    }
}
