//! Least-squares adjustment of static points that the stations measured: control points and pillars.
//!
//! Unknowns are constants θ of the drive (poses and leans of the stations, scales), errors that the survey has of its own (vertical
//! indices, collimations, prism constant of the target, zero of each range), and the coordinates of the markers. The residual of a
//! reading is that of the drive ([`super::residuals`]): marker less corrected reading in the axes of the sight. Surveyed coordinates
//! enter as one more reading of each marker, from a level frame with unknown position and yaw. All but θ is eliminated.
//!
//! The mean of both faces is free of vertical index and collimation. Half of their difference is a reading of these two errors.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

use super::block_jacobians::point_jacobian;
use super::loss::{CONSISTENCY, robust_weight};
use super::sight::Sight;
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use super::station_model::{MeanSight, StationModel};
use super::survey::{FaceErrors, RangesTest, Survey, SurveyReading, SurveyTests};
use super::survey_elimination::{
    Centre, EliminatedFrame, FRAME, OwnErrors, PointEquation, PointJacobian, add_gram,
    without_frame,
};
use super::survey_markers::{ANGLE_RAD, Marker, Observed, face_indices};
use super::tested_error::TestedError;
use crate::calibration::Estimate;
use crate::geometry::{LevelTransform, align_level};
use crate::network::{Number, PerStation, Station};
use crate::statistics::median;

/// Standard deviation of a surveyed coordinate with the centring of the target, which all stations share (m).
const SURVEYED_M: f64 = 0.002;
/// Numbers by which the stated noise counts in its estimate from the residuals.
pub const STATED_NUMBERS: f64 = 12.0;

/// State of the adjustment.
pub struct Adjustment {
    pub layout: Arc<Layout>,
    pub constants: Constants,
    pub mean: Constants,
    pub precision: ConstantsMatrix,
    /// Markers by set.
    pub markers: Vec<Vec<Marker>>,
    /// Transforms from the frames of surveyed coordinates to station 1's.
    pub frames: Vec<LevelTransform>,
    pub noise_factors: Vector3<f64>,
    /// Numbers from which these are estimated.
    pub noise_numbers: Vector3<f64>,
    /// Errors whose columns come after those of the constants.
    pub tested: Vec<TestedError>,
}

/// Normal equations of the constants and tested errors, without priors, with markers and frames eliminated.
pub struct SurveyEquations {
    pub information: ConstantsMatrix,
    pub gradient: Constants,
    /// Eliminated frames by set.
    pub frames: Vec<EliminatedFrame>,
    /// Residuals of the readings along the sight, to its right and up (m), marker by marker.
    pub residuals_m: Vec<Vector3<f64>>,
}

impl SurveyEquations {
    pub fn with_priors(&self, precision: &ConstantsMatrix) -> ConstantsMatrix {
        &self.information + precision
    }
}

/// A reading's residual over σ, with what its weight depends on.
struct WeighedResidual {
    normalised: Vector3<f64>,
    redundancy: Vector3<f64>,
    weight: f64,
}

impl Adjustment {
    pub fn stations(&self) -> StationModels {
        let mut of_both_faces = self.constants.clone();
        for station in (0..self.layout.stations()).map(Station::at) {
            face_indices(&self.layout, station).into_iter().for_each(|k| of_both_faces[k] = 0.0);
        }
        StationModels {
            of_one_face: StationModel::all(&self.layout, &self.constants),
            of_both_faces: StationModel::all(&self.layout, &of_both_faces),
        }
    }

    /// Estimate less prior mean.
    pub fn deviation(&self) -> Constants {
        &self.constants - &self.mean
    }

    /// Position of a reading in station 1's frame (m), and the axes of its sight there.
    pub fn placed(stations: &StationModels, reading: &Observed) -> (Vector3<f64>, Matrix3<f64>) {
        let model = stations.model(reading);
        let Sight { along, side, up, .. } = reading.sight;
        // (5)
        let point_m = model.rotation * model.corrected(&reading.sight) + model.position_m;
        (point_m, model.rotation * Matrix3::from_columns(&[along, side, up]))
    }

