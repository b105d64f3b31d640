//! Three RTK receivers on the vehicle, with noise and epochs without a fixed solution.

use nalgebra::Vector3;
use rand::RngExt;
use rand_chacha::ChaCha8Rng;

use super::motion::Motion;
use super::random::normal;
use super::simulated::EPOCH_S;
use resect_core::deployment::GnssFix;
use resect_core::geometry::Geodetic;

const RATE_HZ: f64 = 1.0;
/// Standard deviations stated by such receivers under open sky: east, north, up (m).
const SIGMA_M: [f64; 3] = [0.006, 0.006, 0.012];
/// Factor by which the noise is larger without fixed ambiguities.
const FLOAT_FACTOR: f64 = 30.0;
const FLOAT_SHARE: f64 = 0.03;
/// Position of station 1, arbitrary.
const STATION1: Geodetic = Geodetic { latitude_rad: 0.816, longitude_rad: -1.244, height_m: 60.0 };

/// Simulates the positions of antennas 1, 2, 3, given in the vehicle's frame (m).
pub fn measure(
    antennas_m: &[Vector3<f64>; 3],
    motion: &Motion,
    duration_s: f64,
    rng: &mut ChaCha8Rng,
) -> [Vec<GnssFix>; 3] {
    let ecef_from_local = STATION1.ecef_from_local();
    antennas_m.map(|antenna_m| {
        (0..(duration_s * RATE_HZ) as usize)
            .map(|k| {
                let t = k as f64 / RATE_HZ;
                let fixed = !rng.random_bool(FLOAT_SHARE);
                let factor = if fixed { 1.0 } else { FLOAT_FACTOR };
                let noise = Vector3::from(SIGMA_M.map(|sigma| factor * sigma * normal(rng)));
                let local_m = motion.position_m(&antenna_m, t) + noise;
                GnssFix {
                    time_s: EPOCH_S + t,
                    position_m: STATION1.to_ecef() + ecef_from_local * local_m,
                    quality: if fixed { 1 } else { 2 },
                }
            })
            .collect()
    })
}
