//! Whether an answer can be trusted, in one word.

use serde::{Deserialize, Serialize};

/// How far an answer can be trusted, from best to worst. The reasons stand in the findings beside it.
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

    /// What has to be said beside it: a good answer that nothing independent has checked is not as good as one that was.
    pub fn caveat(self, independently_checked: bool) -> &'static str {
        if self == Self::Good && !independently_checked {
            ", not independently checked"
        } else {
            ""
        }
    }

    /// The word, and what has to be said beside it.
    pub fn in_words(self, independently_checked: bool) -> String {
        format!("{}{}", self.name(), self.caveat(independently_checked))
    }
}
