//! Errors of a station that the adjustment of a survey has no unknowns for.

use nalgebra::{DMatrix, DVector, Vector3};

use super::settling::own_settling;
use super::sight::Sight;
use super::station_model::StationModel;
use super::survey_markers::Observed;
use crate::calibration::ErrorSizes;
use crate::network::Station;

/// An error that is tested.
#[derive(Clone, Copy, Debug)]
pub enum TestedError {
    Ranges(Station),
    Pose(Station, usize),
}

impl TestedError {
    pub fn parameters(self) -> usize {
        match self {
            Self::Ranges(_) => 1,
            Self::Pose(..) => 4,
        }
    }

    /// Jacobian of a reading's position by the parameters; `None` if the reading does not have this error.
    pub fn jacobian(
        self,
        model: &StationModel,
        reading: &Observed,
        set: usize,
    ) -> Option<DMatrix<f64>> {
        let Sight { along, .. } = reading.sight;
        match self {
            Self::Ranges(station) if station == reading.station => {
                let by_excess = -(model.rotation * along);
                Some(DMatrix::from_column_slice(3, 1, by_excess.as_slice()))
            }
            Self::Pose(station, changed) if (station, changed) == (reading.station, set) => {
                let by_yaw_m =
                    Vector3::z().cross(&(model.rotation * model.corrected(&reading.sight)));
                let mut jacobian = DMatrix::identity(3, 4);
                jacobian.set_column(3, &by_yaw_m);
                Some(jacobian)
            }
            _ => None,
        }
    }

    /// Variances of the parameters that need no explanation.
    pub fn usual(self, sizes: &ErrorSizes) -> DVector<f64> {
        match self {
            Self::Ranges(_) => DVector::from_element(1, 1e-14),
            Self::Pose(..) => DVector::from_column_slice(own_settling(sizes).as_slice()),
        }
    }
}
