//! Positions of the GNSS antennas on the vehicle.

use nalgebra::Vector3;

/// One solution of a receiver.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssFix {
    /// Unix time (s).
    pub time_s: f64,
    /// In a frame that the antennas of one deployment share: Earth-centred, or about the base station (m).
    pub position_m: Vector3<f64>,
    /// As RTKLIB counts it: 1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP.
    pub quality: u8,
}
