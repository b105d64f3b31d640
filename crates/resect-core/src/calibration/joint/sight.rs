//! Direction of a reading.

use nalgebra::Vector3;

/// Radius of the earth (m). Textbook: mean radius.
pub const EARTH_RADIUS_M: f64 = 6.371e6;

/// A reading's direction in the station's own axes: unit vectors along the sight, to its right, and up.
#[derive(Clone, Copy, Debug)]
pub struct Sight {
    pub range_m: f64,
    pub along: Vector3<f64>,
    pub side: Vector3<f64>,
    pub up: Vector3<f64>,
}

impl Sight {
    /// The sight to a point in the station's own frame (m).
    pub fn to(point_m: &Vector3<f64>) -> Self {
        let range_m = point_m.norm().max(1e-9);
        let along = point_m / range_m;
        let side = along.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        Self { range_m, along, side, up: side.cross(&along) }
    }
}
