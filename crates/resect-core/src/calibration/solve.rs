//! Calibration by the method of the settings, together with the published answer, with all checks.

use crate::deployment::findings::answers::{published_answer_missing, tracks_not_transformed};

use super::inter_prism::{FirstSolution, StartingPoint};
use super::joint::JointEstimate;
use super::joint_data::JointData;
use super::{
    Calibration, CalibrationError, CalibrationSettings, Method, Offer, Verdict, Witness, checks,
    control_points_alone, disagreements, dynamic_gcp, inter_prism, sense, static_gcp, two_point,
};
use crate::deployment::{Deployment, Finding, TrackFrame, advice};
use crate::network::Prism;
use crate::pipeline::Triplets;
use crate::progress::Progress;
use crate::stopwatch::Stopwatch;

/// Calibrates a deployment by the method of the settings; by the joint estimate if they name none.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<Calibration, CalibrationError> {
    solve_while(deployment, triplets, settings, offer, &Progress::default())
}

/// Calibrates like [`solve`] until `progress` is cancelled, which returns [`CalibrationError::Cancelled`].
pub fn solve_while(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
    progress: &Progress,
) -> Result<Calibration, CalibrationError> {
    let problem = Problem { deployment, triplets, offer, progress };
    match settings.method.unwrap_or_default() {
        Method::Joint => problem.solve_jointly_beside_published(settings),
        method => {
            let answer = problem.solve_by(method, settings)?;
            problem.check(answer, settings, &mut sense::Tried::default())
        }
    }
}

/// From this number of triplets on, the paper's method runs before the joint estimate. It takes a hundredth of the time, and both
/// in parallel would need twice the memory.
const LONG: usize = 100_000;

/// A deployment to calibrate, with its triplets.
#[derive(Clone, Copy)]
struct Problem<'a> {
    deployment: &'a Deployment,
    triplets: &'a Triplets,
    offer: &'a Offer,
    progress: &'a Progress,
}

impl<'a> Problem<'a> {
    /// Calibrates by the joint estimate and by the paper's method, so that the two answers can be compared.
    fn solve_jointly_beside_published(
        self,
        settings: &CalibrationSettings,
    ) -> Result<Calibration, CalibrationError> {
        let started = Stopwatch::start();
        let Self { deployment, triplets, progress, .. } = self;
        let all = JointData::new(triplets);
        let of_all = Self { triplets: all.triplets, ..self };
        let is_same_data = std::ptr::eq(all.triplets, triplets);
        let published_method = self.offer.published_method();
        let [by_published, by_joint] =
            [published_method, Method::Joint].map(|method| settings.with_method(method));
        // Method D and the joint estimate begin with the same solution if they have the same triplets.
        let is_shared =
            published_method == Method::InterPrism && settings.evidence.drive && is_same_data;
        let first = is_shared.then(|| self.first_solution(settings)).transpose();
        let first = first.map_err(|error| self.explained(error))?;
        let start = first.as_ref().map(FirstSolution::without_data);
        let publish = || {
            self.timed(&started, || match first {
                Some(first) => {
                    inter_prism::solve(first, deployment, triplets, &by_published, progress)
                        .map(Into::into)
                }
                None => self.answer_by(published_method, &by_published),
            })
        };
        let estimate = || self.timed(&started, || of_all.estimate_jointly(&by_joint, &all, start));
        let (published, joint) = if triplets.len() < LONG {
            rayon::join(publish, estimate)
        } else {
            (publish(), estimate())
        };
        self.progress.check()?;
        // Both checks try the same misreadings of the same triplets.
        let mut tried = sense::Tried::default();
        let published = published.and_then(|answer| self.check(answer, &by_published, &mut tried));
        self.progress.check()?;
        let joint = joint.and_then(|answer| {
            // In place of a joint estimate that failed, the published method answers from its own triplets.
            if is_same_data || answer.joint().is_none() {
                return self.check(answer, &by_joint, &mut tried);
            }
            of_all.check(answer, &by_joint, &mut sense::Tried::default())
        });
        let mut joint = match (joint, &published) {
            (Err(why), Ok(_)) if why != CalibrationError::Cancelled => {
                let (why, published) = (Box::new(why), published_method);
                return Err(CalibrationError::NoJointEstimate { why, published });
            }
            (joint, _) => joint?,
        };
        match published {
            // One station: the paper has no answer to compare with.
            Ok(_) if self.offer.lack(published_method).is_some() => {}
            Ok(published) => joint.published = Some(Box::new(published)),
            Err(why) => {
                let method = published_method.to_string();
                joint.findings.push(published_answer_missing(&method, &why.finding()));
            }
        }
        joint.solve_ms = started.elapsed_ms() - joint.prior_ms;
        Ok(joint)
    }

