//! The Gauss–Newton iteration of clock, lever arm, body rotation and scale.

use nalgebra::{DMatrix, DVector, UnitQuaternion, Vector3};

use super::alignment::align_rigidly;
use super::clock_evidence::significant_clock_change;
use super::clock_information;
use super::drift_sizes::DriftSizes;
use super::fit::Fit;
use super::instruments::truth_is_less_noisy;
use super::likelihood::{Equations, search};
use super::neighbours::share_of_stamped;
use super::state::FitState;
use super::unknowns::{BODY, CLOCK, SCALE, UNKNOWNS};
use super::wandering_frame::{first_frame, pass};
use crate::estimates::association::thinned;
use crate::estimates::ground_truth::GroundTruth;
use crate::estimates::matched_pose::MatchedPose;
use crate::estimates::options::{Association, TrajectoryAlignment};
use crate::estimates::unfit::Unfit;
use crate::estimates::unjudged::Unjudged;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::statistics::{median, sandwich};

/// Largest number of epochs in a fit, evenly spread, and in a sample for the search of the sizes of noise and drift.
const MOST_EPOCHS: usize = 3000;
const MOST_SEARCHED: usize = 300;
/// Number of consecutive epochs in a group of a sample.
const BURST: usize = 20;
pub const FEWEST_EPOCHS: usize = 10;
const MOST_STEPS: usize = 150;
/// Number of times that the sizes of noise and drift are searched, each after the unknowns have converged.
const SEARCHES: usize = 2;
/// The unknowns have converged if a step is smaller than this share of σ, and nearly if it is smaller than the second.
const SETTLED_SIGMAS: f64 = 0.02;
const NEAR_SIGMAS: f64 = 0.3;
/// Steps that shrink less than this ratio oscillate, such as where the estimate stands still, and are damped.
const OSCILLATES: f64 = 0.98;
/// Largest step (σ) of an iteration that never ends and is taken nevertheless.
const UNSETTLED_SIGMAS: f64 = 1.0;
/// Change of the time offset (s) above which the ground truth is recomputed, and not moved along its velocity: during the
/// iteration, and before its end.
const LINEAR_S: f64 = 0.01;
const EXACT_S: f64 = 1e-4;
/// The iteration ends if it has moved the clock by less than this share of its σ since the ground truth was computed; after many steps
/// the second share is enough, and what is left counts as an error.
const EXACT_SIGMAS: f64 = 0.05;
const LEAST_EXACT_SIGMAS: f64 = 0.5;
const MANY_STEPS: usize = 40;
/// Largest ratio of two changes of the time offset from which the rest is extrapolated (Aitken).
/// Effect: noise of the velocities shortens steps of the clock, so that they converge slowly.
const MOST_RATIO: f64 = 0.8;

/// Sizes of the steps of one system of equations.
struct StepSizes {
    last: f64,
    damping: f64,
    /// Last change of the time offset before the ground truth was computed again (s), and the number of times that it was.
    last_s: f64,
    renewals: usize,
}

impl Default for StepSizes {
    fn default() -> Self {
        Self { last: f64::INFINITY, damping: 1.0, last_s: 0.0, renewals: 0 }
    }
}

impl StepSizes {
    /// Returns the share of a step of this size to take.
    fn damping(&mut self, size: f64) -> f64 {
        if size > OSCILLATES * self.last {
            self.damping *= 0.5;
        }
        self.last = size;
        self.damping
    }

    /// Returns the expected rest of the changes of the time offset after one (s), before the ground truth is computed again.
    fn rest_s(&mut self, change_s: f64) -> f64 {
        self.renewals += 1;
        if self.renewals > MOST_RENEWALS {
            self.damping *= DAMPED;
            self.last = f64::INFINITY;
            return 0.0;
        }
        let ratio = if self.last_s == 0.0 { 0.0 } else { change_s / self.last_s };
        let ratio = ratio.clamp(0.0, MOST_RATIO);
        // After an extrapolation the next ratio is not that of the series.
        self.last_s = if ratio > 0.0 { 0.0 } else { change_s };
        (self.last, self.damping) = (f64::INFINITY, 1.0);
        change_s * ratio / (1.0 - ratio)
    }
}

