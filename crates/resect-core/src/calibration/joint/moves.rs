//! How the unknowns of the drive's parts move with what is constant and with what is slow.

use std::sync::Arc;

use nalgebra::SMatrix;

use super::band_rows::PART;
use super::drive::Drive;
use super::unknowns::{CONSTANTS, Constants, SLOW, Station, moves, shifts, turns_of_station_1};

/// By the constants, and by the slow states of the part.
pub type Moved = (SMatrix<f64, PART, CONSTANTS>, SMatrix<f64, PART, SLOW>);

/// The stations that all parts move with. A part's matrices are made whenever they are asked for: kept, those of a long
/// drive would take more room than its readings.
#[derive(Clone)]
pub struct Moves {
    drive: Arc<Drive>,
    stations: [Station; 3],
}

impl Moves {
    pub fn about(drive: &Arc<Drive>, constants: &Constants) -> Self {
        let stations = [0, 1, 2].map(|station| Station::of(constants, station));
        Self { drive: Arc::clone(drive), stations }
    }

    pub fn of(&self, part: usize) -> Moved {
        let time_s = self.drive.part_times_s[part];
        let since_s = time_s - self.drive.middle_s(time_s);
        moves(&self.stations, &self.drive.outlooks[part], since_s)
    }

    /// Whether the part after this one belongs to the same stretch.
    pub fn ties_to_next(&self, part: usize) -> bool {
        self.drive.tied_to_next[part]
    }

    /// How what station 1 reads during a part is shifted (m) and turned about the station (rad), by the constants and by the
    /// slow states.
    pub fn of_station_1(&self, part: usize) -> (SMatrix<f64, 6, CONSTANTS>, SMatrix<f64, 6, SLOW>) {
        let (own, outlook) = (&self.stations[0], &self.drive.outlooks[part][0]);
        let (shift_by_constants, shift_by_slow) = shifts(own, outlook, 0);
        let mut by_constants = SMatrix::<f64, 6, CONSTANTS>::zeros();
        let mut by_slow = SMatrix::<f64, 6, SLOW>::zeros();
        by_constants.fixed_rows_mut::<3>(0).copy_from(&shift_by_constants);
        by_slow.fixed_rows_mut::<3>(0).copy_from(&shift_by_slow);
        for (column, axis) in turns_of_station_1(own) {
            let mut shift = by_constants.fixed_view_mut::<3, 1>(0, column);
            shift -= axis.cross(&(own.turn * outlook.point_m));
            by_constants.fixed_view_mut::<3, 1>(3, column).copy_from(&axis);
        }
        (by_constants, by_slow)
    }
}
