//! What the scene is asked to show.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// What the colour of points and tracks means.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Colouring {
    /// Raw readings by what became of them, tracks by station.
    #[default]
    Fate,
    Station,
    Interval,
    Speed,
    Residual,
    Time,
}

/// A distance that is measured in the scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ruler {
    pub active: bool,
    /// At most two.
    pub ends: Vec<RulerEnd>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RulerEnd {
    /// In station 1's frame.
    pub position_m: Vector3<f64>,
    /// What it snapped to, in words.
    pub what: String,
    /// A prism of the triangle at the cursor, 0 to 2.
    pub prism: Option<usize>,
}
