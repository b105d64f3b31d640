//! Gauss–Newton iteration of the joint estimate.

use std::sync::Arc;

use super::attempt_end::{AttemptEnd, not_definite};
use super::constants_prior::prior_mean;
use super::detected_steps::{add_steps, measured_steps};
use super::drive::{BLOCK_LENGTHS_S, Drive};
use super::facet_covariance::FacetCovariance;
use super::gauss_newton_step::{GaussNewtonStep, RowBuffers, step_motion};
use super::joint_estimate::JointEstimate;
use super::learned_noise::learn_noise;
use super::linearisation::Weighting;
use super::marginal_likelihood::{choose_processes, likeliest_clocks_s2};
use super::priors::{Priors, RigDistances};
use super::prism_motion::Solution;
use super::readings::DriveReadings;
use super::solver_status::SolverStatus;
use super::state_vector::{Constants, ConstantsMatrix, Layout, StateVector};
use super::step_control::{is_small, share_after};
use super::step_search::StationStep;
use super::survey::Survey;
use super::survey_change::{PosesByDistances, SurveyEvidence};
use super::trace::{SlowChanges, SolverPhase, Trace, TraceEvent, TraceRow};
use super::unknown::DISTANCE;
use crate::calibration::ErrorSizes;
use crate::geometry::LevelTransform;
use crate::network::PerStation;
use crate::progress::{Cancelled, Progress};

/// Largest number of Gauss–Newton steps.
pub const MOST_ITERATIONS: usize = 40;
/// The residuals show slow changes once no constant moves by more than this many σ.
const NEAR_SIGMAS: f64 = 1.5;
/// They do not show them before the squared length of a step is this small (σ²).
const NEAR_SQUARE: f64 = 4.0;
/// The normal matrix is reused while the squared length of the steps shrinks at least by this factor: the length by 3.2.
const FAST: f64 = 0.1;
/// Noise levels are estimated on a sample of about so many knots.
const SAMPLE_KNOTS: usize = 600;
/// Least number of searches for slow changes near the solution: detected changes move everything else. Simulated: with one search
/// alone the 95 % regions of 3000 drives covered 91.7 %, with two 94.1 %.
const SEARCHES: usize = 2;
/// Steps of the motion alone that bring a whole drive near its readings once a sample of it is solved.
const MOTION_STEPS: usize = 3;
/// A step that raises the cost by more than this share is taken again. The Jacobians are approximations, so the cost may rise a
/// little although the steps converge.
const COST_TOLERANCE: f64 = 0.01;
/// Share of a step that is taken again, over its share before.
const SHORTER: f64 = 0.25;
/// A smaller share of a step is not taken again.
const SHORTEST: f64 = 1e-3;
/// Normal matrices are not reused after a longer step (σ²).
const LONG_STEP: f64 = 10.0;
/// An estimate this far from the published answer (m) has diverged.
const DIVERGED_M: f64 = 30.0;
/// If a station seems to have moved further since the survey (m), the drive may have another answer, near the control points. Simulated: of 20
/// circles driven one way, one has an answer 7 m away that fits as well.
const ELSEWHERE_M: f64 = 0.3;
/// Input of the joint estimate beside the readings of the drive.
#[derive(Clone)]
pub struct JointInput<'a> {
    /// The network and its unknowns.
    pub layout: &'a Arc<Layout>,
    /// The answer of a published method, from which the iteration starts.
    pub published: &'a PerStation<LevelTransform>,
    /// The distances between the followed prisms.
    pub rig: RigDistances,
    /// The control points, if they are evidence.
    pub survey: Option<Arc<Survey>>,
    /// True if the drive alone determines the answer; otherwise the survey is used from the first step on.
    pub is_determined_by_drive: bool,
    pub sizes: &'a ErrorSizes,
}

