//! Places of the unknowns in the vector of the fit.

/// Number of unknowns.
pub const UNKNOWNS: usize = 8;
/// First index of each kind of unknown; the lever arm begins at 0.
pub const CLOCK: usize = 3;
pub const BODY: usize = 4;
pub const SCALE: usize = 7;

/// Columns of derivatives: the unknowns, of which the lever arm is by its instruments, and the lever arm by the residuals.
pub const BY_RESIDUAL: usize = UNKNOWNS;
pub const COLUMNS: usize = UNKNOWNS + 3;
