use resect_core::deployment::{Finding, Overrides};
use resect_core::progress::Progress;

use super::found::FoundFile;

/// What the readers of everything beside the tracks share.
pub struct Reading<'a, 'b> {
    pub files: &'a [FoundFile],
    pub overrides: &'a Overrides,
    /// The overrides that the user says, over those that the folder says.
    pub put_right: &'a Overrides,
    /// The inter-prism distances by the rig's files (m), once they are read.
    pub distances_of_files_m: Option<[f64; 3]>,
    pub progress: &'a Progress,
    /// Names of the files that were read.
    pub used: &'b mut Vec<&'a str>,
    pub findings: &'b mut Vec<Finding>,
}
