//! Changes of the stations' set-ups between the survey and the drive.
//!
//! The survey observes `θ + Δθ`: poses and leans of the drive, changed by settling in the meantime. The survey
//! ([`super::survey`]) has the information Λ and the estimate θ̂, and the change the prior covariance D. Elimination of Δθ leaves
//! `M = Λ − Λ_Δ (Λ_ΔΔ + D⁻¹)⁻¹ Λ_Δᵀ` as information about θ. The prior is that of a drive ([`super::settling`]). A step of one station that the data demands beyond it
//! is detected like a step during the drive ([`super::step_search`]).

use std::sync::Arc;

use nalgebra::{SMatrix, SVector, Vector3, Vector4};

use super::prior_conflict::LEAST_INFORMATION;
use super::settling::{own_settling, relative_settling};
use super::state_vector::{CONSTANTS, Constants, ConstantsMatrix, LEANS};
use super::step_fit::{fit, step_jacobians};
use super::survey::Survey;
use crate::calibration::{ErrorSizes, Estimate};
use crate::geometry::wrap_to_pi;

/// Number of changes Δθ: of (x, y, z, yaw) of stations 2 and 3, then of the leans of stations 1 to 3.
const CHANGES: usize = 14;
const POSES: usize = 8;
/// Least standard deviation of a changed station's displacement, added to the prior (23).
const CHANGED_M: f64 = 0.005;
/// Least standard deviation of a changed station's rotation, added to the prior (23).
const CHANGED_RAD: f64 = 0.002;
/// A detected change is measured in directions with this multiple of the variances of settling.
const DETECTED: f64 = 1e6;
/// Critical χ² of the change of one station. Textbook: 4 degrees of freedom, 0.1 %; exceeded by chance in 0.3 % of drives.
const CHANGE_CHI_SQUARE: f64 = 18.5;
/// χ² from which a change is possible but not detected. Textbook: exceeded by chance in 1.4 % of drives.
const SUSPICIOUS_CHI_SQUARE: f64 = 15.0;
/// Critical χ² of the rest once one station's change is fitted. Textbook: 4 degrees of freedom, 1 %.
const REST_CHI_SQUARE: f64 = 13.3;
/// Variance of a distance of the rig that is wrong (m²).
const WRONG_DISTANCE_M2: f64 = 1e-4;
/// Critical χ² of the rest once all three distances are fitted. Textbook: 5 degrees of freedom, 1 %.
const REST_WITH_DISTANCES: f64 = 15.1;

type Changes = SVector<f64, CHANGES>;
type ChangeMatrix = SMatrix<f64, CHANGES, CHANGES>;
/// Change of the poses by the drive for an error of each measured distance.
pub type PosesByDistances = SMatrix<f64, POSES, 3>;
type PoseMatrix = SMatrix<f64, POSES, POSES>;

/// The survey as evidence about the constants of the drive.
#[derive(Clone, Debug)]
pub struct SurveyEvidence {
    survey: Arc<Survey>,
    /// Prior covariance of the changes.
    change_covariance: ChangeMatrix,
    /// Information about the constants, and its product with the survey's estimate.
    pub information: ConstantsMatrix,
    vector: Constants,
    /// Regression of the changes on the survey's estimate less the constants, and the covariance of the changes given these.
    regression: SMatrix<f64, CHANGES, CONSTANTS>,
    conditional: ChangeMatrix,
    /// Variances of one station's settling over a drive (x, y, z, yaw; m², rad²).
    own: Vector4<f64>,
    /// Stations with a detected change; more than one if the data does not decide between them.
    pub changed: Vec<usize>,
    /// True if a change is possible but not detected.
    pub may_have_changed: bool,
    /// Change of the poses by the drive alone for errors of the measured distances, if these are evidence.
    by_distances: Option<PosesByDistances>,
    /// True if wrong distances of the rig explain the same difference.
    distances_explain: bool,
}

/// Change of a station's set-up between the survey and the drive (drive less survey).
#[derive(Clone, Debug, PartialEq)]
pub struct SetUpChange {
    /// The station, 0 to 2; `None` if the data does not decide which one changed.
    pub station: Option<usize>,
    /// True if wrong distances of the rig explain the same difference; no station is named then.
    pub distances_explain: bool,
    /// Rotation about z (rad) and displacement (m, station 1's frame), of the candidate that fits best.
    pub turned_rad: Estimate,
    pub moved_m: [Estimate; 3],
}

impl SetUpChange {
    /// Length of the displacement (m).
    pub fn moved_length_m(&self) -> Estimate {
        Estimate::length_of(&self.moved_m)
    }
}

impl SurveyEvidence {
    /// Evidence with the prior of settling; yaws are unwrapped to those of the prior mean.
    pub fn new(survey: &Arc<Survey>, sizes: &ErrorSizes, mean: &Constants) -> Option<Self> {
        let mut survey = (**survey).clone();
        for yaw in [3, 7] {
            survey.constants[yaw] = mean[yaw] + wrap_to_pi(survey.constants[yaw] - mean[yaw]);
        }
        let mut covariance = ChangeMatrix::zeros();
        covariance.fixed_view_mut::<POSES, POSES>(0, 0).copy_from(&relative_settling(sizes, mean));
        let lean_rad2 = sizes.lean_rad.max(1e-7).powi(2);
        (POSES..CHANGES).for_each(|lean| covariance[(lean, lean)] = lean_rad2);
        Self::with_covariance(Arc::new(survey), covariance, own_settling(sizes), Vec::new())
    }

