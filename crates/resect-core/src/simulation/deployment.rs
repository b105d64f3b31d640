//! Conversion of a simulated drive to a deployment, without files.

use super::simulated::Simulated;
use crate::deployment::{Deployment, Overrides, Rig, Track, TrackFrame, pairwise_distances};
use crate::network::{PerStation, USUAL_STATIONS};

impl Simulated {
    /// Returns the readings of the drive with the true rig; numbers are not rounded as in files.
    ///
    /// Control points and GNSS are omitted. `resect_io::simulation_files` writes and reads everything.
    pub fn readings(&self) -> Deployment {
        let track = |station: usize| Track {
            measurements: (self.records.iter())
                .filter(|record| record.station == station as i64 + 1)
                .map(|record| record.measurement)
                .collect(),
            prism_constant_m: self.scenario.prism_constant_m,
            ..Track::default()
        };
        let prisms_m = self.truth.prisms_m;
        let rig = Rig {
            inter_prism_m: pairwise_distances(&prisms_m),
            prisms_m: Some(prisms_m.into()),
            in_vehicle_m: Some(prisms_m.into()),
            inter_antenna_m: None,
        };
        let is_rig = rig.inter_prism_m.iter().all(|distance_m| *distance_m > 0.0);
        Deployment {
            name: self.scenario.name.to_owned(),
            tracks: [0, 1, 2].map(track).into(),
            track_frame: TrackFrame::Own,
            control_points: Vec::new(),
            rig: is_rig.then_some(rig),
            prisms: None,
            gnss: None,
            time_corrections: PerStation::repeat(USUAL_STATIONS, Vec::new()),
            overrides: Overrides::default(),
            as_read: Overrides::default(),
            ingredients: Vec::new(),
            findings: Vec::new(),
            ground_truth: None,
            restarts_s: Vec::new(),
        }
    }
}
