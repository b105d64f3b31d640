//! Triplets as they would be had the instruments been right.

use std::borrow::Cow;

use nalgebra::Vector3;

use super::joint_estimate::JointEstimate;
use super::unknowns::{Sight, Station};
use crate::calibration::{Clock, velocity_m_per_s};
use crate::pipeline::Triplets;

impl JointEstimate {
    /// How late the stamps of stations 2 and 3 are.
    pub fn clocks(&self) -> [Clock; 2] {
        std::array::from_fn(|slot| Clock {
            offset_s: self.clock_offsets_s[slot].value,
            drift: self.clock_drifts[slot].value,
        })
    }

    /// The triplets with all that was found of the instruments taken into account, each station upright in its own frame.
    pub fn corrected(&self, triplets: Cow<'_, Triplets>) -> Triplets {
        let mut triplets = triplets.into_owned();
        self.put_right(&triplets.time_s, &triplets.interval, &mut triplets.points_m);
        triplets
    }

    /// The same to the points of triplets by station (m), with their times (s) and intervals.
    pub fn put_right(
        &self,
        time_s: &[f64],
        interval: &[u32],
        points_m: &mut [Vec<Vector3<f64>>; 3],
    ) {
        for (station, points_m) in points_m.iter_mut().enumerate() {
            let velocity_m_per_s = velocity_m_per_s(time_s, interval, points_m, 1);
            let instrument = self.instrument(station);
            for (point_m, (time_s, velocity)) in
                points_m.iter_mut().zip(time_s.iter().zip(&velocity_m_per_s))
            {
                let late_s = self.late_s(station, *time_s);
                let sight = Sight::at(point_m);
                let across: Vector3<f64> = velocity - sight.along * sight.along.dot(velocity);
                let when = velocity * late_s + across * instrument.latency_s;
                *point_m = instrument.turn * (instrument.corrected(&sight) + when);
            }
        }
    }

    /// How late the stamps of a station are at an instant (s).
    fn late_s(&self, station: usize, time_s: f64) -> f64 {
        let Some(slot) = station.checked_sub(1) else { return 0.0 };
        let drive = self.drives.iter().rfind(|drive| drive.span_s[0] <= time_s);
        let Some(drive) = drive.or(self.drives.first()) else { return 0.0 };
        let since_s = time_s - 0.5 * (drive.span_s[0] + drive.span_s[1]);
        drive.late_s[slot].value + self.clock_drifts[slot].value * since_s
    }

    /// A station in its own upright frame, its clock right.
    fn instrument(&self, station: usize) -> Station {
        let [x, y] = self.leans_rad[station].map(|lean| lean.value);
        Station {
            turn: *nalgebra::Rotation3::new(Vector3::new(x, y, 0.0)).matrix(),
            place_m: Vector3::zeros(),
            offset_m: self.range_offsets_m[station].value,
            scale: self.range_scales[station].value,
            index_rad: self.indices_rad[station].value,
            collimation_rad: self.collimations_rad[station].value,
            latency_s: self.latencies_s[station].value,
            late_s: 0.0,
            drift: 0.0,
        }
    }
}
