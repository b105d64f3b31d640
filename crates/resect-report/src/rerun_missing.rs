//! Stands in for the Rerun export in builds without the feature `rerun`.

use std::path::Path;

use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;

#[derive(Debug, thiserror::Error)]
#[error("this build has no Rerun export; build with `--features rerun`")]
pub struct RerunError;

pub fn save(_: &Deployment, _: &Analysis, _: &Path) -> Result<(), RerunError> {
    Err(RerunError)
}

pub fn open_viewer(_: &Deployment, _: &Analysis) -> Result<(), RerunError> {
    Err(RerunError)
}
