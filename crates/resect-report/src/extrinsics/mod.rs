//! The output of `resect extrinsics`: text, JSON, and the transform for other programs.

mod advice_text;
mod extrinsics_copy;
mod extrinsics_json;
mod extrinsics_text;

pub use extrinsics_copy::extrinsics_copy;
pub use extrinsics_json::extrinsics_json;
pub use extrinsics_text::extrinsics_text;
