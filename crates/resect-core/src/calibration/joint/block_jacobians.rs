//! Jacobians of a block's unknowns u with respect to the constants θ and the slow states s.
//!
//! Within a block the errors of an instrument are approximated by one shift of its station, that of the mean sight. The first station that has
//! readings there is the reference of the block: the motion has its errors, and its shift is the opposite shift of all others. So the
//! readings of a block have the Jacobians of its unknowns, `∂u = J_θ ∂θ + J_s ∂s`.

use std::sync::Arc;

use nalgebra::{DMatrix, Vector3};

use super::drive::Drive;
use super::state_vector::{Constants, Layout, Slow};
use super::station_model::{MeanSight, StationModel};
use super::unknown::{CLOCK_DRIFT, CLOCK_OFFSET, COLLIMATION, DISTANCE, LATENCY, LEAN_X, LEAN_Y};
use crate::network::{Number, PerStation, Station};

/// Jacobians of a block's unknowns: by the constants, and by the slow states.
pub type BlockJacobian = (DMatrix<f64>, DMatrix<f64>);

/// Jacobians of all blocks of a drive. Each is computed when it is needed: stored, those of a long drive would need more memory than
/// its readings.
#[derive(Clone)]
pub struct BlockJacobians {
    drive: Arc<Drive>,
    stations: Vec<StationModel>,
}

impl BlockJacobians {
    /// The Jacobians at these constants.
    pub fn new(drive: &Arc<Drive>, constants: &Constants) -> Self {
        let stations = StationModel::all(&drive.layout, constants);
        Self { drive: Arc::clone(drive), stations }
    }

    pub fn drive(&self) -> &Drive {
        &self.drive
    }

    pub fn of_block(&self, block: usize) -> BlockJacobian {
        let time_s = self.drive.block_times_s[block];
        let since_s = time_s - self.drive.middle_s(time_s);
        block_jacobian(&self.drive.layout, &self.stations, &self.drive.mean_sights[block], since_s)
    }

    /// Returns true if the next block belongs to the same segment.
    pub fn is_coupled_to_next(&self, block: usize) -> bool {
        self.drive.coupled_to_next[block]
    }

    /// Jacobians of the shift (m) and the rotation about the origin (rad) of the motion during a block, by the errors of its reference.
    pub fn of_motion(&self, block: usize) -> BlockJacobian {
        let layout = &self.drive.layout;
        let mut by_constants = DMatrix::zeros(6, layout.constants);
        let mut by_slow = DMatrix::zeros(6, layout.slow());
        let Some((reference, mean_sight)) = reference(&self.drive.mean_sights[block]) else {
            return (by_constants, by_slow);
        };
        let model = &self.stations[reference.index()];
        let (shift_by_constants, shift_by_slow) =
            point_jacobian(layout, model, mean_sight, reference);
        by_constants.rows_mut(0, 3).copy_from(&shift_by_constants);
        by_slow.rows_mut(0, 3).copy_from(&shift_by_slow);
        let mean_m = model.rotation * mean_sight.point_m;
        for (column, axis) in rotations(layout, model, reference) {
            let mut shift = by_constants.fixed_view_mut::<3, 1>(0, column);
            shift -= axis.cross(&(mean_m + model.position_m));
            by_constants.fixed_view_mut::<3, 1>(3, column).copy_from(&axis);
        }
        if let Some(slot) = reference.slot() {
            for by_pose in [&mut by_constants, &mut by_slow] {
                by_pose.fixed_view_mut::<3, 3>(0, 4 * slot).fill_with_identity();
                let yaw = 4 * slot + 3;
                let by_yaw_m = -Vector3::z().cross(&model.position_m);
                by_pose.fixed_view_mut::<3, 1>(0, yaw).copy_from(&by_yaw_m);
                by_pose.fixed_view_mut::<3, 1>(3, yaw).copy_from(&Vector3::z());
            }
        }
        (by_constants, by_slow)
    }
}

/// Returns the reference of a block, with its mean sight.
fn reference(mean_sights: &PerStation<Option<MeanSight>>) -> Option<(Station, &MeanSight)> {
    mean_sights.each().find_map(|(station, mean_sight)| Some((station, mean_sight.as_ref()?)))
}

