//! Places of the unknowns in the vector of the fit.

/// Number of unknowns.
pub const UNKNOWNS: usize = 8;
/// First index of each kind of unknown; the lever arm begins at 0.
pub const CLOCK: usize = 3;
pub const BODY: usize = 4;
pub const SCALE: usize = 7;

/// Columns of derivatives: the unknowns, of which the lever arm is by the estimate's orientations, and the lever arm by those of the ground truth.
/// Against positions, these are those between the poses before and after, and those of the poses.
pub const BY_TRUTH: usize = UNKNOWNS;
pub const COLUMNS: usize = UNKNOWNS + 3;
