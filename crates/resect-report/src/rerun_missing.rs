//! Replaces the Rerun export in builds without the feature `rerun`.

use std::path::Path;

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;

use super::rerun_error::RerunError;

pub fn save(_: &Deployment, _: &Analysis, _: &Path) -> Result<(), RerunError> {
    Err(RerunError::NotBuilt)
}

pub fn open_viewer(_: &Deployment, _: &Analysis) -> Result<(), RerunError> {
    Err(RerunError::NotBuilt)
}
