//! One station's frame, clock and instrument: from a raw reading to a point in station 1's frame.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::state_vector::{
    CLOCKS, COLLIMATIONS, Constants, DRIFTS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES,
};

/// Radius of the earth (m). Textbook: mean radius.
pub const EARTH_RADIUS_M: f64 = 6.371e6;
/// Coefficient of refraction: the curvature of a sight over that of the earth. Textbook: Gauss's value.
const REFRACTION: f64 = 0.13;

/// One station's frame, clock and instrument errors.
#[derive(Clone, Debug)]
pub struct StationModel {
    /// Rotation from the station's own axes to station 1's level axes.
    pub rotation: Matrix3<f64>,
    /// Position in station 1's frame (m).
    pub position_m: Vector3<f64>,
    pub offset_m: f64,
    pub scale: f64,
    pub index_rad: f64,
    pub collimation_rad: f64,
    /// Age of the angles when the range is measured (s).
    pub latency_s: f64,
    /// Delay of the stamps (s), and its increase per second.
    pub clock_offset_s: f64,
    pub clock_drift: f64,
}

impl StationModel {
    /// The model of a station, 0 to 2, by the constants θ.
    pub fn new(constants: &Constants, station: usize) -> Self {
        let lean = LEANS + 2 * station;
        let lean = Rotation3::new(Vector3::new(constants[lean], constants[lean + 1], 0.0));
        let slot = station.checked_sub(1);
        let yaw_rad = slot.map_or(0.0, |slot| constants[4 * slot + 3]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        Self {
            rotation: *(yaw * lean).matrix(), // (2)
            position_m: slot
                .map_or_else(Vector3::zeros, |slot| constants.fixed_rows::<3>(4 * slot).into()),
            offset_m: constants[OFFSETS + station],
            scale: constants[SCALES + station],
            index_rad: constants[INDICES + station],
            collimation_rad: constants[COLLIMATIONS + station],
            latency_s: constants[LATENCIES + station],
            clock_offset_s: slot.map_or(0.0, |slot| constants[CLOCKS + slot]),
            clock_drift: slot.map_or(0.0, |slot| constants[DRIFTS + slot]),
        }
    }

    /// Returns the point of a reading without the errors of range, vertical index, collimation and refraction (m, own axes).
    pub fn corrected(&self, sight: &Sight) -> Vector3<f64> {
        // (1)
        let range_m = sight.range_m * (1.0 - self.scale) - self.offset_m;
        let raised = self.index_rad - 0.5 * REFRACTION * sight.range_m / EARTH_RADIUS_M;
        sight.along * range_m + sight.up * (raised * sight.range_m)
            - sight.side * (self.collimation_rad * sight.range_m)
    }
}

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

/// Mean of the sights of one station during a block.
#[derive(Clone, Copy, Debug, Default)]
pub struct MeanSight {
    /// Means of the unit vectors along the sight, to its right, and up.
    pub along: Vector3<f64>,
    pub side: Vector3<f64>,
    pub up: Vector3<f64>,
    /// Means of the same vectors times the range (m).
    pub point_m: Vector3<f64>,
    pub up_m: Vector3<f64>,
    pub side_m: Vector3<f64>,
}

impl MeanSight {
    /// The mean of sights; `None` without any.
    pub fn of(sights: impl Iterator<Item = Sight>) -> Option<Self> {
        let mut sum = Self::default();
        let mut count = 0.0;
        for sight in sights {
            sum.along += sight.along;
            sum.side += sight.side;
            sum.up += sight.up;
            sum.point_m += sight.along * sight.range_m;
            sum.up_m += sight.up * sight.range_m;
            sum.side_m += sight.side * sight.range_m;
            count += 1.0;
        }
        (count > 0.0).then(|| Self {
            along: sum.along / count,
            side: sum.side / count,
            up: sum.up / count,
            point_m: sum.point_m / count,
            up_m: sum.up_m / count,
            side_m: sum.side_m / count,
        })
    }
}
