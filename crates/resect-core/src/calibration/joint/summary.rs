//! The joint estimate of a last step: values, covariance, and variance budget.

use std::ops::Range;
use std::sync::Arc;

use nalgebra::{SMatrix, SVector, Vector3};

use super::chain::ChainVectors;
use super::facets::facet_covariance;
use super::gauss_newton_step::GaussNewtonStep;
use super::joint_estimate::{DriveClocks, JointEstimate, SurveyPoses};
use super::linearisation::Weighting;
use super::prior_conflict::PriorConflict;
use super::priors::Priors;
use super::prism_motion::Solution;
use super::reliability::{
    GroupReliability, PosteriorMoments, control_point_reliability, drive_reliability,
    rig_reliability,
};
use super::state_vector::{
    CLOCKS, COLLIMATIONS, CONSTANTS, Constants, ConstantsMatrix, DISTANCES, DRIFTS, INDICES,
    LATENCIES, LEANS, OFFSETS, SCALES, SLOW, SLOW_ACROSS, SLOW_CLOCKS, SLOW_RANGES,
};
use super::trace::Trace;
use crate::calibration::{ErrorSizes, Estimate};
use crate::geometry::LevelTransform;
use crate::network::PerStation;

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

impl<const LOCAL: usize, const ROW: usize> GaussNewtonStep<LOCAL, ROW> {
    /// Summarises a solution; the caller sets steps, iterations and the rows of the trace.
    pub fn summary(&self, solution: Solution) -> JointEstimate {
        let Solution { state, weighting: Weighting { levels, .. }, priors, sizes, prisms, .. } =
            &solution;
        let is_rig = *prisms == 3;
        let blocks = state.slow.len();
        // Mean poses of the stations over the drive.
        let poses = DriveMean { constants: 0, slow: 0, blocks: (0..blocks).collect() };
        let pose_sensitivity = self.factor.solve(poses.jacobian::<8>(blocks));
        let covariance = poses.of(&pose_sensitivity);
        let states = ChainVectors::<1> { slow: state.slow.clone(), constants: state.constants };
        let mean: SVector<f64, 8> = poses.of(&states);
        // Variance of a random walk's mean about its start is a third of that of its end.
        let settling = priors.slow.settling / 3.0;
        // One prism has no heading.
        let facets = if is_rig && sizes.ranges_wander {
            let information = self.normal.matrix.multiply_slow(&pose_sensitivity);
            facet_covariance(&solution.drive, state, &information)
        } else {
            SMatrix::zeros()
        };
        let mut budget = self.variance_budget(&pose_sensitivity, priors, &settling);
        budget.push(("facets of prisms", facets.diagonal()));
        let constants = self.factor.constants_covariance();
        let estimate = |index: usize| Estimate {
            value: state.constants[index],
            sigma: constants[(index, index)].max(0.0).sqrt(),
        };
        let drives = self.drive_clocks(&solution, &states);
        JointEstimate {
            station1_from_station: level_transforms(&mean),
            covariance: covariance + settling + facets, // (25)
            budget,
            reliability: group_reliability(&solution, &constants, &pose_sensitivity.constants),
            clock_offsets_s: drives[0].offsets_s,
            drives,
            clock_drifts: [0, 1].map(|slot| estimate(DRIFTS + slot)),
            latencies_s: [0, 1, 2].map(|station| estimate(LATENCIES + station)),
            distances_m: is_rig.then(|| [0, 1, 2].map(|pair| estimate(DISTANCES + pair))),
            leans_rad: [0, 1, 2]
                .map(|station| [0, 1].map(|axis| estimate(LEANS + 2 * station + axis))),
            range_offsets_m: [0, 1, 2].map(|station| estimate(OFFSETS + station)),
            range_scales: [0, 1, 2].map(|station| estimate(SCALES + station)),
            indices_rad: [0, 1, 2].map(|station| estimate(INDICES + station)),
            collimations_rad: [0, 1, 2].map(|station| estimate(COLLIMATIONS + station)),
            stated_size_conflicts: self.stated_size_conflicts(priors, state),
            prior_conflict: PriorConflict::new(
                &(state.constants - priors.mean),
                &priors.covariance(),
                &constants,
            ),
            levels: *levels,
            slow_ranges: priors.slow.ranges,
            slow_across: priors.slow.across,
            slow_upward: priors.slow.upward,
            sizes: *sizes,
            survey: survey_poses(priors, &state.constants, &constants, sizes),
            steps: Vec::new(),
            iterations: 0,
            trace: Trace::default(),
            solution: Arc::new(solution),
        }
    }

