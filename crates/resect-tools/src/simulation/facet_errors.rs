//! Errors of readings that repeat with the incidence on a prism.

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use serde::Serialize;

use super::random::normal;
use resect_core::geometry::Polar;

/// Orders of the Fourier series: 360° prisms have six to eight facets.
const ORDERS: [f64; 3] = [6.0, 7.0, 8.0];

/// Errors of the readings of one prism: Fourier series of the incidence, with the coefficients of cosine and sine by order (m).
///
/// The incidence is the azimuth of the station in the vehicle's frame, so a station repeats its errors with its direction, and two
/// stations have different errors at one time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct FacetErrors {
    /// Along the sight, positive for ranges that are too long.
    pub along_m: [[f64; 2]; ORDERS.len()],
    /// Across the sight, positive to its right.
    pub across_m: [[f64; 2]; ORDERS.len()],
    pub upward_m: [[f64; 2]; ORDERS.len()],
}

impl FacetErrors {
    /// Draws the errors of a prism; `rms_m` are root mean squares along the sight, across it and upward (m).
    pub fn draw(rms_m: [f64; 3], rng: &mut ChaCha8Rng) -> Self {
        let [along_m, across_m, upward_m] = rms_m.map(|rms_m| {
            // Cosine and sine of an order have a mean square of one half each.
            let sigma_m = rms_m / (ORDERS.len() as f64).sqrt();
            ORDERS.map(|_| [sigma_m * normal(rng), sigma_m * normal(rng)])
        });
        Self { along_m, across_m, upward_m }
    }

    /// Returns the error along the sight, to its right and upward (m) at an incidence (rad).
    pub fn at_m(&self, incidence_rad: f64) -> Vector3<f64> {
        let series = |coefficients_m: &[[f64; 2]; ORDERS.len()]| -> f64 {
            let terms = ORDERS.iter().zip(coefficients_m);
            terms
                .map(|(order, [cosine_m, sine_m])| {
                    let (sin, cos) = (order * incidence_rad).sin_cos();
                    cosine_m * cos + sine_m * sin
                })
                .sum()
        };
        Vector3::new(series(&self.along_m), series(&self.across_m), series(&self.upward_m))
    }

    /// Returns a reading with the error for a direction from the prism to the station in the vehicle's frame.
    pub fn misread(&self, to_station: &Vector3<f64>, reading: Polar) -> Polar {
        let error_m = self.at_m(to_station.y.atan2(to_station.x));
        let Polar { range_m, azimuth_rad, zenith_rad } = reading;
        Polar {
            range_m: range_m + error_m.x,
            // Azimuths increase to the right, and zenith angles downward.
            azimuth_rad: azimuth_rad + error_m.y / (range_m * zenith_rad.sin()),
            zenith_rad: zenith_rad - error_m.z / range_m,
        }
    }
}