/// Estimates all unknowns.
///
/// Returns the trace with its status if there is no estimate.
pub fn estimate(
    readings: &DriveReadings,
    input: &JointInput<'_>,
    progress: &Progress,
) -> Result<Result<JointEstimate, Trace>, Cancelled> {
    let mut trace = Trace { status: SolverStatus::NoReadings, ..Trace::default() };
    let survey_first = !input.is_determined_by_drive;
    for block_s in BLOCK_LENGTHS_S {
        let Some(drive) = Drive::new(input.layout, readings, block_s).map(Arc::new) else {
            break;
        };
        let mut attempt = |event: TraceEvent, survey_first: bool| {
            trace.add_event(event);
            let drive = Arc::clone(&drive);
            match solve(drive, readings, input, survey_first, &mut trace, progress) {
                Ok(estimate) => Ok(Ok(estimate)),
                Err(AttemptEnd::Cancelled) => Err(Cancelled),
                Err(AttemptEnd::Failed(status)) => {
                    trace.add_event(TraceEvent::Failed(status));
                    Ok(Err(status))
                }
            }
        };
        let mut solved = attempt(TraceEvent::BlockLength(block_s), survey_first)?;
        // A drive that determines little by itself converges only with the survey from the first step on, or to an answer that is metres away.
        let is_doubtful = solved.as_ref().map_or(true, |found| moved_m(found) > ELSEWHERE_M);
        if is_doubtful && input.survey.is_some() && !survey_first {
            let again = attempt(TraceEvent::SurveyFirst, true)?;
            if solved.is_err() || again.as_ref().is_ok_and(|again| moved_m(again) == 0.0) {
                solved = again.or(solved);
            }
        }
        match solved {
            Ok(estimate) => {
                trace.status = SolverStatus::Converged;
                return Ok(Ok(JointEstimate { trace, ..estimate }));
            }
            Err(status) => trace.status = status,
        }
        if trace.status == SolverStatus::TooManySteps {
            break;
        }
    }
    Ok(Err(trace))
}

/// Displacement of a station since the survey (m); zero without a change.
fn moved_m(estimate: &JointEstimate) -> f64 {
    let change = estimate.survey.as_ref().and_then(|survey| survey.change.as_ref());
    change.map_or(0.0, |change| change.moved_length_m().value)
}

/// Estimates noise levels on a sample, then iterates with robust weights that follow the residuals, then with fixed ones.
///
/// The survey is used from the first step on, or once the drive alone is nearly solved: a set-up that changed in between would
/// otherwise look like outliers of the drive.
fn solve(
    drive: Arc<Drive>,
    readings: &DriveReadings,
    input: &JointInput<'_>,
    survey_first: bool,
    trace: &mut Trace,
    progress: &Progress,
) -> Result<JointEstimate, AttemptEnd> {
    let JointInput { layout, published, rig, survey, sizes, .. } = input;
    let mean = prior_mean(layout, published, &rig.measured_m);
    let mut priors = Priors::new(layout, sizes, &mean, rig, &readings.restarts_s);
    let survey = survey.as_ref();
    let mut pending_survey =
        survey.and_then(|survey| SurveyEvidence::new(layout, survey, sizes, &mean));
    if survey_first {
        priors.survey = pending_survey.take();
    }
    let sample = Arc::new(drive.sample(SAMPLE_KNOTS));
    let (weighting, mut state) = learn_noise(&sample, &priors, trace, progress)?;
    let is_sampled = sample.segments.len() < drive.segments.len();
    if is_sampled {
        state = drive.initial_state(&state.constants);
    }
    if is_sampled {
        for _ in 0..MOTION_STEPS {
            step_motion(&drive, &mut state, &weighting, progress)?.ok_or_else(not_definite)?;
            trace.add_row(TraceRow::of_motion(weighting.levels));
        }
    }
    // The whole drive determines the constants better than its sample: the first step may be that much longer.
    let times = drive.knots() as f64 / sample.knots() as f64;
    let near = (NEAR_SIGMAS * times.sqrt(), NEAR_SQUARE * times);
    let (steps, buffers, iterations, before) = (Vec::new(), RowBuffers::default(), 0, None);
    let mut iteration = Iteration {
        drive,
        sizes,
        progress,
        priors,
        weighting,
        state,
        steps,
        buffers,
        iterations,
        before,
        pending_survey,
        trace,
    };
    let step = iteration.step_reweighted(near)?;
    let step = iteration.step_with_fixed_weights(step)?;
    if step.is_stiffer {
        return Err(SolverStatus::StifferPriors.into());
    }
    Ok(iteration.summarise(&step)?)
}

