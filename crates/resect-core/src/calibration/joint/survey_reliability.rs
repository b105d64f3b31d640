//! Reliability of the readings of a survey.

use nalgebra::Vector3;

use super::state_vector::ConstantsMatrix;
use super::survey::SurveyReading;
use super::survey_adjustment::{Adjustment, STATED_NUMBERS};
use super::survey_elimination::{Centre, EliminatedFrame, FRAME};
use crate::statistics::tables::{largest_normal, student_sigmas};

/// Critical normalised residuals along the sights, to their right and up, by the number of all residuals, and by those from which the noise is
/// estimated.
pub fn critical_sigmas(readings: &[SurveyReading], noise_numbers: &Vector3<f64>) -> Vector3<f64> {
    let largest_sigmas = largest_normal(readings.iter().map(SurveyReading::tests).sum());
    noise_numbers.map(|numbers| student_sigmas(largest_sigmas, numbers))
}

/// Numbers from which the noise along the sights, to their right and up is estimated.
pub fn noise_numbers(readings: &[SurveyReading]) -> Vector3<f64> {
    let redundant = readings.iter().map(|reading| reading.weight.powi(2) * reading.redundancy);
    redundant.sum::<Vector3<f64>>().add_scalar(STATED_NUMBERS)
}

impl Adjustment {
    /// Residuals of all readings with their redundancy numbers, by the covariance of the constants.
    pub fn reliability(
        &self,
        frames: &[EliminatedFrame],
        covariance: &ConstantsMatrix,
    ) -> Vec<SurveyReading> {
        let stations = self.stations();
        let mut all = Vec::new();
        for (set, markers) in self.markers.iter().enumerate() {
            for marker in markers {
                let equations = self.equations(&stations, marker, set);
                let Some(centre) = Centre::of(&equations) else { continue };
                for (reading, equation) in marker.readings.iter().zip(&equations) {
                    let axes = Self::placed(&stations, reading).1;
                    let constants = self.layout.constants;
                    let total = &equation.jacobian - &centre.jacobian;
                    let by_frame = total.fixed_columns::<FRAME>(constants).into_owned();
                    let frame = &frames[set];
                    let jacobian = total.columns(0, constants) + &by_frame * &frame.by_constants;
                    // Covariance of the fitted position.
                    let fitted = &jacobian * covariance * jacobian.transpose()
                        + &by_frame * frame.covariance * by_frame.transpose();
                    let fitted = axes.tr_mul(&((centre.covariance + fitted) * axes));
                    let sigma_m = self.sigma_m(reading);
                    let share = |axis: usize| {
                        1.0 - reading.weight * fitted[(axis, axis)] / sigma_m[axis].powi(2)
                    };
                    all.push(SurveyReading {
                        set,
                        point: reading.point,
                        station: reading.station,
                        residual_m: axes.tr_mul(&(centre.point_m - equation.point_m)),
                        sigma_m,
                        weight: reading.weight,
                        redundancy: Vector3::new(share(0), share(1), share(2))
                            .map(|share| share.clamp(0.0, 1.0)),
                        critical_sigmas: Vector3::repeat(f64::INFINITY),
                        influence: jacobian
                            .tr_mul(&(equation.information * axes))
                            .resize_horizontally(3, 0.0),
                    });
                }
            }
        }
        all
    }
}
