//! Validation of one open deployment's calibration on the others: requests and results.

use std::sync::Arc;

use resect_core::progress::Progress;
use resect_tools::validation::Validation;

/// Identifies the result of an open deployment: the deployment's id, and the count of its result.
pub type AnswerOf = (u64, u64);

/// Request and results.
#[derive(Default)]
pub struct Validations {
    /// The result whose calibration is validated.
    pub of: Option<AnswerOf>,
    /// Validations by the result that the calibration was tested on.
    pub found: Vec<(AnswerOf, Validation)>,
    /// Number and progress of the running request.
    pub running: Option<(u64, Arc<Progress>)>,
}

/// Results of a request.
pub struct Validated {
    pub of: AnswerOf,
    pub found: Vec<(AnswerOf, Validation)>,
}
