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
use super::constants_prior::prior_mean;
use super::loss::{CONSISTENCY, robust_weight};
use super::sight::Sight;
use super::state_vector::{Constants, ConstantsMatrix, Layout, by_station};
use super::station_model::{MeanSight, StationModel};
use super::survey::{ANGLES, FaceErrors, RANGES, Survey, SurveyReading, survey_precisions};
use super::survey_elimination::{
    Centre, EliminatedFrame, FRAME, OwnErrors, PointEquation, PointJacobian, add_gram,
    without_frame,
};
use super::unknown::{COLLIMATION, VERTICAL_INDEX};
use crate::calibration::{CalibrationSettings, ErrorSizes, Estimate};
use crate::deployment::{ControlPoint, ControlPointSet, Deployment};
use crate::geometry::{LevelTransform, Polar, align_level};
use crate::network::{Number, PerPair, PerStation, Station};
use crate::statistics::median;

/// Standard deviation of a static range of length zero.
const RANGE_M: f64 = 0.001;
/// Standard deviation of a static range by its length.
const RANGE_SHARE: f64 = 1e-6;
/// Standard deviation of a static angle. Angles in files of six digits are rounded to 10 µrad.
const ANGLE_RAD: f64 = 6e-6;
/// Standard deviation of the position of the target across the sight.
const TARGET_M: f64 = 0.0003;
/// Standard deviation of a surveyed coordinate with the centring of the target, which all stations share (m).
const SURVEYED_M: f64 = 0.002;
/// Fewest points that each other station shares with station 1.
const FEWEST_SHARED: usize = 3;
/// Largest number of iterations of the adjustment.
const MOST_ITERATIONS: usize = 60;
/// The iteration has converged once no constant moves by more than this many σ.
const CONVERGED_SIGMAS: f64 = 1e-3;
/// Iterations from one computation of σ and redundancy numbers, which change slowly, to the next.
const REDUNDANCY_PERIOD: usize = 4;
/// Numbers by which the stated noise counts in its estimate from the residuals.
const STATED_NUMBERS: f64 = 12.0;

/// A reading with what does not change during the adjustment.
struct Observed {
    point: usize,
    station: Station,
    sight: Sight,
    /// Vertical index and collimation (rad) by the readings in both faces, of which the sight is the mean.
    face_errors_rad: Option<[f64; 2]>,
    sigma_m: Vector3<f64>,
    weight: f64,
}

impl Observed {
    /// Indices of vertical index and collimation among the constants, with their values by both faces (rad).
    fn face_errors(&self, layout: &Layout) -> impl Iterator<Item = (usize, f64)> + use<> {
        let indices = face_indices(layout, self.station);
        self.face_errors_rad.into_iter().flat_map(move |values| indices.into_iter().zip(values))
    }
}

/// Indices of a station's vertical index and collimation among the constants.
fn face_indices(layout: &Layout, station: Station) -> [usize; 2] {
    [&VERTICAL_INDEX, &COLLIMATION].map(|unknown| layout.index(unknown, station.index()))
}

/// A marker: its readings, and its surveyed coordinates in the frame of its set (m).
struct Marker {
    readings: Vec<Observed>,
    surveyed_m: Option<Vector3<f64>>,
}

/// Adjusts the control points of a deployment if the settings use them.
pub fn of_deployment(
    deployment: &Deployment,
    layout: &Arc<Layout>,
    settings: &CalibrationSettings,
) -> Option<Arc<Survey>> {
    let sets = deployment.comparable_control_points();
    if !settings.evidence.control_points {
        return None;
    }
    adjust(sets, layout, &settings.errors).map(Arc::new)
}

/// Adjusts the control points of a deployment; `None` unless each other station shares three points with station 1.
pub fn adjust(
    sets: &[ControlPointSet],
    layout: &Arc<Layout>,
    sizes: &ErrorSizes,
) -> Option<Survey> {
    let published = approximate_transforms(sets, layout.stations())?;
    let mean = prior_mean(layout, &published, &PerPair::default());
    let mut adjustment = Adjustment {
        layout: Arc::clone(layout),
        constants: mean.clone(),
        mean,
        precision: survey_precisions(layout, sizes),
        markers: sets.iter().map(markers).collect(),
        frames: vec![LevelTransform::IDENTITY; sets.len()],
        noise_factors: [1.0; 2],
    };
    adjustment.place_frames();
    let mut redundancy = Vec::new();
    for iteration in 0..MOST_ITERATIONS {
        let equations = adjustment.linearise();
        let factor = equations.with_priors(&adjustment.precision).cholesky()?;
        let gradient = &equations.gradient + &adjustment.precision * adjustment.deviation();
        let step = factor.solve(&gradient);
        let mut is_converged = false;
        if iteration % REDUNDANCY_PERIOD == 0 {
            let covariance = factor.inverse();
            let sigmas =
                step.zip_map(&covariance.diagonal(), |step, variance| step.abs() / variance.sqrt());
            is_converged = sigmas.max() < CONVERGED_SIGMAS;
            let readings = adjustment.reliability(&equations.frames, &covariance);
            redundancy = readings.into_iter().map(|reading| reading.redundancy).collect();
        }
        adjustment.reweight(&equations.residuals_m, &redundancy);
        adjustment.apply(&step, &equations.frames);
        if is_converged {
            break;
        }
    }
    let equations = adjustment.linearise();
    let covariance = equations.with_priors(&adjustment.precision).cholesky()?.inverse();
    let readings = adjustment.reliability(&equations.frames, &covariance);
    let face_errors = adjustment.face_errors(&covariance);
    let survey = adjustment.into_survey(&equations, readings);
    Some(Survey { face_errors, ..survey })
}

