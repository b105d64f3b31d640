//! Changes of the stations' set-ups between the survey and the drive.
//!
//! The survey observes `θ + Δθ`: poses and leans of the drive, changed by settling in the meantime. The survey
//! ([`super::survey`]) has the information Λ and the estimate θ̂, and the change the prior covariance D. Elimination of Δθ leaves
//! `M = Λ − Λ_Δ (Λ_ΔΔ + D⁻¹)⁻¹ Λ_Δᵀ` as information about θ. The prior is that of a drive ([`super::settling`]). A step of one station that the data demands beyond it
//! is detected like a step during the drive ([`super::step_search`]).

use std::sync::Arc;

use nalgebra::{DMatrix, DVector, Vector4};

use super::prior_conflict::LEAST_INFORMATION;
use super::settling::{own_settling, relative_settling};
use super::state_vector::{Constants, ConstantsMatrix, Layout};
use super::step_fit::{fit, step_jacobians, with_errors};
use super::survey::Survey;
use super::unknown::{LEAN_X, LEAN_Y};
use crate::calibration::{ErrorSizes, Estimate};
use crate::geometry::wrap_to_pi;
use crate::network::{Number, Station};
use crate::progress::Cancelled;

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
/// A station whose change explains less by this χ² is no candidate: the other one is twenty times as likely.
const RIVAL_CHI_SQUARE: f64 = 6.0;
/// Variance of a distance of the rig that is wrong (m²).
const WRONG_DISTANCE_M2: f64 = 1e-4;
/// Critical χ² of the rest once all three distances are fitted. Textbook: 5 degrees of freedom, 1 %.
const REST_WITH_DISTANCES: f64 = 15.1;