    pub fn sigma_m(&self, reading: &Observed) -> Vector3<f64> {
        reading.sigma_m.component_mul(&self.noise_factors)
    }

    /// Aligns the frames of surveyed coordinates to the markers.
    pub fn place_frames(&mut self) {
        let stations = self.stations();
        for (markers, frame) in self.markers.iter().zip(&mut self.frames) {
            let placed = markers.iter().filter_map(|marker| {
                let mean = |axis: usize| {
                    let of = |reading| Self::placed(&stations, reading).0[axis];
                    median(marker.readings.iter().map(of))
                };
                Some((Vector3::new(mean(0)?, mean(1)?, mean(2)?), marker.surveyed_m?))
            });
            let (to_m, from_m): (Vec<_>, Vec<_>) = placed.unzip();
            if let Some(aligned) = align_level(&to_m, &from_m) {
                *frame = aligned;
            }
        }
    }

    /// Subtracts a step of the constants, with the steps of the frames that belong to it.
    pub fn apply(&mut self, step: &Constants, eliminated: &[EliminatedFrame]) {
        self.constants -= step;
        for (frame, eliminated) in self.frames.iter_mut().zip(eliminated) {
            let step = eliminated.step + &eliminated.by_constants * step;
            frame.translation_m -= step.fixed_rows::<3>(0);
            frame.yaw_rad -= step[3];
        }
    }

    /// Number of the constants and of the parameters of tested errors.
    fn columns(&self) -> usize {
        let parameters = self.tested.iter().map(|error| error.parameters());
        self.layout.constants + parameters.sum::<usize>()
    }

    /// Inserts the columns of the tested errors after those of the constants.
    fn with_tested(
        &self,
        jacobian: PointJacobian,
        by_error: impl Fn(&TestedError) -> Option<DMatrix<f64>>,
    ) -> PointJacobian {
        let mut first = self.layout.constants;
        let mut jacobian = jacobian.insert_columns(first, self.columns() - first, 0.0);
        for error in &self.tested {
            if let Some(columns) = by_error(error) {
                jacobian.columns_mut(first, error.parameters()).copy_from(&columns);
            }
            first += error.parameters();
        }
        jacobian
    }

    /// The equations of one marker.
    pub fn equations(
        &self,
        stations: &StationModels,
        marker: &Marker,
        set: usize,
    ) -> Vec<PointEquation> {
        let mut equations: Vec<PointEquation> = marker
            .readings
            .iter()
            .map(|reading| {
                let (point_m, axes) = Self::placed(stations, reading);
                let variance_m2 = self.sigma_m(reading).map(|sigma_m| sigma_m.powi(-2));
                let information =
                    axes * Matrix3::from_diagonal(&variance_m2) * axes.transpose() * reading.weight;
                let model = stations.model(reading);
                let jacobian = self.with_tested(jacobian(&self.layout, model, reading), |error| {
                    error.jacobian(model, reading, set)
                });
                PointEquation { point_m, jacobian, information }
            })
            .collect();
        // Fewer than two coordinates determine nothing but the frame.
        let surveyed =
            self.markers[set].iter().filter(|marker| marker.surveyed_m.is_some()).count();
        if let Some(surveyed_m) = marker.surveyed_m.filter(|_| surveyed > 1) {
            let frame = &self.frames[set];
            let constants = self.columns();
            let mut jacobian = PointJacobian::zeros(3, constants + FRAME);
            jacobian.fixed_view_mut::<3, 3>(0, constants).fill_with_identity();
            let by_yaw = Vector3::z().cross(&frame.rotate(&surveyed_m));
            jacobian.fixed_view_mut::<3, 1>(0, constants + 3).copy_from(&by_yaw);
            let information = Matrix3::from_diagonal_element(SURVEYED_M.powi(-2));
            let point_m = frame.apply(&surveyed_m);
            equations.push(PointEquation { point_m, jacobian, information });
        }
        equations
    }

