//! Normal equations of method D.

use nalgebra::{DMatrix, DVector};

/// JᵀJ, Jᵀr and rᵀr of all triplets at a state.
#[derive(Clone, Debug, PartialEq)]
pub struct NormalEquations {
    pub matrix: DMatrix<f64>,
    pub gradient: DVector<f64>,
    /// Sum of squared residuals (m²).
    pub cost: f64,
}

impl NormalEquations {
    pub fn zeros(unknowns: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(unknowns, unknowns),
            gradient: DVector::zeros(unknowns),
            cost: 0.0,
        }
    }

    pub fn clear(&mut self) {
        self.matrix.fill(0.0);
        self.gradient.fill(0.0);
        self.cost = 0.0;
    }
}
