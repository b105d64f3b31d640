//! Elimination of the unknowns of a survey that no other evidence shares: markers, frames of surveyed coordinates, and the survey's own
//! errors of the instruments.

use nalgebra::{DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

use super::state_vector::{Constants, ConstantsMatrix};

/// Unknowns of the frame of surveyed coordinates: (x, y, z, yaw).
pub const FRAME: usize = 4;

/// Jacobian of a position by the constants and a frame of surveyed coordinates.
pub type PointJacobian = DMatrix<f64>;

/// An eliminated frame of surveyed coordinates; zeros without one.
pub struct EliminatedFrame {
    /// The step of the frame at these constants, and its regression on their step.
    pub step: SVector<f64, FRAME>,
    pub by_constants: DMatrix<f64>,
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

/// Regression of the constants' gradient on that of the errors that a survey has of its own, and the transposed information between both. A
/// station points at another target than in the drive, and in another way.
pub struct OwnErrors {
    pub regression: DMatrix<f64>,
    pub transposed: DMatrix<f64>,
}

impl OwnErrors {
    /// `own` are the indices of the survey's own errors.
    pub fn new(information: &ConstantsMatrix, precision: &ConstantsMatrix, own: &[usize]) -> Self {
        let with_priors = (information + precision).select_columns(own).select_rows(own);
        let across = information.select_columns(own);
        // Positive definite by the priors.
        let inverse =
            with_priors.try_inverse().unwrap_or_else(|| DMatrix::zeros(own.len(), own.len()));
        Self { regression: &across * inverse, transposed: across.transpose() }
    }
}

/// Adds `JᵀWJ` of a Jacobian in which most columns are zero.
pub fn add_gram(sum: &mut DMatrix<f64>, jacobian: &PointJacobian, information: &Matrix3<f64>) {
    let is_used = |column: &usize| jacobian.column(*column).iter().any(|value| *value != 0.0);
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
        let mut jacobian = DMatrix::zeros(3, equations[0].jacobian.ncols());
        equations.iter().for_each(|one| jacobian += one.information * &one.jacobian);
        let (point_m, jacobian) = (covariance * point_m, covariance * jacobian);
        let jacobian = jacobian.resize_vertically(3, 0.0);
        Some(Self { point_m, jacobian, information, covariance })
    }
}

/// Eliminates the frame of surveyed coordinates from the equations of a set.
pub fn without_frame(
    information: &DMatrix<f64>,
    gradient: &DVector<f64>,
) -> (ConstantsMatrix, Constants, EliminatedFrame) {
    let constants = gradient.len() - FRAME;
    let own = information.view((0, 0), (constants, constants)).into_owned();
    let own_gradient = gradient.rows(0, constants).into_owned();
    let frame = information.fixed_view::<FRAME, FRAME>(constants, constants).into_owned();
    let Some(inverse) = frame.try_inverse() else {
        let none = EliminatedFrame {
            step: SVector::zeros(),
            by_constants: DMatrix::zeros(FRAME, constants),
            covariance: SMatrix::zeros(),
        };
        return (own, own_gradient, none);
    };
    let across = information.view((0, constants), (constants, FRAME)).into_owned();
    let frame_gradient: SVector<f64, FRAME> = gradient.fixed_rows::<FRAME>(constants).into_owned();
    let by_constants = (-inverse * across.transpose()).resize_vertically(FRAME, 0.0);
    let step = inverse * frame_gradient;
    let own_gradient = own_gradient + by_constants.tr_mul(&frame_gradient);
    let own = own + across * &by_constants;
    (own, own_gradient, EliminatedFrame { step, by_constants, covariance: inverse })
}
