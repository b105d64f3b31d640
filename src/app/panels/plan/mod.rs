//! Numbers of a plan and its prediction; the plan from above is in `plots/plan_map.rs`.

mod foreseen;
mod numbers;

pub use foreseen::ui as foreseen;
pub use numbers::ui as numbers;
