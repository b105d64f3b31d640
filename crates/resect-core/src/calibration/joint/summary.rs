//! The joint estimate of a last step: values, covariance, and the variance budget of the covariance.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{SMatrix, SVector, Vector3};

use super::chain::Columns;
use super::joint_estimate::{DriveClocks, JointEstimate};
use super::pass::{Model, Pass, Weigh};
use super::prisms::Solution;
use super::strain::Strain;
use super::unknowns::{
    CLOCKS, COLLIMATIONS, CONSTANTS, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES,
    SLOW, SLOW_CLOCKS, SLOW_RANGES,
};
use crate::calibration::Estimate;
use crate::geometry::LevelTransform;

/// Groups of constants in the variance budget.
const BUDGET_GROUPS: [(&str, Range<usize>); 8] = [
    ("clocks", CLOCKS..LATENCIES),
    ("latencies", LATENCIES..DISTANCES),
    ("inter-prism distances", DISTANCES..LEANS),
    ("leans", LEANS..OFFSETS),
    ("range offsets", OFFSETS..SCALES),
    ("range scales", SCALES..INDICES),
    ("vertical indices", INDICES..COLLIMATIONS),
    ("collimations", COLLIMATIONS..CONSTANTS),
];

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    /// Summarises a solution; its steps and its convergence are set by the caller.
    pub fn summary(&self, solution: Solution) -> JointEstimate {
        let Solution { at, by: Weigh { levels, .. }, model, sizes, prisms, .. } = &solution;
        let rig = *prisms == 3;
        let parts = at.slow.len();
        // Mean positions of the stations over the drive.
        let answer = Mean { constants: 0, slow: 0, parts: (0..parts).collect() };
        let by = self.factor.solve(answer.columns::<8>(parts));
        let covariance = answer.of(&by);
        let states = Columns::<1> { slow: at.slow.clone(), constants: at.constants };
        let mean: SVector<f64, 8> = answer.of(&states);
        let level = |slot: usize| {
            let at = mean.fixed_rows::<4>(4 * slot);
            LevelTransform::new(Vector3::new(at[0], at[1], at[2]), at[3])
        };
        // Random walk of a station: variance of its mean position about its position at set-up.
        let stray = model.priors.settling / 3.0;
        let constants = self.factor.of_constants();
        let estimate = |place: usize| Estimate {
            value: at.constants[place],
            sigma: constants[(place, place)].max(0.0).sqrt(),
        };
        let drives = self.drive_clocks(&solution, &states);
        JointEstimate {
            station1_from_station: [LevelTransform::IDENTITY, level(0), level(1)],
            covariance: covariance + stray,
            budget: self.variance_budget(&by, model, &stray),
            clock_offsets_s: drives[0].late_s,
            drives,
            clock_drifts: [0, 1].map(|slot| estimate(DRIFTS + slot)),
            latencies_s: [0, 1, 2].map(|station| estimate(LATENCIES + station)),
            distances_m: rig.then(|| [0, 1, 2].map(|pair| estimate(DISTANCES + pair))),
            leans_rad: [0, 1, 2]
                .map(|station| [0, 1].map(|axis| estimate(LEANS + 2 * station + axis))),
            range_offsets_m: [0, 1, 2].map(|station| estimate(OFFSETS + station)),
            range_scales: [0, 1, 2].map(|station| estimate(SCALES + station)),
            indices_rad: [0, 1, 2].map(|station| estimate(INDICES + station)),
            collimations_rad: [0, 1, 2].map(|station| estimate(COLLIMATIONS + station)),
            contradictions: self.contradictions(model, at),
            strain: Strain::new(&(at.constants - model.start), &model.precision, &constants),
            levels: *levels,
            wander: model.priors.wander,
            sizes: *sizes,
            stepped: Vec::new(),
            converged: false,
            steps: 0,
            solution: Arc::new(solution),
        }
    }

    /// Returns the share of each source in the variances of the answer; `by` is the solution for its columns.
    fn variance_budget(
        &self,
        by: &Columns<8>,
        model: &Model,
        stray: &SMatrix<f64, 8, 8>,
    ) -> Vec<(&'static str, SVector<f64, 8>)> {
        let mut budget = vec![("noise", self.linear.data.squares(by).diagonal())];
        for (name, places) in BUDGET_GROUPS {
            let share = |k: usize| {
                places.clone().map(|p| by.constants[(p, k)].powi(2) * model.precision[p]).sum()
            };
            budget.push((name, SVector::from_fn(|k, _| share(k))));
        }
        let mut by_slow = [SVector::<f64, 8>::zeros(); 3];
        for (part, state) in by.slow.iter().enumerate() {
            let pull = self.slow_priors.pull(&by.slow, part);
            for row in 0..SLOW {
                let which = match row {
                    SLOW_RANGES.. => 2,
                    SLOW_CLOCKS.. => 1,
                    _ => 0,
                };
                for k in 0..8 {
                    by_slow[which][k] += state[(row, k)] * pull[(row, k)];
                }
            }
        }
        budget.push(("settling", by_slow[0] + stray.diagonal()));
        budget.push(("wandering clocks", by_slow[1]));
        budget.push(("wandering ranges", by_slow[2]));
        budget
    }

    /// Returns the mean clock offsets of stations 2 and 3 in each drive.
    fn drive_clocks(&self, solution: &Solution, states: &Columns<1>) -> Vec<DriveClocks> {
        let drive = &solution.drive;
        let parts = states.slow.len();
        let clocks = |span_s: &[f64; 2]| {
            let inside = |time_s: f64| (span_s[0]..=span_s[1]).contains(&time_s);
            let own = (0..parts).filter(|part| inside(drive.part_times_s[*part])).collect();
            let late = Mean { constants: CLOCKS, slow: SLOW_CLOCKS, parts: own };
            let value: SVector<f64, 2> = late.of(states);
            let by = self.factor.solve(late.columns::<2>(parts));
            let variance = late.of::<2, 2>(&by).diagonal();
            let late_s = [0, 1]
                .map(|slot| Estimate { value: value[slot], sigma: variance[slot].max(0.0).sqrt() });
            DriveClocks { span_s: *span_s, late_s }
        };
        drive.spans_s.iter().map(clocks).collect()
    }
}

/// Constants from one place on, plus the mean of the slow states from another place on over some parts.
struct Mean {
    constants: usize,
    slow: usize,
    parts: Vec<usize>,
}

impl Mean {
    /// Returns the means of some columns.
    fn of<const N: usize, const K: usize>(&self, columns: &Columns<K>) -> SMatrix<f64, N, K> {
        let of_part = |part: &usize| columns.slow[*part].fixed_rows::<N>(self.slow).into_owned();
        let sum: SMatrix<f64, N, K> = self.parts.iter().map(of_part).sum();
        columns.constants.fixed_rows::<N>(self.constants) + sum / self.parts.len() as f64
    }

    /// Returns the Jacobian of the means, as columns.
    fn columns<const N: usize>(&self, parts: usize) -> Columns<N> {
        let mut columns = Columns::zeros(parts);
        for k in 0..N {
            columns.constants[(self.constants + k, k)] = 1.0;
            for part in &self.parts {
                columns.slow[*part][(self.slow + k, k)] = 1.0 / self.parts.len() as f64;
            }
        }
        columns
    }
}
