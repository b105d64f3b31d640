//! Conversion of raw polar tracks to triplets: the four modules of the paper's pre-processing pipeline.
//!
//! ```text
//! tracks ─1 outlier filter─▶ filtered ─2 interval split─▶ intervals ─3 interval filter─▶ kept ─4 interpolation─▶ triplets
//! ```
//! Each stage is a pure function of the one before it and of its own settings. `StagedPipeline` stores the last output of
//! each stage, so that a change re-runs only the stages that depend on it.

mod all_readings;
pub mod explanation;
pub mod interpolation;
pub mod interval_filter;
pub mod interval_split;
mod numbers;
pub mod outlier_filter;
mod settings;
mod staged;
mod triplets;

pub use interval_split::Interval;
pub use numbers::{PIPELINE_NUMBERS, RATE, TAU_A, TAU_E, TAU_L, TAU_R, TAU_S};
pub use outlier_filter::{FilteredTrack, OutlierReason};
pub use settings::{Interpolation, PipelineSettings, Thresholds};
pub use staged::StagedPipeline;
pub use staged::{Fates, PipelineOutput, SampleFate, run};
pub use triplets::Triplets;
