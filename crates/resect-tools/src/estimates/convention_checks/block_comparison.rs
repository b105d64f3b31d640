//! Significance of a difference between two fits, by the blocks of a drive.

/// Blocks of a drive.
pub const BLOCKS: usize = 12;
/// Two fits differ if Student's t of the blocks exceeds this: with 11 degrees of freedom once in 2500 drives.
pub const SIGNIFICANT: f64 = 5.0;

/// Sums of squares of each block, from the squares of consecutive errors.
pub fn block_sums(squares: &[f64]) -> Vec<f64> {
    squares.chunks(squares.len().div_ceil(BLOCKS).max(1)).map(|block| block.iter().sum()).collect()
}

/// Returns Student's t of the logarithms of the ratios of two fits' sums of squares: positive if the second fits better.
pub fn students_t(first: &[f64], second: &[f64]) -> f64 {
    let ratios: Vec<f64> =
        first.iter().zip(second).map(|(first, second)| (first / second).ln()).collect();
    let count = ratios.len() as f64;
    let mean = ratios.iter().sum::<f64>() / count;
    let variance = ratios.iter().map(|ratio| (ratio - mean).powi(2)).sum::<f64>() / (count - 1.0);
    mean / (variance / count).sqrt().max(f64::MIN_POSITIVE)
}
