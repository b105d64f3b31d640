//! The pose of a vehicle on the ground, and how its speed follows the driver.

/// Time between poses (s).
pub const STEP_S: f64 = 0.01;

/// A place on the ground, and which way the vehicle faces there.
#[derive(Clone, Copy, Debug, Default)]
pub struct Planar {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_rad: f64,
}

/// The speed a hundredth of a second later: a soft foot on the pedal, about half a second to react.
pub fn reacting(speed_m_per_s: f64, wanted_m_per_s: f64) -> f64 {
    speed_m_per_s + (wanted_m_per_s - speed_m_per_s) * STEP_S / 0.6
}
