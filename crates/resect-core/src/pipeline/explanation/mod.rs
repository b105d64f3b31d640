//! Why the pipeline did to one raw reading what it did.

mod explanation;
mod remedy;
#[cfg(test)]
mod tests;
mod words;

pub use explanation::{Explanation, Place, Rate, Silence, Step, explain};
