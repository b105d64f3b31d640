//! What an estimate is told as: the answer, its covariance and what that is made of.

use std::sync::Arc;

use nalgebra::{SVector, Vector3};

use super::chain::Columns;
use super::pass::{Pass, Weigh};
use super::prisms::Solution;
use super::strain::Strain;
use super::unknowns::{
    CLOCKS, COLLIMATIONS, CONSTANTS, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS, OFFSETS, SCALES,
    SLOW, SLOW_CLOCKS, SLOW_RANGES,
};
use super::{DriveClocks, JointEstimate};
use crate::calibration::Estimate;
use crate::geometry::LevelTransform;

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    pub fn summary(&self, solution: Solution) -> JointEstimate {
        let Solution { drive, at, by: Weigh { levels, .. }, model, sizes, prisms } = &solution;
        let rig = *prisms == 3;
        let parts = at.slow.len();
        // The answer: where the stations stood on average over the parts.
        let mut wanted = Columns::<8>::zeros(parts);
        for k in 0..8 {
            wanted.constants[(k, k)] = 1.0;
            wanted.slow.iter_mut().for_each(|slow| slow[(k, k)] = 1.0 / parts as f64);
        }
        let by = self.factor.solve(&wanted);
        let covariance = wanted.dot(&by);
        let states = Columns::<1> { slow: at.slow.clone(), constants: at.constants };
        let mean = wanted.dot(&states);
        let level = |slot: usize| {
            let at = mean.fixed_rows::<4>(4 * slot);
            LevelTransform::new(Vector3::new(at[0], at[1], at[2]), at[3])
        };
        // A station that walks randomly is this far from its mean where it was set up.
        let stray = model.priors.settling / 3.0;
        let mut budget = vec![("noise", by.dot(&self.data.times(&by)).diagonal())];
        let groups = [
            ("clocks", CLOCKS..LATENCIES),
            ("latencies", LATENCIES..DISTANCES),
            ("inter-prism distances", DISTANCES..LEANS),
            ("leans", LEANS..OFFSETS),
            ("range offsets", OFFSETS..SCALES),
            ("range scales", SCALES..INDICES),
            ("vertical indices", INDICES..COLLIMATIONS),
            ("collimations", COLLIMATIONS..CONSTANTS),
        ];
        for (name, places) in groups {
            let share = |k: usize| {
                places.clone().map(|p| by.constants[(p, k)].powi(2) * model.precision[p]).sum()
            };
            budget.push((name, SVector::from_fn(|k, _| share(k))));
        }
        let slow = self.slow_priors.times(&by.slow);
        let mut by_slow = [SVector::<f64, 8>::zeros(); 3];
        for (state, pull) in by.slow.iter().zip(&slow) {
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
        let constants = self.factor.of_constants();
        let estimate = |place: usize| Estimate {
            value: at.constants[place],
            sigma: constants[(place, place)].max(0.0).sqrt(),
        };
        let drives: Vec<DriveClocks> = drive
            .spans_s
            .iter()
            .map(|span_s| {
                let inside = |time_s: f64| (span_s[0]..=span_s[1]).contains(&time_s);
                let own: Vec<usize> =
                    (0..parts).filter(|part| inside(drive.part_times_s[*part])).collect();
                let mut wanted = Columns::<2>::zeros(parts);
                for slot in 0..2 {
                    wanted.constants[(CLOCKS + slot, slot)] = 1.0;
                    for part in &own {
                        wanted.slow[*part][(SLOW_CLOCKS + slot, slot)] = 1.0 / own.len() as f64;
                    }
                }
                let value = wanted.dot(&states);
                let variance = wanted.dot(&self.factor.solve(&wanted)).diagonal();
                let late_s = [0, 1].map(|slot| Estimate {
                    value: value[slot],
                    sigma: variance[slot].max(0.0).sqrt(),
                });
                DriveClocks { span_s: *span_s, late_s }
            })
            .collect();
        JointEstimate {
            station1_from_station: [LevelTransform::IDENTITY, level(0), level(1)],
            covariance: covariance + stray,
            budget,
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
}