/// Changes Δθ: of (x, y, z, yaw) of stations 2, 3, …, then of the leans of all stations.
type Changes = DVector<f64>;
type ChangeMatrix = DMatrix<f64>;
/// Change of the poses by the drive for an error of each measured distance.
pub type PosesByDistances = DMatrix<f64>;
type PoseMatrix = DMatrix<f64>;

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
    regression: DMatrix<f64>,
    conditional: ChangeMatrix,
    /// Variances of one station's settling over a drive (x, y, z, yaw; m², rad²).
    own: Vector4<f64>,
    /// Stations with a detected change; more than one if the data does not decide between them.
    pub changed: Vec<Station>,
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
    /// `None` if the data does not decide which station changed.
    pub station: Option<Station>,
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
    pub fn new(
        layout: &Layout,
        survey: &Arc<Survey>,
        sizes: &ErrorSizes,
        mean: &Constants,
    ) -> Option<Self> {
        let mut survey = (**survey).clone();
        let poses = layout.poses();
        for yaw in (3..poses).step_by(4) {
            survey.constants[yaw] = mean[yaw] + wrap_to_pi(survey.constants[yaw] - mean[yaw]);
        }
        let lean_rad2 = sizes.lean_rad.max(1e-7).powi(2);
        let changes = changing(layout).len();
        let mut covariance = ChangeMatrix::from_diagonal_element(changes, changes, lean_rad2);
        let settling = relative_settling(sizes, mean, layout.moved());
        covariance.view_mut((0, 0), (poses, poses)).copy_from(&settling);
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
        changed: Vec<Station>,
    ) -> Option<Self> {
        let information = &survey.information;
        let changing = changing(&survey.layout);
        let by_changes = information.select_columns(&changing);
        let of_changes = by_changes.select_rows(&changing);
        // (12)
        let conditional =
            (of_changes + change_covariance.clone().cholesky()?.inverse()).cholesky()?.inverse();
        let regression = &conditional * by_changes.transpose();
        let marginal = information - &by_changes * &regression;
        let marginal = 0.5 * (&marginal + marginal.transpose());
        let mut evidence = Self {
            survey,
            change_covariance,
            information: marginal,
            vector: Constants::default(),
            regression,
            conditional,
            own,
            changed,
            may_have_changed: false,
            by_distances: None,
            distances_explain: false,
        };
        let gradient = evidence.without_changes(&evidence.survey.gradient);
        evidence.vector = &evidence.information * &evidence.survey.constants - gradient;
        Some(evidence)
    }

    /// The adjustment of the control points.
    pub fn survey(&self) -> &Survey {
        &self.survey
    }

    /// Eliminates the changes from a gradient of the survey's cost.
    pub fn without_changes(&self, gradient: &Constants) -> Constants {
        gradient - self.regression.tr_mul(&gradient.select_rows(&changing(&self.survey.layout)))
    }

    /// Cost of the survey (σ²), less that of its own adjustment.
    pub fn cost(&self, constants: &Constants) -> f64 {
        let change = constants - &self.survey.constants;
        let gradient = self.without_changes(&self.survey.gradient);
        change.dot(&(&self.information * &change)) + 2.0 * gradient.dot(&change) // (12)
    }

    /// Gradient of the survey's cost by the constants.
    pub fn gradient(&self, constants: &Constants) -> Constants {
        &self.information * constants - &self.vector
    }

    /// Poses and leans of the survey less those of the drive.
    fn changes(&self, constants: &Constants) -> Changes {
        let gradient = self.survey.gradient.select_rows(&changing(&self.survey.layout));
        &self.regression * (&self.survey.constants - constants) - &self.conditional * gradient
    }

    /// Covariance of the changes, by that of the constants.
    fn covariance(&self, constants: &ConstantsMatrix) -> ChangeMatrix {
        &self.conditional + &self.regression * constants * self.regression.transpose()
    }

    /// The part of the poses of a matrix of changes.
    fn of_poses(&self, changes: &ChangeMatrix) -> PoseMatrix {
        let poses = self.survey.layout.poses();
        changes.view((0, 0), (poses, poses)).into_owned()
    }

    /// Poses of stations 2, 3, … at the survey (x, y, z, yaw) and their covariance, by the constants of the drive and theirs.
    pub fn poses(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> (DVector<f64>, PoseMatrix) {
        let size = self.survey.layout.poses();
        let poses = constants.rows(0, size) + self.changes(constants).rows(0, size);
        let mut by_constants = -self.regression.rows(0, size).into_owned();
        (0..size).for_each(|k| by_constants[(k, k)] += 1.0);
        let own = self.of_poses(&self.conditional);
        (poses, own + &by_constants * covariance * by_constants.transpose())
    }

    /// Normal matrix and right-hand side of the changes of poses, without their prior.
    fn without_prior(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
    ) -> Option<(PoseMatrix, DVector<f64>)> {
        let precision = self.of_poses(&self.change_covariance).cholesky()?.inverse();
        let posterior = self.of_poses(&self.covariance(covariance));
        let right = &precision * self.changes(constants).rows(0, precision.ncols());
        Some((&precision - &precision * posterior * &precision, right))
    }

    /// Widens the prior of each station that may have changed, if the data rejects the prior. Returns `None` if nothing is different.
    ///
    /// `by_facets` returns the covariance of the constants by errors that repeat with the incidence. It is costly, and asked for changes alone that
    /// are significant without it.
    pub fn with_detected_change(
        &self,
        constants: &Constants,
        covariance: &ConstantsMatrix,
        by_facets: impl FnOnce() -> Result<ConstantsMatrix, Cancelled>,
    ) -> Result<Option<Self>, Cancelled> {
        // A single station has nothing that it moves against.
        if !self.changed.is_empty() || self.survey.layout.moved() == 0 {
            return Ok(None);
        }
        let Some((mut normal, mut right)) = self.without_prior(constants, covariance) else {
            return Ok(None);
        };
        let mut fits = self.fits(constants, &normal, &right);
        if largest(&fits) > SUSPICIOUS_CHI_SQUARE {
            let of_changes = &self.regression * by_facets()? * self.regression.transpose();
            if let Some(factor) = self.of_poses(&self.change_covariance).cholesky() {
                let precision = factor.inverse();
                let errors = &precision * self.of_poses(&of_changes) * &precision;
                (normal, right) = with_errors(normal, right, &errors);
            }
            fits = self.fits(constants, &normal, &right);
        }
        Ok(self.widened(constants, (&normal, &right), fits))
    }

    /// Widens the prior of the stations whose changes explain the right-hand side. Returns `None` if nothing is different.
    fn widened(
        &self,
        constants: &Constants,
        (normal, right): (&PoseMatrix, &DVector<f64>),
        fits: Vec<(Station, f64, Vec<Estimate>)>,
    ) -> Option<Self> {
        let all = chi_square(normal, right, self.of_poses(&self.change_covariance))?;
        let best = largest(&fits);
        if best < CHANGE_CHI_SQUARE {
            let may_have_changed = best > SUSPICIOUS_CHI_SQUARE;
            return (may_have_changed != self.may_have_changed)
                .then(|| Self { may_have_changed, ..self.clone() });
        }
        // The right one may leave a little more by chance, but hardly much more than another.
        let is_sufficient = |chi_square: f64| {
            all - chi_square < REST_CHI_SQUARE || best - chi_square < RIVAL_CHI_SQUARE
        };
        let is_decided = fits.iter().any(|(_, chi_square, _)| is_sufficient(*chi_square));
        let mut widened = self.change_covariance.clone();
        let mut changed = Vec::new();
        for (station, chi_square, size) in fits {
            if is_decided && !is_sufficient(chi_square) {
                continue;
            }
            changed.push(station);
            let jacobian = self.pose_jacobian(station, constants);
            let sigma = |k: usize| {
                let usual = if k < 3 { CHANGED_M } else { CHANGED_RAD };
                usual.max(size[k].value.abs())
            };
            let own = DMatrix::from_diagonal(&DVector::from_fn(4, |k, _| sigma(k).powi(2)));
            let mut poses = widened.view_mut((0, 0), (jacobian.nrows(), jacobian.nrows()));
            poses += &jacobian * own * jacobian.transpose(); // (23)
        }
        let by_distances = self.by_distances.as_ref().and_then(|jacobian| {
            fit(jacobian, normal, right, &vec![WRONG_DISTANCE_M2; jacobian.ncols()])
        });
        let distances_explain =
            by_distances.is_some_and(|(chi_square, _)| all - chi_square < REST_WITH_DISTANCES);
        let widened = Self::with_covariance(Arc::clone(&self.survey), widened, self.own, changed)?;
        Some(Self { distances_explain, ..widened })
    }

    /// Fits a change of each station, with its χ² and its size.
    fn fits(
        &self,
        constants: &Constants,
        normal: &PoseMatrix,
        right: &DVector<f64>,
    ) -> Vec<(Station, f64, Vec<Estimate>)> {
        let of_station = |station: Station| {
            let jacobian = self.pose_jacobian(station, constants);
            let (chi_square, size) = fit(&jacobian, normal, right, self.own.as_slice())?;
            Some((station, chi_square, size))
        };
        let stations = (0..self.survey.layout.stations()).map(Station::at);
        stations.filter_map(of_station).collect()
    }

    /// Jacobian of the poses by a station's displacement and rotation (x, y, z, yaw).
    fn pose_jacobian(&self, station: Station, constants: &Constants) -> DMatrix<f64> {
        let layout = &self.survey.layout;
        step_jacobians(layout, station, constants).0.rows(0, layout.poses()).into_owned()
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
        let pose = |matrix: &ChangeMatrix| Some(self.of_poses(matrix).cholesky()?.inverse());
        let posterior = pose(&self.covariance(covariance))?;
        let normal = &posterior - pose(&self.change_covariance)?;
        let slots = self.survey.layout.moved();
        let settling = relative_settling(sizes, constants, slots).cholesky()?.inverse();
        let regression = &settling * (normal + &settling).cholesky()?.inverse();
        let precision = &settling - &regression * &settling;
        let right = regression * (posterior * self.changes(constants).rows(0, 4 * slots));
        let detected = self.own * DETECTED;
        let fits = self.changed.iter().filter_map(|station| {
            let jacobian = self.pose_jacobian(*station, constants);
            let (chi_square, size) = fit(&jacobian, &precision, &right, detected.as_slice())?;
            Some((*station, chi_square, size))
        });
        let (station, _, size) = fits.max_by(|a, b| a.1.total_cmp(&b.1))?;
        // The drive less the survey.
        let [x, y, z, turned_rad] =
            [0, 1, 2, 3].map(|k: usize| Estimate { value: -size[k].value, sigma: size[k].sigma });
        let distances_explain = self.distances_explain;
        let is_decided = self.changed.len() == 1 && !distances_explain;
        let station = is_decided.then_some(station);
        Some(SetUpChange { station, distances_explain, turned_rad, moved_m: [x, y, z] })
    }
}

/// Indices of the constants that change: poses, then leans.
fn changing(layout: &Layout) -> Vec<usize> {
    let leans = layout.indices(&LEAN_X).zip(layout.indices(&LEAN_Y));
    (0..layout.poses()).chain(leans.flat_map(|(x, y)| [x, y])).collect()
}

/// The largest χ² of the fits.
fn largest(fits: &[(Station, f64, Vec<Estimate>)]) -> f64 {
    fits.iter().map(|(_, chi_square, _)| *chi_square).fold(0.0, f64::max)
}

/// χ² of all changes of poses, in directions whose prior variance the data reduces noticeably.
fn chi_square(normal: &PoseMatrix, right: &DVector<f64>, prior: PoseMatrix) -> Option<f64> {
    let root = prior.cholesky()?.l();
    let (scaled, right) = (root.tr_mul(&(normal * &root)), root.tr_mul(right));
    let eigen = scaled.symmetric_eigen();
    let pairs = eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter());
    let informed = pairs.filter(|(value, _)| **value > LEAST_INFORMATION);
    Some(informed.map(|(value, vector)| vector.dot(&right).powi(2) / value).sum())
}
