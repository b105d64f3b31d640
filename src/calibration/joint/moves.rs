//! How the unknowns of the drive's parts move with what is constant and with what is slow.

use nalgebra::SMatrix;

use super::band_rows::PART;
use super::drive::Drive;
use super::unknowns::{CONSTANTS, Constants, SLOW, Station, moves, shifts};

/// By the constants, and by the slow states of the part.
pub type Moved = (SMatrix<f64, PART, CONSTANTS>, SMatrix<f64, PART, SLOW>);

/// The stations that all parts move with. A part's matrices are made whenever they are asked for: kept, those of a long
/// drive would take more room than its readings.
pub struct Moves {
    stations: [Station; 3],
}

impl Moves {
    pub fn about(constants: &Constants) -> Self {
        Self { stations: [0, 1, 2].map(|station| Station::of(constants, station)) }
    }

    pub fn of(&self, drive: &Drive, part: usize) -> Moved {
        let time_s = drive.part_times_s[part];
        moves(&self.stations, &drive.outlooks[part], time_s - drive.middle_s(time_s))
    }

    /// How what station 1 reads during a part moves (m), by the constants and by the slow states.
    pub fn of_station_1(
        &self,
        drive: &Drive,
        part: usize,
    ) -> (SMatrix<f64, 3, CONSTANTS>, SMatrix<f64, 3, SLOW>) {
        shifts(&self.stations[0], &drive.outlooks[part][0], 0)
    }
}
