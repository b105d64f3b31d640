//! What of a deployment the scene and the plots show.

use serde::{Deserialize, Serialize};

/// What the scene and the plots show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Visibility {
    pub stations: [bool; 3],
    pub raw: bool,
    pub tracks: bool,
    pub control_points: bool,
    /// The vehicle's frame along the track.
    pub poses: bool,
    /// What the interpolation states about its own error: ellipsoids in the scene, bands in the plot.
    pub uncertainty: bool,
    /// What the answer states about where stations 2 and 3 stand.
    pub station_ellipsoids: bool,
    /// Arrows at stations 2 and 3 along what the drive leaves free or weak.
    pub weak_directions: bool,
    /// Pairs of prisms in the plots.
    pub pairs: [bool; 3],
}

impl Default for Visibility {
    fn default() -> Self {
        Self {
            stations: [true; 3],
            raw: true,
            tracks: true,
            control_points: true,
            poses: true,
            uncertainty: true,
            station_ellipsoids: true,
            weak_directions: true,
            pairs: [true; 3],
        }
    }
}
