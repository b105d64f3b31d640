//! An answer from inter-prism distances, of method D or of the joint estimate, before its verdict.

use super::diagnosis::{self, DiagnosisInput};
use super::observability::{self, Observability};
use super::published::Published;
use super::uncertainty::{self, Uncertainty};
use super::used::Used;
use super::{
    CentredTriplets, FEWEST_TRIPLETS, InterPrismDetails, PriorSearch, PrismNetwork, gross_errors,
};
use crate::calibration::joint::SurveyPoses;
use crate::calibration::judgement::Judgement;
use crate::calibration::method::why_no_triplets;
use crate::calibration::{CalibrationError, CalibrationSettings, Method, Offer};
use crate::deployment::{Deployment, Rig};
use crate::geometry::RigidTransform;
use crate::network::{PerStation, Prism};
use crate::pipeline::Triplets;

/// Returns the rig and the network of its prisms, if the deployment has all data that the method needs.
pub fn required_rig<'a>(
    deployment: &'a Deployment,
    triplets: &Triplets,
    offer: &Offer,
) -> Result<(&'a Rig, PrismNetwork), CalibrationError> {
    let name = || deployment.name.clone();
    if triplets.is_empty() {
        let why = why_no_triplets(deployment);
        return Err(CalibrationError::NoTriplets { deployment: name(), why });
    }
    if Prism::is_one(&offer.followed) {
        return Err(CalibrationError::lacking(deployment, Method::InterPrism, offer));
    }
    if triplets.len() < FEWEST_TRIPLETS {
        let (found, needed) = (triplets.len(), FEWEST_TRIPLETS);
        return Err(CalibrationError::TooFewTriplets { deployment: name(), found, needed });
    }
    let no_rig = || CalibrationError::NoRig { deployment: name() };
    let rig = deployment.rig.as_ref().ok_or_else(no_rig)?;
    // The joint estimate has triplets of its own.
    if [Method::InterPrism, Method::Joint].iter().all(|method| offer.lack(*method).is_some()) {
        return Err(CalibrationError::lacking(deployment, Method::InterPrism, offer));
    }
    Ok((rig, PrismNetwork::new(offer.followed.clone(), &rig.inter_prism_m)))
}

/// An answer without its verdict.
pub struct UnjudgedAnswer {
    pub published: Published,
    pub prior_search: Option<PriorSearch>,
    /// The triplets whose distances fit.
    pub fitting: CentredTriplets,
    pub uncertainty: Uncertainty,
    pub station1_from_station: PerStation<RigidTransform>,
}

impl UnjudgedAnswer {
    /// Returns the answer of the published method on these triplets, with its uncertainty.
    pub fn published(
        mut published: Published,
        data: &CentredTriplets,
        used: &Used<'_>,
        settings: &CalibrationSettings,
    ) -> Self {
        let (time_s, interval) = used.instants();
        let fitting = gross_errors::inliers(&published.thinned, &published.answer.parameters);
        let answer = &published.answer;
        let uncertainty =
            uncertainty::estimate(data, &fitting, &time_s, &interval, answer, settings);
        let level = &published.choice.answer.station1_from_station;
        let station1_from_station = level.map(|level| RigidTransform::from(*level));
        Self {
            prior_search: published.prior_search.take(),
            published,
            fitting,
            uncertainty,
            station1_from_station,
        }
    }

    pub fn observability(&self) -> Observability {
        observability::observe(&self.fitting, &self.published.answer.parameters, &self.uncertainty)
    }

    /// Judges the answer by its own data. Moves the findings of the solution to the judgement.
    ///
    /// `survey` are the poses when the control points were measured, if the answer has them.
    pub fn judge(
        &mut self,
        deployment: &Deployment,
        observability: &Observability,
        survey: Option<&SurveyPoses>,
    ) -> Judgement {
        let mut findings = std::mem::take(&mut self.published.findings);
        let evidence = DiagnosisInput {
            deployment,
            thinned: &self.published.thinned,
            answer: &self.published.answer,
            rival: self.published.rival.clone(),
            uncertainty: &self.uncertainty,
            observability,
            choice: &self.published.choice,
            station1_from_station: &self.station1_from_station,
            sigma: self.uncertainty.sigma(),
            survey,
        };
        let verdict = diagnosis::judge(&evidence, &mut findings);
        Judgement { verdict, findings }
    }

    pub fn into_details(self, observability: Observability) -> InterPrismDetails {
        let noise_sigma = self.uncertainty.sigma();
        let Published { choice, basins, .. } = self.published;
        InterPrismDetails {
            noise_sigma,
            basin: choice.answer,
            mirror: choice.mirror,
            observability,
            basins,
            prior_search: self.prior_search,
        }
    }
}
