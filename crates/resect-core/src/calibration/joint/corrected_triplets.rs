//! Triplets corrected for the estimated errors of clocks and instruments.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::joint_estimate::JointEstimate;
use super::sight::Sight;
use super::station_model::StationModel;
use crate::calibration::{Clock, velocity_m_per_s};
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;

impl JointEstimate {
    /// Clock offsets and drifts; zero for station 1.
    pub fn clocks(&self) -> PerStation<Clock> {
        self.clock_offsets_s.zip(&self.clock_drifts(), |offset_s, drift| Clock {
            offset_s: offset_s.value,
            drift: drift.value,
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
        let drifts = self.clock_drifts();
        for (station, points_m) in points_m.numbers().zip(points_m.iter_mut()) {
            let velocity_m_per_s = velocity_m_per_s(time_s, interval, points_m, 1);
            let model = self.level_model(station);
            for (point_m, (time_s, velocity)) in
                points_m.iter_mut().zip(time_s.iter().zip(&velocity_m_per_s))
            {
                let offset_s = self.clock_offset_s(station, drifts[station].value, *time_s);
                let sight = Sight::to(point_m);
                let across: Vector3<f64> = velocity - sight.along * sight.along.dot(velocity);
                let moved_m = velocity * offset_s + across * model.latency_s;
                *point_m = model.rotation * (model.corrected(&sight) + moved_m);
            }
        }
    }

    /// Clock offset of a station at an instant (s).
    fn clock_offset_s(&self, station: Station, drift: f64, time_s: f64) -> f64 {
        let drive = self.drives.iter().rfind(|drive| drive.span_s[0] <= time_s);
        let Some(drive) = drive.or(self.drives.first()) else { return 0.0 };
        let since_s = time_s - 0.5 * (drive.span_s[0] + drive.span_s[1]);
        drive.offsets_s[station].value + drift * since_s
    }

    /// The model of a station in its own level frame.
    fn level_model(&self, station: Station) -> StationModel {
        let (layout, constants) = (self.layout(), &self.solution.state.constants);
        StationModel::new(layout, constants, station).in_own_level_frame(layout, constants, station)
    }
}
