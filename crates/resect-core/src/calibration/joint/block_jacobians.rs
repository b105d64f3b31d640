//! Jacobians of a block's unknowns u with respect to the constants θ and the slow states s.
//!
//! Within a block the errors of an instrument are approximated by one shift of its station, that of the mean sight, and a shift of station 1
//! by the opposite shift of stations 2 and 3. So the readings of a block have the Jacobians of its 14 unknowns, `∂u = J_θ ∂θ + J_s ∂s`.

use crate::network::PerStation;
use std::sync::Arc;

use nalgebra::{SMatrix, Vector3};

use super::drive::Drive;
use super::state_vector::{
    BLOCK, BLOCK_CLOCKS, BLOCK_DISTANCES, BLOCK_LATENCIES, CLOCKS, COLLIMATIONS, CONSTANTS,
    Constants, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES, SLOW, SLOW_ACROSS,
    SLOW_CLOCKS, SLOW_RANGES, Slow,
};
use super::station_model::{MeanSight, StationModel};

/// Jacobians of a block's unknowns: by the constants, and by the slow states.
pub type BlockJacobian = (SMatrix<f64, BLOCK, CONSTANTS>, SMatrix<f64, BLOCK, SLOW>);

/// Jacobians of all blocks of a drive. Each is computed when it is needed: stored, those of a long drive would need more memory than
/// its readings.
#[derive(Clone)]
pub struct BlockJacobians {
    drive: Arc<Drive>,
    stations: [StationModel; 3],
}

impl BlockJacobians {
    /// The Jacobians at these constants.
    pub fn new(drive: &Arc<Drive>, constants: &Constants) -> Self {
        let stations = [0, 1, 2].map(|station| StationModel::new(constants, station));
        Self { drive: Arc::clone(drive), stations }
    }

    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    pub fn of_block(&self, block: usize) -> BlockJacobian {
        let time_s = self.drive.block_times_s[block];
        let since_s = time_s - self.drive.middle_s(time_s);
        block_jacobian(&self.stations, &self.drive.mean_sights[block], since_s)
    }

    /// Returns true if the next block belongs to the same segment.
    pub fn is_coupled_to_next(&self, block: usize) -> bool {
        self.drive.coupled_to_next[block]
    }

    /// Jacobians of the shift (m) and the rotation about the station (rad) of station 1's readings during a block.
    pub fn of_station_1(
        &self,
        block: usize,
    ) -> (SMatrix<f64, 6, CONSTANTS>, SMatrix<f64, 6, SLOW>) {
        let (station, mean_sight) = (&self.stations[0], &self.drive.mean_sights[block][0]);
        let (shift_by_constants, shift_by_slow) = point_jacobian(station, mean_sight, 0);
        let mut by_constants = SMatrix::<f64, 6, CONSTANTS>::zeros();
        let mut by_slow = SMatrix::<f64, 6, SLOW>::zeros();
        by_constants.fixed_rows_mut::<3>(0).copy_from(&shift_by_constants);
        by_slow.fixed_rows_mut::<3>(0).copy_from(&shift_by_slow);
        for (column, axis) in station_1_rotations(station) {
            let mut shift = by_constants.fixed_view_mut::<3, 1>(0, column);
            shift -= axis.cross(&(station.rotation * mean_sight.point_m));
            by_constants.fixed_view_mut::<3, 1>(3, column).copy_from(&axis);
        }
        (by_constants, by_slow)
    }
}

