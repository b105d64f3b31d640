//! The chain's rows: how a part is eliminated after the one before it, and the loops over its rows.

use multiversion::multiversion;
use nalgebra::{Cholesky, Const};

use super::band_rows::factorise;
use super::chain::{Block, Square};
use super::slow_priors::{LnDeterminant, SlowPrecisions};
use super::unknowns::{CONSTANTS, Constants, SLOW};

/// Places in a row of the factor: the part's own slow states, the next part's, and the constants.
pub const NEXT: usize = SLOW;
pub const BORDER: usize = 2 * SLOW;
const ROW: usize = BORDER + CONSTANTS;

/// A part's rows of the factor: of its own slow states, with what these have in common with the next part's and the constants.
pub type Rows = [[f64; ROW]; SLOW];

/// The chain eliminated from its first part on, as far as it has come.
pub struct Elimination<'a> {
    priors: &'a SlowPrecisions,
    /// The rows of the last part.
    pub before: Option<Rows>,
    /// What all said of the constants.
    gram: [[f64; CONSTANTS]; CONSTANTS],
    log_determinant: f64,
}

impl<'a> Elimination<'a> {
    pub fn new(priors: &'a SlowPrecisions) -> Self {
        let gram = [[0.0; CONSTANTS]; CONSTANTS];
        Self { priors, before: None, gram, log_determinant: -priors.log_determinant }
    }

    /// Eliminates the next part, and shows its rows; `None` where a direction stays free.
    pub fn eliminate(&mut self, data: &Block, part: usize) -> Option<&Rows> {
        let rows = next_rows(data, self.priors, part, self.before.as_ref())?;
        add_gram(&mut self.gram, &rows);
        self.log_determinant += (0..SLOW).map(|i| 2.0 * rows[i][i].ln()).sum::<f64>();
        Some(self.before.insert(rows))
    }

    /// The factor of the constants once all parts are eliminated, and the logarithm of the determinant less the one of the
    /// slow priors.
    pub fn constants(
        self,
        data: &Square,
        precision: &Constants,
    ) -> Option<(Cholesky<f64, Const<CONSTANTS>>, f64)> {
        let gram = Square::from_fn(|i, j| self.gram[i.min(j)][i.max(j)]);
        let constants = data + Square::from_diagonal(precision) - gram;
        let constants = constants.cholesky()?;
        let log_determinant = self.log_determinant + 2.0 * constants.ln_determinant_of_root();
        log_determinant.is_finite().then_some((constants, log_determinant))
    }
}

/// A part's rows, given those of the part before it; `None` where a direction stays free.
pub fn next_rows(
    data: &Block,
    priors: &SlowPrecisions,
    part: usize,
    before: Option<&Rows>,
) -> Option<Rows> {
    let own = data.own + priors.own(part);
    let next = data.with_next + priors.with_next(part);
    let mut rows = [[0.0; ROW]; SLOW];
    for (i, row) in rows.iter_mut().enumerate() {
        for j in 0..SLOW {
            row[j] = own[(i, j)];
            row[NEXT + j] = next[(i, j)];
        }
        for j in 0..CONSTANTS {
            row[BORDER + j] = data.with_constants[(i, j)];
        }
    }
    if let Some(before) = before {
        subtract(before, &mut rows);
    }
    factorise(&mut rows).then_some(rows)
}

/// Solves for a part's own rows, and takes them out of what comes after.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn forward<const K: usize>(
    rows: &Rows,
    own: &mut [[f64; K]; SLOW],
    mut next: Option<&mut [[f64; K]; SLOW]>,
    constants: &mut [[f64; K]; CONSTANTS],
) {
    for (m, row) in rows.iter().enumerate() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        value.iter_mut().for_each(|value| *value /= row[m]);
        for (factor, other) in row[m + 1..SLOW].iter().zip(after) {
            subtract_times(other, *factor, value);
        }
        if let Some(next) = next.as_deref_mut() {
            for (factor, other) in row[NEXT..BORDER].iter().zip(next) {
                subtract_times(other, *factor, value);
            }
        }
        for (factor, other) in row[BORDER..].iter().zip(constants.iter_mut()) {
            subtract_times(other, *factor, value);
        }
    }
}

/// Solves for a part's own rows, all after it being known.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn backward<const K: usize>(
    rows: &Rows,
    own: &mut [[f64; K]; SLOW],
    next: Option<&[[f64; K]; SLOW]>,
    constants: &[[f64; K]; CONSTANTS],
) {
    for (m, row) in rows.iter().enumerate().rev() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        for (factor, other) in row[BORDER..].iter().zip(constants) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[NEXT..BORDER].iter().zip(next.into_iter().flatten()) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[m + 1..SLOW].iter().zip(after) {
            subtract_times(value, *factor, other);
        }
        value.iter_mut().for_each(|value| *value /= row[m]);
    }
}

#[inline(always)]
fn subtract_times<const K: usize>(from: &mut [f64; K], factor: f64, values: &[f64; K]) {
    for k in 0..K {
        from[k] -= factor * values[k];
    }
}

/// Subtracts what an eliminated part says of the next one.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn subtract(before: &Rows, block: &mut Rows) {
    for (r, row) in block.iter_mut().enumerate() {
        let mut sum = *row;
        for from in before {
            let factor = from[NEXT + r];
            for j in 0..SLOW {
                sum[j] -= factor * from[NEXT + j];
            }
            for j in BORDER..ROW {
                sum[j] -= factor * from[j];
            }
        }
        *row = sum;
    }
}

/// Adds the products of a part's border with itself, above the diagonal.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn add_gram(gram: &mut [[f64; CONSTANTS]; CONSTANTS], rows: &Rows) {
    for (i, sum) in gram.iter_mut().enumerate() {
        for row in rows {
            let factor = row[BORDER + i];
            for j in 0..CONSTANTS {
                sum[j] += factor * row[BORDER + j];
            }
        }
    }
}
