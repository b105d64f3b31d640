//! Result of the adjustment of the control points ([`super::survey_adjustment`]).

use std::sync::Arc;

use nalgebra::{DMatrix, Vector3};

use super::constants_prior::precisions;
use super::state_vector::{Constants, ConstantsMatrix, Layout, level_transforms};
use super::unknown::{COLLIMATION, LEAN_X, LEAN_Y, RANGE_OFFSET, VERTICAL_INDEX};
use crate::calibration::{ErrorSizes, Estimate, Quantity, SUPPORTED_SIGMAS};
use crate::deployment::findings::instruments::{NamedError, instrument_error};
use crate::deployment::findings::points::control_point_outlier;
use crate::deployment::{ControlPointSet, Finding};
use crate::geometry::LevelTransform;
use crate::network::{Number, PerStation, Station};
use crate::statistics::median;

/// Standard deviation of the target's prism constant, which all stations share (m).
const TARGET_CONSTANT_M: f64 = 0.005;
/// Standard deviation of the zero of a station's ranges beside the prism constant.
const ZERO_M: f64 = 0.0005;
/// An outlier among the readings of control points has a smaller robust weight.
const OUTLIER_WEIGHT: f64 = 0.3;
/// An outlier has a residual of more than this multiple of the median.
const OUTLIER_RATIO: f64 = 5.0;
/// An outlier has a larger residual (m).
const LEAST_OUTLIER_M: f64 = 0.010;

/// Kinds of numbers in a reading.
pub const RANGES: usize = 0;
pub const ANGLES: usize = 1;

/// Result of the adjustment.
#[derive(Clone, Debug)]
pub struct Survey {
    pub layout: Arc<Layout>,
    /// Estimates of the constants θ at the survey; zero for those that the readings do not depend on.
    pub constants: Constants,
    /// Information of the readings about them, without their priors, and the gradient of the readings' cost there.
    pub information: ConstantsMatrix,
    pub gradient: Constants,
    /// Factors of the stated noise of ranges and angles.
    pub noise_factors: [f64; 2],
    /// True if the coordinates of some points were surveyed.
    pub has_surveyed_coordinates: bool,
    /// Reliability of each reading, marker by marker.
    pub readings: Vec<SurveyReading>,
    /// Errors of each instrument during the survey; `None` without readings in both faces.
    pub face_errors: PerStation<Option<FaceErrors>>,
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

    /// Returns a finding for each point with a reading that is an outlier; the sets are those of the adjustment.
    pub fn outliers(&self, sets: &[ControlPointSet]) -> Vec<Finding> {
        let residual_m = |reading: &SurveyReading| reading.residual_m.norm();
        let Some(typical_m) = median(self.readings.iter().map(residual_m)) else {
            return Vec::new();
        };
        let limit_m = (OUTLIER_RATIO * typical_m).max(LEAST_OUTLIER_M);
        let is_outlier = |reading: &SurveyReading| {
            reading.weight < OUTLIER_WEIGHT && residual_m(reading) > limit_m
        };
        let mut findings = Vec::new();
        for readings in self.readings.chunk_by(|a, b| (a.set, a.point) == (b.set, b.point)) {
            let outliers = readings.iter().filter(|reading| is_outlier(reading));
            let Some(largest_m) = outliers.map(residual_m).max_by(f64::total_cmp) else { continue };
            let set = &sets[readings[0].set];
            let marker = set.points[readings[0].point].marker;
            findings.push(control_point_outlier(&set.file, marker, largest_m, typical_m));
        }
        findings
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
