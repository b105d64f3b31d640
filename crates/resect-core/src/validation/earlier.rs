//! An earlier calibration, whose validity for another run is in question.

use nalgebra::SMatrix;

use crate::analysis::Answer;
use crate::calibration::{Method, Verdict};
use crate::deployment::{Deployment, Finding, Severity, TrackFrame};
use crate::geometry::RigidTransform;

/// An earlier calibration: what is asked whether it holds.
#[derive(Clone, Debug, PartialEq)]
pub struct Earlier {
    /// A file, or a deployment.
    pub name: String,
    pub method: Method,
    pub verdict: Verdict,
    /// What limits it first.
    pub doubt: Option<String>,
    /// The frames that its tracks were in; `None` where that is not known.
    pub track_frame: Option<TrackFrame>,
    pub station1_from_station: [RigidTransform; 3],
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3 (m, rad); `None` where a direction was free.
    pub covariance: Option<SMatrix<f64, 8, 8>>,
    /// The rig's distances as they were measured for it (m).
    pub inter_prism_m: Option<[f64; 3]>,
}

impl Earlier {
    /// The answer to a deployment that is open.
    pub fn of(deployment: &Deployment, answer: &Answer) -> Self {
        let calibration = &answer.calibration;
        Self {
            name: deployment.name.clone(),
            method: calibration.method,
            verdict: calibration.verdict,
            doubt: first_doubt(&calibration.findings),
            track_frame: Some(deployment.track_frame),
            station1_from_station: calibration.station1_from_station,
            covariance: calibration.covariance,
            inter_prism_m: deployment.rig.as_ref().map(|rig| rig.inter_prism_m),
        }
    }

    /// The frames that its transforms are about: control points are always seen in the stations' own.
    pub fn frame(&self) -> Option<TrackFrame> {
        if self.method.is_from_tracks() { self.track_frame } else { Some(TrackFrame::Own) }
    }
}

/// The first that limits an answer.
pub fn first_doubt(findings: &[Finding]) -> Option<String> {
    let first = findings.iter().find(|finding| finding.severity > Severity::Note);
    first.map(ToString::to_string)
}
