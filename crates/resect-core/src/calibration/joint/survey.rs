//! Result of the adjustment of the control points ([`super::survey_adjustment`]).

use std::sync::Arc;

use nalgebra::{DMatrix, Vector3};

use super::constants_prior::precisions;
use super::state_vector::{Constants, ConstantsMatrix, Layout, level_transforms};
use super::unknown::{COLLIMATION, LEAN_X, LEAN_Y, RANGE_OFFSET, VERTICAL_INDEX};
use crate::calibration::{ErrorSizes, Estimate, Quantity, SUPPORTED_SIGMAS, Verdict};
use crate::deployment::findings::instruments::{NamedError, instrument_error};
use crate::deployment::findings::points::{
    control_point_ranges_off, control_point_reading_off, station_moved_between_sets,
};
use crate::deployment::{ControlPointSet, Finding};
use crate::geometry::LevelTransform;
use crate::network::{Number, PerStation, Station};

/// Standard deviation of the target's prism constant, which all stations share (m).
const TARGET_CONSTANT_M: f64 = 0.005;
/// Standard deviation of the zero of a station's ranges beside the prism constant: the instrument and its adapter, 0.7 mm each as in
/// [`ErrorSizes::range_offset_m`].
const ZERO_M: f64 = 0.001;
/// A reading of a control point that is off by more is a mistake: of a marker, or of a prism constant (m).
const LEAST_MISTAKE_M: f64 = 0.010;

/// Result of the adjustment.
#[derive(Clone, Debug)]
pub struct Survey {
    pub layout: Arc<Layout>,
    /// Estimates of the constants θ at the survey; zero for those that the readings do not depend on.
    pub constants: Constants,
    /// Information of the readings about them, without their priors, and the gradient of the readings' cost there.
    pub information: ConstantsMatrix,
    pub gradient: Constants,
    /// Factors of the stated noise along the sights, to their right and up. Heights of targets are less certain than their positions.
    pub noise_factors: Vector3<f64>,
    /// True if the coordinates of some points were surveyed.
    pub has_surveyed_coordinates: bool,
    /// Reliability of each reading, marker by marker.
    pub readings: Vec<SurveyReading>,
    /// Errors of each instrument during the survey; `None` without readings in both faces.
    pub face_errors: PerStation<Option<FaceErrors>>,
    /// Tests for errors that the adjustment has no unknowns for.
    pub tests: SurveyTests,
}

/// An error of a station during the survey with its size.
#[derive(Clone, Debug, PartialEq)]
pub enum SurveyConflict {
    /// Ranges that are longer than those of the other stations (m).
    Ranges { station: Station, excess_m: Estimate },
    /// A station that stood elsewhere in one set than in the others.
    Moved { station: Station, set: usize, turned_rad: Estimate, moved_m: [Estimate; 3] },
}

/// Results of the tests.
#[derive(Clone, Debug, Default)]
pub struct SurveyTests {
    /// The most significant error; `None` if chance explains all of them.
    pub conflict: Option<SurveyConflict>,
    /// Tests of the ranges of stations.
    pub of_ranges: Vec<RangesTest>,
}

/// Test of a station's ranges to control points for an offset that they share.
#[derive(Clone, Debug)]
pub struct RangesTest {
    pub station: Station,
    /// Standard deviation of the offset by the other readings (m).
    pub sigma_m: f64,
    pub critical_sigmas: f64,
    /// Gradient of the survey's cost by the constants for an offset (1/m).
    pub influence: Constants,
}

/// Errors of an instrument by readings in both faces.
#[derive(Clone, Copy, Debug)]
pub struct FaceErrors {
    /// Number of points that were measured in both faces.
    pub points: usize,
    pub index_rad: Estimate,
    pub collimation_rad: Estimate,
}

impl Survey {
    /// Poses of the stations at the survey, and the covariance of (x, y, z, yaw) of stations 2, 3, … (m, rad).
    pub fn poses(&self, sizes: &ErrorSizes) -> Option<(PerStation<LevelTransform>, DMatrix<f64>)> {
        let information = &self.information + survey_precisions(&self.layout, sizes);
        let covariance = information.cholesky()?.inverse();
        let size = self.layout.poses();
        let poses = level_transforms(&self.constants.rows(0, size).into_owned());
        Some((poses, covariance.view((0, 0), (size, size)).into_owned()))
    }

