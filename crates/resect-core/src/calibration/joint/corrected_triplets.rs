//! Triplets corrected for the estimated errors of clocks and instruments.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::joint_estimate::JointEstimate;
use super::station_model::{Sight, StationModel};
use crate::calibration::{Clock, velocity_m_per_s};
use crate::network::PerStation;
use crate::pipeline::Triplets;

impl JointEstimate {
    /// Clock offsets and drifts of stations 2 and 3.
    pub fn clocks(&self) -> [Clock; 2] {
        std::array::from_fn(|slot| Clock {
            offset_s: self.clock_offsets_s[slot].value,
            drift: self.clock_drifts[slot].value,
        })
    }

    /// Returns the triplets corrected for clocks and instruments, in level frames of the stations.
    pub fn corrected(&self, triplets: Cow<'_, Triplets>) -> Triplets {
        let mut triplets = triplets.into_owned();
        self.correct(&triplets.time_s, &triplets.interval, &mut triplets.points_m);
        triplets
    }

    /// Corrects the points of triplets by station (m), with their times (s) and intervals.
    pub fn correct(
        &self,
        time_s: &[f64],
        interval: &[u32],
        points_m: &mut PerStation<Vec<Vector3<f64>>>,
    ) {
        for (station, points_m) in points_m.iter_mut().enumerate() {
            let velocity_m_per_s = velocity_m_per_s(time_s, interval, points_m, 1);
            let model = self.level_model(station);
            for (point_m, (time_s, velocity)) in
                points_m.iter_mut().zip(time_s.iter().zip(&velocity_m_per_s))
            {
                let offset_s = self.clock_offset_s(station, *time_s);
                let sight = Sight::to(point_m);
                let across: Vector3<f64> = velocity - sight.along * sight.along.dot(velocity);
                let moved_m = velocity * offset_s + across * model.latency_s;
                *point_m = model.rotation * (model.corrected(&sight) + moved_m);
            }
        }
    }

    /// Clock offset of a station at an instant (s).
    fn clock_offset_s(&self, station: usize, time_s: f64) -> f64 {
        let Some(slot) = station.checked_sub(1) else { return 0.0 };
        let drive = self.drives.iter().rfind(|drive| drive.span_s[0] <= time_s);
        let Some(drive) = drive.or(self.drives.first()) else { return 0.0 };
        let since_s = time_s - 0.5 * (drive.span_s[0] + drive.span_s[1]);
        drive.offsets_s[slot].value + self.clock_drifts[slot].value * since_s
    }

    /// The model of a station in its own level frame, without clock errors.
    fn level_model(&self, station: usize) -> StationModel {
        let [x, y] = self.leans_rad[station].map(|lean| lean.value);
        StationModel {
            rotation: *nalgebra::Rotation3::new(Vector3::new(x, y, 0.0)).matrix(),
            position_m: Vector3::zeros(),
            offset_m: self.range_offsets_m[station].value,
            scale: self.range_scales[station].value,
            index_rad: self.indices_rad[station].value,
            collimation_rad: self.collimations_rad[station].value,
            latency_s: self.latencies_s[station].value,
            clock_offset_s: 0.0,
            clock_drift: 0.0,
        }
    }
}
