//! Pose of a vehicle on the ground, and the response of its speed to the driver.

/// Time between poses (s).
pub const STEP_S: f64 = 0.01;

/// Position on the ground and heading.
#[derive(Clone, Copy, Debug, Default)]
pub struct Planar {
    pub x_m: f64,
    pub y_m: f64,
    pub heading_rad: f64,
}

/// Returns the speed after one step of a hundredth of a second: a first-order response with a time constant of 0.6 s.
pub fn reacting(speed_m_per_s: f64, wanted_m_per_s: f64) -> f64 {
    speed_m_per_s + (wanted_m_per_s - speed_m_per_s) * STEP_S / 0.6
}
