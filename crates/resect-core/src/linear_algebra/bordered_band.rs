//! Cholesky factorisation of a banded matrix with a border, one block row at a time.
//!
//! Rows of `A x + B y = b` with the unknowns x in blocks of `N`, each coupled to the next three blocks. A block row lies in
//! memory as `[A_kk | A_k,k+1 | A_k,k+2 | A_k,k+3 | border]`, `ROW` numbers for each of its `N` unknowns. The border begins with
//! the right-hand side b; its other columns are B. Elimination leaves the upper factor U of `A = UᵀU`, and `U⁻ᵀ` times the border.

use multiversion::multiversion;

use super::sums::dot;

/// Blocks of a block row: its own and the three after it.
pub const BANDWIDTH: usize = 4;
/// Index of the right-hand side in the border.
pub const RIGHT_HAND_SIDE: usize = 0;
/// A pivot below this share of its diagonal element is lost in rounding.
const LEAST_PIVOT: f64 = 1e-13;

/// Factorises the own block of a block row, and applies `U⁻ᵀ` to all right of it; `false` if the block is not positive definite.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn factorise<const N: usize, const ROW: usize>(rows: &mut [[f64; ROW]; N]) -> bool {
    let before: [f64; N] = std::array::from_fn(|m| rows[m][m]);
    for m in 0..N {
        let (above, below) = rows.split_at_mut(m + 1);
        let row = &mut above[m];
        let pivot = row[m];
        if pivot.is_nan() || pivot <= LEAST_PIVOT * before[m] {
            return false;
        }
        let inverse = 1.0 / pivot.sqrt();
        row.iter_mut().for_each(|value| *value *= inverse);
        for (offset, other) in below.iter_mut().enumerate() {
            let factor = row[m + 1 + offset];
            for (value, own) in other.iter_mut().zip(row.iter()) {
                *value -= factor * own;
            }
        }
    }
    true
}

/// Subtracts the Schur complement's share of a factorised block row from the `AWAY`-th block row after it.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn update<const N: usize, const ROW: usize, const AWAY: usize>(
    own: &[[f64; ROW]; N],
    target: &mut [[f64; ROW]; N],
) {
    // Both couple to the target's own block and the blocks after it, as far as the band reaches, and to the border.
    let coupled = (BANDWIDTH - AWAY) * N;
    for (r, row) in target.iter_mut().enumerate() {
        let mut sum = *row;
        for from in own {
            let factor = from[N * AWAY + r];
            for c in 0..coupled {
                sum[c] -= factor * from[N * AWAY + c];
            }
            for c in BANDWIDTH * N..ROW {
                sum[c] -= factor * from[c];
            }
        }
        *row = sum;
    }
}

/// Adds the Gram matrix of a factorised block row's border, on and above the diagonal.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn add_border_gram<const N: usize, const ROW: usize, const BORDER: usize>(
    gram: &mut [[f64; BORDER]; BORDER],
    own: &[[f64; ROW]; N],
) {
    const { assert!((ROW - BANDWIDTH * N).is_multiple_of(4) && ROW - BANDWIDTH * N <= BORDER) };
    let width = ROW - BANDWIDTH * N;
    let mut borders = [[0.0; BORDER]; N];
    for (to, from) in borders.iter_mut().zip(own) {
        to[..width].copy_from_slice(&from[BANDWIDTH * N..]);
    }
    // Four rows at a time share each number that is read. The lower triangle is computed too, and never read.
    let (fours, _) = gram[..width].as_chunks_mut::<4>();
    for (four, rows) in fours.iter_mut().enumerate() {
        let mut sums = *rows;
        for border in &borders {
            for (r, sum) in sums.iter_mut().enumerate() {
                let factor = border[4 * four + r];
                for (value, own) in sum[..width].iter_mut().zip(&border[..width]) {
                    *value += factor * own;
                }
            }
        }
        *rows = sums;
    }
}

/// Solves for the unknowns of a block row, the first of `x`, given those of the blocks after it and `−1, y` in `border`.
///
/// The result solves `A x + B y = b`: the −1 moves b to the right-hand side.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn back_substitute<const N: usize, const ROW: usize>(
    rows: &[[f64; ROW]; N],
    border: &[f64],
    x: &mut [f64],
) {
    for m in (0..N).rev() {
        let row = &rows[m];
        let border = &border[..ROW - BANDWIDTH * N];
        let known = dot(&row[m + 1..x.len()], &x[m + 1..]) + dot(&row[BANDWIDTH * N..], border);
        x[m] = -known / row[m];
    }
}

