//! Severity of findings.

use serde::Serialize;

/// The weight of a finding.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// Something was repaired or left out, or limits how far an answer can be trusted.
    Warning,
    /// Something needed is missing; an answer will not come, or must not be used.
    Problem,
}

impl Severity {
    /// The sign before a finding in plain text.
    pub fn mark(self) -> char {
        match self {
            Self::Note => '-',
            Self::Warning => '!',
            Self::Problem => 'x',
        }
    }
}
