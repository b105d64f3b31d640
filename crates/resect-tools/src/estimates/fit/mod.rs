//! Fit of an estimate to the ground truth: time offset, position of the body in the vehicle, and transform of the estimate's
//! frame.
//!
//! Gauss–Newton steps estimate time offset, lever arm, body rotation and scale beside a frame that wanders ([`wandering_frame`]). The sizes of
//! noise and drift have the largest likelihood. Noise of orientations is no information on a lever arm ([`instruments`]), and noise of velocities is
//! none on the clock ([`neighbours`], [`clock_information`]). σ have two sources. A
//! sandwich estimator over blocks of time needs no model of the innovations. The errors of the ground truth that are common to all instants are
//! added, because the residuals do not show them. Finally plain least squares over all epochs aligns the frame, as evo does.

mod alignment;
mod clock_change;
mod clock_evidence;
mod clock_information;
mod drift_sizes;
mod epoch_rows;
mod fit;
mod fit_estimate;
mod instruments;
mod likelihood;
mod neighbours;
mod refine;
mod state;
mod unknowns;
mod wandering_frame;

#[cfg(test)]
mod tests;

pub use alignment::align;
pub use clock_change::ClockChange;
pub use fit::{Fit, FitCovariance, LEAST_GAIN, LEVER_SIGMA_M};
pub use fit_estimate::fit;
pub use unknowns::{BODY, CLOCK};
