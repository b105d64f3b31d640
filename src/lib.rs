//! placeholder
#![forbid(unsafe_code)]
pub mod calibration;
pub mod deployment;
pub mod geometry;
pub mod pipeline;