    /// Contribution of each source to the variances of the poses; `sensitivity` is the solution for their Jacobian.
    fn variance_budget(
        &self,
        sensitivity: &ChainVectors<8>,
        priors: &Priors,
        settling: &SMatrix<f64, 8, 8>,
    ) -> Vec<(&'static str, SVector<f64, 8>)> {
        let noise = self.normal.matrix.quadratic_form(sensitivity).diagonal();
        let mut budget = vec![("noise", noise)];
        let information = priors.own_information();
        for (name, indices) in BUDGET_GROUPS {
            let own = sensitivity.constants.rows_range(indices.clone());
            let own_information = information.view_range(indices.clone(), indices);
            budget.push((
                name,
                (own.transpose() * (own_information * own))
                    .diagonal()
                    .fixed_rows::<8>(0)
                    .into_owned(),
            ));
        }
        if let Some(survey) = &priors.survey {
            let own = &sensitivity.constants;
            budget.push((
                "control points",
                (own.transpose() * (survey.information * own)).diagonal(),
            ));
        }
        let mut slow_variances = [SVector::<f64, 8>::zeros(); 4];
        for (block, slow) in sensitivity.slow.iter().enumerate() {
            let product = self.slow_precisions.multiply(&sensitivity.slow, block);
            for row in 0..SLOW {
                let source = match row {
                    SLOW_ACROSS.. => 3,
                    SLOW_RANGES.. => 2,
                    SLOW_CLOCKS.. => 1,
                    _ => 0,
                };
                for k in 0..8 {
                    slow_variances[source][k] += slow[(row, k)] * product[(row, k)];
                }
            }
        }
        budget.push(("settling", slow_variances[0] + settling.diagonal()));
        budget.push(("wandering clocks", slow_variances[1]));
        budget.push(("slow range errors", slow_variances[2]));
        budget.push(("slow errors across the sights", slow_variances[3]));
        budget
    }

    /// Mean clock offsets of stations 2 and 3 in each drive.
    fn drive_clocks(&self, solution: &Solution, states: &ChainVectors<1>) -> Vec<DriveClocks> {
        let drive = &solution.drive;
        let blocks = states.slow.len();
        let clocks = |span_s: &[f64; 2]| {
            let is_inside = |time_s: f64| (span_s[0]..=span_s[1]).contains(&time_s);
            let own = (0..blocks).filter(|block| is_inside(drive.block_times_s[*block])).collect();
            let mean = DriveMean { constants: CLOCKS, slow: SLOW_CLOCKS, blocks: own };
            let value: SVector<f64, 2> = mean.of(states);
            let sensitivity = self.factor.solve(mean.jacobian::<2>(blocks));
            let variance = mean.of::<2, 2>(&sensitivity).diagonal();
            let offsets_s = [0, 1]
                .map(|slot| Estimate { value: value[slot], sigma: variance[slot].max(0.0).sqrt() });
            DriveClocks { span_s: *span_s, offsets_s }
        };
        drive.spans_s.iter().map(clocks).collect()
    }
}

/// Reliability of all readings that are evidence; `with_poses` is the covariance of the constants with the poses.
fn group_reliability(
    solution: &Solution,
    covariance: &ConstantsMatrix,
    with_poses: &SMatrix<f64, CONSTANTS, 8>,
) -> Vec<GroupReliability> {
    let Solution { state, weighting, priors, prisms, .. } = solution;
    let information = priors.own_information();
    let change = state.constants - priors.mean;
    let posterior = PosteriorMoments { information, change, covariance, with_poses };
    let mut groups = drive_reliability(&posterior, &weighting.squares);
    if let Some(survey) = &priors.survey {
        // A step is opposite to its gradient; the sizes do not depend on the sign.
        let pose_change =
            |gradient: &Constants| with_poses.tr_mul(&survey.without_changes(gradient));
        groups.extend(control_point_reliability(&survey.survey().readings, pose_change));
    }
    if *prisms == 3 && priors.distances_are_evidence {
        groups.extend(rig_reliability(&posterior));
    }
    groups
}

fn level_transforms(poses: &SVector<f64, 8>) -> PerStation<LevelTransform> {
    let level = |slot: usize| {
        let pose = poses.fixed_rows::<4>(4 * slot);
        LevelTransform::new(Vector3::new(pose[0], pose[1], pose[2]), pose[3])
    };
    [LevelTransform::IDENTITY, level(0), level(1)].into()
}

/// Poses at the survey, by the constants and their covariance.
fn survey_poses(
    priors: &Priors,
    constants: &Constants,
    covariance: &ConstantsMatrix,
    sizes: &ErrorSizes,
) -> Option<SurveyPoses> {
    let survey = priors.survey.as_ref()?;
    let change = survey.set_up_change(constants, covariance, sizes);
    let (poses, covariance) = survey.poses(constants, covariance);
    let may_have_changed = survey.may_have_changed;
    let station1_from_station = level_transforms(&poses);
    Some(SurveyPoses { station1_from_station, covariance, change, may_have_changed })
}

/// Consecutive constants plus the mean of consecutive slow states over some blocks.
struct DriveMean {
    /// Index of the first constant, and of the first slow state.
    constants: usize,
    slow: usize,
    blocks: Vec<usize>,
}

impl DriveMean {
    /// The means of some columns.
    fn of<const N: usize, const K: usize>(&self, columns: &ChainVectors<K>) -> SMatrix<f64, N, K> {
        let of_block = |block: &usize| columns.slow[*block].fixed_rows::<N>(self.slow).into_owned();
        let sum: SMatrix<f64, N, K> = self.blocks.iter().map(of_block).sum();
        columns.constants.fixed_rows::<N>(self.constants) + sum / self.blocks.len() as f64
    }

    /// The transposed Jacobian of the means, a column for each.
    fn jacobian<const N: usize>(&self, blocks: usize) -> ChainVectors<N> {
        let mut columns = ChainVectors::zeros(blocks);
        for k in 0..N {
            columns.constants[(self.constants + k, k)] = 1.0;
            for block in &self.blocks {
                columns.slow[*block][(self.slow + k, k)] = 1.0 / self.blocks.len() as f64;
            }
        }
        columns
    }
}
