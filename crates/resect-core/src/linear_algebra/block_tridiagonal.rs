//! Cholesky factorisation of a block tridiagonal matrix with a border, one block row at a time (a Kalman smoother's equations:
//! Rauch, Tung & Striebel 1965).
//!
//! The unknowns are blocks x_k of `N` numbers, each coupled to the next block and to `B` unknowns y that all have in common. A
//! block row lies in memory as `[D_k | E_k | F_k]`: its own block, the coupling to the next block, and the coupling to y. It has
//! `ROW = 2N + B` numbers for each of its `N` unknowns. Elimination leaves the upper factor U, and `U⁻ᵀ` times the rest.

use multiversion::multiversion;
use nalgebra::SMatrix;

use super::bordered_band::factorise;

/// A block row.
pub type BlockRow<const N: usize, const ROW: usize> = [[f64; ROW]; N];

/// Writes the factorised block row of a block to `rows`, given that of the block before it; `None` if it is not positive definite.
pub fn eliminate_block<const N: usize, const B: usize, const ROW: usize>(
    diagonal: &SMatrix<f64, N, N>,
    upper: &SMatrix<f64, N, N>,
    border: &SMatrix<f64, N, B>,
    before: Option<&BlockRow<N, ROW>>,
    rows: &mut BlockRow<N, ROW>,
) -> Option<()> {
    const { assert!(ROW == 2 * N + B) };
    for (i, row) in rows.iter_mut().enumerate() {
        for j in 0..N {
            row[j] = diagonal[(i, j)];
            row[N + j] = upper[(i, j)];
        }
        for j in 0..B {
            row[2 * N + j] = border[(i, j)];
        }
    }
    if let Some(before) = before {
        update(before, rows);
    }
    factorise(rows).then_some(())
}

/// Subtracts the Schur complement's share of a factorised block row from the next one.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
fn update<const N: usize, const ROW: usize>(
    before: &BlockRow<N, ROW>,
    target: &mut BlockRow<N, ROW>,
) {
    for (r, row) in target.iter_mut().enumerate() {
        let mut sum = *row;
        for from in before {
            let factor = from[N + r];
            for j in 0..N {
                sum[j] -= factor * from[N + j];
            }
            for j in 2 * N..ROW {
                sum[j] -= factor * from[j];
            }
        }
        *row = sum;
    }
}

/// Adds the Gram matrix FᵀF of the border F of a factorised block row.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn add_border_gram<const N: usize, const B: usize, const ROW: usize>(
    gram: &mut [[f64; B]; B],
    rows: &BlockRow<N, ROW>,
) {
    const { assert!(ROW == 2 * N + B) };
    for (i, sum) in gram.iter_mut().enumerate() {
        for row in rows {
            let factor = row[2 * N + i];
            for j in 0..B {
                sum[j] += factor * row[2 * N + j];
            }
        }
    }
}

/// Applies `U⁻ᵀ` to `K` right-hand sides of a block, and subtracts their share from those of the next block and of the border.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn forward_substitute<const N: usize, const B: usize, const ROW: usize, const K: usize>(
    rows: &BlockRow<N, ROW>,
    own: &mut [[f64; K]; N],
    mut next: Option<&mut [[f64; K]; N]>,
    border: &mut [[f64; K]; B],
) {
    const { assert!(ROW == 2 * N + B) };
    for (m, row) in rows.iter().enumerate() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        value.iter_mut().for_each(|value| *value /= row[m]);
        for (factor, other) in row[m + 1..N].iter().zip(after) {
            subtract_times(other, *factor, value);
        }
        if let Some(next) = next.as_deref_mut() {
            for (factor, other) in row[N..2 * N].iter().zip(next) {
                subtract_times(other, *factor, value);
            }
        }
        for (factor, other) in row[2 * N..].iter().zip(border.iter_mut()) {
            subtract_times(other, *factor, value);
        }
    }
}

