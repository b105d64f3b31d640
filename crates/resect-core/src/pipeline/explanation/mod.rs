//! Explanation of the fate of one raw reading.

mod explanation;
mod remedy;
#[cfg(test)]
mod tests;
mod words;

pub use explanation::{Explanation, Place, Rate, Silence, Step, explain};
