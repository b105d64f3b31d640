//! The joint estimate at the minimum that the evidence chooses.
//!
//! Heights of the rig and control points choose between a minimum and its mirror twin. Without them all readings choose, by the
//! likelihoods of the joint estimates that start from either.

use super::PrismNetwork;
use super::basin::heights_apart_m;
use super::joint_answer::{self, JointAnswer};
use super::used::Used;
use crate::calibration::joint::{self, DriveReadings, JointEstimate, JointInput};
use crate::calibration::joint_failure::JointFailure;
use crate::calibration::{Basin, ResolvedBy};
use crate::deployment::Deployment;
use crate::geometry::LevelTransform;
use crate::network::PerStation;
use crate::progress::{Cancelled, Progress};

/// A joint estimate with its evaluation by method D.
pub type Evaluated = (JointEstimate, JointAnswer);

/// Input of the search for the right minimum.
pub struct MinimumSearch<'a> {
    pub input: &'a JointInput<'a>,
    pub deployment: &'a Deployment,
    pub network: &'a PrismNetwork,
    /// Heights of station 1's prism above that of each station by a reading of the rig (m).
    pub heights_m: Option<&'a PerStation<f64>>,
    pub readings: &'a DriveReadings,
    pub used: &'a Used<'a>,
    pub progress: &'a Progress,
}

impl MinimumSearch<'_> {
    /// Returns the joint estimate with its evaluation.
    ///
    /// If the heights or control points choose another minimum after the readings are corrected, the iteration starts again there, and its
    /// result stands if it stays.
    pub fn estimate(&self) -> Result<Result<Evaluated, JointFailure>, Cancelled> {
        let first = match self.estimate_from(self.input.published)? {
            Ok(first) => first,
            Err(failure) => return Ok(Err(failure)),
        };
        let (estimate, evaluated) = &first;
        if let Some(twin) = evaluated.undecided_twin().cloned()
            && let Some(forth) =
                joint::excess_of(estimate, &twin.station1_from_station, self.progress)?
        {
            return Ok(Ok(self.by_likelihood(first, twin, forth)?));
        }
        let Some(other) = &evaluated.fits_better else { return Ok(Ok(first)) };
        let again = self.estimate_from(&other.station1_from_station)?.ok();
        let stays = again.filter(|(_, evaluated)| evaluated.fits_better.is_none());
        Ok(Ok(stays.unwrap_or(first)))
    }

    fn estimate_from(
        &self,
        published: &PerStation<LevelTransform>,
    ) -> Result<Result<Evaluated, JointFailure>, Cancelled> {
        let input = JointInput { published, ..self.input.clone() };
        let estimate = joint::estimate(self.readings, &input, self.progress)?;
        self.progress.check()?;
        Ok(estimate.map_err(JointFailure::from).map(|estimate| {
            let known = (self.network, self.heights_m);
            let points = self.deployment.comparable_control_points();
            let is_determined = self.input.is_determined_by_drive;
            let evaluated = joint_answer::solve(&estimate, known, points, self.used, is_determined);
            (estimate, evaluated)
        }))
    }

    /// Returns the estimate that all readings prefer: the first one, or that from its mirror twin.
    ///
    /// Each has learned noise levels and slow errors of its own, so the comparisons by both must agree. `forth` is that by the first one
    /// ([`joint::excess_of`]).
    fn by_likelihood(
        &self,
        first: Evaluated,
        twin: Basin,
        forth: f64,
    ) -> Result<Evaluated, Cancelled> {
        let (start, twin_start) = (&first.0.station1_from_station, &twin.station1_from_station);
        let decisive = joint::decisive_excess(&first.0);
        if forth.abs() <= decisive {
            // The cost of the triplets counts as well, if the likelihoods do not contradict it.
            let by_cost = forth > 0.0 && is_decided_by_cost(&first);
            return Ok(if by_cost { first } else { decided(first, twin, None) });
        }
        let second = if forth.is_finite() { self.estimate_from(twin_start)?.ok() } else { None };
        let is_other = |(second, _): &Evaluated| {
            let second = &second.station1_from_station;
            heights_apart_m(second, twin_start) < heights_apart_m(second, start)
        };
        // A twin that has no estimate of its own cannot contradict.
        let Some(second) = second.filter(is_other) else {
            return Ok(decided(first, twin, Some(forth).filter(|forth| *forth > 0.0)));
        };
        let back = joint::excess_of(&second.0, start, self.progress)?.unwrap_or(0.0);
        let (for_first, for_second) = (forth.min(-back), back.min(-forth));
        if for_second > decisive {
            let twin = first.1.solution.choice.answer.clone();
            return Ok(decided(second, twin, Some(for_second)));
        }
        if for_first <= decisive && for_first > 0.0 && is_decided_by_cost(&first) {
            return Ok(first);
        }
        Ok(decided(first, twin, Some(for_first).filter(|excess| *excess > decisive)))
    }
}

/// Decides between an estimate and its mirror twin ([`JointAnswer::decide`]).
fn decided((estimate, mut evaluated): Evaluated, twin: Basin, excess: Option<f64>) -> Evaluated {
    evaluated.decide(twin, excess);
    (estimate, evaluated)
}

fn is_decided_by_cost((_, evaluated): &Evaluated) -> bool {
    let witness = evaluated.solution.choice.mirror.resolved_by;
    evaluated.fits_better.is_none() && witness == ResolvedBy::Cost
}
