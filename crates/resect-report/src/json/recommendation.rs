//! A recommendation as JSON.

use resect_core::calibration::{Method, Recommendation};
use serde_json::{Value, json};

/// Returns the method of the answer to use (null for none), the stable name of the reason, and the text.
pub fn recommendation(recommendation: &Recommendation) -> Value {
    json!({
        "answer": recommendation.answer.map(Method::name),
        "reason": recommendation.reason.code(),
        "text": recommendation.to_string(),
    })
}
