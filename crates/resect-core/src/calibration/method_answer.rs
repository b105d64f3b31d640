//! Answer of one method, before it becomes a [`Calibration`](super::Calibration).

use nalgebra::DMatrix;

use super::joint_failure::{JointFailure, JointResult};
use super::judgement::Judgement;
use super::{Method, TransformSigma, Verdict, Witness};
use crate::deployment::Remedy;
use crate::geometry::RigidTransform;
use crate::network::PerStation;

/// Answer of one method, with details of its own.
pub struct MethodAnswer<D> {
    pub method: Method,
    pub station1_from_station: PerStation<RigidTransform>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3, … (m, rad); `None` where a direction is not determined.
    pub covariance: Option<DMatrix<f64>>,
    pub judgement: Judgement,
    /// Independent data that agrees with the answer.
    pub checked_by: Vec<Witness>,
    pub details: D,
    /// Wall time of the prior (ms).
    pub prior_ms: f64,
}

impl<D> MethodAnswer<D> {
    /// Returns the standard deviations of the transforms; zeros for station 1.
    pub fn sigma(&self) -> Option<PerStation<TransformSigma>> {
        self.covariance.as_ref().map(TransformSigma::of_covariance)
    }

    /// Returns this answer of a published method in place of a joint estimate that failed, at most weak.
    pub fn in_place_of_joint(self, failure: JointFailure) -> MethodAnswer<(JointResult, D)> {
        let mut judgement = self.judgement;
        for finding in &mut judgement.findings {
            finding.remedies.retain(|remedy| *remedy != Remedy::JointEstimate);
        }
        let finding = failure.finding(self.method);
        if failure.is_unconverged() {
            judgement.put_first([(Verdict::Weak, finding)]);
        } else {
            // The directions that the data leaves open come first.
            judgement.doubt([finding]);
        }
        MethodAnswer {
            method: Method::Joint,
            station1_from_station: self.station1_from_station,
            covariance: self.covariance,
            judgement,
            checked_by: self.checked_by,
            details: (Err(failure), self.details),
            prior_ms: self.prior_ms,
        }
    }
}
