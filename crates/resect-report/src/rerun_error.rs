//! Errors of the Rerun export.

use resect_io::atomic::WriteError;

#[derive(Debug, thiserror::Error)]
pub enum RerunError {
    #[error(transparent)]
    Write(#[from] WriteError),
    #[error("the Rerun SDK failed: {0}; report it, with the data")]
    Sdk(String),
    #[error("the Rerun viewer did not start: {0}; install it with `pip install rerun-sdk=={1}`")]
    NoViewer(String, &'static str),
    #[error("this build has no Rerun export; build with `--features rerun`")]
    NotBuilt,
}