/// Level transforms by the points that two stations share, as method B.
fn approximate_transforms(
    sets: &[ControlPointSet],
    stations: usize,
) -> Option<PerStation<LevelTransform>> {
    let points = || sets.iter().flat_map(|set| &set.points);
    let transform = |station: usize| {
        let shared = points().filter_map(|point| {
            let reading = |station| Some((*point.readings.get(station)?)?.to_cartesian());
            Some((reading(Station::FIRST)?, reading(Station::at(station))?))
        });
        let (to_m, from_m): (Vec<_>, Vec<_>) = shared.unzip();
        (to_m.len() >= FEWEST_SHARED).then(|| align_level(&to_m, &from_m))?
    };
    let others: Option<Vec<LevelTransform>> = (1..stations).map(transform).collect();
    Some(by_station(LevelTransform::IDENTITY, others?))
}

fn markers(points: &ControlPointSet) -> Vec<Marker> {
    let marker = |(index, point): (usize, &ControlPoint)| {
        let reading = |(station, reading): (Station, &Option<Polar>)| {
            let point_m = (*reading)?.to_cartesian();
            let sight = Sight::to(&point_m);
            let face_errors_rad = point.face_one[station].map(|face_one| {
                let off_rad = (face_one.to_cartesian() - point_m) / sight.range_m;
                [-sight.up.dot(&off_rad), sight.side.dot(&off_rad)]
            });
            let range_m = sight.range_m;
            let across_m = (ANGLE_RAD * range_m).hypot(TARGET_M);
            let sigma_m = Vector3::new(RANGE_M + RANGE_SHARE * range_m, across_m, across_m);
            Some(Observed { point: index, station, sight, face_errors_rad, sigma_m, weight: 1.0 })
        };
        let readings = point.readings.each().filter_map(reading).collect();
        Marker { readings, surveyed_m: point.known_m }
    };
    points.points.iter().enumerate().map(marker).collect()
}

/// State of the adjustment.
struct Adjustment {
    layout: Arc<Layout>,
    constants: Constants,
    mean: Constants,
    precision: ConstantsMatrix,
    /// Markers by set.
    markers: Vec<Vec<Marker>>,
    /// Transforms from the frames of surveyed coordinates to station 1's.
    frames: Vec<LevelTransform>,
    noise_factors: [f64; 2],
}

/// Normal equations of the constants, without priors, with markers and frames eliminated.
struct SurveyEquations {
    information: ConstantsMatrix,
    gradient: Constants,
    /// Eliminated frames by set.
    frames: Vec<EliminatedFrame>,
    /// Residuals of the readings along the sight, to its right and up (m), marker by marker.
    residuals_m: Vec<Vector3<f64>>,
}

