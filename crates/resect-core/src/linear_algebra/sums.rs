//! Dot products, outer products and sums in SIMD lanes.

use multiversion::multiversion;
use nalgebra::SMatrix;

/// Numbers in the widest vector register.
const WIDEST: usize = 8;
/// Rows of an outer product that are added together.
const OUTER: usize = 4;

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

/// Adds `weight · v vᵀ` on and below the diagonal, and up to three entries above it in each column. `N` is a multiple of 4. Columns
/// for zeros of `v` are skipped.
pub fn add_outer_product<const N: usize>(
    matrix: &mut SMatrix<f64, N, N>,
    vector: &SMatrix<f64, N, 1>,
    weight: f64,
) {
    const { assert!(N.is_multiple_of(OUTER)) };
    add_columns(matrix.as_mut_slice(), vector.as_slice(), weight);
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
        let mut vector = SVector::<f64, 12>::from_fn(|_, _| rng.random_range(-1.0..1.0));
        vector[3] = 0.0;
        let before = SMatrix::<f64, 12, 12>::from_fn(|_, _| rng.random_range(-1.0..1.0));
        let mut matrix = before;
        add_outer_product(&mut matrix, &vector, 0.3);
        let expected = before + vector * vector.transpose() * 0.3;
        for i in 0..12 {
            for j in 0..=i {
                assert!((matrix[(i, j)] - expected[(i, j)]).abs() < 1e-15, "{i}, {j}");
            }
        }
    }
}
