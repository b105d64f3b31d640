//! Elimination of the unknowns of a survey that no other evidence shares: markers, frames of surveyed coordinates, and the survey's own
//! errors of the instruments.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

use super::state_vector::{CONSTANTS, Constants, ConstantsMatrix, INDICES, OFFSETS};

/// Unknowns of the frame of surveyed coordinates: (x, y, z, yaw).
pub const FRAME: usize = 4;

/// Jacobian of a position by the constants and a frame of surveyed coordinates.
pub type PointJacobian = SMatrix<f64, 3, { CONSTANTS + FRAME }>;

/// An eliminated frame of surveyed coordinates; zeros without one.
pub struct EliminatedFrame {
    /// The step of the frame at these constants, and its regression on their step.
    pub step: SVector<f64, FRAME>,
    pub by_constants: SMatrix<f64, FRAME, CONSTANTS>,
    /// Covariance given the constants.
    pub covariance: SMatrix<f64, FRAME, FRAME>,
}

/// A reading, or the surveyed coordinates, of a marker at the linearisation point.
pub struct PointEquation {
    /// Position in station 1's frame (m), its Jacobian by the constants and the frame, and its information (1/m²).
    pub point_m: Vector3<f64>,
    pub jacobian: PointJacobian,
    pub information: Matrix3<f64>,
}

/// Number of errors that a survey has of its own: range offsets, vertical indices, collimations. A station points at another target than
/// in the drive, and in another way.
pub const OWN: usize = 9;

/// Index of an error of the survey's own among the constants.
pub fn own_index(own: usize) -> usize {
    if own < 3 { OFFSETS + own } else { INDICES + own - 3 }
}

pub fn own_errors(constants: &Constants) -> SVector<f64, OWN> {
    SVector::from_fn(|own, _| constants[own_index(own)])
}

/// Regression of the constants' gradient on that of the survey's own errors, and the transposed information between both.
pub struct OwnErrors {
    pub regression: SMatrix<f64, CONSTANTS, OWN>,
    pub transposed: SMatrix<f64, OWN, CONSTANTS>,
}

impl OwnErrors {
    pub fn new(information: &ConstantsMatrix, precision: &ConstantsMatrix) -> Self {
        let own = SMatrix::<f64, OWN, OWN>::from_fn(|i, j| {
            let (i, j) = (own_index(i), own_index(j));
            information[(i, j)] + precision[(i, j)]
        });
        let across =
            SMatrix::<f64, CONSTANTS, OWN>::from_fn(|row, own| information[(row, own_index(own))]);
        // Positive definite by the priors.
        let inverse = own.try_inverse().unwrap_or_else(SMatrix::zeros);
        Self { regression: across * inverse, transposed: across.transpose() }
    }
}

/// Adds `JᵀWJ` of a Jacobian in which most columns are zero.
pub fn add_gram(sum: &mut DMatrix<f64>, jacobian: &PointJacobian, information: &Matrix3<f64>) {
    let is_used = |column: &usize| jacobian.column(*column) != Vector3::zeros();
    let used: Vec<usize> = (0..jacobian.ncols()).filter(is_used).collect();
    let weighted = information * jacobian;
    for j in &used {
        let (column, mut sums) = (weighted.column(*j), sum.column_mut(*j));
        used.iter().for_each(|i| sums[*i] += jacobian.column(*i).dot(&column));
    }
}

/// Weighted mean of the equations of a marker.
pub struct Centre {
    pub point_m: Vector3<f64>,
    pub jacobian: PointJacobian,
    pub information: Matrix3<f64>,
    pub covariance: Matrix3<f64>,
}

impl Centre {
    /// The mean; `None` without equations.
    pub fn of(equations: &[PointEquation]) -> Option<Self> {
        let information: Matrix3<f64> = equations.iter().map(|one| one.information).sum();
        let covariance = information.try_inverse()?;
        let point_m =
            equations.iter().map(|one| one.information * one.point_m).sum::<Vector3<f64>>();
        let mut jacobian = SMatrix::zeros();
        equations.iter().for_each(|one| jacobian += one.information * one.jacobian);
        let (point_m, jacobian) = (covariance * point_m, covariance * jacobian);
        Some(Self { point_m, jacobian, information, covariance })
    }
}

/// Eliminates the frame of surveyed coordinates from the equations of a set.
pub fn without_frame(
    information: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> (ConstantsMatrix, Constants, EliminatedFrame) {
    let own = information.fixed_view::<CONSTANTS, CONSTANTS>(0, 0).into_owned();
    let own_gradient: Constants = gradient.fixed_rows::<CONSTANTS>(0).into_owned();
    let frame = information.fixed_view::<FRAME, FRAME>(CONSTANTS, CONSTANTS).into_owned();
    let Some(inverse) = frame.try_inverse() else {
        let none = EliminatedFrame {
            step: SVector::zeros(),
            by_constants: SMatrix::zeros(),
            covariance: SMatrix::zeros(),
        };
        return (own, own_gradient, none);
    };
    let across = information.fixed_view::<CONSTANTS, FRAME>(0, CONSTANTS).into_owned();
    let frame_gradient: SVector<f64, FRAME> = gradient.fixed_rows::<FRAME>(CONSTANTS).into_owned();
    let by_constants = -inverse * across.transpose();
    let step = inverse * frame_gradient;
    let eliminated = EliminatedFrame { step, by_constants, covariance: inverse };
    let own_gradient = own_gradient + by_constants.tr_mul(&frame_gradient);
    (own + across * by_constants, own_gradient, eliminated)
}
