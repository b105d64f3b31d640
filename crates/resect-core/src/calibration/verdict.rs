//! Verdict on an answer, in one word.

use serde::{Deserialize, Serialize};

/// Reliability of an answer, from best to worst. The findings give the reasons.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    Good,
    /// The uncertainty is large in some direction.
    Weak,
    /// The data does not decide between two answers.
    Ambiguous,
    /// A direction is unobservable.
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

    /// Returns the caveat of a good answer that no independent data has checked; empty for others.
    pub fn caveat(self, independently_checked: bool) -> &'static str {
        if self == Self::Good && !independently_checked {
            ", not independently checked"
        } else {
            ""
        }
    }

    /// Returns the verdict in words, with its caveat.
    pub fn in_words(self, independently_checked: bool) -> String {
        format!("{}{}", self.name(), self.caveat(independently_checked))
    }
}