/// The state of the iteration.
pub struct Iteration<'a> {
    pub drive: Arc<Drive>,
    pub sizes: &'a ErrorSizes,
    pub progress: &'a Progress,
    pub priors: Priors,
    pub weighting: Weighting,
    pub state: StateVector,
    /// Detected steps of stations and clocks.
    pub steps: Vec<StationStep>,
    pub buffers: RowBuffers,
    pub iterations: usize,
    pub before: Option<StateBefore>,
    /// The survey until the drive alone is nearly solved.
    pub pending_survey: Option<SurveyEvidence>,
    pub trace: &'a mut Trace,
}

/// The state before a step, its cost (σ²), and the share of the step that was taken.
pub struct StateBefore {
    state: StateVector,
    cost: f64,
    share: f64,
    /// The whole step of the constants (σ).
    step_sigmas: Constants,
}

impl Iteration<'_> {
    /// Steps with robust weights that follow the residuals, until the searches find no further slow change. Returns the last step.
    fn step_reweighted(
        &mut self,
        (near_sigmas, near_square): (f64, f64),
    ) -> Result<GaussNewtonStep, AttemptEnd> {
        let mut searches = 0;
        loop {
            let mut step = self.linearise()?;
            let mut is_settled = false;
            let largest_step_sigmas = step.largest_step_sigmas();
            if largest_step_sigmas < near_sigmas && step.squared_length < near_square {
                let known = self.steps.len();
                searches += 1;
                self.search_slow_changes(&mut step, searches == SEARCHES)?;
                // Readings near a step seem to be outliers until the priors allow the step.
                is_settled = searches >= SEARCHES && self.steps.len() == known;
            }
            self.apply(&step, |row| row.largest_step_sigmas = Some(largest_step_sigmas))?;
            if is_settled || self.iterations >= MOST_ITERATIONS {
                return Ok(step);
            }
            self.buffers = step.into_buffers();
        }
    }

    /// Steps with the robust weights of `step`, until the last step is small. Returns it.
    fn step_with_fixed_weights(
        &mut self,
        mut step: GaussNewtonStep,
    ) -> Result<GaussNewtonStep, AttemptEnd> {
        if self.iterations >= MOST_ITERATIONS {
            return Err(SolverStatus::TooManySteps.into());
        }
        self.trace.add_event(TraceEvent::WeightsFixed);
        self.weighting.fixed = Some(step.weights());
        // The cost is another one now.
        self.before = None;
        let is_stored = self.drive.stored_segments() == self.drive.segments.len();
        let mut reuse_matrix = is_stored && step.squared_length < LONG_STEP;
        loop {
            let before = step.squared_length;
            if reuse_matrix {
                step.update_gradient(&self.state, &self.priors, self.progress)?;
                self.before = None;
            } else {
                self.buffers = step.into_buffers();
                step = self.linearise()?;
            }
            self.apply(&step, |row| {
                row.is_matrix_reused = reuse_matrix;
                // The cost is that of the state at which the matrix was computed.
                row.cost = row.cost.filter(|_| !reuse_matrix);
            })?;
            if is_small(&step, self.iterations) {
                return Ok(step);
            }
            if self.iterations >= MOST_ITERATIONS {
                return Err(SolverStatus::TooManySteps.into());
            }
            reuse_matrix = is_stored && step.squared_length < FAST * before;
        }
    }

    /// Linearises at the state; before that, goes back as long as the last step has raised the cost.
    pub fn linearise(&mut self) -> Result<GaussNewtonStep, AttemptEnd> {
        loop {
            let step = self.linearise_here()?;
            let Some(before) = &self.before else { return step.ok_or_else(not_definite) };
            let cost = step.as_ref().map_or(f64::NAN, |it| it.cost(&self.state, &self.priors));
            // NaN has not decreased.
            if cost < before.cost * (1.0 + COST_TOLERANCE) || before.share < SHORTEST {
                return step.ok_or_else(not_definite);
            }
            if self.iterations >= MOST_ITERATIONS {
                return step.ok_or_else(not_definite);
            }
            let share = SHORTER * before.share;
            self.state = before.state.clone();
            if let Some(step) = step {
                self.buffers = step.into_buffers();
            }
            let step = self.linearise_here()?.ok_or_else(not_definite)?;
            self.take_share(&step, share, |_| ());
            self.buffers = step.into_buffers();
        }
    }

    fn linearise_here(&mut self) -> Result<Option<GaussNewtonStep>, Cancelled> {
        let Self { drive, state, weighting, priors, buffers, progress, .. } = self;
        // The motion follows the sights within the blocks, which the Jacobians of the constants neglect. Otherwise the cost of a good step
        // seems to rise.
        let Some(squares) = step_motion(drive, state, weighting, progress)? else {
            return Ok(None);
        };
        if weighting.fixed.is_none() {
            weighting.squares = squares;
        }
        GaussNewtonStep::new(drive, state, weighting, priors, buffers, progress)
    }

    /// Applies a step, and adds its row with some changes; fails if the estimate has diverged.
    pub fn apply(
        &mut self,
        step: &GaussNewtonStep,
        change_row: impl FnOnce(&mut TraceRow),
    ) -> Result<(), AttemptEnd> {
        let share = self.before.as_ref().map_or(1.0, |before| {
            let is_fixed = self.weighting.fixed.is_some();
            share_after(&before.step_sigmas, before.share, &step.step_sigmas(), is_fixed)
        });
        self.take_share(step, share, change_row);
        let moved = self.priors.layout.moved();
        let has_diverged = has_diverged(&self.state.constants, &self.priors.mean, moved);
        if has_diverged { Err(SolverStatus::Diverged.into()) } else { Ok(()) }
    }

    fn take_share(
        &mut self,
        step: &GaussNewtonStep,
        share: f64,
        change_row: impl FnOnce(&mut TraceRow),
    ) {
        let cost = step.cost(&self.state, &self.priors);
        let is_fixed = self.weighting.fixed.is_some();
        let phase = if is_fixed { SolverPhase::FixedWeights } else { SolverPhase::Reweighted };
        let mut row = TraceRow { cost: Some(cost), share, ..step.trace_row(phase) };
        change_row(&mut row);
        self.trace.add_step(row, step.is_stiffer);
        let (state, step_sigmas) = (self.state.clone(), step.step_sigmas());
        self.before = Some(StateBefore { state, cost, share, step_sigmas });
        step.apply(&mut self.state, share);
        self.iterations += 1;
    }

    /// Estimates the variances of slow states and detects steps, then solves again.
    fn search_slow_changes(
        &mut self,
        step: &mut GaussNewtonStep,
        is_last: bool,
    ) -> Result<(), AttemptEnd> {
        let Self { state, priors, progress, trace, .. } = self;
        // A smaller size is a statement of the user, which is tested elsewhere.
        if self.sizes.clock_offset_s >= ErrorSizes::default().clock_offset_s {
            let constants = &state.constants - &step.step.constants;
            let covariance = step.factor.constants_covariance();
            let widened = priors.widen_clock_offsets(&constants, &covariance);
            widened.into_iter().for_each(|it| trace.add_event(TraceEvent::ClockPriorWidened(it)));
        }
        add_survey(step, &mut self.pending_survey, state, priors, (trace, progress))?;
        // The search has a factor of its own.
        step.factor.forget_rows();
        if self.sizes.ranges_wander {
            choose_processes(&step.normal, priors, state, progress)?;
        }
        let (known, prior_s2) = (self.steps.len(), self.sizes.clock_wander_s.powi(2));
        let choose_clocks = |priors: &mut Priors| -> Result<(), Cancelled> {
            priors.slow.clocks_s2 =
                likeliest_clocks_s2(&step.normal, priors, state, prior_s2, progress)?;
            Ok(())
        };
        let (mut suspected, mut with_steps) = (self.steps.clone(), priors.clone());
        add_steps(&mut suspected, step, &mut with_steps, state, progress)?;
        if suspected.len() > known {
            // Stamps that wander are no steps. Beside a step that happened they wander less than without it.
            choose_clocks(&mut with_steps)?;
            priors.slow.clocks_s2 = with_steps.slow.clocks_s2;
            add_steps(&mut self.steps, step, priors, state, progress)?;
        }
        if is_last || suspected.len() > known {
            choose_clocks(priors)?;
        }
        let slow = &priors.slow;
        trace.add_event(TraceEvent::Search(SlowChanges {
            processes: [slow.ranges, slow.across, slow.upward],
            clocks_s: slow.clocks_s2.sqrt(),
            steps: self.steps.len(),
        }));
        step.solve_again(state, priors).ok_or_else(not_definite)
    }

    fn summarise(self, step: &GaussNewtonStep) -> Result<JointEstimate, Cancelled> {
        let Self { drive, state, weighting, priors, sizes, steps, iterations, progress, .. } = self;
        let steps = measured_steps(&steps, &step.factor, &priors, &drive, &state);
        let size = drive.layout.constants;
        let added_covariance = Arc::new(ConstantsMatrix::zeros(size, size));
        let solution =
            Solution { drive, state, weighting, priors, sizes: *sizes, added_covariance };
        Ok(JointEstimate { steps, iterations, ..step.summary(solution, progress)? })
    }
}