    pub fn linearise(&self) -> SurveyEquations {
        let constants = self.columns();
        let all = constants + FRAME;
        let stations = self.stations();
        let mut sum = SurveyEquations {
            information: ConstantsMatrix::zeros(constants, constants),
            gradient: Constants::zeros(constants),
            frames: Vec::new(),
            residuals_m: Vec::new(),
        };
        for (set, markers) in self.markers.iter().enumerate() {
            let mut information = DMatrix::<f64>::zeros(all, all);
            let mut gradient = DVector::<f64>::zeros(all);
            for marker in markers {
                let equations = self.equations(&stations, marker, set);
                let Some(centre) = Centre::of(&equations) else { continue };
                for equation in &equations {
                    add_gram(&mut information, &equation.jacobian, &equation.information);
                    let off = equation.information * (equation.point_m - centre.point_m);
                    gradient += equation.jacobian.tr_mul(&off);
                }
                for (reading, equation) in marker.readings.iter().zip(&equations) {
                    let axes = Self::placed(&stations, reading).1;
                    sum.residuals_m.push(axes.tr_mul(&(centre.point_m - equation.point_m)));
                }
                // Σ (J − J̄)ᵀW(J − J̄) = Σ JᵀWJ − J̄ᵀΣW J̄, with the mean J̄ by the information W.
                add_gram(&mut information, &centre.jacobian, &-centre.information);
            }
            self.add_face_errors(markers, &mut information, &mut gradient);
            let (own, own_gradient, frame) = without_frame(&information, &gradient);
            sum.information += own;
            sum.gradient += own_gradient;
            sum.frames.push(frame);
        }
        sum
    }

    /// Adds the differences of both faces to the normal equations.
    fn add_face_errors(
        &self,
        markers: &[Marker],
        information: &mut DMatrix<f64>,
        gradient: &mut DVector<f64>,
    ) {
        for reading in markers.iter().flat_map(|marker| &marker.readings) {
            let precisions = self.face_precisions();
            for ((index, observed_rad), precision) in
                reading.face_errors(&self.layout).zip(precisions)
            {
                let off_rad = self.constants[index] - observed_rad;
                let weight = robust_weight(off_rad * off_rad * precision) * precision;
                information[(index, index)] += weight;
                gradient[index] += weight * off_rad;
            }
        }
    }

    /// Information of half of the difference of two vertical angles, and of two horizontal ones (1/rad²).
    fn face_precisions(&self) -> [f64; 2] {
        [self.noise_factors.z, self.noise_factors.y]
            .map(|factor| 2.0 * (ANGLE_RAD * factor).powi(-2))
    }

    /// Errors of each instrument with readings in both faces.
    pub fn face_errors(&self, covariance: &ConstantsMatrix) -> PerStation<Option<FaceErrors>> {
        let estimate = |index: usize| Estimate {
            value: self.constants[index],
            sigma: covariance[(index, index)].sqrt(),
        };
        let readings = || self.markers.iter().flatten().flat_map(|marker| &marker.readings);
        PerStation::from_fn(self.layout.stations(), |station| {
            let is_of_both = |reading: &&Observed| {
                reading.station == station && reading.face_errors_rad.is_some()
            };
            let points = readings().filter(is_of_both).count();
            let [index_rad, collimation_rad] = face_indices(&self.layout, station).map(estimate);
            (points > 0).then_some(FaceErrors { points, index_rad, collimation_rad })
        })
    }

