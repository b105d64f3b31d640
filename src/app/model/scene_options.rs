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
    /// How much of its way is drawn behind each prism at the time cursor (s); 0 for none.
    pub trail_s: u32,
    /// Whether the camera goes with the rig.
    pub follow: bool,
}

impl SceneOptions {
    /// Scales of ellipsoids and arrows that are offered: never one by the answer, or a better answer would look like a worse one.
    pub const ERROR_SCALES: [u32; 5] = [1, 10, 100, 1000, 10_000];
    pub const HEIGHT_SCALES: [u32; 4] = [1, 2, 5, 10];
    pub const TRAILS_S: [u32; 4] = [0, 10, 30, 60];

    /// The length of a trail, as it is chosen.
    pub fn trail_in_words(trail_s: u32) -> String {
        if trail_s == 0 { "off".to_owned() } else { format!("{trail_s} s") }
    }
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            legend_open: None,
            ellipsoid_scale: 100,
            residual_scale: 1000,
            height_scale: 1,
            trail_s: 0,
            follow: false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_session_from_before_trails_opens_without_one() {
        let old: SceneOptions = toml::from_str("height_scale = 5").expect("read");
        assert_eq!(old, SceneOptions { height_scale: 5, ..SceneOptions::default() });
        assert_eq!((old.trail_s, old.follow), (0, false));
    }
}
