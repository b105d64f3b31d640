//! The two solutions of the published method alone, for whoever only asks what some triplets would show.

use super::levenberg_marquardt::ROUGH_M;
use super::minima::{self, THINNED};
use super::{
    CentredTriplets, Parameters, SquaredCost, basin, closed_form_priors, minimise, mirror,
};
use crate::calibration::Basin;
use crate::deployment::{ControlPointSet, Rig};
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::statistics::median;

/// This many triplets show whether anything near a prior fits at all.
const FIRST_LOOK: usize = 60;

/// The lowest minimum and its mirror twin, judged by nothing yet.
pub struct Twins {
    lowest: Basin,
    twin: Option<Basin>,
}

impl Twins {
    /// `None` where the nearest minima fit worse than `hopeless_m` (median size of the errors): the search for all of them takes
    /// ten times as long, and triplets that were read right are near one to begin with.
    pub fn of(rig: &Rig, triplets: &Triplets, hopeless_m: f64) -> Option<Self> {
        let data = CentredTriplets::new(triplets, rig.inter_prism_m);
        let thinned = data.thinned(THINNED);
        let squared = SquaredCost::of(&thinned);
        let priors = closed_form_priors(&squared);
        let some = data.thinned(FIRST_LOOK);
        let fit_m = |prior: &Parameters| {
            let nearest = minimise(&some, *prior, ROUGH_M).parameters;
            let errors_m = some.distance_errors_m(&nearest);
            median(errors_m.into_iter().map(f64::abs)).unwrap_or(f64::INFINITY)
        };
        if hopeless_m.is_finite() && priors.iter().map(fit_m).all(|fit_m| fit_m > hopeless_m) {
            return None;
        }
        let found = minima::find(&data, &thinned, &squared, &priors);
        let twin = found.twin.as_ref().map(|twin| basin(&data, twin));
        Some(Self { lowest: basin(&data, &found.lowest), twin })
    }

    /// Frames of the stations into station 1's by the one of the two that rig, control points or cost decide for.
    pub fn chosen(&self, rig: &Rig, control_points: &[ControlPointSet]) -> [RigidTransform; 3] {
        let choice = mirror::choose(rig, control_points, self.lowest, self.twin);
        choice.answer.station1_from_station.map(RigidTransform::from)
    }
}
