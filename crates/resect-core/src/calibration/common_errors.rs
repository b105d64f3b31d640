//! Covariance of errors that all readings of a drive share: tilts of the stations within the accuracy of their compensators, and
//! the error of the prism constant (tenths of a millimetre).
//!
//! No residual shows these errors, and more readings do not average them out.

use nalgebra::{DMatrix, DVector, Rotation3, Vector3};

use crate::calibration::instrument::{PRISM_CONSTANT_SIGMA_M, TILT_SIGMA_RAD};
use crate::geometry::{RigidTransform, wrap_to_pi};
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;

/// Number of triplets from which the effect of a shared error is computed.
const ENOUGH: usize = 400;

/// Returns the covariance of (x, y, z, yaw) of stations 2, 3, … that the shared errors cause (m, rad), by aligning with each error
/// of 1 σ.
pub fn covariance(
    triplets: &Triplets,
    align: impl Fn(&Triplets) -> Option<PerStation<RigidTransform>>,
) -> Option<DMatrix<f64>> {
    let stride = triplets.len().div_ceil(ENOUGH).max(1);
    let some: Vec<usize> = (0..triplets.len()).step_by(stride).collect();
    let some = triplets.select(&some);
    let without = align(&some)?;
    let moved_by = |error: &dyn Fn(Station, &Vector3<f64>) -> Vector3<f64>| {
        let points_m = some
            .points_m
            .map_each(|station, points| points.iter().map(|point| error(station, point)).collect());
        let with = align(&Triplets { points_m, ..some.clone() })?;
        Some(DVector::from_fn(4 * (without.len() - 1), |k, _| {
            let (with, without) = (&with[k / 4 + 1], &without[k / 4 + 1]);
            match k % 4 {
                3 => wrap_to_pi(with.yaw_rad() - without.yaw_rad()),
                axis => with.translation_m[axis] - without.translation_m[axis],
            }
        }))
    };
    let longer =
        |_: Station, point: &Vector3<f64>| point + PRISM_CONSTANT_SIGMA_M * point.normalize();
    let mut moves = vec![moved_by(&longer)?];
    for leaning in triplets.points_m.numbers() {
        for axis in [Vector3::x_axis(), Vector3::y_axis()] {
            let lean = Rotation3::from_axis_angle(&axis, TILT_SIGMA_RAD);
            moves.push(moved_by(&|station, point| {
                if station == leaning { lean * point } else { *point }
            })?);
        }
    }
    Some(moves.iter().map(|moved| moved * moved.transpose()).sum())
}
