//! The kernels of the estimators: matrices of a known structure, factorised and summed by vector instructions.
//!
//! | file | structure | used by |
//! |---|---|---|
//! | [`bordered_rows`] | banded matrix with a border | motion and slow states of the joint estimate |
//! | [`dense_tiles`] | dense matrix of a few dozen rows with right-hand sides | Gaussian processes of the interpolation |
//! | [`sparse_products`] | products with matrices that are mostly zeros | Jacobians of the joint estimate |
//! | [`sums`] | dot and outer products | method D and its clock check, [`bordered_rows`] |
//!
//! Everything else uses nalgebra. These four are several times faster than it, because their loops run over neighbours in memory
//! and `multiversion` compiles most of them for AVX-512, AVX2 and every other processor. Each is tested against nalgebra on random
//! matrices.

pub mod bordered_rows;
pub mod dense_tiles;
pub mod sparse_products;
pub mod sums;
