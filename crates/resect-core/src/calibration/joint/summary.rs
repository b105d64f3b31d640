//! The joint estimate of a last step: values, covariance, and variance budget.

use std::sync::Arc;

use nalgebra::{DMatrix, DVector};

use super::chain::ChainVector;
use super::facet_covariance::FacetCovariance;
use super::gauss_newton_step::GaussNewtonStep;
use super::height_curvature::{HeightCurvature, height_curvature};
use super::joint_estimate::{DriveClocks, JointEstimate, SurveyPoses};
use super::linearisation::Weighting;
use super::prior_conflict::PriorConflict;
use super::priors::Priors;
use super::prism_motion::Solution;
use super::reliability::{
    GroupReliability, PosteriorMoments, control_point_offsets, control_point_reliability,
    drive_reliability, rig_reliability,
};
use super::state_vector::{Constants, ConstantsMatrix, Layout, by_station, level_transforms};
use super::trace::Trace;
use super::unknown::CLOCK_OFFSET;
use crate::calibration::{ErrorSizes, Estimate};
use crate::progress::{Cancelled, Progress};

impl GaussNewtonStep {
    /// Summarises a solution, whose added covariance is not known yet; the caller sets steps, iterations and the rows of the trace.
    pub fn summary(
        &self,
        mut solution: Solution,
        progress: &Progress,
    ) -> Result<JointEstimate, Cancelled> {
        let (layout, blocks) = (Arc::clone(&solution.drive.layout), solution.state.slow.len());
        let layout = &*layout;
        // Mean poses of the stations over the drive.
        let poses = DriveMean {
            constants: (0..layout.poses()).collect(),
            slow: 0,
            blocks: (0..blocks).collect(),
        };
        let mut pose_sensitivity = self.factor.solve(&poses.jacobian(layout, blocks));
        let linear = self.factor.constants_covariance();
        let amplified = self.amplify(&mut pose_sensitivity, &poses, &solution, progress)?;
        let at = (&solution.state, &solution.priors);
        let facets = FacetCovariance::new(self, at, &amplified.response, progress)?;
        let Amplified { covariance, least_share, .. } = amplified;
        let scaled =
            |factor: &ConstantsMatrix, own: &ConstantsMatrix| factor * own * factor.transpose();
        let constants = scaled(&amplified.constants, &linear)
            + scaled(&amplified.constants_response, &facets.constants);
        solution.added_covariance = Arc::new(constants - &linear);
        let Solution { state, weighting: Weighting { levels, .. }, priors, sizes, .. } = &solution;
        let states = ChainVector { slow: state.slow.clone(), constants: state.constants.clone() };
        // Variance of a random walk's mean about its start is a third of that of its end.
        let settling = &priors.slow.settling / 3.0;
        let information = self.normal.matrix.multiply(&pose_sensitivity);
        let mut budget = self.variance_budget(&pose_sensitivity, &information, priors);
        add_to_source(&mut budget, "settling", &settling.diagonal());
        budget.push(("facets of prisms", facets.poses.diagonal()));
        let constants = solution.constants_covariance(self);
        let estimate = |index: usize| Estimate {
            value: state.constants[index],
            sigma: constants[(index, index)].max(0.0).sqrt(),
        };
        let drives = self.drive_clocks(&solution, &states);
        let with_poses = by_columns(&pose_sensitivity, layout.constants);
        Ok(JointEstimate {
            station1_from_station: level_transforms(&poses.of(&states)),
            covariance: covariance + settling + facets.poses, // (25)
            budget,
            height_share: least_share,
            reliability: group_reliability(&solution, &linear, &with_poses),
            clock_offsets_s: drives[0].offsets_s.clone(),
            drives,
            constants: (0..layout.constants).map(estimate).collect(),
            stated_size_conflicts: self.stated_size_conflicts(priors, state),
            prior_conflict: PriorConflict::new(
                layout,
                &(&state.constants - &priors.mean),
                &priors.covariance(),
                &linear,
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
        })
    }

    /// Replaces the sensitivity of the poses by that with the curvature of the heights for noise, and returns that for a further gradient.
    fn amplify(
        &self,
        sensitivity: &mut [ChainVector],
        poses: &DriveMean,
        solution: &Solution,
        progress: &Progress,
    ) -> Result<Amplified, Cancelled> {
        let Solution { state, priors, .. } = solution;
        let layout = &*priors.layout;
        let covariance = poses.of_all(sensitivity);
        let (size, places) = (layout.constants, layout.heights());
        // The distances alone are curved.
        if layout.prisms() < 2 {
            let constants = ConstantsMatrix::identity(size, size);
            return Ok(Amplified {
                covariance,
                constants_response: constants.clone(),
                constants,
                response: sensitivity.to_vec(),
                least_share: 1.0,
            });
        }
        let directions: Vec<ChainVector> =
            places.iter().map(|place| sensitivity[*place].clone()).collect();
        let heights = |vector: &ChainVector| poses.of(vector).select_rows(&places);
        let with_slow = (priors, &self.slow_precisions);
        let curvature = height_curvature(self, state, with_slow, &directions, &heights, progress)?;
        let HeightCurvature { by_heights, of_response, least_share } = &curvature;
        let amplification = |with_heights: DMatrix<f64>, by_heights: &DMatrix<f64>| {
            let mut by_gradient = DMatrix::identity(with_heights.nrows(), with_heights.nrows());
            for (column, height) in (with_heights * by_heights).column_iter().zip(&places) {
                by_gradient.column_mut(*height).axpy(1.0, &column, 1.0);
            }
            by_gradient
        };
        let with_heights = covariance.select_columns(&places);
        let add_curvature = |sensitivity: &mut [ChainVector], by_gradient: &DMatrix<f64>| {
            let more = by_gradient - DMatrix::identity(by_gradient.nrows(), by_gradient.nrows());
            for (row, own) in more.row_iter().zip(sensitivity) {
                for (place, direction) in places.iter().zip(&directions) {
                    own.add_multiple(direction, row[*place]);
                }
            }
        };
        let mut response = sensitivity.to_vec();
        add_curvature(&mut response, &amplification(with_heights.clone(), of_response));
        let by_gradient = amplification(with_heights, by_heights);
        add_curvature(sensitivity, &by_gradient);
        let of_constants = by_columns(&directions, size);
        Ok(Amplified {
            covariance: &by_gradient * covariance * by_gradient.transpose(),
            constants: amplification(of_constants.clone(), by_heights),
            response,
            constants_response: amplification(of_constants, of_response),
            least_share: *least_share,
        })
    }

    /// Contribution of each source to the variances of the poses; `sensitivity` is the solution for their Jacobian, and `information` its
    /// product with the data's normal matrix.
    fn variance_budget(
        &self,
        sensitivity: &[ChainVector],
        information: &[ChainVector],
        priors: &Priors,
    ) -> Vec<(&'static str, DVector<f64>)> {
        let layout = &*priors.layout;
        let of_each = |variance: &dyn Fn(usize) -> f64| {
            DVector::from_fn(sensitivity.len(), |k, _| variance(k))
        };
        let noise = of_each(&|k| {
            let both = sensitivity[k].slow.iter().zip(&information[k].slow);
            sensitivity[k].constants.dot(&information[k].constants)
                + both.map(|(x, product)| x.dot(product)).sum::<f64>()
        });
        let mut budget = vec![("noise", noise)];
        let own_information = priors.own_information();
        // The first source is the transforms.
        for (name, indices) in layout.sources().skip(1) {
            let own_information = own_information.view_range(indices.clone(), indices.clone());
            let variance = of_each(&|k| {
                let own = sensitivity[k].constants.rows_range(indices.clone());
                own.dot(&(own_information * own))
            });
            budget.push((name, variance));
        }
        if let Some(survey) = &priors.survey {
            let variance = of_each(&|k| {
                let own = &sensitivity[k].constants;
                own.dot(&(&survey.information * own))
            });
            budget.push(("control points", variance));
        }
        let by_slow = self.slow_variances(layout, sensitivity);
        let slow = |first: usize, end: usize| of_each(&|k| by_slow[k].rows_range(first..end).sum());
        let clocks = layout.slow_clocks();
        budget.push(("settling", slow(0, clocks)));
        budget.push(("wandering clocks", slow(clocks, layout.slow_ranges())));
        budget.push(("slow range errors", slow(layout.slow_ranges(), layout.slow_across())));
        budget.push(("slow errors across the sights", slow(layout.slow_across(), layout.slow())));
        budget
    }

    /// Contribution of the prior of each slow state to the variances of the poses.
    fn slow_variances(&self, layout: &Layout, sensitivity: &[ChainVector]) -> Vec<DVector<f64>> {
        let of_pose = |column: &ChainVector| {
            let mut sum = DVector::zeros(layout.slow());
            for (block, slow) in column.slow.iter().enumerate() {
                sum += slow.component_mul(&self.slow_precisions.multiply(&column.slow, block));
            }
            sum
        };
        sensitivity.iter().map(of_pose).collect()
    }

    /// Mean clock offsets in each drive.
    fn drive_clocks(&self, solution: &Solution, states: &ChainVector) -> Vec<DriveClocks> {
        let (drive, layout) = (&solution.drive, solution.layout());
        let blocks = states.slow.len();
        let clocks = |span_s: &[f64; 2]| {
            let is_inside = |time_s: f64| (span_s[0]..=span_s[1]).contains(&time_s);
            let own = (0..blocks).filter(|block| is_inside(drive.block_times_s[*block])).collect();
            let mean = DriveMean {
                constants: layout.indices(&CLOCK_OFFSET).collect(),
                slow: layout.slow_clocks(),
                blocks: own,
            };
            let value = mean.of(states);
            let variance = mean.of_all(&self.factor.solve(&mean.jacobian(layout, blocks)));
            let offset_s = |slot: usize| {
                let index = mean.constants[slot];
                let variance = variance[(slot, slot)] + solution.added_covariance[(index, index)];
                Estimate { value: value[slot], sigma: variance.max(0.0).sqrt() }
            };
            let reference = Estimate { value: 0.0, sigma: 0.0 };
            let offsets_s = by_station(reference, (0..layout.moved()).map(offset_s));
            DriveClocks { span_s: *span_s, offsets_s }
        };
        drive.spans_s.iter().map(clocks).collect()
    }
}

/// Covariance of the poses with the curvature of the heights, and the factor by which the curvature changes the errors of the constants by noise.
struct Amplified {
    covariance: DMatrix<f64>,
    constants: ConstantsMatrix,
    /// Sensitivity of the poses to a gradient that is no noise, and the factor for the constants.
    response: Vec<ChainVector>,
    constants_response: ConstantsMatrix,
    /// Least share of the information on a height that is not noise.
    least_share: f64,
}

/// Adds to the variances by a source.
fn add_to_source(budget: &mut [(&'static str, DVector<f64>)], name: &str, more: &DVector<f64>) {
    for (_, variances) in budget.iter_mut().filter(|(source, _)| *source == name) {
        *variances += more;
    }
}

/// A matrix with the constants of each vector as its columns; one station has no poses and no columns.
fn by_columns(all: &[ChainVector], constants: usize) -> DMatrix<f64> {
    DMatrix::from_fn(constants, all.len(), |row, column| all[column].constants[row])
}

/// Reliability of all readings that are evidence; `with_poses` is the covariance of the constants with the poses.
fn group_reliability(
    solution: &Solution,
    covariance: &ConstantsMatrix,
    with_poses: &DMatrix<f64>,
) -> Vec<GroupReliability> {
    let Solution { state, weighting, priors, .. } = solution;
    let layout = solution.layout();
    let information = priors.own_information();
    let change = &state.constants - &priors.mean;
    let added = &*solution.added_covariance;
    let posterior = PosteriorMoments { layout, information, change, covariance, added, with_poses };
    let mut groups = drive_reliability(&posterior, &weighting.squares);
    if let Some(survey) = &priors.survey {
        // A step is opposite to its gradient; the sizes do not depend on the sign.
        let pose_change =
            |gradient: &Constants| with_poses.tr_mul(&survey.without_changes(gradient));
        let readings = &survey.survey().readings;
        groups.extend(control_point_reliability(readings, layout.stations(), pose_change));
        groups.extend(control_point_offsets(&survey.survey().tests.of_ranges, pose_change));
    }
    if priors.distances_are_evidence {
        groups.extend(rig_reliability(&posterior));
    }
    groups
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

/// Constants plus the mean of as many consecutive slow states over some blocks.
struct DriveMean {
    /// Indices of the constants, and of the first slow state.
    constants: Vec<usize>,
    slow: usize,
    blocks: Vec<usize>,
}

impl DriveMean {
    /// The means of a vector.
    fn of(&self, vector: &ChainVector) -> DVector<f64> {
        let slow = self.slow..self.slow + self.constants.len();
        let mut mean = DVector::zeros(self.constants.len());
        for block in &self.blocks {
            mean += vector.slow[*block].rows_range(slow.clone());
        }
        mean /= self.blocks.len() as f64;
        mean.iter_mut().zip(&self.constants).for_each(|(own, k)| *own += vector.constants[*k]);
        mean
    }

    /// The means of some vectors, as columns.
    fn of_all(&self, vectors: &[ChainVector]) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = vectors.iter().map(|vector| self.of(vector)).collect();
        let size = self.constants.len();
        DMatrix::from_fn(size, columns.len(), |row, column| columns[column][row])
    }

    /// The transposed Jacobian of the means, a vector for each.
    fn jacobian(&self, layout: &Layout, blocks: usize) -> Vec<ChainVector> {
        let of_mean = |(k, index): (usize, &usize)| {
            let mut column = ChainVector::zeros(layout, blocks);
            column.constants[*index] = 1.0;
            for block in &self.blocks {
                column.slow[*block][self.slow + k] = 1.0 / self.blocks.len() as f64;
            }
            column
        };
        self.constants.iter().enumerate().map(of_mean).collect()
    }
}
