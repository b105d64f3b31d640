//! The published answer without gross outliers, from which the joint estimate starts: no robust loss makes them harmless.

use std::ops::Range;

use super::published::{self, Published};
use super::used::Used;
use super::{CentredTriplets, FEWEST_TRIPLETS, PrismNetwork, followed_another, gross_errors};
use crate::calibration::{CalibrationSettings, PriorMethod};
use crate::deployment::{Deployment, Rig};
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Most rounds of rejecting triplets that do not fit the answer; the second one is usually the last.
const MOST_SCREENINGS: usize = 4;
/// Parts of a drive, one of which may be wrong as a whole: a station followed another prism for minutes.
const PARTS: usize = 5;
/// Median of the triplets' worst errors from which no triplet fits least squares (m): bends and stops cause less. Simulated: a fifth of a drive
/// with another prism of the rig causes 60 mm and more.
const POOR_M: f64 = 0.02;
/// Ratio of this median to that without a part from which the answer without the part is better.
const BETTER: f64 = 2.0;

/// Input of the screening.
pub struct Screening<'a> {
    pub deployment: &'a Deployment,
    pub rig: &'a Rig,
    pub network: &'a PrismNetwork,
    pub triplets: &'a Triplets,
    pub settings: &'a CalibrationSettings,
    pub progress: &'a Progress,
}

/// The published answer on the triplets that fit it.
pub struct Screened<'a> {
    pub published: Published,
    pub data: CentredTriplets,
    pub used: Used<'a>,
}

impl<'a> Screening<'a> {
    /// Screens the triplets, beginning with the published answer on all of them.
    pub fn screened(&self, published: Published) -> Result<Screened<'a>, Cancelled> {
        let Self { triplets, network, .. } = *self;
        let mut published = self.without_a_part(&published)?.unwrap_or(published);
        let mut used = Used::all(triplets);
        let mut data = used.centred(network);
        for _ in 0..MOST_SCREENINGS {
            let answer = &published.choice.answer.station1_from_station;
            let kept = gross_errors::fitting_triplets(&triplets.points_m, answer, network);
            if kept.len() == used.len() || kept.len() < FEWEST_TRIPLETS {
                break;
            }
            used = Used::some(triplets, kept);
            drop(data);
            data = used.centred(network);
            published = self.solve(&used, &data);
            self.progress.check()?;
        }
        Ok(Screened { published, data, used })
    }

    fn solve(&self, used: &Used<'_>, data: &CentredTriplets) -> Published {
        let points = self.deployment.comparable_control_points();
        let heights_m = self.network.height_differences_m(self.rig);
        let search = (self.settings.prior == PriorMethod::Search).then_some(used);
        published::solve(heights_m.as_ref(), points, data, search)
    }

    /// Returns the answer without the part of the drive that makes the median of the errors least (Rousseeuw 1984); `None` if all triplets
    /// fit, no answer is much better, or no other prism explains the part: a station that was knocked is a step of the joint estimate.
    fn without_a_part(&self, published: &Published) -> Result<Option<Published>, Cancelled> {
        let (triplets, count) = (self.triplets, self.triplets.len());
        let median_m = |published: &Published| {
            let answer = &published.choice.answer.station1_from_station;
            gross_errors::median_worst_m(&triplets.points_m, answer, self.network)
        };
        let with_all_m = median_m(published);
        if with_all_m < POOR_M || count < PARTS * FEWEST_TRIPLETS {
            return Ok(None);
        }
        let mut best: (f64, Option<(Published, Range<usize>)>) = (with_all_m / BETTER, None);
        for part in 0..PARTS {
            let left_out = part * count / PARTS..(part + 1) * count / PARTS;
            let kept = (0..count).filter(|index| !left_out.contains(index)).collect();
            let without = self.solve_on(kept);
            let without_m = median_m(&without);
            if without_m < best.0 {
                best = (without_m, Some((without, left_out)));
            }
            self.progress.check()?;
        }
        let Some((without, triplets_left_out)) = best.1 else { return Ok(None) };
        // What is wrong seldom begins and ends with a part.
        let answer = &without.choice.answer.station1_from_station;
        let kept = gross_errors::fitting_triplets(&triplets.points_m, answer, self.network);
        let fitting = if kept.len() < FEWEST_TRIPLETS { without } else { self.solve_on(kept) };
        Ok(self.is_other_prism(&fitting, triplets_left_out).then_some(fitting))
    }

    fn solve_on(&self, kept: Vec<usize>) -> Published {
        let used = Used::some(self.triplets, kept);
        self.solve(&used, &used.centred(self.network))
    }

    /// Returns true if a station followed another prism during these triplets.
    fn is_other_prism(&self, published: &Published, triplets: Range<usize>) -> bool {
        let answer = &published.choice.answer.station1_from_station;
        let placed = answer.map(|level| RigidTransform::from(*level));
        let span_s = [triplets.start, triplets.end - 1].map(|index| self.triplets.time_s[index]);
        followed_another::prism_changes(self.triplets, &placed, self.network, self.rig, span_s)
            .is_some()
    }
}
