//! Readings of markers, and what does not change during their adjustment.

use nalgebra::Vector3;

use super::sight::Sight;
use super::state_vector::Layout;
use super::unknown::{COLLIMATION, VERTICAL_INDEX};
use crate::deployment::{ControlPoint, ControlPointSet};
use crate::geometry::Polar;
use crate::network::{Number, Station};

/// Standard deviation of a static range of length zero.
const RANGE_M: f64 = 0.001;
/// Standard deviation of a static range by its length.
const RANGE_SHARE: f64 = 1e-6;
/// Standard deviation of a static angle. Angles in files of six digits are rounded to 10 µrad.
pub const ANGLE_RAD: f64 = 6e-6;
/// Standard deviation of the position of the target across the sight.
const TARGET_M: f64 = 0.0003;

/// A reading with what does not change during the adjustment.
pub struct Observed {
    pub point: usize,
    pub station: Station,
    pub sight: Sight,
    /// Vertical index and collimation (rad) by the readings in both faces, of which the sight is the mean.
    pub face_errors_rad: Option<[f64; 2]>,
    pub sigma_m: Vector3<f64>,
    pub weight: f64,
}

impl Observed {
    /// Indices of vertical index and collimation among the constants, with their values by both faces (rad).
    pub fn face_errors(&self, layout: &Layout) -> impl Iterator<Item = (usize, f64)> + use<> {
        let indices = face_indices(layout, self.station);
        self.face_errors_rad.into_iter().flat_map(move |values| indices.into_iter().zip(values))
    }
}

/// Indices of a station's vertical index and collimation among the constants.
pub fn face_indices(layout: &Layout, station: Station) -> [usize; 2] {
    [&VERTICAL_INDEX, &COLLIMATION].map(|unknown| layout.index(unknown, station.index()))
}

/// A marker: its readings, and its surveyed coordinates in the frame of its set (m).
pub struct Marker {
    pub readings: Vec<Observed>,
    pub surveyed_m: Option<Vector3<f64>>,
}

/// The markers of a set.
pub fn markers(points: &ControlPointSet) -> Vec<Marker> {
    let marker = |(index, point): (usize, &ControlPoint)| {
        let reading = |(station, reading): (Station, &Option<Polar>)| {
            let point_m = (*reading)?.to_cartesian();
            let sight = Sight::to(&point_m);
            let face_errors_rad = point.face_one[station].map(|face_one| {
                let off_rad = (face_one.to_cartesian() - point_m) / sight.range_m;
                [-sight.up.dot(&off_rad), sight.side.dot(&off_rad)]
            });
            let range_m = sight.range_m;
            let across_m = (ANGLE_RAD * range_m).hypot(TARGET_M);
            let sigma_m = Vector3::new(RANGE_M + RANGE_SHARE * range_m, across_m, across_m);
            Some(Observed { point: index, station, sight, face_errors_rad, sigma_m, weight: 1.0 })
        };
        let readings = point.readings.each().filter_map(reading).collect();
        Marker { readings, surveyed_m: point.known_m }
    };
    points.points.iter().enumerate().map(marker).collect()
}
