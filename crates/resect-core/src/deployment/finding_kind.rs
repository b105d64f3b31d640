//! Kinds of findings: each has a stable code, its usual severity and the advice of the Guide. Each crate lists its own.

use std::fmt;

use super::Severity;
use super::advice::Advice;

/// A kind of finding: the same cause, whatever the station, the file and the numbers.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FindingKind {
    /// The stable name in JSON.
    pub code: &'static str,
    /// The cause in one sentence, as the documentation of the kind has it.
    pub cause: &'static str,
    pub nature: Nature,
    /// The advice of the Guide; `None` if it has none.
    pub advice: Option<Advice>,
}

/// Severity of a kind, with the two properties that only some kinds of a severity have.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Nature {
    Note,
    /// A note that a table beside the answer shows too.
    Tabled,
    Warning,
    /// A warning about the data: no answer from it can be better than weak.
    Doubt,
    Problem,
}

/// Defines kinds of findings from lines of name, code, nature and advice, and the list of them.
#[macro_export]
macro_rules! finding_kinds {
    ($($(#[doc = $cause:literal])+ $kind:ident = $code:literal, $nature:ident $(, $advice:ident)?;)+) => {
        $($(#[doc = $cause])+
        pub const $kind: $crate::deployment::FindingKind = $crate::deployment::FindingKind {
            code: $code,
            cause: concat!($($cause),+).trim_ascii(),
            nature: $crate::deployment::Nature::$nature,
            advice: $crate::finding_kinds!(@advice $($advice)?),
        };)+

        /// The kinds of this crate.
        pub const ALL: &[$crate::deployment::FindingKind] = &[$($kind),+];
    };
    (@advice) => { None };
    (@advice $advice:ident) => { Some($crate::deployment::advice::$advice) };
}

impl FindingKind {
    /// The usual severity. Some findings have a lower or higher one: see their constructors.
    pub fn severity(self) -> Severity {
        match self.nature {
            Nature::Note | Nature::Tabled => Severity::Note,
            Nature::Warning | Nature::Doubt => Severity::Warning,
            Nature::Problem => Severity::Problem,
        }
    }

    /// Returns true if no answer from this data can be better than weak.
    pub fn is_doubt(self) -> bool {
        self.nature == Nature::Doubt
    }

    /// Returns true if a table beside the answer shows the same numbers.
    pub fn is_tabled(self) -> bool {
        self.nature == Nature::Tabled
    }
}

impl fmt::Debug for FindingKind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.code)
    }
}
