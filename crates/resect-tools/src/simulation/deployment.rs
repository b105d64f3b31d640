//! Conversion of a simulated drive to a deployment, without files.

use super::simulated::Simulated;
use resect_core::deployment::{Deployment, Overrides, Rig, Track, TrackFrame, pairwise_distances};
use resect_core::network::{Number, PerStation, Prism, Station, USUAL_STATIONS};

impl Simulated {
    /// Returns the readings of the drive with the true rig; numbers are not rounded as in files.
    ///
    /// Control points and GNSS are omitted. `resect_io::simulation_files` writes and reads everything.
    pub fn readings(&self) -> Deployment {
        let (stations, prisms) = (self.scenario.stations(), self.scenario.prisms());
        // The usual numbers are recognised, as in files that do not state them.
        let is_usual = stations == USUAL_STATIONS && self.scenario.prisms_m.len() == stations;
        let track = |station: Station| Track {
            measurements: (self.records.iter())
                .filter(|record| record.station == station.number() as i64)
                .map(|record| record.measurement)
                .collect(),
            prism_constant_m: self.scenario.prism_constant_m,
            prism: (!is_usual).then(|| Prism::at(self.scenario.prism_of(station.index()))),
            ..Track::default()
        };
        let prisms_m = &self.truth.prisms_m;
        let rig = Rig {
            inter_prism_m: pairwise_distances(prisms_m.as_slice()),
            prisms_m: Some(prisms_m.clone()),
            in_vehicle_m: Some(prisms_m.clone()),
            inter_antenna_m: None,
        };
        let is_rig = prisms > 1;
        Deployment {
            name: self.scenario.name.to_owned(),
            tracks: PerStation::from_fn(stations, track),
            track_frame: TrackFrame::Own,
            control_points: Vec::new(),
            rig: is_rig.then_some(rig),
            prisms: (!is_usual).then_some(prisms as u8),
            gnss: None,
            time_corrections: PerStation::repeat(stations, Vec::new()),
            overrides: Overrides::default(),
            as_read: Overrides::default(),
            ingredients: Vec::new(),
            findings: Vec::new(),
            ground_truth: None,
            restarts_s: Vec::new(),
        }
    }
}
