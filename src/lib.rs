//! placeholder
#![forbid(unsafe_code)]
pub mod analysis;
pub mod app;
pub mod calibration;
pub mod command;
pub mod deployment;
pub mod evaluation;
pub mod export;
pub mod geometry;
pub mod palette;
pub mod pipeline;
pub mod simulation;
