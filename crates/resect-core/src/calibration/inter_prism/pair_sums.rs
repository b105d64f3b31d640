//! Normal equations of method D from sums over the residuals of each pair of stations.
//!
//! A residual r of the pair (a, b) has the derivatives +u and −u with respect to the translations of stations a and b, and +a and
//! −b with respect to their yaws. Station 1 has no unknowns; it is always station a. The normal matrix follows from the sums of
//! products of (u, a, b, r). `L` rows are stored side by side, for vector instructions.

use super::NormalEquations;
use super::prism_network::first_unknown;
use crate::linear_algebra::sums::{multiply_add, sum_lanes};
use crate::network::StationPair;

/// `L` residuals r of one pair and their derivatives.
pub struct PairRows<const L: usize> {
    pub u: [[f64; L]; 3],
    pub a: [f64; L],
    pub b: [f64; L],
    pub r: [f64; L],
}

/// Sums of one pair over the rows of its residuals: products of u, a, b and r.
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
        }
        total.aa = [sum_lanes(&self.aa)];
        total.ab = [sum_lanes(&self.ab)];
        total.bb = [sum_lanes(&self.bb)];
        total.ar = [sum_lanes(&self.ar)];
        total.br = [sum_lanes(&self.br)];
        total.rr = [sum_lanes(&self.rr)];
        total
    }

    /// Adds rows; `moving` is true if station a has unknowns.
    #[inline(always)]
    pub fn add(&mut self, rows: &PairRows<L>, moving: bool) {
        for i in 0..3 {
            multiply_add(&mut self.ur[i], &rows.u[i], &rows.r);
        }
        multiply_add(&mut self.br, &rows.b, &rows.r);
        if moving {
            multiply_add(&mut self.ar, &rows.a, &rows.r);
        }
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
    }
}

impl PairSums<1> {
    /// Adds JᵀJ (the upper triangle), Jᵀr and rᵀr of a pair to those of the network.
    pub fn add_to(&self, pair: StationPair, normal: &mut NormalEquations) {
        let of_b = first_unknown(pair.second).expect("station b is not station 1");
        self.add_station(of_b, &self.ub, self.bb[0], normal);
        if let Some(of_a) = first_unknown(pair.first) {
            self.add_station(of_a, &self.ua, self.aa[0], normal);
            let order = normal.gradient.len();
            let matrix = normal.matrix.as_mut_slice();
            for i in 0..3 {
                for j in 0..3 {
                    matrix[(of_b + j) * order + of_a + i] -= self.uu(i, j);
                }
                matrix[(of_b + 3) * order + of_a + i] -= self.ub[i][0];
                matrix[(of_b + i) * order + of_a + 3] -= self.ua[i][0];
            }
            matrix[(of_b + 3) * order + of_a + 3] -= self.ab[0];
        }
        add_row(normal.gradient.as_mut_slice(), pair, (&self.ur, &self.ar, &self.br));
        normal.cost += self.rr[0];
    }

    /// Adds the block of one station, from the products of its yaw's derivative with the others and with itself.
    fn add_station(
        &self,
        first: usize,
        by_yaw: &[[f64; 1]; 3],
        yaw_yaw: f64,
        normal: &mut NormalEquations,
    ) {
        let order = normal.gradient.len();
        let matrix = normal.matrix.as_mut_slice();
        for i in 0..3 {
            for j in 0..3 {
                matrix[(first + j) * order + first + i] += self.uu(i, j);
            }
            matrix[(first + 3) * order + first + i] += by_yaw[i][0];
        }
        matrix[(first + 3) * order + first + 3] += yaw_yaw;
    }

    fn uu(&self, i: usize, j: usize) -> f64 {
        self.uu[[[0, 1, 2], [1, 3, 4], [2, 4, 5]][i][j]][0]
    }
}

/// Adds a sum of rows of J, from the sums for the translations and for the yaws of stations a and b.
fn add_row(row: &mut [f64], pair: StationPair, (u, a, b): (&[[f64; 1]; 3], &[f64; 1], &[f64; 1])) {
    let of_b = first_unknown(pair.second).expect("station b is not station 1");
    for i in 0..3 {
        row[of_b + i] -= u[i][0];
    }
    row[of_b + 3] -= b[0];
    if let Some(of_a) = first_unknown(pair.first) {
        for i in 0..3 {
            row[of_a + i] += u[i][0];
        }
        row[of_a + 3] += a[0];
    }
}
