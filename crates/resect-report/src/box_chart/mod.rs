//! A study as groups of box plots, as in the paper's figures, laid out for any size.

mod boxes;
mod chart;
mod foot;
mod sizes;

pub use chart::{LaidOut, draw, lay_out};
