//! One example of each finding of this crate.

use super::{conventions, planning, studies, validation};
use resect_core::deployment::Finding;

/// An example of each kind of finding that this crate makes.
pub fn examples() -> Vec<Finding> {
    [planning::examples(), conventions::examples(), studies::examples(), validation::examples()]
        .concat()
}
