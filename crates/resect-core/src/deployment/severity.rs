//! Severity of a finding.

use serde::Serialize;

/// Severity of a finding, in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Information; nothing is wrong.
    Note,
    /// Data was repaired or left out, or limits the trust in an answer.
    Warning,
    /// Required data is missing: there is no answer, or it must not be used.
    Problem,
}

impl Severity {
    /// Returns the sign before a finding in plain text.
    pub fn mark(self) -> char {
        match self {
            Self::Note => '-',
            Self::Warning => '!',
            Self::Problem => 'x',
        }
    }
}
