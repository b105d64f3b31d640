//! What an estimate and the ground truth do not share: the zero of their clocks, where the estimate's body is in the vehicle,
//! and the estimate's frame.
//!
//! Clocks and lever arm are found together with the frame, by Gauss & Newton with Huber's loss on the distances between the
//! two; their σ come from blocks of time (a sandwich), because errors of estimates drift, and from the errors that the ground
//! truth has at all instants alike, which no estimate's errors tell of. Then the frame is aligned once more, by plain least
//! squares over all epochs, as evo does it.

mod body;
mod fit;
mod fit_estimate;
mod pieces;
mod state;

pub use fit::Fit;
pub use fit_estimate::{align, fit};
