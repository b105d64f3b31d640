//! Positions on the Earth: latitude, longitude and height, converted to and from Cartesian coordinates.

use nalgebra::{Matrix3, Vector3};

/// Semi-major axis of the WGS84 ellipsoid (m), and its flattening (NGA.STND.0036, table 3.1).
const SEMI_MAJOR_M: f64 = 6_378_137.0;
const FLATTENING: f64 = 1.0 / 298.257_223_563;
/// Square of the first eccentricity.
const ECCENTRICITY2: f64 = FLATTENING * (2.0 - FLATTENING);

/// A position relative to the WGS84 ellipsoid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Geodetic {
    pub latitude_rad: f64,
    pub longitude_rad: f64,
    /// Height above the ellipsoid (m), not above sea level.
    pub height_m: f64,
}

impl Geodetic {
    /// Earth-centred, Earth-fixed coordinates (m).
    pub fn to_ecef(self) -> Vector3<f64> {
        let (sin_latitude, cos_latitude) = self.latitude_rad.sin_cos();
        let (sin_longitude, cos_longitude) = self.longitude_rad.sin_cos();
        let normal_m = SEMI_MAJOR_M / (1.0 - ECCENTRICITY2 * sin_latitude * sin_latitude).sqrt();
        let horizontal_m = (normal_m + self.height_m) * cos_latitude;
        Vector3::new(
            horizontal_m * cos_longitude,
            horizontal_m * sin_longitude,
            (normal_m * (1.0 - ECCENTRICITY2) + self.height_m) * sin_latitude,
        )
    }

    /// Rotation from local coordinates at this position to Earth-centred ones: its columns are east, north and up.
    pub fn ecef_from_local(self) -> Matrix3<f64> {
        let (sin_latitude, cos_latitude) = self.latitude_rad.sin_cos();
        let (sin_longitude, cos_longitude) = self.longitude_rad.sin_cos();
        Matrix3::from_columns(&[
            Vector3::new(-sin_longitude, cos_longitude, 0.0),
            Vector3::new(
                -sin_latitude * cos_longitude,
                -sin_latitude * sin_longitude,
                cos_latitude,
            ),
            Vector3::new(cos_latitude * cos_longitude, cos_latitude * sin_longitude, sin_latitude),
        ])
    }

    /// The inverse of [`Geodetic::to_ecef`], for positions more than 43 km from the centre of the Earth.
    ///
    /// Closed form, in the notation of Vermeille, "Direct transformation from geocentric coordinates to geodetic coordinates",
    /// Journal of Geodesy 76 (2002) 451–454.
    pub fn from_ecef(position_m: Vector3<f64>) -> Self {
        let e2 = ECCENTRICITY2;
        let e4 = e2 * e2;
        let horizontal_m = position_m.xy().norm();
        let z_m = position_m.z;
        let p = (horizontal_m / SEMI_MAJOR_M).powi(2);
        let q = (1.0 - e2) * (z_m / SEMI_MAJOR_M).powi(2);
        let r = (p + q - e4) / 6.0;
        let s = e4 * p * q / (4.0 * r.powi(3));
        let t = (1.0 + s + (s * (2.0 + s)).sqrt()).cbrt();
        let u = r * (1.0 + t + 1.0 / t);
        let v = (u * u + e4 * q).sqrt();
        let w = e2 * (u + v - q) / (2.0 * v);
        let k = (u + v + w * w).sqrt() - w;
        let d_m = k * horizontal_m / (k + e2);
        let foot_m = d_m.hypot(z_m);
        Self {
            latitude_rad: 2.0 * z_m.atan2(d_m + foot_m),
            longitude_rad: position_m.y.atan2(position_m.x),
            height_m: (k + e2 - 1.0) / k * foot_m,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use proptest::prelude::*;

    fn degrees(degrees: f64, minutes: f64, seconds: f64) -> f64 {
        (degrees + minutes / 60.0 + seconds / 3600.0).to_radians()
    }

    #[test]
    fn known_points() {
        let at = |latitude_rad, longitude_rad, height_m| Geodetic {
            latitude_rad,
            longitude_rad,
            height_m,
        };
        let known = [
            // On the axes: the two radii of the ellipsoid.
            (at(0.0, 0.0, 10.0), Vector3::new(6_378_147.0, 0.0, 0.0)),
            (at(0.0, FRAC_PI_2, 0.0), Vector3::new(0.0, 6_378_137.0, 0.0)),
            (at(-FRAC_PI_2, 0.0, 0.0), Vector3::new(0.0, 0.0, -6_356_752.314_245)),
            // The worked example of the IOGP's Guidance Note 7-2, method 9602.
            (
                at(degrees(53.0, 48.0, 33.82), degrees(2.0, 7.0, 46.38), 73.0),
                Vector3::new(3_771_793.968, 140_253.342, 5_124_304.349),
            ),
        ];
        for (geodetic, ecef_m) in known {
            let forth = geodetic.to_ecef();
            assert!((forth - ecef_m).norm() < 1e-3, "{geodetic:?} became {forth}");
            let back = Geodetic::from_ecef(ecef_m);
            let apart_m = (back.latitude_rad - geodetic.latitude_rad).abs() * SEMI_MAJOR_M;
            assert!(apart_m < 1e-3 && (back.height_m - geodetic.height_m).abs() < 1e-3, "{back:?}");
        }
    }

    proptest! {
        #[test]
        fn local_axes_are_directions_of_growing_coordinates(
            latitude_rad in -1.5..1.5f64,
            longitude_rad in -PI..PI,
        ) {
            let base = Geodetic { latitude_rad, longitude_rad, height_m: 100.0 };
            let local = |moved: Geodetic| {
                base.ecef_from_local().transpose() * (moved.to_ecef() - base.to_ecef())
            };
            let east = local(Geodetic { longitude_rad: longitude_rad + 1e-6, ..base }).normalize();
            let north = local(Geodetic { latitude_rad: latitude_rad + 1e-6, ..base }).normalize();
            let up = local(Geodetic { height_m: 101.0, ..base });
            prop_assert!((east - Vector3::x()).norm() < 1e-5, "{east}");
            prop_assert!((north - Vector3::y()).norm() < 1e-5, "{north}");
            prop_assert!((up - Vector3::z()).norm() < 1e-6, "{up}");
        }

        #[test]
        fn round_trip(
            latitude_rad in -FRAC_PI_2..FRAC_PI_2,
            longitude_rad in -PI..PI,
            height_m in -11_000.0..1e6f64,
        ) {
            let geodetic = Geodetic { latitude_rad, longitude_rad, height_m };
            let there = geodetic.to_ecef();
            let back = Geodetic::from_ecef(there);
            prop_assert!((back.to_ecef() - there).norm() < 1e-6);
            // Both conversions could have the same error, so the height is compared directly.
            prop_assert!((back.height_m - height_m).abs() < 1e-6);
        }
    }
}
