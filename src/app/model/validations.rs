//! Whether the calibration of one open deployment holds for the others: what was asked, and what was found.

use std::sync::Arc;

use resect_core::progress::Progress;
use resect_core::validation::Validation;

/// An open deployment's answer: its id, and which of its answers it is.
pub type AnswerOf = (u64, u64);

/// What was asked and found.
#[derive(Default)]
pub struct Validations {
    /// The answer whose calibration was asked about.
    pub of: Option<AnswerOf>,
    /// What it was held against.
    pub found: Vec<(AnswerOf, Validation)>,
    /// The request's number.
    pub running: Option<(u64, Arc<Progress>)>,
}

/// What came of a request.
pub struct Validated {
    pub of: AnswerOf,
    pub found: Vec<(AnswerOf, Validation)>,
}
