//! The paper's studies, over one or many deployments: [`ablate`] (modules of the pipeline), [`sweep`] (a threshold),
//! [`sweep_answers`] (a threshold, with a calibration for each value), [`compare`] (the calibrations).
//!
//! Each returns a [`Study`]: labelled boxes of errors, which the terminal, CSV, JSON, pictures and the window show.
//! [`Progress`](resect_core::progress::Progress) counts the steps of a study, and cancels it.

mod ablation;
mod answers;
mod comparison;
mod error;
mod reference;
mod sensitivity;
mod split;
mod study;

pub use ablation::ablate;
pub use answers::sweep_answers;
pub use comparison::{Compared, Comparison, compare};
pub use error::StudyError;
pub use reference::Reference;
pub use sensitivity::{Parameter, Sweep, sweep};
pub use split::Splits;
pub use study::{Group, INSTRUMENT_NOISE_MM, Level, Quantiles, Series, Study};
