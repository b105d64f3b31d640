//! Plans: what a drive will tell before it is driven, and what would tell more.
//!
//! ```text
//! Plan ──drive──▶ readings without noise ──joint::foresee──▶ Prediction ──improvements──▶ better plans, ranked
//!         before there are any: opening_m; readings so far of a drive in progress ──what_next──▶ manoeuvres, ranked
//! ```
//! A [`Plan`] is a file (`resect_io::plan_file`) or made from a preset or a past deployment ([`past`]); [`way`] lays out its way, which `resect_io::way_file` can read, and
//! [`drive`] drives and reads it by the simulation. [`predict()`] asks the joint estimate what such readings leave open, with
//! the conditions of [`locks`]; [`in_words`] says it. [`improvements()`] tries [`manoeuvres`] and other changes.

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
pub use what_next::{Advice, Known, NextMove, known, what_next};