/// Number of times that the ground truth is computed again before steps are damped, and the factor of each time. Where the estimate stands
/// still, they may go to and fro for ever.
const MOST_RENEWALS: usize = 12;
const DAMPED: f64 = 0.8;

/// Unknowns to estimate.
pub struct Sought {
    pub frame: TrajectoryAlignment,
    pub clock: bool,
    pub lever: bool,
    pub body: bool,
}

impl Sought {
    /// Returns true if there is anything to estimate beside the frame.
    pub fn any(&self) -> bool {
        self.clock || self.lever || self.body
    }

    fn open(&self) -> Vec<usize> {
        let lever = if self.lever { 0..CLOCK } else { 0..0 };
        let clock = if self.clock { CLOCK..BODY } else { 0..0 };
        let body = if self.body { BODY..SCALE } else { 0..0 };
        let is_scaled = self.frame != TrajectoryAlignment::None;
        let scale = if is_scaled { SCALE..UNKNOWNS } else { 0..0 };
        lever.chain(clock).chain(body).chain(scale).collect()
    }
}

/// Estimates the unknowns with σ.
pub fn refine(
    state: &mut FitState,
    (truth, association): (&GroundTruth<'_>, Association),
    poses: &[EstimatedPose],
    sought: &Sought,
    estimate: &EstimatedTrajectory,
) -> Result<(), Unjudged> {
    let unfit = |why| Unjudged::Unfit { name: estimate.name.clone(), why };
    let open = sought.open();
    let matched = |offset_s: f64| truth.matched(poses, offset_s, (association, MOST_EPOCHS));
    let mut pairs = matched(state.fit.time_offset_s)?;
    align_rigidly(&mut state.fit, &pairs, sought.frame).map_err(unfit)?;
    let misfits_m = pairs.iter().map(|pair| {
        let [placed_m, true_m] = state.fit.both_positions_m(&pair.pose, &pair.truth);
        (true_m - placed_m).norm()
    });
    let misfit_m = median(misfits_m).unwrap_or_default();
    let is_aligned = sought.frame != TrajectoryAlignment::None;
    let usual = match state.offset_prior {
        None => DriftSizes::usual(is_aligned, misfit_m),
        Some(_) => DriftSizes::of_points(is_aligned, misfit_m),
    };
    state.share_of_stamped = share_of_stamped(&pairs);
    let mut sizes = usual;
    let (mut steps, mut searches) = (StepSizes::default(), 0);
    let mut last_step = None;
    for step in 0..MOST_STEPS {
        if pairs.len() < FEWEST_EPOCHS {
            return Err(unfit(Unfit::FewEpochs));
        }
        align_rigidly(&mut state.fit, &pairs, sought.frame).map_err(unfit)?;
        state.aligned = state.fit.truth_from_estimate.rotation;
        if step == 0 && sought.body {
            state.fit.body_rotation = mean_turn(&state.fit, &pairs);
        }
        if is_aligned {
            state.fit.truth_from_estimate = first_frame(&pairs, state, &sizes);
        }
        let filtered = pass(&pairs, state, &sizes, None);
        let equations = Equations::of(&filtered, state, &open);
        let root = equations.information.cholesky().ok_or_else(|| unfit(Unfit::Undetermined))?;
        let solved = root.solve(&equations.gradient);
        // In units of σ by the model.
        let change = equations.gradient.dot(&solved).max(0.0).sqrt();
        let damping = steps.damping(change);
        last_step = (searches == SEARCHES && change < UNSETTLED_SIGMAS).then(|| solved.clone());
        state.step(&open, &(damping * solved));
        let is_last = searches == SEARCHES;
        // Damped steps are small also where the equations are wrong, as on a circle.
        let is_right = !is_last || change < UNSETTLED_SIGMAS;
        let settled =
            is_right && damping * change < if is_last { SETTLED_SIGMAS } else { NEAR_SIGMAS };
        let clock = open.iter().position(|unknown| *unknown == CLOCK);
        let exact_s = clock.filter(|_| is_last).map_or(LINEAR_S, |clock| {
            let share = if step < MANY_STEPS { EXACT_SIGMAS } else { LEAST_EXACT_SIGMAS };
            EXACT_S.max(share * root.inverse()[(clock, clock)].sqrt())
        });
        if state.later_s.abs() > if settled { exact_s } else { LINEAR_S } {
            state.fit.time_offset_s += steps.rest_s(state.later_s);
            state.later_s = 0.0;
            pairs = matched(state.fit.time_offset_s)?;
        } else if settled && !is_last {
            searches += 1;
            let first = sizes.with_slow_clock();
            sizes = search(usual, first, &samples(&pairs), state, &open);
            if state.fit.body_rotation.is_some() {
                state.is_turned_by_estimate = truth_is_less_noisy(&filtered.blocks);
            }
            state.share_of_estimate = share_of_estimate(&pairs, &sizes);
            steps = StepSizes::default();
        } else if settled {
            return take_sigmas(state, truth, &pairs, &sizes, (&open, None))
                .ok_or_else(|| unfit(Unfit::Undetermined));
        }
    }
    // It goes to and fro within its σ: the last step is a further error.
    last_step
        .and_then(|step| take_sigmas(state, truth, &pairs, &sizes, (&open, Some(&step))))
        .ok_or_else(|| unfit(Unfit::Undetermined))
}

/// Returns the share of the estimate in the variance of the noise; 1 without σ of the ground truth.
fn share_of_estimate(pairs: &[MatchedPose], sizes: &DriftSizes) -> f64 {
    let stated = pairs.iter().filter_map(|pair| Some(pair.truth.covariance_m2?.trace() / 3.0));
    let of_truth_m2 = stated.sum::<f64>() / pairs.len().max(1) as f64;
    let noise_m2 = sizes.position_m.powi(2) + sizes.lasting_m.powi(2);
    (1.0 - of_truth_m2 / noise_m2).clamp(0.0, 1.0)
}

/// Returns samples of the epochs for the search of the sizes: all of few; otherwise evenly spread ones, which show slow changes, and groups of
/// consecutive ones, which show fast ones.
fn samples(pairs: &[MatchedPose]) -> Vec<Vec<MatchedPose>> {
    if pairs.len() <= 2 * MOST_SEARCHED {
        return vec![pairs.to_vec()];
    }
    let every = pairs.len().div_ceil(MOST_SEARCHED);
    let groups = pairs.chunks(BURST).step_by(every).flatten();
    vec![thinned(pairs, MOST_SEARCHED).cloned().collect(), groups.cloned().collect()]
}

/// Stores σ by blocks of time, with the errors that the ground truth shares; `last_step` is that of an iteration that did not settle. `None` if
/// the drive does not determine the unknowns.
fn take_sigmas(
    state: &mut FitState,
    truth: &GroundTruth<'_>,
    pairs: &[MatchedPose],
    sizes: &DriftSizes,
    (open, last_step): (&[usize], Option<&DVector<f64>>),
) -> Option<()> {
    let times_s: Vec<f64> = pairs.iter().map(|pair| pair.truth.time_s).collect();
    let common = truth.common_errors(&times_s);
    let filtered = pass(pairs, state, sizes, common.as_ref());
    let equations = Equations::of(&filtered, state, open);
    let mut covariance = clock_information::covariance(&equations, pairs, (state, sizes), open)?;
    let root = equations.information.clone().cholesky()?;
    let by_model = root.inverse();
    let mut widened = by_blocks(&by_model, &equations)?;
    widened.component_mul_assign(&by_free_frame(&by_model, (pairs, state), sizes, open)?);
    // Correlations stay: without them, combinations that the drive determines well would have the σ of their parts.
    let widened = DMatrix::from_diagonal(&widened);
    covariance = &widened * covariance * &widened;
    if let Some(common) = common {
        let moved = root.solve(
            &(&equations.transform
                * filtered.by_common.select_rows(&equations.instruments.columns)),
        );
        covariance += &moved * &common.covariance * moved.transpose();
    }
    if let Some(step) = last_step {
        covariance += step * step.transpose();
    }
    let clock = open.iter().position(|unknown| *unknown == CLOCK);
    if let Some(clock) = clock {
        covariance[(clock, clock)] += state.later_s.powi(2);
    }
    state.take_sigmas(open, &covariance);
    state.fit.clock_change =
        clock.and_then(|_| significant_clock_change(filtered.cost, pairs, state, sizes, open));
    Some(())
}

/// A variance by blocks counts if it is larger than the model's by so many of its own σ.
/// Effect: with 1, chance in one of three lengths of blocks widens most σ. Measured: halves of drives then differ by √(χ²/f) = 0.79 in the median,
/// and by 0.83 with 2.
const SIGNIFICANT_SIGMAS: f64 = 2.0;

/// Returns the factors of σ by innovations that are correlated after all, or larger than their model.
fn by_blocks(covariance: &DMatrix<f64>, equations: &Equations) -> Option<DVector<f64>> {
    let prior = sandwich::Prior { precision: equations.prior.clone(), weight: 1.0 };
    let blocks = &equations.blocks;
    let [twos, fours] =
        [2, 4].map(|count| blocks.chunks(count).map(sandwich::Block::sum).collect::<Vec<_>>());
    let mut widened = DVector::repeat(covariance.nrows(), 1.0_f64);
    for blocks in [blocks, &twos, &fours] {
        let by_blocks = sandwich::covariance(blocks, Some(&prior))?;
        // Of so many blocks, the variance has this σ relative to itself.
        let relative_sigma = (2.0 / blocks.len() as f64).sqrt();
        let significant = 1.0 + SIGNIFICANT_SIGMAS * relative_sigma;
        for (index, widened) in widened.iter_mut().enumerate() {
            let ratio = by_blocks[(index, index)] / covariance[(index, index)];
            if ratio > significant {
                *widened = widened.max(ratio.sqrt());
            }
        }
    }
    Some(widened)
}

/// Least ratio of σ with and without a frame that may be turned at the first epoch, from which that frame determines an unknown.
const BY_FIRST_FRAME: f64 = 2.0;

/// Returns the factors of σ without the frame at the first epoch, where that alone determines the unknowns; 1 elsewhere.
fn by_free_frame(
    covariance: &DMatrix<f64>,
    (pairs, state): (&[MatchedPose], &FitState),
    sizes: &DriftSizes,
    open: &[usize],
) -> Option<DVector<f64>> {
    let free = pass(pairs, state, &sizes.with_free_frame(), None);
    let free = Equations::of(&free, state, open).information.cholesky()?.inverse();
    let ratio = |index: usize| (free[(index, index)] / covariance[(index, index)]).sqrt();
    let factor = |ratio: f64| if ratio > BY_FIRST_FRAME { ratio } else { 1.0 };
    Some(DVector::from_fn(open.len(), |index, _| factor(ratio(index))))
}

/// Largest root mean square angle of orientations about the mean rotation of the body (rad). Beyond, they do not follow the drive: their
/// convention is another one, or they drift by tens of degrees.
const LARGEST_SPREAD_RAD: f64 = 0.5;

/// Returns true if the orientations of an estimate turn as those of the ground truth do.
pub fn orientations_follow(fit: &Fit, pairs: &[MatchedPose]) -> bool {
    let Some(mean) = mean_turn(fit, pairs) else { return false };
    let squares = pairs.iter().filter_map(|MatchedPose { pose, truth, .. }| {
        let vehicle = truth.rotation.as_ref()?.orientation;
        Some((vehicle * mean).angle_to(&fit.placed_orientation(pose)?).powi(2))
    });
    squares.sum::<f64>() < pairs.len() as f64 * LARGEST_SPREAD_RAD.powi(2)
}

/// Returns the mean rotation of the body in the vehicle; `None` without orientations.
pub fn mean_turn(fit: &Fit, pairs: &[MatchedPose]) -> Option<UnitQuaternion<f64>> {
    let turns: Option<Vec<UnitQuaternion<f64>>> = pairs
        .iter()
        .map(|MatchedPose { pose, truth, .. }| {
            let rotation = truth.rotation.as_ref()?;
            Some(rotation.orientation.inverse() * fit.placed_orientation(pose)?)
        })
        .collect();
    let turns = turns.filter(|turns| !turns.is_empty())?;
    // Far from the mean rotation, the mean of rotation vectors is not the mean rotation.
    let mut mean = turns[turns.len() / 2];
    for _ in 0..10 {
        let left = turns.iter().map(|turn| (turn * mean.inverse()).scaled_axis());
        let step = left.sum::<Vector3<f64>>() / turns.len() as f64;
        mean = UnitQuaternion::from_scaled_axis(step) * mean;
        if step.norm() < 1e-9 {
            break;
        }
    }
    Some(mean)
}
