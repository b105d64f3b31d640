//! The kernels of the estimators: matrices of a known structure, factorised and summed by vector instructions.
//!
//! | file | structure | used by |
//! |---|---|---|
//! | [`bordered_band`] | banded matrix with a border | the motion of the joint estimate |
//! | [`block_tridiagonal`] | block tridiagonal matrix with a border | the slow states of the joint estimate |
//! | [`dense_tiles`] | dense matrix of a few dozen rows with right-hand sides | Gaussian processes of the interpolation |
//! | [`sums`] | dot and outer products | method D and its clock check, [`bordered_band`] |
//!
//! Everything else uses nalgebra. These four are several times faster than it, because their loops run over neighbours in memory
//! and `multiversion` compiles them for AVX-512, AVX2 and every other processor. Each is tested against nalgebra on random
//! matrices.

pub mod block_tridiagonal;
pub mod bordered_band;
pub mod dense_tiles;
pub mod sums;
