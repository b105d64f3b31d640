//! Normal equations of method D from sums over the residuals of each pair of prisms.
//!
//! A residual r of the pair (a, b) has the derivatives +u and −u with respect to the translations of stations a and b, and +a and
//! −b with respect to their yaws. In pairs 12 and 13 station a is station 1, which is fixed; only pair 23 has unknowns of both
//! stations. The 8×8 normal matrix follows from the sums of products of (u, a, b, r). `L` rows are stored side by side, for vector
//! instructions.

use nalgebra::{SMatrix, SVector};

use crate::linear_algebra::sums::{multiply_add, sum_lanes};

/// `L` residuals r of one pair and their derivatives.
pub struct PairRows<const L: usize> {
    pub u: [[f64; L]; 3],
    pub a: [f64; L],
    pub b: [f64; L],
    pub r: [f64; L],
}

/// Sums of one pair over the rows of its residuals: products of u, a, b and r, and u, a and b themselves.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct PairSums<const L: usize> {
    uu: [[f64; L]; 6],
    ua: [[f64; L]; 3],
    ub: [[f64; L]; 3],
    aa: [f64; L],
    ab: [f64; L],
    bb: [f64; L],
    ur: [[f64; L]; 3],
    ar: [f64; L],
    br: [f64; L],
    rr: [f64; L],
    u: [[f64; L]; 3],
    a: [f64; L],
    b: [f64; L],
}

impl<const L: usize> PairSums<L> {
    pub const ZERO: Self = Self {
        uu: [[0.0; L]; 6],
        ua: [[0.0; L]; 3],
        ub: [[0.0; L]; 3],
        aa: [0.0; L],
        ab: [0.0; L],
        bb: [0.0; L],
        ur: [[0.0; L]; 3],
        ar: [0.0; L],
        br: [0.0; L],
        rr: [0.0; L],
        u: [[0.0; L]; 3],
        a: [0.0; L],
        b: [0.0; L],
    };

    /// Returns the sums over all lanes.
    #[inline(always)]
    pub fn fold(&self) -> PairSums<1> {
        let mut total = PairSums::<1>::ZERO;
        for i in 0..6 {
            total.uu[i] = [sum_lanes(&self.uu[i])];
        }
        for i in 0..3 {
            total.ua[i] = [sum_lanes(&self.ua[i])];
            total.ub[i] = [sum_lanes(&self.ub[i])];
            total.ur[i] = [sum_lanes(&self.ur[i])];
            total.u[i] = [sum_lanes(&self.u[i])];
        }
        total.aa = [sum_lanes(&self.aa)];
        total.ab = [sum_lanes(&self.ab)];
        total.bb = [sum_lanes(&self.bb)];
        total.ar = [sum_lanes(&self.ar)];
        total.br = [sum_lanes(&self.br)];
        total.rr = [sum_lanes(&self.rr)];
        total.a = [sum_lanes(&self.a)];
        total.b = [sum_lanes(&self.b)];
        total
    }

    /// Adds rows; `moving` is true if station a has unknowns (pair 23). A solver needs the products, a covariance needs the
    /// gradient and the plain sums.
    #[inline(always)]
    pub fn add<const FOR_SOLVER: bool>(&mut self, rows: &PairRows<L>, moving: bool) {
        for i in 0..3 {
            multiply_add(&mut self.ur[i], &rows.u[i], &rows.r);
        }
        multiply_add(&mut self.br, &rows.b, &rows.r);
        if moving {
            multiply_add(&mut self.ar, &rows.a, &rows.r);
        }
        if FOR_SOLVER {
            let mut entry = 0;
            for i in 0..3 {
                for j in i..3 {
                    multiply_add(&mut self.uu[entry], &rows.u[i], &rows.u[j]);
                    entry += 1;
                }
                multiply_add(&mut self.ub[i], &rows.u[i], &rows.b);
            }
            multiply_add(&mut self.bb, &rows.b, &rows.b);
            multiply_add(&mut self.rr, &rows.r, &rows.r);
            if moving {
                for i in 0..3 {
                    multiply_add(&mut self.ua[i], &rows.u[i], &rows.a);
                }
                multiply_add(&mut self.aa, &rows.a, &rows.a);
                multiply_add(&mut self.ab, &rows.a, &rows.b);
            }
        } else {
            for l in 0..L {
                for i in 0..3 {
                    self.u[i][l] += rows.u[i][l];
                }
                self.a[l] += rows.a[l];
                self.b[l] += rows.b[l];
            }
        }
    }
}

/// Returns the index of the first parameter of the pair's station b.
fn first_of_b(pair: usize) -> usize {
    if pair == 0 { 0 } else { 4 }
}

/// Returns the cost: rᵀr of the three pairs.
pub fn cost(sums: &[PairSums<1>; 3]) -> f64 {
    sums.iter().map(|s| s.rr[0]).sum()
}

/// Returns JᵀJ of the three pairs.
pub fn matrix(sums: &[PairSums<1>; 3]) -> SMatrix<f64, 8, 8> {
    let mut matrix = SMatrix::<f64, 8, 8>::zeros();
    for (pair, s) in sums.iter().enumerate() {
        let uu = |i: usize, j: usize| s.uu[[[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]][0];
        let at = first_of_b(pair);
        for i in 0..3 {
            for j in 0..3 {
                matrix[(at + i, at + j)] += uu(i, j);
            }
            matrix[(at + i, at + 3)] += s.ub[i][0];
        }
        matrix[(at + 3, at + 3)] += s.bb[0];
        if pair == 2 {
            for i in 0..3 {
                for j in 0..3 {
                    matrix[(i, j)] += uu(i, j);
                    matrix[(i, 4 + j)] -= uu(i, j);
                }
                matrix[(i, 3)] += s.ua[i][0];
                matrix[(i, 7)] -= s.ub[i][0];
                matrix[(3, 4 + i)] -= s.ua[i][0];
            }
            matrix[(3, 3)] += s.aa[0];
            matrix[(3, 7)] -= s.ab[0];
        }
    }
    matrix.fill_lower_triangle_with_upper_triangle();
    matrix
}

/// Returns Jᵀr of the three pairs.
pub fn gradient(sums: &[PairSums<1>; 3]) -> SVector<f64, 8> {
    let mut total = SVector::zeros();
    for (pair, s) in sums.iter().enumerate() {
        add_row(&mut total, pair, &s.ur, &s.ar, &s.br);
    }
    total
}

/// Returns Σ ∂r/∂p of each pair.
pub fn by_pair(sums: &[PairSums<1>; 3]) -> [SVector<f64, 8>; 3] {
    std::array::from_fn(|pair| {
        let mut row = SVector::zeros();
        add_row(&mut row, pair, &sums[pair].u, &sums[pair].a, &sums[pair].b);
        row
    })
}

/// Adds a sum of rows of J.
fn add_row(row: &mut SVector<f64, 8>, pair: usize, u: &[[f64; 1]; 3], a: &[f64; 1], b: &[f64; 1]) {
    let at = first_of_b(pair);
    for i in 0..3 {
        row[at + i] -= u[i][0];
    }
    row[at + 3] -= b[0];
    if pair == 2 {
        for i in 0..3 {
            row[i] += u[i][0];
        }
        row[3] += a[0];
    }
}