/// Applies `U⁻ᵀ` to another right-hand side, `own` of this block row and `after` of the next three, and keeps it in the rows.
///
/// Adds to `border` the products of the border's columns with the result.
#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+fma", "x86_64+avx2+fma"))]
pub fn forward_substitute<const N: usize, const ROW: usize>(
    rows: &mut [[f64; ROW]; N],
    own: &[f64; N],
    after: &mut [[f64; N]],
    border: &mut [f64],
) {
    let mut own = *own;
    for (m, row) in rows.iter_mut().enumerate() {
        let value = own[m] / row[m];
        for (other, factor) in own[m + 1..].iter_mut().zip(&row[m + 1..N]) {
            *other -= value * factor;
        }
        for (other, factor) in after.as_flattened_mut().iter_mut().zip(&row[N..BANDWIDTH * N]) {
            *other -= value * factor;
        }
        for (sum, factor) in border.iter_mut().zip(&row[BANDWIDTH * N..]) {
            *sum += value * factor;
        }
        row[BANDWIDTH * N + RIGHT_HAND_SIDE] = value;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};
    use rand::{RngExt, SeedableRng};

    const N: usize = 3;
    const BLOCKS: usize = 9;
    const BORDER: usize = 4;
    const ROW: usize = BANDWIDTH * N + BORDER;
    const SIZE: usize = N * BLOCKS;

    /// Returns a random positive definite band with its border, dense and as block rows.
    fn random_band(seed: u64) -> (DMatrix<f64>, DMatrix<f64>, Vec<[[f64; ROW]; N]>) {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(seed);
        let is_coupled = |i: usize, j: usize| (i / N).abs_diff(j / N) < BANDWIDTH;
        let mut band = DMatrix::zeros(SIZE, SIZE);
        for i in 0..SIZE {
            for j in (0..=i).filter(|j| is_coupled(i, *j)) {
                let value = rng.random_range(-1.0..1.0);
                (band[(i, j)], band[(j, i)]) = (value, value);
            }
            band[(i, i)] += 14.0;
        }
        let border = DMatrix::from_fn(SIZE, BORDER, |_, _| rng.random_range(-1.0..1.0));
        let mut rows = vec![[[0.0; ROW]; N]; BLOCKS];
        for (block, rows) in rows.iter_mut().enumerate() {
            for (m, row) in rows.iter_mut().enumerate() {
                for c in 0..(BANDWIDTH * N).min(SIZE - N * block) {
                    row[c] = band[(N * block + m, N * block + c)];
                }
                for c in 0..BORDER {
                    row[BANDWIDTH * N + c] = border[(N * block + m, c)];
                }
            }
        }
        (band, border, rows)
    }

    /// Eliminates all block rows, and returns the Gram matrix of the border.
    fn eliminate(rows: &mut [[[f64; ROW]; N]]) -> [[f64; BORDER]; BORDER] {
        let mut gram = [[0.0; BORDER]; BORDER];
        for block in 0..rows.len() {
            let (own, after) = rows[block..].split_first_mut().expect("a block");
            assert!(factorise(own));
            if let Some(target) = after.first_mut() {
                update::<N, ROW, 1>(own, target);
            }
            if let Some(target) = after.get_mut(1) {
                update::<N, ROW, 2>(own, target);
            }
            if let Some(target) = after.get_mut(2) {
                update::<N, ROW, 3>(own, target);
            }
            add_border_gram(&mut gram, own);
        }
        gram
    }

    #[test]
    fn the_factor_and_the_border_are_nalgebra_s() {
        let (band, border, mut rows) = random_band(1);
        let gram = eliminate(&mut rows);
        let factor = band.cholesky().expect("positive definite").l();
        let solved = factor.solve_lower_triangular(&border).expect("regular");
        let expected_gram = solved.tr_mul(&solved);
        for (block, rows) in rows.iter().enumerate() {
            for (m, row) in rows.iter().enumerate() {
                let i = N * block + m;
                for c in m..(BANDWIDTH * N).min(SIZE - N * block) {
                    assert!((row[c] - factor[(N * block + c, i)]).abs() < 1e-13, "{i}, {c}");
                }
                for c in 0..BORDER {
                    assert!((row[BANDWIDTH * N + c] - solved[(i, c)]).abs() < 1e-13, "{i}, {c}");
                }
            }
        }
        for i in 0..BORDER {
            for j in i..BORDER {
                assert!((gram[i][j] - expected_gram[(i, j)]).abs() < 1e-12, "{i}, {j}");
            }
        }
    }

    #[test]
    fn substitution_solves_the_system_for_any_right_hand_side() {
        let (band, border, mut rows) = random_band(2);
        eliminate(&mut rows);
        let right = DVector::from_fn(SIZE, |i, _| (i as f64).sin());
        let y = [0.4, -0.2, 0.9];
        let mut blocks: Vec<[f64; N]> =
            (0..BLOCKS).map(|b| std::array::from_fn(|m| right[N * b + m])).collect();
        for block in 0..BLOCKS {
            let (own, after) = blocks[block..].split_first_mut().expect("a block");
            let within = after.len().min(BANDWIDTH - 1);
            forward_substitute(&mut rows[block], own, &mut after[..within], &mut [0.0; BORDER]);
        }
        let mut x = vec![0.0; SIZE];
        for block in (0..BLOCKS).rev() {
            let end = SIZE.min(N * (block + BANDWIDTH));
            back_substitute(&rows[block], &[-1.0, y[0], y[1], y[2]], &mut x[N * block..end]);
        }
        let of_border = border.columns(1, 3) * DVector::from_row_slice(&y);
        let expected = band.cholesky().expect("positive definite").solve(&(right - of_border));
        assert!((DVector::from_vec(x) - expected).amax() < 1e-13);
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        let (_, _, mut rows) = random_band(3);
        rows[0][1][1] = -1.0;
        assert!(!factorise(&mut rows[0]));
        rows[0][0][0] = f64::NAN;
        assert!(!factorise(&mut rows[0]));
    }
}
