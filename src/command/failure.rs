//! The failure of a command.

/// Reason for which a command ends without an answer.
#[derive(Debug)]
pub enum Failure {
    /// The user's words are off: exit code 2.
    Usage(String),
    /// The input is: exit code 1.
    Input(anyhow::Error),
}

impl<E: Into<anyhow::Error>> From<E> for Failure {
    fn from(error: E) -> Self {
        Self::Input(error.into())
    }
}