/// Jacobians of the mean point of a station's readings (m, station 1's axes) by its instrument's constants and slow states.
pub fn point_jacobian(
    layout: &Layout,
    model: &StationModel,
    mean_sight: &MeanSight,
    station: Station,
) -> BlockJacobian {
    let rotated = |vector: Vector3<f64>| model.rotation * vector;
    let mut by_constants = DMatrix::zeros(3, layout.constants);
    let mut set = |column: usize, vector: Vector3<f64>| {
        by_constants.fixed_view_mut::<3, 1>(0, column).copy_from(&rotated(vector));
    };
    for (unknown, axis) in [(&LEAN_X, Vector3::x()), (&LEAN_Y, Vector3::y())] {
        set(layout.index(unknown, station.index()), axis.cross(&mean_sight.point_m));
    }
    for ((_, index), correction_m) in layout.reading_errors(station).zip(&mean_sight.corrections_m)
    {
        set(index, *correction_m);
    }
    let mut by_slow = DMatrix::zeros(3, layout.slow());
    let across = layout.slow_across() + 2 * station.index();
    for (column, axis) in [
        (layout.slow_ranges() + station.index(), mean_sight.along),
        (across, mean_sight.side),
        (across + 1, mean_sight.up),
    ] {
        by_slow.fixed_view_mut::<3, 1>(0, column).copy_from(&-rotated(axis));
    }
    (by_constants, by_slow)
}

/// Jacobian of the mean point of a station's readings in station 1's frame (m), by constants and slow states.
fn placed_jacobian(
    layout: &Layout,
    model: &StationModel,
    mean_sight: &MeanSight,
    station: Station,
) -> BlockJacobian {
    let (mut by_constants, mut by_slow) = point_jacobian(layout, model, mean_sight, station);
    if let Some(slot) = station.slot() {
        let by_yaw_m = Vector3::z().cross(&(model.rotation * mean_sight.point_m));
        for by_pose in [&mut by_constants, &mut by_slow] {
            by_pose.fixed_view_mut::<3, 3>(0, 4 * slot).fill_with_identity();
            by_pose.fixed_view_mut::<3, 1>(0, 4 * slot + 3).copy_from(&by_yaw_m);
        }
    }
    (by_constants, by_slow)
}

/// Correction of the slow errors of a block's reference in a position (m, station 1's level axes).
pub fn reference_shift_m(
    layout: &Layout,
    constants: &Constants,
    mean_sights: &PerStation<Option<MeanSight>>,
    slow: &Slow,
) -> Vector3<f64> {
    let Some((reference, mean_sight)) = reference(mean_sights) else { return Vector3::zeros() };
    let model = StationModel::new(layout, constants, reference);
    let shift_m = placed_jacobian(layout, &model, mean_sight, reference).1 * slow;
    shift_m.fixed_rows::<3>(0).into()
}

/// The constants that rotate all readings of a station about it, with their axes in station 1's level axes.
///
/// A collimation error is a rotation about the vertical for level sights only.
fn rotations(
    layout: &Layout,
    model: &StationModel,
    station: Station,
) -> [(usize, Vector3<f64>); 3] {
    let axes = [(&LEAN_X, Vector3::x()), (&LEAN_Y, Vector3::y()), (&COLLIMATION, Vector3::z())];
    axes.map(|(unknown, axis)| (layout.index(unknown, station.index()), model.rotation * axis))
}

/// Jacobians of a block's unknowns, `since_middle_s` after the middle of its drive.
fn block_jacobian(
    layout: &Layout,
    stations: &[StationModel],
    mean_sights: &PerStation<Option<MeanSight>>,
    since_middle_s: f64,
) -> BlockJacobian {
    // (19)
    let mut by_constants = DMatrix::zeros(layout.block(), layout.constants);
    let mut by_slow = DMatrix::zeros(layout.block(), layout.slow());
    for (station, mean_sight) in mean_sights.each() {
        let latency = layout.index(&LATENCY, station.index());
        by_constants[(layout.block_latencies() + station.index(), latency)] = 1.0;
        let Some(slot) = station.slot() else { continue };
        let clock = layout.block_clocks() + slot;
        by_constants[(clock, layout.index(&CLOCK_OFFSET, slot))] = 1.0;
        by_constants[(clock, layout.index(&CLOCK_DRIFT, slot))] = since_middle_s;
        by_slow[(clock, layout.slow_clocks() + slot)] = 1.0;
        let Some(mean_sight) = mean_sight else { continue };
        let model = &stations[station.index()];
        let (shift_by_constants, shift_by_slow) =
            placed_jacobian(layout, model, mean_sight, station);
        by_constants.rows_mut(3 * slot, 3).copy_from(&shift_by_constants);
        by_slow.rows_mut(3 * slot, 3).copy_from(&shift_by_slow);
    }
    for (pair, index) in layout.indices(&DISTANCE).enumerate() {
        by_constants[(layout.block_distances() + pair, index)] = 1.0;
    }
    subtract_reference(layout, stations, mean_sights, &mut by_constants, &mut by_slow);
    (by_constants, by_slow)
}

