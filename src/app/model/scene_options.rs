//! Drawing options of the scene.

use serde::{Deserialize, Serialize};

/// Drawing options of the scene.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct SceneOptions {
    /// True if the legend is open; `None` until the user chooses, which opens it if there is room.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub legend_open: Option<bool>,
    /// Magnification of the ellipsoids of stations and tracks.
    pub ellipsoid_scale: u32,
    /// Magnification of the residual arrows at the control points; `None` for the one that suits the scene.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual_scale: Option<u32>,
    /// Vertical exaggeration of the whole scene, which makes the relief of flat ground visible.
    pub height_scale: u32,
    /// Length of the trail behind each prism at the time cursor (s); 0 for none.
    pub trail_s: u32,
    /// True if the camera follows the rig.
    pub follow: bool,
}

impl SceneOptions {
    /// Scales of ellipsoids and arrows. Those of ellipsoids do not depend on the result, which could make a better result look worse.
    pub const ERROR_SCALES: [u32; 5] = [1, 10, 100, 1000, 10_000];
    pub const HEIGHT_SCALES: [u32; 4] = [1, 2, 5, 10];
    pub const TRAILS_S: [u32; 4] = [0, 10, 30, 60];

    /// Describes the length of a trail.
    pub fn trail_in_words(trail_s: u32) -> String {
        if trail_s == 0 { "off".to_owned() } else { format!("{trail_s} s") }
    }
}

impl Default for SceneOptions {
    fn default() -> Self {
        Self {
            legend_open: None,
            ellipsoid_scale: 100,
            residual_scale: None,
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
