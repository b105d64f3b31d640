//! The measurements of one field session.

use std::sync::Arc;

use super::control_points::ControlPointSet;
use super::estimated_trajectory::EstimatedTrajectory;
use super::finding::Finding;
use super::gnss::GnssFix;
use super::ingredient::Ingredient;
use super::overrides::{Overrides, as_numbered, list_of};
use super::rig::Rig;
use super::track::{TimeCorrection, Track};
use super::track_frame::TrackFrame;
use crate::network::{Number, PerStation, Prism, PrismSchedule, Station, USUAL_STATIONS};

/// One field session: measurements of the stations, control points and the prism rig.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Deployment {
    pub name: String,
    /// Tracks of the stations; a missing station has an empty track.
    pub tracks: PerStation<Track>,
    /// The frames that the tracks are in.
    pub track_frame: TrackFrame,
    /// Static points, one set per file.
    pub control_points: Vec<ControlPointSet>,
    /// The prisms on the vehicle; `None` if no file describes them.
    pub rig: Option<Rig>,
    /// Number of prisms that the stations follow; `None` if no file states it.
    pub prisms: Option<u8>,
    /// Positions of GNSS antennas 1, 2, 3 on the vehicle.
    pub gnss: Option<[Vec<GnssFix>; 3]>,
    /// Corrections of the stations' clocks during the recording; empty if it has none.
    pub time_corrections: PerStation<Vec<TimeCorrection>>,
    /// Overrides with which it was read: `deployment.toml`, and the user's later corrections.
    pub overrides: Overrides,
    /// Overrides by its files alone: the folder's `deployment.toml`, and the rig's distances.
    pub as_read: Overrides,
    /// Files that were read or skipped.
    pub ingredients: Vec<Ingredient>,
    /// Findings of the readers.
    pub findings: Vec<Finding>,
    /// A trajectory of another system that is the ground truth in place of readings.
    pub ground_truth: Option<Arc<EstimatedTrajectory>>,
    /// Start of each further drive of the same set-up (s); empty for a single drive.
    pub restarts_s: Vec<f64>,
}

impl Deployment {
    /// Returns a deployment without readings whose ground truth is a trajectory of another system.
    pub fn of_ground_truth(truth: Arc<EstimatedTrajectory>) -> Self {
        let ingredient = Ingredient {
            file: truth.path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            path: Some(truth.path.clone()),
            what: "ground truth, a trajectory of another system",
            used: true,
        };
        Self {
            name: truth.name.clone(),
            tracks: PerStation::repeat(USUAL_STATIONS, Track::default()),
            time_corrections: PerStation::repeat(USUAL_STATIONS, Vec::new()),
            ingredients: vec![ingredient],
            findings: truth.findings.clone(),
            ground_truth: Some(truth),
            ..Self::default()
        }
    }

    /// Returns the numbers of the stations in the files.
    pub fn station_numbers(&self) -> PerStation<i64> {
        self.overrides.stations.clone().unwrap_or_else(|| as_numbered(self.tracks.len()))
    }

    /// Returns "station 3", with its name if it has one: "station 3 (/rts10)".
    pub fn station_in_words(&self, station: Station) -> String {
        let name = self.tracks.get(station).and_then(|track| track.name.as_ref());
        let name = name.map_or_else(String::new, |name| format!(" ({name})"));
        format!("station {station}{name}")
    }

    /// Returns the prisms that the stations follow over time: the stated ones, else one for each.
    pub fn prism_schedule(&self) -> PrismSchedule {
        let first_prism = |station: Station, track: &Track| {
            track.prism.unwrap_or_else(|| Prism::at(station.index()))
        };
        let changes = self.tracks.each().flat_map(|(station, track)| {
            track.prism_changes.iter().map(move |change| (station, *change))
        });
        PrismSchedule::new(self.tracks.map_each(first_prism), changes)
    }

    /// Returns the numbers of the stations with readings as a list of `deployment.toml`: "[1, 3]".
    pub fn numbers_with_readings(&self) -> String {
        let numbers = self.station_numbers();
        let number_of =
            |station: usize| numbers.iter().copied().nth(station).unwrap_or(station as i64 + 1);
        list_of(self.stations_with_readings().into_iter().map(number_of))
    }

    pub fn stations_with_readings(&self) -> Vec<usize> {
        let has_readings = |station: &usize| !self.tracks[*station].measurements.is_empty();
        (0..self.tracks.len()).filter(has_readings).collect()
    }

    /// Control points that can be compared with an answer from the tracks; their own answer can then be compared with the
    /// tracks. Empty if the tracks are in another frame.
    pub fn comparable_control_points(&self) -> &[ControlPointSet] {
        match self.track_frame {
            TrackFrame::Own => &self.control_points,
            TrackFrame::Common => &[],
        }
    }

    /// Time of the first measurement of any station, or pose of the ground truth (s, in the stations' common clock).
    pub fn start_s(&self) -> Option<f64> {
        let truth = self.ground_truth.iter().filter_map(|truth| truth.poses.first());
        self.tracks
            .iter()
            .filter_map(|track| track.measurements.first())
            .map(|m| m.time_s)
            .chain(truth.map(|pose| pose.time_s))
            .min_by(f64::total_cmp)
    }

    /// Time of the last measurement of any station, or pose of the ground truth (s).
    pub fn end_s(&self) -> Option<f64> {
        let truth = self.ground_truth.iter().filter_map(|truth| truth.poses.last());
        self.tracks
            .iter()
            .filter_map(|track| track.measurements.last())
            .map(|m| m.time_s)
            .chain(truth.map(|pose| pose.time_s))
            .max_by(f64::total_cmp)
    }
}