/// Subtracts the shift of a block's reference from all others, and its rotation.
///
/// A rotation of the reference is unobservable from the rig alone, because it rotates the rig as well. It is the opposite rotation of the points
/// of the others about it, which yaws and positions can compensate.
fn subtract_reference(
    layout: &Layout,
    stations: &[StationModel],
    mean_sights: &PerStation<Option<MeanSight>>,
    by_constants: &mut DMatrix<f64>,
    by_slow: &mut DMatrix<f64>,
) {
    let Some((reference, sight)) = reference(mean_sights) else { return };
    let placed_m = |station: Station, mean_sight: &MeanSight| {
        let model = &stations[station.index()];
        model.rotation * mean_sight.point_m + model.position_m
    };
    let model = &stations[reference.index()];
    let (shift_by_constants, shift_by_slow) = placed_jacobian(layout, model, sight, reference);
    let rotations = rotations(layout, model, reference);
    let reference_m = placed_m(reference, sight);
    for (station, mean_sight) in mean_sights.each() {
        let (Some(slot), Some(mean_sight)) = (station.slot(), mean_sight) else { continue };
        let mut rows = by_constants.rows_mut(3 * slot, 3);
        rows -= &shift_by_constants;
        let mut rows = by_slow.rows_mut(3 * slot, 3);
        rows -= &shift_by_slow;
        let separation_m = placed_m(station, mean_sight) - reference_m;
        for (column, axis) in rotations {
            let mut rows = by_constants.fixed_view_mut::<3, 1>(3 * slot, column);
            rows -= axis.cross(&separation_m);
        }
        let Some(of_reference) = reference.slot() else { continue };
        let by_yaw_m = Vector3::z().cross(&separation_m);
        for by_pose in [&mut *by_constants, &mut *by_slow] {
            let mut rows = by_pose.fixed_view_mut::<3, 1>(3 * slot, 4 * of_reference + 3);
            rows -= by_yaw_m;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::sight::Sight;
    use super::super::state_vector::tests::layout;
    use super::*;

    /// Stations and their mean sights to a rig that rotates, far from level.
    fn example() -> (Constants, Vec<StationModel>, PerStation<Option<MeanSight>>) {
        let layout = layout(3);
        let mut constants = Constants::zeros(layout.constants);
        for (index, value) in
            [60.0, -12.0, 1.5, 0.7, 35.0, 48.0, -2.0, -2.1].into_iter().enumerate()
        {
            constants[index] = value;
        }
        let stations = StationModel::all(&layout, &constants);
        let mean_sights = [0, 1, 2].map(|k: usize| {
            let model = &stations[k];
            let sights = (0..15).map(|i| {
                let (t, angle_rad) = (0.4 * f64::from(i), 0.3 * f64::from(i) + 2.1 * k as f64);
                let rig_m =
                    Vector3::new(0.6 * angle_rad.cos(), 0.6 * angle_rad.sin(), 0.2 * k as f64);
                let prism_m = Vector3::new(30.0 + t, 20.0 - 0.5 * t, 0.8) + rig_m;
                Sight::to(&model.rotation.tr_mul(&(prism_m - model.position_m)))
            });
            MeanSight::of(&layout, sights)
        });
        (constants, stations, mean_sights.into())
    }

    /// Largest change of the block's unknowns if everything rotates about an axis through station 1: each station by its lean, or
    /// by its yaw and station 1 by its collimation.
    fn change_by_common_rotation(axis: &Vector3<f64>, lean: bool, silent: Option<usize>) -> f64 {
        let layout = layout(3);
        let (constants, stations, mut mean_sights) = example();
        if let Some(silent) = silent {
            mean_sights[silent] = None;
        }
        let mut rotation = Constants::zeros(layout.constants);
        for slot in 0..2 {
            let position: Vector3<f64> = constants.fixed_rows::<3>(4 * slot).into();
            rotation.fixed_rows_mut::<3>(4 * slot).copy_from(&axis.cross(&position));
        }
        if lean {
            for station in 0..3 {
                let own_axis = stations[station].rotation.tr_mul(axis);
                rotation[layout.index(&LEAN_X, station)] = own_axis.x;
                rotation[layout.index(&LEAN_Y, station)] = own_axis.y;
            }
        } else {
            rotation[layout.index(&COLLIMATION, 0)] = 1.0;
            (rotation[3], rotation[7]) = (1.0, 1.0);
        }
        (block_jacobian(&layout, &stations, &mean_sights, 0.0).0 * rotation).amax()
    }

    #[test]
    fn a_common_rotation_of_all_stations_is_unobservable() {
        // In a block without station 1, station 2 is the reference.
        for silent in [None, Some(0), Some(1)] {
            for axis in [Vector3::x(), Vector3::y()] {
                assert!(change_by_common_rotation(&axis, true, silent) < 1e-9, "{silent:?}");
            }
        }
        // A collimation error acts on the slope distance, and a yaw on the horizontal one: they differ where sights are steep.
        let steep = change_by_common_rotation(&Vector3::z(), false, None);
        assert!(steep > 1e-4 && steep < 0.03, "{steep} m a radian");
        // Station 1 is not there, and its collimation has no effect.
        assert!(change_by_common_rotation(&Vector3::z(), false, Some(0)) < 1e-9);
    }
}