/// Solves for the unknowns of a block, given those of the next block and of the border.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn back_substitute<const N: usize, const B: usize, const ROW: usize, const K: usize>(
    rows: &BlockRow<N, ROW>,
    own: &mut [[f64; K]; N],
    next: Option<&[[f64; K]; N]>,
    border: &[[f64; K]; B],
) {
    const { assert!(ROW == 2 * N + B) };
    for (m, row) in rows.iter().enumerate().rev() {
        let (value, after) = own[m..].split_first_mut().expect("a row");
        for (factor, other) in row[2 * N..].iter().zip(border) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[N..2 * N].iter().zip(next.into_iter().flatten()) {
            subtract_times(value, *factor, other);
        }
        for (factor, other) in row[m + 1..N].iter().zip(after) {
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    #[test]
    fn a_random_chain_is_solved_as_by_nalgebra() {
        const N: usize = 3;
        const B: usize = 2;
        const ROW: usize = 2 * N + B;
        const BLOCKS: usize = 5;
        const SIZE: usize = N * BLOCKS + B;
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(4);
        let mut dense = DMatrix::zeros(SIZE, SIZE);
        let is_coupled =
            |i: usize, j: usize| i.max(j) >= N * BLOCKS || (i / N).abs_diff(j / N) <= 1;
        for i in 0..SIZE {
            for j in (0..=i).filter(|j| is_coupled(i, *j)) {
                let value = rng.random_range(-1.0..1.0);
                (dense[(i, j)], dense[(j, i)]) = (value, value);
            }
            dense[(i, i)] += 12.0;
        }
        let right = DVector::from_fn(SIZE, |_, _| rng.random_range(-1.0..1.0));
        let mut rows: Vec<BlockRow<N, ROW>> = Vec::new();
        let mut gram = [[0.0; B]; B];
        for block in 0..BLOCKS {
            let at = N * block;
            let border = dense.fixed_view::<N, B>(at, N * BLOCKS).into_owned();
            let upper = match block + 1 < BLOCKS {
                true => dense.fixed_view::<N, N>(at, at + N).into_owned(),
                false => SMatrix::zeros(),
            };
            let diagonal = dense.fixed_view::<N, N>(at, at).into_owned();
            let mut row: BlockRow<N, ROW> = [[0.0; ROW]; N];
            eliminate_block::<N, B, ROW>(&diagonal, &upper, &border, rows.last(), &mut row)
                .expect("positive definite");
            rows.push(row);
            add_border_gram(&mut gram, &rows[block]);
        }
        let mut x: Vec<[[f64; 1]; N]> =
            (0..BLOCKS).map(|b| std::array::from_fn(|m| [right[N * b + m]])).collect();
        let mut y: [[f64; 1]; B] = std::array::from_fn(|m| [right[N * BLOCKS + m]]);
        for block in 0..BLOCKS {
            let (own, next) = x[block..].split_first_mut().expect("a block");
            forward_substitute(&rows[block], own, next.first_mut(), &mut y);
        }
        let border = SMatrix::<f64, B, B>::from_fn(|i, j| {
            dense[(N * BLOCKS + i, N * BLOCKS + j)] - gram[i.min(j)][i.max(j)]
        });
        let right_of_border = SMatrix::<f64, B, 1>::from_fn(|i, _| y[i][0]);
        let solved = border.cholesky().expect("positive definite").solve(&right_of_border);
        y = std::array::from_fn(|m| [solved[m]]);
        for block in (0..BLOCKS).rev() {
            let (own, next) = x[block..].split_first_mut().expect("a block");
            back_substitute(&rows[block], own, next.first(), &y);
        }
        let found = x.as_flattened().iter().chain(&y).map(|[value]| *value);
        let found = DVector::from_iterator(SIZE, found);
        let expected = dense.cholesky().expect("positive definite").solve(&right);
        assert!((found - expected).amax() < 1e-13);
    }

    #[test]
    fn a_block_that_is_not_positive_definite_is_refused() {
        let (one, none) = (SMatrix::<f64, 2, 2>::identity(), SMatrix::<f64, 2, 2>::zeros());
        let border = SMatrix::<f64, 2, 1>::zeros();
        let mut rows = [[0.0; 5]; 2];
        assert!(eliminate_block::<2, 1, 5>(&one, &none, &border, None, &mut rows).is_some());
        assert!(eliminate_block::<2, 1, 5>(&-one, &none, &border, None, &mut rows).is_none());
    }
}