    /// Returns the solution of the published method on all triplets.
    fn first_solution(
        self,
        settings: &CalibrationSettings,
    ) -> Result<FirstSolution<'a>, CalibrationError> {
        let Self { deployment, triplets, offer, progress } = self;
        FirstSolution::new(deployment, triplets, settings, offer, progress)
    }

    /// Returns an answer with its wall time.
    fn timed(
        self,
        started: &Stopwatch,
        solve: impl FnOnce() -> Result<Calibration, CalibrationError>,
    ) -> Result<Calibration, CalibrationError> {
        let mut answer = solve().map_err(|error| self.explained(error))?;
        answer.solve_ms = started.elapsed_ms() - answer.prior_ms;
        Ok(answer)
    }

    /// Adds the misreading that explains why there are no triplets.
    fn explained(self, error: CalibrationError) -> CalibrationError {
        match (error, &self.deployment.rig) {
            (CalibrationError::NoTriplets { deployment: name, mut why }, Some(rig)) => {
                if let Some(misread) = sense::explain_no_triplets(self.deployment, rig) {
                    why = format!("{why}; {misread}");
                }
                CalibrationError::NoTriplets { deployment: name, why }
            }
            (error, _) => error,
        }
    }

    /// Calibrates by one method, without checks.
    fn solve_by(
        self,
        method: Method,
        settings: &CalibrationSettings,
    ) -> Result<Calibration, CalibrationError> {
        // The joint estimate of one station starts from method C, which has no answer of its own there.
        if method == Method::DynamicGcp && self.offer.lack(method).is_some() {
            return Err(CalibrationError::lacking(self.deployment, method, self.offer));
        }
        self.timed(&Stopwatch::start(), || self.answer_by(method, settings))
    }

    fn answer_by(
        self,
        method: Method,
        settings: &CalibrationSettings,
    ) -> Result<Calibration, CalibrationError> {
        let Self { deployment, triplets, offer, progress } = self;
        match method {
            Method::TwoPoint => {
                two_point::solve(deployment, triplets, &settings.errors, offer).map(Into::into)
            }
            Method::StaticGcp => {
                static_gcp::solve(deployment, triplets, settings, offer).map(Into::into)
            }
            Method::DynamicGcp => {
                dynamic_gcp::solve(deployment, triplets, settings, offer).map(Into::into)
            }
            Method::InterPrism => {
                let first = self.first_solution(settings)?;
                inter_prism::solve(first, deployment, triplets, settings, progress).map(Into::into)
            }
            Method::Joint => {
                let all = JointData::new(triplets);
                Self { triplets: all.triplets, ..self }.estimate_jointly(settings, &all, None)
            }
        }
    }

    /// Calibrates by the joint estimate of one prism or of several, which starts from the published method.
    fn estimate_jointly(
        self,
        settings: &CalibrationSettings,
        all: &JointData<'_>,
        start: Option<StartingPoint<'_>>,
    ) -> Result<Calibration, CalibrationError> {
        let Self { deployment, triplets, offer, progress } = self;
        if !settings.evidence.drive {
            return control_points_alone::solve(deployment, triplets, settings, offer)
                .map(Into::into);
        }
        if !Prism::is_one(&offer.followed) {
            let start = match start {
                Some(start) => start,
                None => self.first_solution(settings)?.without_data(),
            };
            let answer =
                inter_prism::solve_jointly(start, deployment, all, settings, offer, progress)?;
            return Ok(answer.into());
        }
        if offer.lack(Method::Joint).is_some() {
            return Err(CalibrationError::lacking(deployment, Method::Joint, offer));
        }
        let answer = dynamic_gcp::solve_jointly(deployment, all, settings, offer, progress)?;
        Ok(answer.into())
    }

    /// Checks an answer against all data that it does not use, and lowers its verdict where data contradicts it.
    fn check(
        self,
        mut calibration: Calibration,
        settings: &CalibrationSettings,
        tried: &mut sense::Tried,
    ) -> Result<Calibration, CalibrationError> {
        let Self { deployment, triplets, offer, progress } = self;
        if calibration.inter_prism().is_some() {
            self.check_against_control_points(&mut calibration, settings);
        }
        let survey = calibration.joint().and_then(JointEstimate::control_points);
        let notes = survey.map(|survey| survey.significant_face_errors(&settings.errors));
        let contradictions =
            survey.map(|survey| survey.contradictions(deployment.comparable_control_points()));
        for (verdict, contradiction) in contradictions.into_iter().flatten() {
            calibration.verdict = calibration.verdict.max(verdict);
            calibration.findings.push(contradiction);
        }
        calibration.findings.extend(notes.into_iter().flatten());
        sense::check(&mut calibration, deployment, triplets, offer, tried, progress)?;
        // Beside control points the joint estimate takes the distances of the rig as readings with errors, which it tests.
        let is_rig_tested = calibration.survey().is_some();
        let counts = |finding: &&Finding| {
            finding.kind.is_doubt() && !(is_rig_tested && finding.kind.advice == Some(advice::RIG))
        };
        for doubt in deployment.findings.iter().filter(counts) {
            calibration.verdict = calibration.verdict.max(Verdict::Weak);
            calibration.findings.push(doubt.clone());
        }
        if calibration.placing_tracks(deployment).is_none() {
            calibration.findings.push(tracks_not_transformed());
        }
        Ok(calibration)
    }

    /// Checks an answer from inter-prism distances against method B on the control points, if there are any.
    fn check_against_control_points(
        self,
        calibration: &mut Calibration,
        settings: &CalibrationSettings,
    ) {
        let Self { deployment, offer, .. } = self;
        if offer.lack(Method::StaticGcp).is_some() || deployment.track_frame == TrackFrame::Common {
            return;
        }
        let by_points = static_gcp::solve(deployment, &Triplets::default(), settings, offer);
        let Ok(by_points) = by_points.map(Calibration::from) else { return };
        // Empty for a joint estimate that uses the control points.
        let disagreements = disagreements(&by_points, calibration, deployment);
        let is_unchanged = calibration.survey().is_none_or(|survey| survey.change.is_none());
        let agrees = calibration.survey_sigma().is_some_and(|sigma| {
            let transforms = calibration.survey_transforms();
            checks::control_points_contradict(deployment, &transforms, &sigma).is_none()
        });
        // Control points that do not determine an answer of their own agree with any answer.
        let is_determined = by_points.verdict == Verdict::Good;
        if is_determined && is_unchanged && agrees && disagreements.is_empty() {
            calibration.checked_by.push(Witness::ControlPoints);
        }
        for disagreement in disagreements {
            calibration.verdict = calibration.verdict.max(Verdict::Weak);
            calibration.findings.push(disagreement.finding());
        }
    }
}
