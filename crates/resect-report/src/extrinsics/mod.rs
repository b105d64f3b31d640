//! The output of `resect extrinsics`: text, JSON, and the transform for other programs.

mod advice_text;
mod extrinsics_copy;
mod extrinsics_json;
mod extrinsics_text;

pub use advice_text::advice_in_words;
pub use extrinsics_copy::extrinsics_copy;
pub use extrinsics_json::extrinsics_json;
pub use extrinsics_text::{QuantityRow, conclusion, extrinsics_text, headline, quantities};
