//! Content and camera of the scene.

use nalgebra::Vector3;

use crate::app::model::{Colouring, Ruler, SceneOptions, View, Visibility};

/// A control point of the active deployment.
pub struct ShownPoint {
    pub file: String,
    pub marker: i64,
    /// Position by the first station that measured it (m, station 1's frame).
    pub position_m: Vector3<f64>,
}

#[derive(Default)]
pub struct SceneState {
    pub visibility: Visibility,
    pub colouring: Colouring,
    pub options: SceneOptions,
    pub view: View,
    pub ruler: Ruler,
    /// The control point at which the user looks; it has a ring and its residuals beside it.
    pub shown_point: Option<ShownPoint>,
}
