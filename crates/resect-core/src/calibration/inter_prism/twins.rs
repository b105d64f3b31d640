//! The two solutions of the published method, for hypothetical triplets.

use super::levenberg_marquardt::ROUGH_M;
use super::minima::{self, THINNED};
use super::{
    CentredTriplets, Parameters, PrismNetwork, SquaredCost, basin, closed_form_priors, minimise,
    mirror,
};
use crate::calibration::Basin;
use crate::deployment::{ControlPointSet, Rig};
use crate::geometry::RigidTransform;
use crate::network::PerStation;
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Number of triplets from which the fit near a prior is computed first.
const FIRST_LOOK: usize = 60;

/// The lowest minimum and its mirror twin, before the choice between them.
pub struct Twins {
    network: PrismNetwork,
    lowest: Basin,
    twin: Option<Basin>,
}

impl Twins {
    /// Finds the two solutions; `None` if the minima nearest to the priors fit worse than `hopeless_m` (median absolute error).
    ///
    /// The search for all minima takes ten times as long, and correct triplets have a minimum near a prior.
    pub fn of(network: PrismNetwork, triplets: &Triplets, hopeless_m: f64) -> Option<Self> {
        let data = CentredTriplets::new(triplets, &network);
        let thinned = data.thinned(THINNED);
        let squared = SquaredCost::of(&thinned);
        let priors = closed_form_priors(&squared);
        let some = data.thinned(FIRST_LOOK);
        let fit_m = |prior: &Parameters| {
            let nearest = minimise(&some, prior.clone(), ROUGH_M).parameters;
            let errors_m = some.distance_errors_m(&nearest);
            median(errors_m.into_iter().map(f64::abs)).unwrap_or(f64::INFINITY)
        };
        if hopeless_m.is_finite() && priors.iter().map(fit_m).all(|fit_m| fit_m > hopeless_m) {
            return None;
        }
        let found = minima::find(&data, &thinned, &squared, &priors);
        let twin = found.twin.as_ref().map(|twin| basin(&data, twin));
        Some(Self { network, lowest: basin(&data, &found.lowest), twin })
    }

    /// Returns the transforms of the stations to station 1's frame by the solution that rig, control points or cost select.
    pub fn chosen(
        &self,
        rig: &Rig,
        control_points: &[ControlPointSet],
    ) -> PerStation<RigidTransform> {
        let heights_m = self.network.height_differences_m(rig);
        let choice = mirror::choose(
            heights_m.as_ref(),
            control_points,
            self.lowest.clone(),
            self.twin.clone(),
        );
        choice.answer.station1_from_station.map(|level| RigidTransform::from(*level))
    }
}
