//! The data model: one field session of three robotic total stations, as it was measured.
//!
//! Readers (`resect-io`) make a [`Deployment`]; pipeline, calibration, window and commands take one and never look at a file again.

mod column_mapping;
mod control_points;
mod drives;
mod finding;
mod finding_advice;
mod finding_kind;
pub mod findings;
mod gnss;
mod ingredient;
mod message;
pub mod names;
mod overrides;
mod overrides_beyond;
pub mod printable;
mod quantity;
mod remedy;
mod rig;
pub mod station_clocks;
mod told_angle;
mod track;

pub use column_mapping::{ColumnMapping, TableAngle, TableLength, TimeFormat, VerticalAngle};
pub use control_points::{ControlPoint, ControlPointSet};
pub use drives::OtherSetUp;
pub use finding::{Finding, FindingIdentity, Severity, Subject, doubts};
pub use finding_advice::{ADVICE, Advice};
pub use finding_kind::FindingKind;
pub use gnss::GnssFix;
pub use ingredient::Ingredient;
pub use message::Message;
pub use overrides::{AzimuthSense, MaskedReading, OneOrMany, Overrides, PrismConstants};
pub use overrides_beyond::AS_NUMBERED;
pub use quantity::{FindingQuantity, Unit};
pub use remedy::Remedy;
pub use rig::{Rig, pairwise_distances};
pub use told_angle::{ToldAngle, ToldIn};
pub use track::{Measurement, RawRecord, TimeCorrection, Track};

use serde::{Deserialize, Serialize};

/// Names of the pairs of prisms in the order of every `[f64; 3]` of distances: α, β, γ.
pub const PAIRS: [(usize, usize); 3] = [(0, 1), (0, 2), (1, 2)];

/// Label of a pair for people: "1–2".
pub fn pair_label(pair: usize) -> String {
    let (a, b) = PAIRS[pair];
    format!("{}–{}", a + 1, b + 1)
}

/// The frames that a deployment's tracks are in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TrackFrame {
    /// Each in its station's own, as measured; answers map those of stations 2 and 3 to that of station 1.
    #[default]
    Own,
    /// All in one, into which somebody turned them before they were written, in a way that is not known. Answers from
    /// the tracks (methods C and D) map what is left; answers from control points (A and B) are about the stations' own
    /// frames, and the two cannot be compared.
    Common,
}

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
