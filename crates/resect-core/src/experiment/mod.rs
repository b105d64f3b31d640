//! The paper's studies, over one or many deployments: [`ablate`] (modules of the pipeline), [`sweep`] (a threshold),
//! [`compare`] (the calibrations).
//!
//! Each gives a [`Study`]: boxes of errors with a label each, which the terminal, CSV, JSON, pictures and the window
//! all show. [`Progress`](crate::progress::Progress) tells how far one
//! is, in steps, and stops it.

mod ablation;
mod comparison;
mod error;
mod reference;
mod sensitivity;
mod split;
mod study;

pub use ablation::ablate;
pub use comparison::{Compared, Comparison, compare};
pub use error::StudyError;
pub use reference::Reference;
pub use sensitivity::{Parameter, Sweep, sweep};
pub use split::Splits;
pub use study::{Group, INSTRUMENT_NOISE_MM, Level, Quantiles, Series, Study};
