//! A calibration by one method.

use std::borrow::Cow;

use nalgebra::DMatrix;

use super::details::Details;
use super::inter_prism::InterPrismDetails;
use super::joint::{JointEstimate, SurveyPoses, Trace};
use super::joint_failure::JointFailure;
use super::method_answer::MethodAnswer;
use super::{Clock, Estimate, Method, TransformSigma, Verdict, Witness};
use crate::deployment::{Deployment, Finding, TrackFrame};
use crate::geometry::RigidTransform;
use crate::network::PerStation;
use crate::pipeline::Triplets;

/// A calibration by one method, with its uncertainty, verdict and checks.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// The requested method; see [`Self::answered_by`].
    pub method: Method,
    /// Transforms from the stations' frames to station 1's (identity for station 1); level unless a rigid alignment was requested.
    pub station1_from_station: PerStation<RigidTransform>,
    /// Standard deviations of the transforms, zeros for station 1; `None` when a direction is not determined.
    pub sigma: Option<PerStation<TransformSigma>>,
    /// Covariance of (x, y, z, yaw) of station 2, then of station 3, … (m, rad).
    pub covariance: Option<DMatrix<f64>>,
    pub verdict: Verdict,
    /// Reasons of the verdict, and notes.
    pub findings: Vec<Finding>,
    /// Independent data that agrees with it.
    pub checked_by: Vec<Witness>,
    /// Details of its method.
    pub details: Details,
    /// Beside a joint estimate, the paper's answer to the same data, checked like any other. `None` if the paper's method has
    /// no answer, which a finding reports.
    pub published: Option<Box<Calibration>>,
    /// Wall time of the prior and of the rest (ms).
    pub prior_ms: f64,
    pub solve_ms: f64,
}

impl<D: Into<Details>> From<MethodAnswer<D>> for Calibration {
    fn from(answer: MethodAnswer<D>) -> Self {
        Self {
            method: answer.method,
            sigma: answer.sigma(),
            station1_from_station: answer.station1_from_station,
            covariance: answer.covariance,
            verdict: answer.judgement.verdict,
            findings: answer.judgement.findings,
            checked_by: answer.checked_by,
            details: answer.details.into(),
            published: None,
            prior_ms: answer.prior_ms,
            solve_ms: 0.0,
        }
    }
}

impl Calibration {
    /// Returns the method of the answer: the published one if the joint estimate failed.
    pub fn answered_by(&self) -> Method {
        match &self.details {
            Details::Joint(details) if details.estimate.is_err() => {
                match details.published.inter_prism() {
                    Some(_) => Method::InterPrism,
                    None => Method::DynamicGcp,
                }
            }
            _ => self.method,
        }
    }

    /// Returns the reason why the published method answers; `None` unless the joint estimate failed.
    pub fn joint_failure(&self) -> Option<&JointFailure> {
        match &self.details {
            Details::Joint(details) => details.estimate.as_ref().err(),
            _ => None,
        }
    }

    /// Returns the trace of the joint estimate, if it failed as well; `None` for other methods.
    pub fn trace(&self) -> Option<&Trace> {
        let joint = self.joint().map(|joint| &joint.trace);
        joint.or_else(|| self.joint_failure().map(|failure| &failure.trace))
    }

    /// Returns the method of the answer for sentences: "the joint estimate", or "method D (the joint estimate did not converge)".
    pub fn method_in_words(&self) -> String {
        let method = self.answered_by();
        self.joint_failure().map_or_else(
            || method.in_words(),
            |failure| format!("{method} ({})", failure.in_words()),
        )
    }

    /// Returns true if independent data that would expose a bias agrees with the answer.
    pub fn is_independently_checked(&self) -> bool {
        self.checked_by.iter().any(|witness| witness.is_independent())
    }

    /// Returns the transforms of the tracks to station 1's frame; `None` if the answer is about the stations' own frames and the
    /// tracks are in another.
    pub fn placing_tracks(&self, deployment: &Deployment) -> Option<&PerStation<RigidTransform>> {
        let placed = deployment.track_frame == TrackFrame::Own || self.method.is_from_tracks();
        placed.then_some(&self.station1_from_station)
    }

    /// Returns the transforms of the control points, which are in the stations' own frames; `None` if the answer is about the frame
    /// of the tracks.
    pub fn placing_control_points(
        &self,
        deployment: &Deployment,
    ) -> Option<PerStation<RigidTransform>> {
        let placed = deployment.track_frame == TrackFrame::Own || !self.method.is_from_tracks();
        placed.then(|| self.survey_transforms())
    }

    /// Returns the transforms at the time of the survey, which differ from those of the drive if the joint estimate uses the control
    /// points.
    pub fn survey_transforms(&self) -> PerStation<RigidTransform> {
        self.survey().map_or_else(|| self.station1_from_station.clone(), SurveyPoses::transforms)
    }

    /// Returns the standard deviations of [`Self::survey_transforms`]; `None` when a direction is not determined.
    pub fn survey_sigma(&self) -> Option<PerStation<TransformSigma>> {
        self.survey().map(SurveyPoses::sigma).or_else(|| self.sigma.clone())
    }

    /// Returns the poses at the survey, if the answer uses the control points of a joint estimate.
    pub fn survey(&self) -> Option<&SurveyPoses> {
        self.joint()?.survey.as_ref()
    }

    /// Returns "good", "good, not independently checked", "weak" …
    pub fn verdict_in_words(&self) -> String {
        self.verdict.in_words(self.is_independently_checked())
    }

    /// Returns the root mean square of the point errors of methods A, B and C, and of the tracks of one prism (m).
    pub fn fit_rms_m(&self) -> Option<f64> {
        self.details.fit_rms_m()
    }

    /// Returns the triplets corrected by the joint estimate's clocks and instrument errors; `None` for other methods.
    pub fn corrected(&self, triplets: &Triplets) -> Option<Triplets> {
        Some(self.joint()?.corrected(Cow::Borrowed(triplets)))
    }

    /// Returns the correlation matrix of [`Calibration::covariance`].
    pub fn correlation(&self) -> Option<DMatrix<f64>> {
        let covariance = self.covariance.as_ref()?;
        let sigma = covariance.diagonal().map(|variance| variance.max(f64::MIN_POSITIVE).sqrt());
        let entry = |i: usize, j: usize| covariance[(i, j)] / (sigma[i] * sigma[j]);
        Some(DMatrix::from_fn(covariance.nrows(), covariance.ncols(), entry))
    }

    /// Returns the clocks relative to station 1; `None` if they are not estimated.
    pub fn clocks(&self) -> Option<PerStation<Clock>> {
        Some(self.joint()?.clocks())
    }

    /// Returns offset (s) and drift (s/s) of the clocks relative to station 1; `None` if they are not estimated.
    pub fn clock_estimates(&self) -> Option<PerStation<(Estimate, Estimate)>> {
        let joint = self.joint()?;
        Some(joint.clock_offsets_s.zip(&joint.clock_drifts(), |offset, drift| (*offset, *drift)))
    }

    /// Returns the joint estimate; `None` for other methods, and if it failed.
    pub fn joint(&self) -> Option<&JointEstimate> {
        match &self.details {
            Details::Joint(details) => details.estimate.as_ref().ok(),
            _ => None,
        }
    }

    /// Returns the details of method D, and of a joint estimate that starts from it.
    pub fn inter_prism(&self) -> Option<&InterPrismDetails> {
        self.details.inter_prism()
    }
}
