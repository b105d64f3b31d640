//! Simulated drives for tests of this crate. The simulator belongs to a crate above, whose copy of these types is another one.

use resect_tools::simulation;
pub use resect_tools::simulation::Preset;

use crate::deployment::{Deployment, Measurement, Rig, Track};
use crate::network::{Per, PerStation};

/// Returns the tracks and the rig of a simulated drive.
pub fn simulated(preset: Preset, seed: u64) -> Deployment {
    let readings = simulation::simulate(preset, seed).readings();
    let tracks: PerStation<Track> = readings
        .tracks
        .iter()
        .map(|track| Track {
            measurements: track
                .measurements
                .iter()
                .map(|m| Measurement {
                    time_s: m.time_s,
                    range_m: m.range_m,
                    azimuth_rad: m.azimuth_rad,
                    zenith_rad: m.zenith_rad,
                })
                .collect(),
            prism_constant_m: track.prism_constant_m,
            ..Track::default()
        })
        .collect();
    let rig = readings.rig.map(|rig| Rig {
        inter_prism_m: rig.inter_prism_m.into_iter().collect(),
        prisms_m: rig.prisms_m.map(|prisms_m| prisms_m.into_iter().collect()),
        in_vehicle_m: None,
        inter_antenna_m: None,
    });
    let time_corrections = Per::repeat(tracks.len(), Vec::new());
    Deployment { name: readings.name, tracks, rig, time_corrections, ..Deployment::default() }
}