/// Jacobians of the mean point of a station's readings (m, station 1's axes) by its instrument's constants and slow states.
pub fn point_jacobian(
    model: &StationModel,
    mean_sight: &MeanSight,
    station: usize,
) -> (SMatrix<f64, 3, CONSTANTS>, SMatrix<f64, 3, SLOW>) {
    let rotated = |vector: Vector3<f64>| model.rotation * vector;
    let along = -rotated(mean_sight.along);
    let columns = [
        (LEANS + 2 * station, rotated(Vector3::x().cross(&mean_sight.point_m))),
        (LEANS + 2 * station + 1, rotated(Vector3::y().cross(&mean_sight.point_m))),
        (OFFSETS + station, along),
        (SCALES + station, -rotated(mean_sight.point_m)),
        (INDICES + station, rotated(mean_sight.up_m)),
        (COLLIMATIONS + station, -rotated(mean_sight.side_m)),
    ];
    let mut by_constants = SMatrix::<f64, 3, CONSTANTS>::zeros();
    for (column, vector) in &columns {
        by_constants.fixed_view_mut::<3, 1>(0, *column).copy_from(vector);
    }
    let mut by_slow = SMatrix::<f64, 3, SLOW>::zeros();
    by_slow.fixed_view_mut::<3, 1>(0, SLOW_RANGES + station).copy_from(&along);
    let [across, up] = [mean_sight.side, mean_sight.up].map(|axis| -rotated(axis));
    by_slow.fixed_view_mut::<3, 1>(0, SLOW_ACROSS + 2 * station).copy_from(&across);
    by_slow.fixed_view_mut::<3, 1>(0, SLOW_ACROSS + 2 * station + 1).copy_from(&up);
    (by_constants, by_slow)
}

/// Correction of station 1's slow errors in a position (m, station 1's level axes).
pub fn station_1_shift_m(
    constants: &Constants,
    mean_sight: &MeanSight,
    slow: &Slow,
) -> Vector3<f64> {
    point_jacobian(&StationModel::new(constants, 0), mean_sight, 0).1 * slow
}

/// The constants that rotate all readings of station 1 about it, with their axes in station 1's level axes.
///
/// A collimation error is a rotation about the vertical for level sights only.
fn station_1_rotations(model: &StationModel) -> [(usize, Vector3<f64>); 3] {
    let axes = [(LEANS, Vector3::x()), (LEANS + 1, Vector3::y()), (COLLIMATIONS, Vector3::z())];
    axes.map(|(column, axis)| (column, model.rotation * axis))
}

/// Jacobians of a block's unknowns, `since_middle_s` after the middle of its drive.
fn block_jacobian(
    stations: &[StationModel; 3],
    mean_sights: &PerStation<MeanSight>,
    since_middle_s: f64,
) -> BlockJacobian {
    // (19)
    let mut by_constants = SMatrix::<f64, BLOCK, CONSTANTS>::zeros();
    let mut by_slow = SMatrix::<f64, BLOCK, SLOW>::zeros();
    for (station, (model, mean_sight)) in stations.iter().zip(mean_sights).enumerate() {
        let (shift_by_constants, shift_by_slow) = point_jacobian(model, mean_sight, station);
        // A shift of station 1 is the opposite shift of stations 2 and 3.
        let shifted: &[(usize, f64)] = match station {
            0 => &[(0, -1.0), (3, -1.0)],
            1 => &[(0, 1.0)],
            _ => &[(3, 1.0)],
        };
        for (row, sign) in shifted {
            let mut rows = by_constants.fixed_rows_mut::<3>(*row);
            rows += shift_by_constants * *sign;
            let mut rows = by_slow.fixed_rows_mut::<3>(*row);
            rows += shift_by_slow * *sign;
        }
        by_constants[(BLOCK_LATENCIES + station, LATENCIES + station)] = 1.0;
        by_constants[(BLOCK_DISTANCES + station, DISTANCES + station)] = 1.0;
        let Some(slot) = station.checked_sub(1) else { continue };
        let point_m = model.rotation * mean_sight.point_m;
        // A rotation of station 1 is unobservable from the rig alone, because it rotates the rig as well. With the shift above it becomes the
        // opposite rotation of the points of stations 2 and 3 about station 1, which yaws and positions can compensate.
        let separation_m =
            point_m + model.position_m - stations[0].rotation * mean_sights[0].point_m;
        for (column, axis) in station_1_rotations(&stations[0]) {
            let mut rows = by_constants.fixed_view_mut::<3, 1>(3 * slot, column);
            rows -= axis.cross(&separation_m);
        }
        let by_yaw_m = Vector3::z().cross(&point_m);
        for axis in 0..3 {
            by_constants[(3 * slot + axis, 4 * slot + axis)] = 1.0;
            by_slow[(3 * slot + axis, 4 * slot + axis)] = 1.0;
            by_constants[(3 * slot + axis, 4 * slot + 3)] = by_yaw_m[axis];
            by_slow[(3 * slot + axis, 4 * slot + 3)] = by_yaw_m[axis];
        }
        by_constants[(BLOCK_CLOCKS + slot, CLOCKS + slot)] = 1.0;
        by_constants[(BLOCK_CLOCKS + slot, DRIFTS + slot)] = since_middle_s;
        by_slow[(BLOCK_CLOCKS + slot, SLOW_CLOCKS + slot)] = 1.0;
    }
    (by_constants, by_slow)
}

