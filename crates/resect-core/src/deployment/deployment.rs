//! The measurements of one field session.

use super::control_points::ControlPointSet;
use super::finding::Finding;
use super::gnss::GnssFix;
use super::ingredient::Ingredient;
use super::overrides::Overrides;
use super::rig::Rig;
use super::track::{TimeCorrection, Track};
use super::track_frame::TrackFrame;

/// One field session: three stations' measurements, control points and the prism rig.
#[derive(Clone, Debug, PartialEq)]
pub struct Deployment {
    pub name: String,
    /// What stations 1, 2 and 3 measured; a missing station has an empty track.
    pub tracks: [Track; 3],
    /// The frames that the tracks are in.
    pub track_frame: TrackFrame,
    /// Static points, one set per file.
    pub control_points: Vec<ControlPointSet>,
    /// The prisms on the vehicle, where a file describes them.
    pub rig: Option<Rig>,
    /// How many prisms the stations follow, where a file says so: 1 or 3.
    pub prisms: Option<u8>,
    /// Positions of GNSS antennas 1, 2, 3 on the vehicle.
    pub gnss: Option<[Vec<GnssFix>; 3]>,
    /// What the clocks of stations 1, 2 and 3 were corrected by during the recording, where it says so.
    pub time_corrections: [Vec<TimeCorrection>; 3],
    /// What it was read with: `deployment.toml`, and what the user put right since.
    pub overrides: Overrides,
    /// What its files say of that by themselves: the folder's `deployment.toml`, and the rig's distances.
    pub as_read: Overrides,
    /// What was read and what was passed over, file by file.
    pub ingredients: Vec<Ingredient>,
    /// What the readers noticed.
    pub findings: Vec<Finding>,
    /// Start of each further drive of the same set-up (s); none of a single drive.
    pub restarts_s: Vec<f64>,
}

impl Deployment {
    /// The control points that an answer from the tracks can be held against, and that from them against the tracks:
    /// none where the tracks are in another frame.
    pub fn comparable_control_points(&self) -> &[ControlPointSet] {
        match self.track_frame {
            TrackFrame::Own => &self.control_points,
            TrackFrame::Common => &[],
        }
    }

    /// Time of the first measurement of any station (s, in the stations' common clock).
    pub fn start_s(&self) -> Option<f64> {
        self.tracks
            .iter()
            .filter_map(|track| track.measurements.first())
            .map(|m| m.time_s)
            .min_by(f64::total_cmp)
    }

    /// Time of the last measurement of any station (s).
    pub fn end_s(&self) -> Option<f64> {
        self.tracks
            .iter()
            .filter_map(|track| track.measurements.last())
            .map(|m| m.time_s)
            .max_by(f64::total_cmp)
    }
}
