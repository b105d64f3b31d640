//! Dot products, outer products and sums in SIMD lanes.

use multiversion::multiversion;
use nalgebra::DMatrix;

/// Numbers in the widest vector register.
const WIDEST: usize = 8;
/// Rows of an outer product that are added together.
pub const OUTER: usize = 4;

/// Returns the dot product, summed in as many lanes as a vector register has.
#[inline(always)]
pub fn dot(a: &[f64], b: &[f64]) -> f64 {
    let (a_whole, a_rest) = a.as_chunks::<WIDEST>();
    let (b_whole, b_rest) = b.as_chunks::<WIDEST>();
    let mut sums = [0.0; WIDEST];
    for (a, b) in a_whole.iter().zip(b_whole) {
        for lane in 0..WIDEST {
            sums[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    sums.iter().sum::<f64>() + rest
}

/// Adds `weight · v vᵀ` on and below the diagonal, and up to three entries above it in each column. The length of `v` is a multiple
/// of [`OUTER`]. Columns for zeros of `v` are skipped.
pub fn add_outer_product(matrix: &mut DMatrix<f64>, vector: &[f64], weight: f64) {
    assert!(vector.len().is_multiple_of(OUTER) && matrix.nrows() == vector.len());
    add_columns(matrix.as_mut_slice(), vector, weight);
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq", "x86_64+avx2"))]
fn add_columns(matrix: &mut [f64], vector: &[f64], weight: f64) {
    let (rows, _) = vector.as_chunks::<OUTER>();
    for (index, column) in matrix.chunks_exact_mut(vector.len()).enumerate() {
        let factor = weight * vector[index];
        if factor == 0.0 {
            continue;
        }
        let (column, _) = column.as_chunks_mut::<OUTER>();
        let first = index / OUTER;
        for (sum, row) in column[first..].iter_mut().zip(&rows[first..]) {
            for (sum, row) in sum.iter_mut().zip(row) {
                *sum += factor * row;
            }
        }
    }
}

/// Adds the products of two vectors, lane by lane.
#[inline(always)]
pub fn multiply_add<const L: usize>(sum: &mut [f64; L], a: &[f64; L], b: &[f64; L]) {
    for lane in 0..L {
        sum[lane] += a[lane] * b[lane];
    }
}

/// Returns the sum of all lanes, first to last.
#[inline(always)]
pub fn sum_lanes<const L: usize>(lanes: &[f64; L]) -> f64 {
    let mut sum = 0.0;
    for lane in 0..L {
        sum += lanes[lane];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DVector, SVector};
    use rand::{RngExt, SeedableRng};

    #[test]
    fn sums_agree_with_nalgebra_on_random_vectors() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        for length in [0, 1, 7, 8, 9, 40] {
            let a = DVector::from_fn(length, |_, _| rng.random_range(-1.0..1.0));
            let b = DVector::from_fn(length, |_, _| rng.random_range(-1.0..1.0));
            assert!((dot(a.as_slice(), b.as_slice()) - a.dot(&b)).abs() < 1e-14, "{length}");
        }
        let a = SVector::<f64, 5>::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let mut products = [1.0; 5];
        multiply_add(&mut products, &a.into(), &a.into());
        assert!((sum_lanes(&products) - (5.0 + a.norm_squared())).abs() < 1e-14);
    }

    #[test]
    fn an_outer_product_is_nalgebra_s_below_the_diagonal_and_leaves_the_rest() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(2);
        let mut vector = DVector::from_fn(12, |_, _| rng.random_range(-1.0..1.0));
        vector[3] = 0.0;
        let before = DMatrix::from_fn(12, 12, |_, _| rng.random_range(-1.0..1.0));
        let mut matrix = before.clone();
        add_outer_product(&mut matrix, vector.as_slice(), 0.3);
        let expected = before + &vector * vector.transpose() * 0.3;
        for i in 0..12 {
            for j in 0..=i {
                assert!((matrix[(i, j)] - expected[(i, j)]).abs() < 1e-15, "{i}, {j}");
            }
        }
    }
}
