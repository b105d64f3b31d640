//! Products with matrices that are mostly zeros, as the Jacobians of a block's unknowns are.

use nalgebra::DMatrix;

/// Returns `dense · sparse`, without the zeros of `sparse`.
pub fn by_sparse(dense: &DMatrix<f64>, sparse: &DMatrix<f64>) -> DMatrix<f64> {
    assert_eq!(dense.ncols(), sparse.nrows());
    let mut product = DMatrix::zeros(dense.nrows(), sparse.ncols());
    if dense.is_empty() || sparse.is_empty() {
        return product;
    }
    let (dense_rows, sparse_rows) = (dense.nrows(), sparse.nrows());
    let factors = sparse.as_slice().chunks_exact(sparse_rows);
    for (column, factors) in product.as_mut_slice().chunks_exact_mut(dense_rows).zip(factors) {
        for (factor, values) in factors.iter().zip(dense.as_slice().chunks_exact(dense_rows)) {
            if *factor != 0.0 {
                column.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
            }
        }
    }
    product
}

/// Returns `sparseᵀ · dense`, without the zeros of `sparse`.
pub fn by_sparse_transpose(sparse: &DMatrix<f64>, dense: &DMatrix<f64>) -> DMatrix<f64> {
    by_sparse(&dense.transpose(), sparse).transpose()
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    #[test]
    fn products_are_those_of_nalgebra() {
        let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(1);
        let mut random = |rows: usize, columns: usize, share: f64| {
            DMatrix::from_fn(rows, columns, |_, _| {
                let value = rng.random_range(-1.0..1.0);
                if rng.random_range(0.0..1.0) < share { value } else { 0.0 }
            })
        };
        for (rows, inner, columns) in [(14, 14, 42), (1, 5, 3), (4, 0, 2), (0, 3, 3)] {
            let (dense, sparse) = (random(rows, inner, 1.0), random(inner, columns, 0.3));
            assert!((by_sparse(&dense, &sparse) - &dense * &sparse).amax() < 1e-14);
            let dense = random(inner, rows, 1.0);
            let expected = sparse.transpose() * &dense;
            assert!((by_sparse_transpose(&sparse, &dense) - expected).amax() < 1e-14);
        }
    }
}
