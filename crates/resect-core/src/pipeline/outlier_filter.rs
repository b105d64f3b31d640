//! Module 1: rejects readings that move faster than the vehicle can, and converts the others to Cartesian coordinates.

use nalgebra::Vector3;

use super::Thresholds;
use crate::deployment::{Deployment, Measurement, Track};
use crate::geometry::wrap_to_pi;
use crate::network::PerStation;

/// Rate for which a reading was rejected: the first above its threshold, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutlierReason {
    Range,
    Azimuth,
    Zenith,
}

/// Rates of change from the previous raw reading of the same station.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    pub range_m_per_s: f64,
    pub azimuth_deg_per_s: f64,
    pub zenith_deg_per_s: f64,
}

/// A station's readings after the filter, in Cartesian coordinates of its own frame.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct FilteredTrack {
    pub time_s: Vec<f64>,
    pub position_m: Vec<Vector3<f64>>,
    /// Index of each kept reading in the raw track.
    pub source: Vec<u32>,
    /// Reason for which each raw reading was rejected; `None` if it was not.
    pub rejected: Vec<Option<OutlierReason>>,
    /// True for each reading that the user excluded, as in [`Track::left_out`].
    pub left_out: Vec<bool>,
    /// Instants from which the station follows another prism (s), in order.
    pub prism_changes_s: Vec<f64>,
}

impl FilteredTrack {
    /// Returns true if the station follows another prism at the second instant (s) than at the first.
    pub fn changes_prism(&self, before_s: f64, after_s: f64) -> bool {
        self.prism_changes_s.iter().any(|time_s| before_s < *time_s && *time_s <= after_s)
    }
}

/// Returns the positions of all raw readings (m), each station in its own frame. They do not depend on settings.
pub fn positions_m(deployment: &Deployment) -> PerStation<Vec<Vector3<f64>>> {
    deployment.tracks.map(|track| track.measurements.iter().map(|m| track.position_m(m)).collect())
}

/// Filters the tracks, whose positions are [`positions_m`]. `None` keeps everything, like the paper's pipeline
/// without module 1.
pub fn filter(
    deployment: &Deployment,
    positions_m: &PerStation<Vec<Vector3<f64>>>,
    thresholds: Option<&Thresholds>,
) -> PerStation<FilteredTrack> {
    deployment
        .tracks
        .zip(positions_m, |track, positions_m| filter_track(track, positions_m, thresholds))
}

/// Returns the rates between two readings; the azimuth difference is wrapped to ±π.
pub fn rates(previous: &Measurement, this: &Measurement) -> Rates {
    let elapsed_s = this.time_s - previous.time_s;
    Rates {
        range_m_per_s: (this.range_m - previous.range_m) / elapsed_s,
        azimuth_deg_per_s: wrap_to_pi(this.azimuth_rad - previous.azimuth_rad).to_degrees()
            / elapsed_s,
        zenith_deg_per_s: (this.zenith_rad - previous.zenith_rad).to_degrees() / elapsed_s,
    }
}

/// Compares each reading with the previous raw reading, kept or not, so the return from a jump is rejected as a jump too.
/// Readings that the user excluded are skipped, and the first one of another prism has no previous one.
fn filter_track(
    track: &Track,
    positions_m: &[Vector3<f64>],
    thresholds: Option<&Thresholds>,
) -> FilteredTrack {
    let readings = &track.measurements;
    let mut previous: Option<&Measurement> = None;
    let mut out = FilteredTrack {
        time_s: Vec::with_capacity(readings.len()),
        position_m: Vec::with_capacity(readings.len()),
        source: Vec::with_capacity(readings.len()),
        rejected: Vec::with_capacity(readings.len()),
        left_out: track.left_out.clone(),
        prism_changes_s: track.prism_changes.iter().map(|change| change.time_s).collect(),
    };
    for (index, reading) in readings.iter().enumerate() {
        if track.is_left_out(index) {
            out.rejected.push(None);
            continue;
        }
        let reason = match (thresholds, previous) {
            (Some(thresholds), Some(previous))
                if !out.changes_prism(previous.time_s, reading.time_s) =>
            {
                too_fast(&rates(previous, reading), thresholds)
            }
            _ => None,
        };
        previous = Some(reading);
        out.rejected.push(reason);
        if reason.is_none() {
            out.time_s.push(reading.time_s);
            out.position_m.push(positions_m[index]);
            out.source.push(index as u32);
        }
    }
    out
}

/// Returns the first rate above its threshold.
pub fn too_fast(rates: &Rates, thresholds: &Thresholds) -> Option<OutlierReason> {
    if rates.range_m_per_s.abs() > thresholds.tau_r_m_per_s {
        Some(OutlierReason::Range)
    } else if rates.azimuth_deg_per_s.abs() > thresholds.tau_a_deg_per_s {
        Some(OutlierReason::Azimuth)
    } else if rates.zenith_deg_per_s.abs() > thresholds.tau_e_deg_per_s {
        Some(OutlierReason::Zenith)
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn filtered(
        readings: &[(f64, f64, f64, f64)],
        thresholds: Option<&Thresholds>,
    ) -> FilteredTrack {
        let measurements: Vec<_> = readings
            .iter()
            .map(|&(time_s, range_m, azimuth_rad, zenith_rad)| Measurement {
                time_s,
                range_m,
                azimuth_rad,
                zenith_rad,
            })
            .collect();
        let positions_m = vec![Vector3::zeros(); measurements.len()];
        filter_track(&Track { measurements, ..Track::default() }, &positions_m, thresholds)
    }

    #[test]
    fn each_rate_has_its_threshold_and_the_way_back_counts() {
        let readings = [
            (0.0, 10.0, 0.0, 1.5),
            (1.0, 11.9, 0.0, 1.5),
            (2.0, 14.0, 0.0, 1.5),   // 2.1 m/s
            (3.0, 14.0, 0.02, 1.5),  // 1.15 deg/s
            (4.0, 14.0, 0.02, 1.52), // 1.15 deg/s
            (5.0, 14.0, 0.02, 1.52),
        ];
        let out = filtered(&readings, Some(&Thresholds::default()));
        use OutlierReason::*;
        assert_eq!(out.rejected, [None, None, Some(Range), Some(Azimuth), Some(Zenith), None]);
        assert_eq!(out.source, [0, 1, 5]);
        assert_eq!(filtered(&readings, None).source.len(), 6);
    }

    #[test]
    fn azimuth_wraps() {
        let eps = 1e-3;
        let readings = [(0.0, 10.0, std::f64::consts::TAU - eps, 1.5), (1.0, 10.0, eps, 1.5)];
        assert_eq!(filtered(&readings, Some(&Thresholds::default())).rejected, [None, None]);
    }
}
