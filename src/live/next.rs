//! What to drive next, in one sentence: the one place that knows how to say it.

use super::judged::Judged;

/// What would help an answer most; `None` where nothing is known to.
pub fn what_next(judged: &Judged) -> Option<String> {
    judged.advice.map(str::to_owned)
}
