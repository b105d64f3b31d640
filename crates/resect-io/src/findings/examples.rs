//! One example of each finding of this crate.

use resect_core::deployment::Finding;

use super::{bags, control_points, gnss, positions, readings, rig, surveys, tracks, trajectories};

/// Returns an example of each kind of finding of this crate.
pub fn examples() -> Vec<Finding> {
    [
        bags::examples(),
        control_points::examples(),
        gnss::examples(),
        positions::examples(),
        readings::examples(),
        rig::examples(),
        surveys::examples(),
        tracks::examples(),
        trajectories::examples(),
    ]
    .concat()
}
