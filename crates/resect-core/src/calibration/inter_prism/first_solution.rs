//! The published solution on all triplets of a drive, which method D and the joint estimate share.

use super::published::{self, Published};
use super::unjudged::required_rig;
use super::used::Used;
use super::{CentredTriplets, PrismNetwork};
use crate::calibration::{CalibrationError, CalibrationSettings, Offer, PriorMethod};
use crate::deployment::{Deployment, Rig};
use crate::pipeline::Triplets;
use crate::progress::Progress;

/// Solution of the published method on all triplets of a drive, from which method D and the joint estimate begin.
pub struct FirstSolution<'a> {
    pub rig: &'a Rig,
    pub network: PrismNetwork,
    pub data: CentredTriplets,
    pub published: Published,
}

impl<'a> FirstSolution<'a> {
    /// Solves all triplets.
    ///
    /// # Errors
    /// If the deployment lacks data that the method needs, or if `progress` is cancelled.
    pub fn new(
        deployment: &'a Deployment,
        triplets: &Triplets,
        settings: &CalibrationSettings,
        offer: &Offer,
        progress: &Progress,
    ) -> Result<Self, CalibrationError> {
        let (rig, network) = required_rig(deployment, triplets, offer)?;
        let used = Used::all(triplets);
        let data = used.centred(&network);
        let search = (settings.prior == PriorMethod::Search).then_some(&used);
        let heights_m = network.height_differences_m(rig);
        let points = deployment.comparable_control_points();
        let published = published::solve(heights_m.as_ref(), points, &data, search);
        progress.check()?;
        Ok(Self { rig, network, data, published })
    }

    /// Returns the solution without the data, which is recomputed faster than kept.
    pub fn without_data(&self) -> StartingPoint<'a> {
        let Self { rig, network, published, .. } = self;
        StartingPoint { rig, network: network.clone(), published: published.clone() }
    }
}

/// The solution of the published method from which a joint estimate starts.
pub struct StartingPoint<'a> {
    pub rig: &'a Rig,
    pub network: PrismNetwork,
    pub published: Published,
}