    /// Estimates noise factors and robust weights from the residuals; returns the largest change of a factor, as a share.
    pub fn reweight(&mut self, residuals_m: &[Vector3<f64>], redundancy: &[Vector3<f64>]) -> f64 {
        let readings = self.markers.iter().flatten().flat_map(|marker| &marker.readings);
        let readings: Vec<WeighedResidual> = readings
            .zip(residuals_m.iter().zip(redundancy))
            .map(|(reading, (residual_m, redundancy))| WeighedResidual {
                normalised: residual_m.component_div(&self.sigma_m(reading)),
                redundancy: *redundancy,
                weight: reading.weight,
            })
            .collect();
        let mut factors = self.noise_factors;
        for axis in 0..3 {
            let mut square = STATED_NUMBERS / self.noise_factors[axis].powi(2);
            let mut numbers = STATED_NUMBERS;
            for reading in &readings {
                square += (reading.weight * reading.normalised[axis]).powi(2) / CONSISTENCY;
                numbers += reading.weight.powi(2) * reading.redundancy[axis];
            }
            // Half of the step: factors and weights depend on each other, and the whole step may oscillate.
            factors[axis] *= (square / numbers).powf(0.25);
        }
        let mut weights = readings.iter().map(|reading| {
            let squares = (0..3)
                .map(|axis| reading.normalised[axis].powi(2) / reading.redundancy[axis].max(0.05));
            robust_weight(squares.sum::<f64>() / 3.0)
        });
        let readings = self.markers.iter_mut().flatten().flat_map(|marker| &mut marker.readings);
        for reading in readings {
            reading.weight = weights.next().unwrap_or(1.0);
        }
        let before = std::mem::replace(&mut self.noise_factors, factors);
        factors.zip_map(&before, |factor, before| (factor / before - 1.0).abs()).max()
    }

    /// Eliminates the errors that are not those of the drive.
    pub fn into_survey(
        self,
        equations: &SurveyEquations,
        mut readings: Vec<SurveyReading>,
        mut tests: SurveyTests,
    ) -> Survey {
        let own = self.layout.of_pointing();
        let OwnErrors { regression, transposed } =
            OwnErrors::new(&equations.information, &self.precision, &own);
        let mut information = &equations.information - &regression * transposed;
        let with_priors = &equations.gradient + &self.precision * self.deviation();
        let mut gradient = &equations.gradient - &regression * with_priors.select_rows(&own);
        for SurveyReading { influence, .. } in &mut readings {
            *influence -= &regression * influence.select_rows(&own);
        }
        for RangesTest { influence, .. } in &mut tests.of_ranges {
            *influence -= &regression * influence.select_rows(&own);
        }
        let mut constants = self.constants;
        for index in self.layout.of_motion().into_iter().chain(own) {
            constants[index] = 0.0;
            gradient[index] = 0.0;
            information.row_mut(index).fill(0.0);
            information.column_mut(index).fill(0.0);
            readings.iter_mut().for_each(|reading| reading.influence.row_mut(index).fill(0.0));
            tests.of_ranges.iter_mut().for_each(|test| test.influence[index] = 0.0);
        }
        let information = 0.5 * (&information + information.transpose());
        let mut all = self.markers.iter().flatten();
        Survey {
            face_errors: PerStation::repeat(self.layout.stations(), None),
            tests,
            layout: self.layout,
            constants,
            information,
            gradient,
            noise_factors: self.noise_factors,
            has_surveyed_coordinates: all.any(|marker| marker.surveyed_m.is_some()),
            readings,
        }
    }
}

/// Models of the stations for readings in one face, and for means of both faces, which are free of vertical index and collimation.
pub struct StationModels {
    of_one_face: Vec<StationModel>,
    of_both_faces: Vec<StationModel>,
}

impl StationModels {
    fn model(&self, reading: &Observed) -> &StationModel {
        let models = match reading.face_errors_rad {
            Some(_) => &self.of_both_faces,
            None => &self.of_one_face,
        };
        &models[reading.station.index()]
    }
}

/// Jacobian of a reading's position by the constants of its station.
fn jacobian(layout: &Layout, model: &StationModel, reading: &Observed) -> PointJacobian {
    let mean_sight = MeanSight::of(layout, std::iter::once(reading.sight)).unwrap_or_default();
    let by_instrument = point_jacobian(layout, model, &mean_sight, reading.station).0;
    let mut jacobian = by_instrument.resize_horizontally(layout.constants + FRAME, 0.0);
    for (index, _) in reading.face_errors(layout) {
        jacobian.column_mut(index).fill(0.0);
    }
    if let Some(slot) = reading.station.slot() {
        jacobian.fixed_view_mut::<3, 3>(0, 4 * slot).fill_with_identity();
        let by_yaw = Vector3::z().cross(&(model.rotation * mean_sight.point_m));
        jacobian.fixed_view_mut::<3, 1>(0, 4 * slot + 3).copy_from(&by_yaw);
    }
    jacobian
}
