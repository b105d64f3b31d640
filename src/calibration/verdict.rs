//! Whether an answer can be trusted, in one word.

use serde::{Deserialize, Serialize};

/// From best to worst. The reasons stand in the findings beside it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    Good,
    /// An answer, but with a large uncertainty in some direction.
    Weak,
    /// One of two answers, and nothing decides which.
    Ambiguous,
    /// The data leaves a direction free.
    Degenerate,
}

impl Verdict {
    pub fn name(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Weak => "weak",
            Self::Ambiguous => "ambiguous",
            Self::Degenerate => "degenerate",
        }
    }
}
