//! Waypoints of a vehicle.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

/// A waypoint.
///
/// In a file it is `[x, y]` (m), optionally followed by the speed (m/s) and the duration of a stop there (s). A speed of 0
/// means the usual speed of the drive.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Waypoint {
    pub x_m: f64,
    pub y_m: f64,
    /// Speed towards the waypoint (m/s); `None` for the usual speed of the drive.
    pub speed_m_per_s: Option<f64>,
    /// Duration of a stop there (s).
    pub stand_s: f64,
}

impl Waypoint {
    pub fn at(place_m: Vector2<f64>) -> Self {
        Self { x_m: place_m.x, y_m: place_m.y, speed_m_per_s: None, stand_s: 0.0 }
    }

    pub fn place_m(&self) -> Vector2<f64> {
        Vector2::new(self.x_m, self.y_m)
    }
}

impl TryFrom<Vec<f64>> for Waypoint {
    type Error = &'static str;

    fn try_from(numbers: Vec<f64>) -> Result<Self, Self::Error> {
        let (x_m, y_m, speed, stand_s) = match numbers[..] {
            [x_m, y_m] => (x_m, y_m, None, 0.0),
            [x_m, y_m, speed] => (x_m, y_m, Some(speed), 0.0),
            [x_m, y_m, speed, stand_s] => (x_m, y_m, Some(speed), stand_s),
            _ => return Err("a waypoint is [x, y], [x, y, speed] or [x, y, speed, stand]"),
        };
        Ok(Self { x_m, y_m, speed_m_per_s: speed.filter(|speed| *speed != 0.0), stand_s })
    }
}

impl From<Waypoint> for Vec<f64> {
    fn from(at: Waypoint) -> Self {
        let mut numbers = vec![at.x_m, at.y_m];
        if at.speed_m_per_s.is_some() || at.stand_s > 0.0 {
            numbers.push(at.speed_m_per_s.unwrap_or(0.0));
        }
        if at.stand_s > 0.0 {
            numbers.push(at.stand_s);
        }
        numbers
    }
}