impl SurveyEquations {
    fn with_priors(&self, precision: &ConstantsMatrix) -> ConstantsMatrix {
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
    fn stations(&self) -> StationModels {
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
    fn deviation(&self) -> Constants {
        &self.constants - &self.mean
    }

    /// Position of a reading in station 1's frame (m), and the axes of its sight there.
    fn placed(stations: &StationModels, reading: &Observed) -> (Vector3<f64>, Matrix3<f64>) {
        let model = stations.model(reading);
        let Sight { along, side, up, .. } = reading.sight;
        // (5)
        let point_m = model.rotation * model.corrected(&reading.sight) + model.position_m;
        (point_m, model.rotation * Matrix3::from_columns(&[along, side, up]))
    }

    fn sigma_m(&self, reading: &Observed) -> Vector3<f64> {
        let [ranges, angles] = self.noise_factors;
        reading.sigma_m.component_mul(&Vector3::new(ranges, angles, angles))
    }

    /// Aligns the frames of surveyed coordinates to the markers.
    fn place_frames(&mut self) {
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
    fn apply(&mut self, step: &Constants, eliminated: &[EliminatedFrame]) {
        self.constants -= step;
        for (frame, eliminated) in self.frames.iter_mut().zip(eliminated) {
            let step = eliminated.step + &eliminated.by_constants * step;
            frame.translation_m -= step.fixed_rows::<3>(0);
            frame.yaw_rad -= step[3];
        }
    }

    /// The equations of one marker.
    fn equations(
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
                let jacobian = jacobian(&self.layout, stations.model(reading), reading);
                PointEquation { point_m, jacobian, information }
            })
            .collect();
        // Fewer than two coordinates determine nothing but the frame.
        let surveyed =
            self.markers[set].iter().filter(|marker| marker.surveyed_m.is_some()).count();
        if let Some(surveyed_m) = marker.surveyed_m.filter(|_| surveyed > 1) {
            let frame = &self.frames[set];
            let constants = self.layout.constants;
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

    fn linearise(&self) -> SurveyEquations {
        let constants = self.layout.constants;
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
        let precision = self.face_precision();
        for reading in markers.iter().flat_map(|marker| &marker.readings) {
            for (index, observed_rad) in reading.face_errors(&self.layout) {
                let off_rad = self.constants[index] - observed_rad;
                let weight = robust_weight(off_rad * off_rad * precision) * precision;
                information[(index, index)] += weight;
                gradient[index] += weight * off_rad;
            }
        }
    }

    /// Information of half of the difference of two angles (1/rad²).
    fn face_precision(&self) -> f64 {
        2.0 * (ANGLE_RAD * self.noise_factors[ANGLES]).powi(-2)
    }

    /// Errors of each instrument with readings in both faces.
    fn face_errors(&self, covariance: &ConstantsMatrix) -> PerStation<Option<FaceErrors>> {
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

    /// Residuals of all readings with their redundancy numbers, by the covariance of the constants.
    fn reliability(
        &self,
        frames: &[EliminatedFrame],
        covariance: &ConstantsMatrix,
    ) -> Vec<SurveyReading> {
        let stations = self.stations();
        let mut all = Vec::new();
        for (set, markers) in self.markers.iter().enumerate() {
            for marker in markers {
                let equations = self.equations(&stations, marker, set);
                let Some(centre) = Centre::of(&equations) else { continue };
                for (reading, equation) in marker.readings.iter().zip(&equations) {
                    let axes = Self::placed(&stations, reading).1;
                    let constants = self.layout.constants;
                    let total = &equation.jacobian - &centre.jacobian;
                    let by_frame = total.fixed_columns::<FRAME>(constants).into_owned();
                    let frame = &frames[set];
                    let jacobian = total.columns(0, constants) + &by_frame * &frame.by_constants;
                    // Covariance of the fitted position.
                    let fitted = &jacobian * covariance * jacobian.transpose()
                        + &by_frame * frame.covariance * by_frame.transpose();
                    let fitted = axes.tr_mul(&((centre.covariance + fitted) * axes));
                    let sigma_m = self.sigma_m(reading);
                    let share = |axis: usize| {
                        1.0 - reading.weight * fitted[(axis, axis)] / sigma_m[axis].powi(2)
                    };
                    all.push(SurveyReading {
                        set,
                        point: reading.point,
                        station: reading.station,
                        residual_m: axes.tr_mul(&(centre.point_m - equation.point_m)),
                        sigma_m,
                        weight: reading.weight,
                        redundancy: Vector3::new(share(0), share(1), share(2))
                            .map(|share| share.clamp(0.0, 1.0)),
                        influence: jacobian
                            .tr_mul(&(equation.information * axes))
                            .resize_horizontally(3, 0.0),
                    });
                }
            }
        }
        all
    }

    /// Estimates noise factors and robust weights from the residuals.
    fn reweight(&mut self, residuals_m: &[Vector3<f64>], redundancy: &[Vector3<f64>]) {
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
        for (kind, axes) in [(RANGES, 0..1), (ANGLES, 1..3)] {
            let mut square = STATED_NUMBERS / self.noise_factors[kind].powi(2);
            let mut numbers = STATED_NUMBERS;
            for reading in &readings {
                for axis in axes.clone() {
                    square += (reading.weight * reading.normalised[axis]).powi(2) / CONSISTENCY;
                    numbers += reading.weight.powi(2) * reading.redundancy[axis];
                }
            }
            // Half of the step: factors and weights depend on each other, and the whole step may oscillate.
            factors[kind] *= (square / numbers).powf(0.25);
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
        self.noise_factors = factors;
    }

    /// Eliminates the errors that are not those of the drive.
    fn into_survey(self, equations: &SurveyEquations, mut readings: Vec<SurveyReading>) -> Survey {
        let own = self.layout.of_pointing();
        let OwnErrors { regression, transposed } =
            OwnErrors::new(&equations.information, &self.precision, &own);
        let mut information = &equations.information - &regression * transposed;
        let with_priors = &equations.gradient + &self.precision * self.deviation();
        let mut gradient = &equations.gradient - &regression * with_priors.select_rows(&own);
        for SurveyReading { influence, .. } in &mut readings {
            *influence -= &regression * influence.select_rows(&own);
        }
        let mut constants = self.constants;
        for index in self.layout.of_motion().into_iter().chain(own) {
            constants[index] = 0.0;
            gradient[index] = 0.0;
            information.row_mut(index).fill(0.0);
            information.column_mut(index).fill(0.0);
            readings.iter_mut().for_each(|reading| reading.influence.row_mut(index).fill(0.0));
        }
        let information = 0.5 * (&information + information.transpose());
        let mut all = self.markers.iter().flatten();
        Survey {
            face_errors: PerStation::repeat(self.layout.stations(), None),
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
struct StationModels {
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

#[cfg(test)]
pub mod tests;