    /// Sets the change of the poses by the drive alone for errors of the measured distances.
    pub fn with_distances(self, by_distances: Option<PosesByDistances>) -> Self {
        Self { by_distances, ..self }
    }

    fn with_covariance(
        survey: Arc<Survey>,
        change_covariance: ChangeMatrix,
        own: Vector4<f64>,
        changed: Vec<usize>,
    ) -> Option<Self> {
        let information = &survey.information;
        let by_changes = SMatrix::<f64, CONSTANTS, CHANGES>::from_fn(|row, change| {
            information[(row, constant_of(change))]
        });
        let of_changes =
            ChangeMatrix::from_fn(|i, j| information[(constant_of(i), constant_of(j))]);
        // (12)
        let conditional =
            (of_changes + change_covariance.cholesky()?.inverse()).cholesky()?.inverse();
        let regression = conditional * by_changes.transpose();
        let marginal = information - by_changes * regression;
        let marginal = 0.5 * (marginal + marginal.transpose());
        let mut evidence = Self {
            survey,
            change_covariance,
            information: marginal,
            vector: Constants::zeros(),
            regression,
            conditional,
            own,
            changed,
            may_have_changed: false,
            by_distances: None,
            distances_explain: false,
        };
        let gradient = evidence.without_changes(&evidence.survey.gradient);
        evidence.vector = marginal * evidence.survey.constants - gradient;
        Some(evidence)
    }

    /// The adjustment of the control points.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Eliminates the changes from a gradient of the survey's cost.
    pub fn without_changes(&self, gradient: &Constants) -> Constants {
        let by_changes = Changes::from_fn(|change, _| gradient[constant_of(change)]);
        gradient - self.regression.tr_mul(&by_changes)
    }

    /// Cost of the survey (σ²), less that of its own adjustment.
    pub fn cost(&self, constants: &Constants) -> f64 {
        let change = constants - self.survey.constants;
        let gradient = self.without_changes(&self.survey.gradient);
        change.dot(&(self.information * change)) + 2.0 * gradient.dot(&change) // (12)
    }

    /// Gradient of the survey's cost by the constants.
    pub fn gradient(&self, constants: &Constants) -> Constants {
        self.information * constants - self.vector
    }

    /// Poses and leans of the survey less those of the drive.
    fn changes(&self, constants: &Constants) -> Changes {
        let gradient = Changes::from_fn(|change, _| self.survey.gradient[constant_of(change)]);
        self.regression * (self.survey.constants - constants) - self.conditional * gradient
    }

    /// Covariance of the changes, by that of the constants.
    fn covariance(&self, constants: &ConstantsMatrix) -> ChangeMatrix {
        self.conditional + self.regression * constants * self.regression.transpose()
    }

