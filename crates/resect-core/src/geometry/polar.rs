//! Polar measurements of a total station, converted to and from Cartesian coordinates.

use std::f64::consts::{PI, TAU};

use nalgebra::Vector3;

/// A direction and a distance from a station, prism constant included.
///
/// Azimuths increase clockwise seen from above, as surveyors read them. The zenith angle is 0 straight up and π/2 on the
/// horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Polar {
    pub range_m: f64,
    pub azimuth_rad: f64,
    pub zenith_rad: f64,
}

/// Longest range of a total station (m); a longer one is a blunder that would dominate the estimate.
pub const LONGEST_RANGE_M: f64 = 10_000.0;

impl Polar {
    /// Returns true if a total station can have measured this: finite, in front of it and within 10 km.
    pub fn is_plausible(&self) -> bool {
        self.range_m > 0.0
            && self.range_m < LONGEST_RANGE_M
            && self.azimuth_rad.is_finite()
            && (0.0..=PI).contains(&self.zenith_rad)
    }

    /// Returns the reading as in face left, and true if it was made in face right: its zenith angle is beyond half a turn.
    pub fn in_face_left(self) -> (Self, bool) {
        let is_face_right = self.zenith_rad > PI && self.zenith_rad < TAU;
        if is_face_right {
            let (azimuth_rad, zenith_rad) = (self.azimuth_rad - PI, TAU - self.zenith_rad);
            (Self { azimuth_rad, zenith_rad, ..self }, true)
        } else {
            (self, false)
        }
    }

    /// Position in the station's frame (m): x along azimuth 0, z up, right-handed.
    pub fn to_cartesian(self) -> Vector3<f64> {
        let (sin_zenith, cos_zenith) = self.zenith_rad.sin_cos();
        let (sin_azimuth, cos_azimuth) = self.azimuth_rad.sin_cos();
        self.range_m * Vector3::new(sin_zenith * cos_azimuth, -sin_zenith * sin_azimuth, cos_zenith)
    }

    /// The inverse of [`Polar::to_cartesian`]; azimuth in [−π, π).
    pub fn from_cartesian(position_m: Vector3<f64>) -> Self {
        let horizontal_m = position_m.xy().norm();
        Self {
            range_m: position_m.norm(),
            azimuth_rad: -position_m.y.atan2(position_m.x),
            zenith_rad: horizontal_m.atan2(position_m.z),
        }
    }
}

/// Wraps an angle into [−π, π] by full turns.
pub fn wrap_to_pi(angle_rad: f64) -> f64 {
    if angle_rad.abs() <= PI {
        return angle_rad;
    }
    let wrapped = angle_rad.rem_euclid(TAU);
    if wrapped > PI { wrapped - TAU } else { wrapped }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn azimuth_is_clockwise_and_zenith_is_from_the_vertical() {
        let east_of_x = Polar { range_m: 2.0, azimuth_rad: PI / 2.0, zenith_rad: PI / 2.0 };
        assert!((east_of_x.to_cartesian() - Vector3::new(0.0, -2.0, 0.0)).norm() < 1e-12);
        let up = Polar { range_m: 3.0, azimuth_rad: 0.3, zenith_rad: 0.0 };
        assert!((up.to_cartesian() - Vector3::new(0.0, 0.0, 3.0)).norm() < 1e-12);
    }

    proptest! {
        #[test]
        fn polar_round_trip(x in -200.0..200.0f64, y in -200.0..200.0f64, z in -30.0..30.0f64) {
            let position = Vector3::new(x, y, z);
            prop_assert!((Polar::from_cartesian(position).to_cartesian() - position).norm() < 1e-10);
        }

        #[test]
        fn wrapping_keeps_the_direction(angle in -50.0..50.0f64) {
            let wrapped = wrap_to_pi(angle);
            prop_assert!(wrapped > -PI - 1e-12 && wrapped <= PI + 1e-12);
            prop_assert!((wrapped.sin() - angle.sin()).abs() < 1e-9);
            prop_assert!((wrapped.cos() - angle.cos()).abs() < 1e-9);
        }
    }
}
