//! Warnings as data: what a reader, the pipeline or a solver noticed on the way.

use std::fmt;

use serde::Serialize;

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

/// One line for the user. Shown in the window, printed by the commands, and part of the JSON.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    pub severity: Severity,
    pub message: String,
    /// Whether no answer from this data can be better than weak.
    #[serde(skip)]
    pub doubt: bool,
}

impl Finding {
    pub fn note(message: impl Into<String>) -> Self {
        Self { severity: Severity::Note, message: message.into(), doubt: false }
    }

    pub fn warning(message: impl Into<String>) -> Self {
        Self { severity: Severity::Warning, message: message.into(), doubt: false }
    }

    /// A warning that no answer from this data can be better than weak.
    pub fn doubt(message: impl Into<String>) -> Self {
        Self { doubt: true, ..Self::warning(message) }
    }

    pub fn problem(message: impl Into<String>) -> Self {
        Self { severity: Severity::Problem, message: message.into(), doubt: false }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}
