//! Planning: predicts the information of a drive before it is driven, and suggests improvements.
//!
//! ```text
//! Plan ──drive──▶ readings without noise ──joint::predict──▶ Prediction ──improvements──▶ better plans, ranked
//!        before any readings: opening_m; readings so far of a drive in progress ──what_next──▶ manoeuvres, ranked
//! ```
//! A [`Plan`] is a file (`resect_io::plan_file`), or is derived from a preset or a past deployment ([`past`]). [`way`] lays
//! out its path, which `resect_io::way_file` can read. [`drive`] simulates the drive and its readings. [`predict()`]
//! computes the covariance of the joint estimate from such readings, under the conditions of [`locks`]. [`in_words`]
//! formats it. [`improvements()`] evaluates [`manoeuvres`] and other changes. Where a drive shows a narrow place ([`corridor`]),
//! only manoeuvres that fit it are tried.

mod corridor;
mod drive;
mod from_here;
mod improvements;
mod in_words;
pub mod locks;
mod manoeuvres;
mod opening;
pub mod past;
pub mod plan;
mod predict;
mod prediction;
mod so_far;
pub mod way;
mod what_next;

pub use improvements::{Improvement, ImprovementKind, improvements};
pub use manoeuvres::{FigureEight, Loop};
pub use opening::{OPENING, opening_m};
pub use plan::{Plan, PlannedInstrument, PlannedRig};
pub use predict::predict;
pub use prediction::{Held, OnTheWay, PlanError, Prediction};
pub use so_far::SoFar;
pub use way::Piece;
pub use what_next::{DriveAdvice, Known, NextMove, known, what_next};
