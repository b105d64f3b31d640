//! One example of each finding of this crate.

use super::{answers, checks, clocks, drive, instruments, mirror, outliers, points, recordings};
use crate::deployment::Finding;

/// An example of each kind of finding that this crate makes.
pub fn examples() -> Vec<Finding> {
    [
        answers::examples(),
        checks::examples(),
        clocks::examples(),
        drive::examples(),
        instruments::examples(),
        mirror::examples(),
        outliers::examples(),
        points::examples(),
        recordings::examples(),
    ]
    .concat()
}
