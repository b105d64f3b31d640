//! Blocks of time whose errors are taken to be independent of each other.
//!
//! Ten triplets a second from 2.5 readings a second share their errors, and so do the chords of one bend. Sandwich estimators and
//! training splits must therefore not treat neighbouring triplets as independent.

use std::ops::Range;

/// Length of a block (s).
pub const BLOCK_SECONDS: f64 = 5.0;

/// Returns ranges of consecutive triplets of one interval, none longer than [`BLOCK_SECONDS`].
pub fn of(time_s: &[f64], interval: &[u32]) -> Vec<Range<usize>> {
    let mut blocks = Vec::new();
    let mut start = 0;
    for i in 1..=time_s.len() {
        let ends = i == time_s.len()
            || interval[i] != interval[start]
            || time_s[i] - time_s[start] >= BLOCK_SECONDS;
        if ends {
            blocks.push(start..i);
            start = i;
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_cover_everything_once_and_stay_in_their_interval() {
        let time_s: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.1).collect();
        let interval: Vec<u32> = (0..200).map(|i| u32::from(i >= 73)).collect();
        let blocks = of(&time_s, &interval);
        let mut next = 0;
        for block in &blocks {
            assert_eq!(block.start, next);
            assert!(interval[block.start] == interval[block.end - 1]);
            assert!(time_s[block.end - 1] - time_s[block.start] < BLOCK_SECONDS);
            next = block.end;
        }
        assert_eq!(next, 200);
        assert_eq!(blocks.len(), 2 + 3);
    }
}
