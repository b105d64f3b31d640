use resect_core::deployment::{Finding, Overrides};
use resect_core::network::PerPair;
use resect_core::progress::Progress;

use super::found::FoundFile;

/// Input and output shared by the readers of everything but tracks.
pub struct Reading<'a, 'b> {
    pub files: &'a [FoundFile],
    pub overrides: &'a Overrides,
    /// Overrides of the user, which take precedence over those of the folder.
    pub corrections: &'a Overrides,
    /// Distances between the prisms from the rig's files (m), after these are read.
    pub distances_of_files_m: Option<PerPair<f64>>,
    pub progress: &'a Progress,
    /// Names of the files that were read.
    pub used: &'b mut Vec<&'a str>,
    pub findings: &'b mut Vec<Finding>,
}
