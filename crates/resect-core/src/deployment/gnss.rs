//! Positions of the GNSS antennas on the vehicle.

use nalgebra::Vector3;

/// One position of one antenna.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GnssFix {
    /// Time of the position (Unix time, s).
    pub time_s: f64,
    /// Earth-centred, Earth-fixed coordinates; or east, north, up of the base station if the file has baselines. The frame is
    /// common to all antennas that were solved with the same base and settings.
    pub position_m: Vector3<f64>,
    /// 1 fixed, 2 float, 3 SBAS, 4 DGPS, 5 single, 6 PPP, 7 dead reckoning.
    pub quality: u8,
}
