//! Fit of an estimate to the ground truth: time offset, position of the body in the vehicle, and transform of the estimate's
//! frame.
//!
//! Gauss–Newton steps with Huber's loss on the position differences estimate time offset, lever arm and frame together. σ of
//! time offset and lever arm have two sources. A sandwich estimator over blocks of time accounts for the drift of the estimate.
//! The errors of the ground truth that are common to all instants are added, because the residuals do not show them. Finally
//! plain least squares over all epochs aligns the frame again, as evo does.

mod body;
mod fit;
mod fit_estimate;
mod pieces;
mod state;

pub use fit::Fit;
pub use fit_estimate::{align, fit};
