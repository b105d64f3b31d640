//! The paper's search of a prior: two steps with increasing speed limits.
//!
//! Step 1 starts from the point-to-point alignment and solves with the triplets slower than τ_v = 1 cm/s. It then raises τ_v by 10
//! cm/s over the speed range, with each solution as the prior of the next. Step 2 repeats this from the best solution of step 1,
//! with the same prior for every τ_v. The inter-prism metric selects the best among the optima that at least three other runs agree
//! with (Vaidis et al. 2022, section "Dynamic methods", "Search of prior").

use super::levenberg_marquardt::ROUGH_M;
use super::{CentredTriplets, FEWEST_TRIPLETS, PrismNetwork, minimise, same_solution};
use crate::geometry::{LevelTransform, align_level};
use crate::network::{PerStation, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// First speed limit of the search. Source: Vaidis et al. 2022.
const FIRST_LIMIT_M_PER_S: f64 = 0.01;
/// Increase of the speed limit from one run to the next. Source: Vaidis et al. 2022.
const LIMIT_STEP_M_PER_S: f64 = 0.10;
/// Number of other runs that must converge to the same optimum. Source: Vaidis et al. 2022.
const AGREEING_RUNS: usize = 3;
/// Highest speed limit, so that an outlier does not prolong the search; no vehicle here drives faster.
const HIGHEST_LIMIT_M_PER_S: f64 = 10.0;

/// Solution for one speed limit.
#[derive(Clone, Debug)]
pub struct SearchRun {
    pub tau_v_m_per_s: f64,
    /// Triplets slower than τ_v.
    pub triplets: usize,
    pub station1_from_station: PerStation<LevelTransform>,
    /// Root mean square distance error of those triplets (m): the square root of the minimised cost.
    pub rms_m: f64,
    /// Median of |distance error| over all triplets (m).
    pub metric_m: f64,
    /// Number of other runs of the same step with the same solution.
    pub agreeing: usize,
}

impl SearchRun {
    /// Returns true if enough other runs converged to the same optimum.
    pub fn counts(&self) -> bool {
        self.agreeing >= AGREEING_RUNS
    }
}

/// Runs and result of the search.
#[derive(Clone, Debug)]
pub struct PriorSearch {
    pub steps: [Vec<SearchRun>; 2],
    /// The best run of each step; `None` if no run had enough triplets.
    pub best: [Option<usize>; 2],
    pub chosen: PerStation<LevelTransform>,
    /// True if the best runs of both steps have three agreeing runs.
    pub agreed: bool,
}

/// Runs both steps over all triplets.
pub fn search(triplets: &Triplets, network: &PrismNetwork) -> PriorSearch {
    let mut by_speed: Vec<usize> = (0..triplets.len()).collect();
    by_speed.sort_by(|a, b| triplets.speed_m_per_s[*a].total_cmp(&triplets.speed_m_per_s[*b]));
    let data = CentredTriplets::new(triplets, network).select(&by_speed);
    let first_guess = aligned(triplets);

    let slower_than = |limit: f64| by_speed.partition_point(|i| triplets.speed_m_per_s[*i] < limit);
    let step = |prior: &PerStation<LevelTransform>, chained: bool| {
        let mut runs: Vec<SearchRun> = Vec::new();
        let mut prior = prior.clone();
        let mut limit = FIRST_LIMIT_M_PER_S;
        loop {
            let count = slower_than(limit);
            if count >= FEWEST_TRIPLETS {
                let subset = data.first(count);
                let minimum = minimise(&subset, data.parameters(&prior), ROUGH_M);
                let found = data.transforms(&minimum.parameters);
                let metric_m = metric_m(triplets, network, &found);
                runs.push(SearchRun {
                    tau_v_m_per_s: limit,
                    triplets: count,
                    station1_from_station: found.clone(),
                    rms_m: subset.mean_square_m2(minimum.normal.cost).sqrt(),
                    metric_m,
                    agreeing: 0,
                });
                if chained {
                    prior = found;
                }
            }
            if count == triplets.len() || limit > HIGHEST_LIMIT_M_PER_S {
                break;
            }
            limit += LIMIT_STEP_M_PER_S;
        }
        for index in 0..runs.len() {
            let this = &runs[index].station1_from_station;
            let same =
                runs.iter().filter(|r| same_solution(&r.station1_from_station, this)).count();
            runs[index].agreeing = same - 1;
        }
        runs
    };

    let first = step(&first_guess, true);
    let first_best = best_run(&first);
    let best = first_best.map_or(first_guess, |(run, _)| first[run].station1_from_station.clone());
    let second = step(&best, false);
    let second_best = best_run(&second);
    let chosen = second_best.map_or(best, |(run, _)| second[run].station1_from_station.clone());
    PriorSearch {
        steps: [first, second],
        best: [first_best, second_best].map(|best| best.map(|(run, _)| run)),
        chosen,
        agreed: [first_best, second_best].iter().all(|best| best.is_some_and(|(_, agreed)| agreed)),
    }
}

/// Returns the best run with enough agreeing runs and `true`; without one, the best of all and `false`.
fn best_run(runs: &[SearchRun]) -> Option<(usize, bool)> {
    let best = |counts: &dyn Fn(&SearchRun) -> bool| {
        (0..runs.len())
            .filter(|i| counts(&runs[*i]))
            .min_by(|a, b| runs[*a].metric_m.total_cmp(&runs[*b].metric_m))
    };
    best(&SearchRun::counts)
        .map(|run| (run, true))
        .or_else(|| best(&|_| true).map(|run| (run, false)))
}

/// Returns the point-to-point alignment of each station's track to station 1's.
fn aligned(triplets: &Triplets) -> PerStation<LevelTransform> {
    let reference = &triplets.points_m[Station::FIRST];
    triplets.points_m.map_each(|station, points| {
        let aligned = (station != Station::FIRST).then(|| align_level(reference, points)).flatten();
        aligned.unwrap_or(LevelTransform::IDENTITY)
    })
}

/// Returns the median of |distance error| over all triplets (m).
fn metric_m(
    triplets: &Triplets,
    network: &PrismNetwork,
    station1_from_station: &PerStation<LevelTransform>,
) -> f64 {
    let errors_m = (0..triplets.len()).flat_map(|index| {
        let placed_m: Vec<_> = triplets
            .points_m
            .iter()
            .zip(station1_from_station)
            .map(|(points, transform)| transform.apply(&points[index]))
            .collect();
        network.errors_m(&placed_m).map(f64::abs).collect::<Vec<_>>()
    });
    median(errors_m).unwrap_or(f64::INFINITY)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(x: f64, metric_m: f64, agreeing: usize) -> SearchRun {
        let moved = LevelTransform::new(nalgebra::Vector3::new(x, 0.0, 0.0), 0.0);
        SearchRun {
            tau_v_m_per_s: 0.1,
            triplets: 10,
            station1_from_station: [LevelTransform::IDENTITY, moved, moved].into(),
            rms_m: metric_m,
            metric_m,
            agreeing,
        }
    }

    #[test]
    fn a_lonely_optimum_does_not_count_however_good() {
        let runs = [run(0.0, 0.001, 0), run(1.0, 0.002, 3), run(1.0, 0.003, 3)];
        let (best, agreed) = best_run(&runs).expect("three runs");
        assert_eq!((best, agreed), (1, true));
        let (best, agreed) = best_run(&runs[..1]).expect("one run");
        assert_eq!((best, agreed), (0, false));
    }
}
