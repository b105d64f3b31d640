//! How the scene is drawn, beside what of it is shown.

use serde::{Deserialize, Serialize};

/// How the scene is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SceneOptions {
    /// Whether the legend is open; until the user chooses, it is where there is room.
    pub legend_open: Option<bool>,
    /// How many times larger than true the ellipsoids of stations and tracks are.
    pub ellipsoid_scale: u32,
}

impl SceneOptions {
    /// Scales of ellipsoids that are offered: never one by the answer, or a better answer would look like a worse one.
    pub const ELLIPSOID_SCALES: [u32; 5] = [1, 10, 100, 1000, 10_000];
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self { legend_open: None, ellipsoid_scale: 100 }
    }
}
