//! An earlier calibration, to be validated by another run.

use nalgebra::DMatrix;

use resect_core::analysis::Answer;
use resect_core::calibration::{Method, Verdict};
use resect_core::deployment::{Deployment, Finding, Severity, TrackFrame};
use resect_core::geometry::RigidTransform;
use resect_core::network::{PerPair, PerStation};

/// An earlier calibration, to be validated.
#[derive(Clone, Debug, PartialEq)]
pub struct Earlier {
    /// Name of a file or of a deployment.
    pub name: String,
    pub method: Method,
    pub verdict: Verdict,
    /// The first finding that limits it.
    pub doubt: Option<String>,
    /// Frames of its tracks; `None` if unknown.
    pub track_frame: Option<TrackFrame>,
    pub station1_from_station: PerStation<RigidTransform>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3, … (m, rad); `None` if a direction was unobservable.
    pub covariance: Option<DMatrix<f64>>,
    /// Inter-prism distances as measured for this calibration (m).
    pub inter_prism_m: Option<PerPair<f64>>,
}

impl Earlier {
    /// Returns the calibration of an open deployment.
    pub fn of(deployment: &Deployment, answer: &Answer) -> Self {
        let calibration = &answer.calibration;
        Self {
            name: deployment.name.clone(),
            method: calibration.answered_by(),
            verdict: calibration.verdict,
            doubt: first_doubt(&calibration.findings),
            track_frame: Some(deployment.track_frame),
            station1_from_station: calibration.station1_from_station.clone(),
            covariance: calibration.covariance.clone(),
            inter_prism_m: deployment.rig.as_ref().map(|rig| rig.inter_prism_m.clone()),
        }
    }

    /// Returns the frames of its transforms. Control points are always in the stations' own frames.
    pub fn frame(&self) -> Option<TrackFrame> {
        if self.method.is_from_tracks() { self.track_frame } else { Some(TrackFrame::Own) }
    }
}

/// Returns the first finding that limits a calibration.
pub fn first_doubt(findings: &[Finding]) -> Option<String> {
    let first = findings.iter().find(|finding| finding.severity > Severity::Note);
    first.map(ToString::to_string)
}
