//! How the scene is drawn, beside what of it is shown.

use serde::{Deserialize, Serialize};

/// How the scene is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SceneOptions {
    /// Whether the legend is open; until the user chooses, it is where there is room.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legend_open: Option<bool>,
    /// How many times larger than true the ellipsoids of stations and tracks are.
    pub ellipsoid_scale: u32,
    /// How many times longer than true the arrows of the control points' residuals are.
    pub residual_scale: u32,
    /// How many times higher than true everything is drawn: flat ground shows its shape.
    pub height_scale: u32,
}

impl SceneOptions {
    /// Scales of ellipsoids and arrows that are offered: never one by the answer, or a better answer would look like a worse one.
    pub const ERROR_SCALES: [u32; 5] = [1, 10, 100, 1000, 10_000];
    pub const HEIGHT_SCALES: [u32; 4] = [1, 2, 5, 10];
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { legend_open: None, ellipsoid_scale: 100, residual_scale: 1000, height_scale: 1 }
    }
}