/// Adds the survey to the priors and widens that of a changed set-up.
fn add_survey(
    step: &mut GaussNewtonStep,
    pending: &mut Option<SurveyEvidence>,
    state: &StateVector,
    priors: &mut Priors,
    (trace, progress): (&mut Trace, &Progress),
) -> Result<(), AttemptEnd> {
    if let Some(survey) = pending.take() {
        let by_distances = (priors.layout.pairs() > 0 && priors.distances_are_evidence)
            .then(|| poses_by_distances(&step.factor.constants_covariance(), priors));
        priors.survey = Some(survey.with_distances(by_distances));
        trace.add_event(TraceEvent::SurveyAdded);
        step.solve_again(state, priors).ok_or_else(not_definite)?;
    }
    let constants = &state.constants - &step.step.constants;
    let covariance = step.factor.constants_covariance();
    let by_facets = || {
        let facets = FacetCovariance::new(step, (state, priors), &[], progress)?;
        Ok(facets.constants)
    };
    let changed = match &priors.survey {
        Some(survey) => survey.with_detected_change(&constants, &covariance, by_facets)?,
        None => None,
    };
    let Some(changed) = changed else { return Ok(()) };
    if !changed.changed.is_empty() {
        trace.add_event(TraceEvent::SetUpChanged(changed.changed.clone()));
    }
    priors.survey = Some(changed);
    step.solve_again(state, priors).ok_or_else(not_definite)
}

/// Change of the poses for errors of the measured distances, by the covariance of the constants by the drive alone.
fn poses_by_distances(covariance: &ConstantsMatrix, priors: &Priors) -> PosesByDistances {
    let layout = &priors.layout;
    let distances: Vec<usize> = layout.indices(&DISTANCE).collect();
    let by_distances = covariance * priors.own_information().select_columns(&distances);
    by_distances.rows(0, layout.poses()).into_owned()
}

fn has_diverged(constants: &Constants, mean: &Constants, slots: usize) -> bool {
    let moved = constants - mean;
    // NaN has diverged, too.
    !(0..slots).all(|slot| moved.fixed_rows::<3>(4 * slot).norm() < DIVERGED_M)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn divergence_is_a_distance_from_the_published_answer() {
        let mean = Constants::zeros(8);
        let mut constants = mean.clone();
        constants[4] = 29.0;
        assert!(!has_diverged(&constants, &mean, 2));
        for far in [31.0, -4e15, f64::NAN, f64::INFINITY] {
            constants[5] = far;
            assert!(has_diverged(&constants, &mean, 2), "{far}");
        }
    }
}
