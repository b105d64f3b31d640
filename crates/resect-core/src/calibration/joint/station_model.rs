//! One station's frame, clock and instrument: from a raw reading to a point in station 1's frame.

use nalgebra::{Matrix3, Rotation3, Vector3};

use super::sight::{EARTH_RADIUS_M, Sight};
use super::state_vector::{Constants, Layout};
use super::unknown::{CLOCK_DRIFT, CLOCK_OFFSET, LATENCY, LEAN_X, LEAN_Y, ReadingError};
use crate::network::{Number, Station};

/// Coefficient of refraction: the curvature of a sight over that of the earth. Textbook: Gauss's value.
const REFRACTION: f64 = 0.13;

/// One station's frame, clock and instrument errors.
#[derive(Clone, Debug)]
pub struct StationModel {
    /// Rotation from the station's own axes to station 1's level axes.
    pub rotation: Matrix3<f64>,
    /// Position in station 1's frame (m).
    pub position_m: Vector3<f64>,
    /// Errors that displace the readings, with their sizes.
    reading_errors: Vec<(ReadingError, f64)>,
    /// Age of the angles when the range is measured (s).
    pub latency_s: f64,
    /// Delay of the stamps (s), and its increase per second.
    pub clock_offset_s: f64,
    pub clock_drift: f64,
}

impl StationModel {
    /// The model of a station by the constants θ.
    pub fn new(layout: &Layout, constants: &Constants, station: Station) -> Self {
        let own = |unknown| constants[layout.index(unknown, station.index())];
        let slot = station.slot();
        let yaw_rad = slot.map_or(0.0, |slot| constants[4 * slot + 3]);
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), yaw_rad);
        let of_clock = |unknown| slot.map_or(0.0, |slot| constants[layout.index(unknown, slot)]);
        let reading_errors = layout
            .reading_errors(station)
            .map(|(error, index)| (error, constants[index]))
            .collect();
        Self {
            rotation: *(yaw * lean(own(&LEAN_X), own(&LEAN_Y))).matrix(), // (2)
            position_m: slot
                .map_or_else(Vector3::zeros, |slot| constants.fixed_rows::<3>(4 * slot).into()),
            reading_errors,
            latency_s: own(&LATENCY),
            clock_offset_s: of_clock(&CLOCK_OFFSET),
            clock_drift: of_clock(&CLOCK_DRIFT),
        }
    }

    /// The models of all stations.
    pub fn all(layout: &Layout, constants: &Constants) -> Vec<Self> {
        let stations = (0..layout.stations()).map(Station::at);
        stations.map(|station| Self::new(layout, constants, station)).collect()
    }

    /// The model in the station's own level frame.
    pub fn in_own_level_frame(
        self,
        layout: &Layout,
        constants: &Constants,
        station: Station,
    ) -> Self {
        let [x, y] = [&LEAN_X, &LEAN_Y].map(|lean| constants[layout.index(lean, station.index())]);
        Self { rotation: *lean(x, y).matrix(), position_m: Vector3::zeros(), ..self }
    }

    /// Returns the point of a reading without the errors of the instrument and refraction (m, own axes).
    pub fn corrected(&self, sight: &Sight) -> Vector3<f64> {
        // (1)
        let refraction = 0.5 * REFRACTION * sight.range_m / EARTH_RADIUS_M;
        let mut point_m = sight.along * sight.range_m - sight.up * (refraction * sight.range_m);
        for (error, size) in &self.reading_errors {
            point_m += (error.correction_m)(sight) * *size;
        }
        point_m
    }
}

/// Rotation by leans about a station's own x and y (rad).
fn lean(x_rad: f64, y_rad: f64) -> Rotation3<f64> {
    Rotation3::new(Vector3::new(x_rad, y_rad, 0.0))
}

/// Mean of the sights of one station during a block.
#[derive(Clone, Debug, Default)]
pub struct MeanSight {
    /// Means of the unit vectors along the sight, to its right, and up.
    pub along: Vector3<f64>,
    pub side: Vector3<f64>,
    pub up: Vector3<f64>,
    /// Mean point (m).
    pub point_m: Vector3<f64>,
    /// Mean corrections of the point for errors of one (m), in the order of [`Layout::reading_errors`].
    pub corrections_m: Vec<Vector3<f64>>,
}

impl MeanSight {
    /// The mean of sights; `None` without any.
    pub fn of(layout: &Layout, sights: impl Iterator<Item = Sight>) -> Option<Self> {
        let errors = layout.reading_errors(Station::FIRST).map(|(error, _)| error);
        let errors: Vec<ReadingError> = errors.collect();
        let mut mean =
            Self { corrections_m: vec![Vector3::zeros(); errors.len()], ..Self::default() };
        let mut count = 0.0;
        for sight in sights {
            mean.along += sight.along;
            mean.side += sight.side;
            mean.up += sight.up;
            mean.point_m += sight.along * sight.range_m;
            for (sum, error) in mean.corrections_m.iter_mut().zip(&errors) {
                *sum += (error.correction_m)(&sight);
            }
            count += 1.0;
        }
        let vectors = [&mut mean.along, &mut mean.side, &mut mean.up, &mut mean.point_m];
        vectors.into_iter().chain(&mut mean.corrections_m).for_each(|sum| *sum /= count);
        (count > 0.0).then_some(mean)
    }
}