    /// Returns the findings of outliers, and of an error that all readings of a station share, each with the best verdict that it allows. The sets
    /// are those of the adjustment.
    pub fn contradictions(&self, sets: &[ControlPointSet]) -> Vec<(Verdict, Finding)> {
        let axes = 0..3;
        let tested =
            self.readings.iter().flat_map(|reading| axes.clone().map(move |axis| (reading, axis)));
        let tested: Vec<(&SurveyReading, usize, f64)> = tested
            .filter_map(|(reading, axis)| Some((reading, axis, reading.normalised_residual(axis)?)))
            .collect();
        let file = |set: usize| sets[set].file.as_str();
        let is_outlier = |(reading, axis, sigmas): &&(&SurveyReading, usize, f64)| {
            sigmas.abs() > reading.critical_sigmas[*axis]
        };
        let outliers = tested.iter().filter(is_outlier).map(|(reading, axis, _)| {
            let set = &sets[reading.set];
            let marker = (set.file.as_str(), set.points[reading.point].marker);
            let bias_m = reading.bias_m(*axis);
            let finding =
                control_point_reading_off(marker, reading.station.index(), *axis, &bias_m);
            // Its robust weight keeps a smaller one out of the answer.
            let is_mistake = bias_m.value.abs() > LEAST_MISTAKE_M;
            (if is_mistake { Verdict::Weak } else { Verdict::Good }, finding)
        });
        let conflict = self.tests.conflict.as_ref().map(|conflict| match conflict {
            SurveyConflict::Ranges { station, excess_m } => {
                control_point_ranges_off(station.index(), excess_m)
            }
            SurveyConflict::Moved { station, set, turned_rad, moved_m } => {
                let moved_m = Estimate::length_of(moved_m);
                station_moved_between_sets(station.index(), file(*set), turned_rad, &moved_m)
            }
        });
        conflict.map(|finding| (Verdict::Weak, finding)).into_iter().chain(outliers).collect()
    }

    /// Describes the errors of the instruments by both faces, where they are significant.
    pub fn significant_face_errors(&self, sizes: &ErrorSizes) -> Vec<Finding> {
        let of_station = |(station, errors): (Station, &FaceErrors)| {
            let all = [
                (&VERTICAL_INDEX, errors.index_rad, sizes.index_rad),
                (&COLLIMATION, errors.collimation_rad, sizes.collimation_rad),
            ];
            let points = errors.points;
            let significant = all
                .into_iter()
                .filter(|(_, estimate, _)| estimate.sigmas_from(0.0).abs() > SUPPORTED_SIGMAS);
            significant.map(move |(unknown, estimate, prior_sigma)| {
                let sentence = unknown.sentence_of(&station.to_string());
                let sentence = format!("by both faces of {points} points {sentence}");
                let quantity = Quantity::Angle;
                let station = Some(station.index());
                instrument_error(&NamedError {
                    sentence: &sentence,
                    station,
                    quantity,
                    estimate,
                    prior_sigma,
                })
            })
        };
        let stations = self.face_errors.each();
        stations
            .filter_map(|(station, errors)| Some((station, errors.as_ref()?)))
            .flat_map(of_station)
            .collect()
    }

    /// Number of points that a station measured.
    pub fn points(&self, station: Station) -> usize {
        self.readings.iter().filter(|reading| reading.station == station).count()
    }
}

/// One station's reading of a marker in the adjustment.
#[derive(Clone, Debug)]
pub struct SurveyReading {
    /// Index of the set and of the point in it.
    pub set: usize,
    pub point: usize,
    pub station: Station,
    /// Residual along the sight, to its right and up (m), and its standard deviations before the fit (m).
    pub residual_m: Vector3<f64>,
    pub sigma_m: Vector3<f64>,
    pub weight: f64,
    /// Redundancy number of each of the three.
    pub redundancy: Vector3<f64>,
    /// Critical normalised residuals of the three, with which the largest of all readings are compared (σ).
    pub critical_sigmas: Vector3<f64>,
    /// Gradient of the survey's cost by the constants for an error of each of the three (1/m).
    pub influence: DMatrix<f64>,
}

/// Priors (1/σ²) of the constants at the survey; the range offsets share the prism constant of the target.
pub fn survey_precisions(layout: &Layout, sizes: &ErrorSizes) -> ConstantsMatrix {
    let mut precision = precisions(layout, sizes);
    // A compensator leaves another lean after the survey.
    let lean_rad = sizes.lean_rad.hypot(sizes.lean_rad).max(1e-9);
    for index in layout.indices(&LEAN_X).chain(layout.indices(&LEAN_Y)) {
        precision[index] = lean_rad.powi(-2);
    }
    layout.of_motion().into_iter().for_each(|index| precision[index] = 1.0);
    let mut information = ConstantsMatrix::from_diagonal(&precision);
    let stations = layout.stations();
    let zeros = DMatrix::from_diagonal_element(stations, stations, ZERO_M.powi(2));
    let shared = DMatrix::repeat(stations, stations, TARGET_CONSTANT_M.powi(2));
    // Positive definite: a positive diagonal plus a square.
    let offsets =
        (zeros + shared).try_inverse().unwrap_or_else(|| DMatrix::identity(stations, stations));
    for (i, row) in layout.indices(&RANGE_OFFSET).enumerate() {
        for (j, column) in layout.indices(&RANGE_OFFSET).enumerate() {
            information[(row, column)] = offsets[(i, j)];
        }
    }
    information
}