    /// Poses of stations 2 and 3 at the survey (x, y, z, yaw) and their covariance, by the constants of the drive and theirs.
    pub fn poses(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> (SVector<f64, POSES>, PoseMatrix) {
        let poses =
            constants.fixed_rows::<POSES>(0) + self.changes(constants).fixed_rows::<POSES>(0);
        let mut by_constants = -self.regression.fixed_rows::<POSES>(0).into_owned();
        (0..POSES).for_each(|k| by_constants[(k, k)] += 1.0);
        let own = self.conditional.fixed_view::<POSES, POSES>(0, 0);
        (poses, own + by_constants * covariance * by_constants.transpose())
    }

    /// Normal matrix and right-hand side of the changes of poses, without their prior.
    fn without_prior(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> Option<(PoseMatrix, SVector<f64, POSES>)> {
        let prior: PoseMatrix =
            self.change_covariance.fixed_view::<POSES, POSES>(0, 0).into_owned();
        let precision = prior.cholesky()?.inverse();
        let changes = self.changes(constants);
        let posterior = self.covariance(covariance);
        let posterior = posterior.fixed_view::<POSES, POSES>(0, 0);
        let right = precision * changes.fixed_rows::<POSES>(0);
        Some((precision - precision * posterior * precision, right))
    }

    /// Widens the prior of each station that may have changed, if the data rejects the prior. Returns `None` if nothing is different.
    pub fn with_detected_change(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> Option<Self> {
        if !self.changed.is_empty() {
            return None;
        }
        let (normal, right) = self.without_prior(constants, covariance)?;
        let prior: PoseMatrix =
            self.change_covariance.fixed_view::<POSES, POSES>(0, 0).into_owned();
        let all = chi_square(&normal, &right, &prior)?;
        let positions_m = positions_m(constants);
        let of_station = |station: usize| {
            let jacobian = pose_jacobian(station, &positions_m);
            let (chi_square, size) = fit(&jacobian, &normal, &right, &self.own)?;
            Some((station, chi_square, size))
        };
        let fits: Vec<_> = (0..3).filter_map(of_station).collect();
        let best = fits.iter().map(|(_, chi_square, _)| *chi_square).fold(0.0, f64::max);
        if best < CHANGE_CHI_SQUARE {
            let may_have_changed = best > SUSPICIOUS_CHI_SQUARE;
            return (may_have_changed != self.may_have_changed)
                .then(|| Self { may_have_changed, ..self.clone() });
        }
        let is_sufficient = |chi_square: f64| all - chi_square < REST_CHI_SQUARE;
        let is_decided = fits.iter().any(|(_, chi_square, _)| is_sufficient(*chi_square));
        let mut widened = self.change_covariance;
        let mut changed = Vec::new();
        for (station, chi_square, size) in fits {
            if is_decided && !is_sufficient(chi_square) {
                continue;
            }
            changed.push(station);
            let jacobian = pose_jacobian(station, &positions_m);
            let sigma = |k: usize| {
                let usual = if k < 3 { CHANGED_M } else { CHANGED_RAD };
                usual.max(size[k].value.abs())
            };
            let own =
                SMatrix::<f64, 4, 4>::from_diagonal(&SVector::from_fn(|k, _| sigma(k).powi(2)));
            let mut poses = widened.fixed_view_mut::<POSES, POSES>(0, 0);
            poses += jacobian * own * jacobian.transpose(); // (23)
        }
        let wrong = SVector::<f64, 3>::repeat(WRONG_DISTANCE_M2);
        let by_distances = self.by_distances.as_ref();
        let by_distances = by_distances.and_then(|jacobian| fit(jacobian, &normal, &right, &wrong));
        let distances_explain =
            by_distances.is_some_and(|(chi_square, _)| all - chi_square < REST_WITH_DISTANCES);
        let widened = Self::with_covariance(Arc::clone(&self.survey), widened, self.own, changed)?;
        Some(Self { distances_explain, ..widened })
    }

    /// The change of the detected station, by the data alone.
    pub fn set_up_change(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
        sizes: &ErrorSizes,
    ) -> Option<SetUpChange> {
        if self.changed.is_empty() {
            return None;
        }
        // By the data alone the change has the information Ω = C⁻¹ − D⁻¹. With the variance Q of settling it is (Ω⁻¹ + Q)⁻¹, which is
        // Q⁻¹ − Q⁻¹ (Ω + Q⁻¹)⁻¹ Q⁻¹.
        let pose = |matrix: &ChangeMatrix| {
            let poses: PoseMatrix = matrix.fixed_view::<POSES, POSES>(0, 0).into_owned();
            Some(poses.cholesky()?.inverse())
        };
        let posterior = pose(&self.covariance(covariance))?;
        let normal = posterior - pose(&self.change_covariance)?;
        let settling = relative_settling(sizes, constants).cholesky()?.inverse();
        let regression = settling * (normal + settling).cholesky()?.inverse();
        let precision = settling - regression * settling;
        let right = regression * (posterior * self.changes(constants).fixed_rows::<POSES>(0));
        let positions_m = positions_m(constants);
        let fits = self.changed.iter().filter_map(|station| {
            let jacobian = pose_jacobian(*station, &positions_m);
            let (chi_square, size) = fit(&jacobian, &precision, &right, &(self.own * DETECTED))?;
            Some((*station, chi_square, size))
        });
        let (station, _, size) = fits.max_by(|a, b| a.1.total_cmp(&b.1))?;
        // The drive less the survey.
        let [x, y, z, turned_rad] =
            size.map(|Estimate { value, sigma }| Estimate { value: -value, sigma });
        let distances_explain = self.distances_explain;
        let is_decided = self.changed.len() == 1 && !distances_explain;
        let station = is_decided.then_some(station);
        Some(SetUpChange { station, distances_explain, turned_rad, moved_m: [x, y, z] })
    }
}

fn positions_m(constants: &Constants) -> [Vector3<f64>; 2] {
    [0, 1].map(|slot| constants.fixed_rows::<3>(4 * slot).into())
}

/// Index of the constant that a change is of.
fn constant_of(change: usize) -> usize {
    if change < POSES { change } else { LEANS + change - POSES }
}

fn pose_jacobian(station: usize, positions_m: &[Vector3<f64>; 2]) -> SMatrix<f64, POSES, 4> {
    step_jacobians(station, positions_m).0.fixed_rows::<POSES>(0).into_owned()
}

/// χ² of all changes of poses, in directions whose prior variance the data reduces noticeably.
fn chi_square(normal: &PoseMatrix, right: &SVector<f64, POSES>, prior: &PoseMatrix) -> Option<f64> {
    let root = prior.cholesky()?.l();
    let (scaled, right) = (root.tr_mul(&(normal * root)), root.tr_mul(right));
    let eigen = scaled.symmetric_eigen();
    let pairs = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    let informed = pairs.filter(|(value, _)| **value > LEAST_INFORMATION);
    Some(informed.map(|(value, vector)| vector.dot(&right).powi(2) / value).sum())
}