#[cfg(test)]
mod tests {
    use super::super::station_model::Sight;
    use super::*;

    /// Stations and their mean sights to a rig that rotates, far from level.
    fn example() -> (Constants, [StationModel; 3], PerStation<MeanSight>) {
        let mut constants = Constants::zeros();
        for (index, value) in
            [60.0, -12.0, 1.5, 0.7, 35.0, 48.0, -2.0, -2.1].into_iter().enumerate()
        {
            constants[index] = value;
        }
        let stations = [0, 1, 2].map(|station| StationModel::new(&constants, station));
        let mean_sights = [0, 1, 2].map(|k: usize| {
            let model = &stations[k];
            let sights = (0..15).map(|i| {
                let (t, angle_rad) = (0.4 * f64::from(i), 0.3 * f64::from(i) + 2.1 * k as f64);
                let rig_m =
                    Vector3::new(0.6 * angle_rad.cos(), 0.6 * angle_rad.sin(), 0.2 * k as f64);
                let prism_m = Vector3::new(30.0 + t, 20.0 - 0.5 * t, 0.8) + rig_m;
                Sight::to(&model.rotation.tr_mul(&(prism_m - model.position_m)))
            });
            MeanSight::of(sights).expect("sights")
        });
        (constants, stations, mean_sights.into())
    }

    /// Largest change of the block's unknowns if everything rotates about an axis through station 1: each station by its lean, or
    /// by its yaw and station 1 by its collimation.
    fn change_by_common_rotation(axis: &Vector3<f64>, lean: bool) -> f64 {
        let (constants, stations, mean_sights) = example();
        let mut rotation = Constants::zeros();
        for slot in 0..2 {
            let position: Vector3<f64> = constants.fixed_rows::<3>(4 * slot).into();
            rotation.fixed_rows_mut::<3>(4 * slot).copy_from(&axis.cross(&position));
        }
        if lean {
            for station in 0..3 {
                let own_axis = stations[station].rotation.tr_mul(axis);
                rotation.fixed_rows_mut::<2>(LEANS + 2 * station).copy_from(&own_axis.xy());
            }
        } else {
            (rotation[3], rotation[7], rotation[COLLIMATIONS]) = (1.0, 1.0, 1.0);
        }
        (block_jacobian(&stations, &mean_sights, 0.0).0 * rotation).amax()
    }

    #[test]
    fn a_common_rotation_of_all_stations_is_unobservable() {
        assert!(change_by_common_rotation(&Vector3::x(), true) < 1e-9);
        assert!(change_by_common_rotation(&Vector3::y(), true) < 1e-9);
        // A collimation error acts on the slope distance, and a yaw on the horizontal one: they differ where sights are steep.
        let steep = change_by_common_rotation(&Vector3::z(), false);
        assert!(steep > 1e-4 && steep < 0.03, "{steep} m a radian");
    }
}
