//! Beyond the paper: method D with a robust loss, weights from the instruments' noise, and what else can be estimated:
//! the clocks of stations 2 and 3, the inter-prism distances, the tilts of stations 2 and 3.
//!
//! Iteratively reweighted least squares from the answer of the plain method, then Newton's steps. Distances and tilts are
//! held by priors; a prior must be weighed against data that is correlated in time, so it is multiplied by
//! λ = tr(H⁻¹B)/8, the ratio of the sandwich's middle to the Hessian of the transforms: with independent residuals of
//! unit variance it is 1. The covariance is A⁻¹ (B + λ²P) A⁻¹ with A = H + λP, H = Σ ψ'(r) J Jᵀ, B the sum over blocks
//! of time of the outer products of their gradients, P the priors' precisions (Huber 1981, "Robust Statistics",
//! section 6.3; Liang & Zeger 1986).

mod model;
mod noise;

use nalgebra::{DMatrix, DVector, SMatrix, Vector3};

pub use self::model::Clock;
use self::model::{
    CLOCKS, CONSTANT, DISTANCES, DRIFTS, MovingTriplets, PolarNoise, State, TILTS, UNKNOWNS,
    distances, transforms,
};
use self::noise::{Noise, loss_scale};
use crate::calibration::joint::JointEstimate;
use crate::calibration::{CalibrationSettings, Estimated, Loss, TransformSigma, time_blocks};
use crate::geometry::{LevelTransform, RigidTransform, wrap_to_pi};
use crate::pipeline::Triplets;
use crate::progress::Progress;

type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

const MOST_NEWTON_STEPS: usize = 30;
/// Triplets that a suspicion about the clocks rests on, spread evenly.
const SUSPICION_TRIPLETS: usize = 400;
/// Steps smaller than this (m, rad, s; all of the same order here) change nothing that anyone can see.
const SMALL_STEP: f64 = 1e-9;
/// The Trimble S7: 2 mm + 2 ppm, one arcsecond (`paper.tex`, "Experiments").
const INSTRUMENT: PolarNoise = PolarNoise {
    range_m: 0.002,
    range_share: 2e-6,
    angle_rad: std::f64::consts::PI / 180.0 / 3600.0,
};
/// How far the noise's share of the variances may be off (1 σ); what it pulls the answer by is uncertain as much.
const NOISE_SHARE_SIGMA: f64 = 0.5;
/// Compensators hold a station upright to about this (rad, 1 σ): an arcsecond.
pub const TILT_SIGMA_RAD: f64 = std::f64::consts::PI / 180.0 / 3600.0;
/// Quartz clocks drift by some parts per million (s per s, 1 σ).
const DRIFT_SIGMA: f64 = 5e-6;
/// Where one jumps, it does by milliseconds (s, 1 σ).
const JUMP_SIGMA_S: f64 = 0.01;
/// How well prism constants are known (m, 1 σ).
pub const PRISM_CONSTANT_SIGMA_M: f64 = 0.0003;
/// The loss's scale settles while weights are iterated; then it is held, and Newton's steps finish.
const MOST_REWEIGHTINGS: usize = 15;

/// A number with one standard deviation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    pub value: f64,
    pub sigma: f64,
}

impl Estimate {
    /// How many σ it is from what it would be without estimating it.
    pub fn sigmas_from(&self, other: f64) -> f64 {
        (self.value - other) / self.sigma.max(f64::MIN_POSITIVE)
    }
}

/// Whether the data asks for a group of unknowns: Wald's test of their being what they are without estimating them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Support {
    pub what: &'static str,
    /// Their squared distance from that, in units of their covariance: on average the number of unknowns, if there is
    /// nothing to them.
    pub chi_square: f64,
    pub unknowns: usize,
    /// Larger than chance makes it once in a hundred times.
    pub supported: bool,
}

/// The refined answer.
#[derive(Clone, Debug)]
pub struct Refinement {
    pub station1_from_station: [RigidTransform; 3],
    pub sigma: [TransformSigma; 2],
    /// Of (x, y, z, yaw) of station 2, then 3.
    pub covariance: SMatrix<f64, 8, 8>,
    /// By how much the stamps of stations 2 and 3 are late against station 1's (s).
    pub clock_offsets_s: Option<[Estimate; 2]>,
    /// And how fast that grows (s per s).
    pub clock_drifts: Option<[Estimate; 2]>,
    /// By how much the prism constant makes all ranges too long (m); estimated with the distances.
    pub prism_constant_error_m: Option<Estimate>,
    /// Estimated inter-prism distances (m).
    pub distances_m: Option<[Estimate; 3]>,
    /// Tilts of stations 2 and 3 about their own x and y (rad).
    pub tilts_rad: Option<[[Estimate; 2]; 2]>,
    /// (x, y, z, yaw) of stations 2 and 3: refined minus plain, over the refined σ.
    pub moves_sigmas: [f64; 8],
    /// The joint estimate that this is of, where the readings themselves were used.
    pub joint: Option<Box<JointEstimate>>,
    /// Whether the data supports each group of estimates.
    pub support: Vec<Support>,
    pub converged: bool,
}

impl Refinement {
    /// The joint estimate in the place of a refinement of `plain`.
    pub fn from_joint(joint: JointEstimate, plain: &[LevelTransform; 3]) -> Self {
        let sigma = joint.sigma();
        let moves_sigmas = std::array::from_fn(|place| {
            let (now, before) =
                (&joint.station1_from_station[place / 4 + 1], &plain[place / 4 + 1]);
            match place % 4 {
                3 => wrap_to_pi(now.yaw_rad - before.yaw_rad) / sigma[place / 4].yaw_rad,
                axis => {
                    let moved_m = now.translation_m[axis] - before.translation_m[axis];
                    moved_m / sigma[place / 4].translation_m[axis]
                }
            }
        });
        Self {
            station1_from_station: joint.station1_from_station.map(RigidTransform::from),
            sigma,
            covariance: joint.covariance,
            clock_offsets_s: Some(joint.clock_offsets_s),
            clock_drifts: Some(joint.clock_drifts),
            prism_constant_error_m: None,
            distances_m: joint.distances_m,
            tilts_rad: None,
            moves_sigmas,
            support: Vec::new(),
            converged: joint.converged,
            joint: Some(Box::new(joint)),
        }
    }

    /// The triplets with all that was estimated of instruments put right, but for tilts of triplets.
    pub fn corrected(&self, triplets: &Triplets) -> Triplets {
        if let Some(joint) = &self.joint {
            return joint.corrected(triplets);
        }
        let mut corrected =
            self.clocks().map_or_else(|| triplets.clone(), |clocks| with_clocks(triplets, clocks));
        if let Some(longer_m) = self.prism_constant_error_m {
            for point in corrected.points_m.iter_mut().flatten() {
                *point -= longer_m.value * point.normalize();
            }
        }
        corrected
    }

    /// How late the stamps of stations 2 and 3 are, where that was estimated.
    pub fn clocks(&self) -> Option<[Clock; 2]> {
        let (offsets_s, drifts) = (self.clock_offsets_s?, self.clock_drifts?);
        let clock =
            |slot: usize| Clock { offset_s: offsets_s[slot].value, drift: drifts[slot].value };
        Some([clock(0), clock(1)])
    }
}

/// Refines `plain`, the answer of the published method. `None` when the data leaves a direction free, or nobody waits for
/// it any more.
pub fn refine(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: &[f64; 3],
    settings: &CalibrationSettings,
    progress: &Progress,
) -> Option<Refinement> {
    let data = MovingTriplets::all(triplets);
    let start = start(plain, inter_prism_m);
    let estimated = estimated(settings);
    let precision = precisions(settings);
    let noise = Noise::new(triplets, &plain.map(RigidTransform::from))
        .no_larger_than_residuals(&data, &start);
    let blocks = time_blocks::of(&triplets.time_s, &triplets.interval);

    let mut state = start;
    let mut lambda = 0.0;
    let mut scale = None;
    let mut converged = false;
    for iteration in 0..MOST_REWEIGHTINGS + MOST_NEWTON_STEPS {
        progress.check().ok()?;
        let settled = iteration >= MOST_REWEIGHTINGS;
        if !settled {
            scale = loss_scale(&data, &state, &noise, settings.loss);
        }
        let sums = accumulate(&data, &state, &noise, settings.loss, scale, &blocks);
        if !settled {
            lambda = prior_weight(&sums)?;
        }
        let gradient = sums.gradient + (lambda * precision).component_mul(&(state - start));
        let newton =
            settled.then(|| step(&sums.hessian, &precision, lambda, &gradient, &estimated));
        // Reweighting always descends; Newton's step is for the end.
        let step = newton
            .flatten()
            .or_else(|| step(&sums.normal, &precision, lambda, &gradient, &estimated))?;
        state -= step;
        if step.amax() < SMALL_STEP {
            converged = true;
            break;
        }
    }
    let sums = accumulate(&data, &state, &noise, settings.loss, scale, &blocks);
    let covariance =
        covariance(&sums, &precision, lambda, &estimated, settings.inter_prism_sigma_m)?;
    Some(summary(&state, &start, &covariance, settings, converged))
}

/// What the clocks of stations 2 and 3 look like from the plain answer: one step of least squares with transforms, clocks
/// and distances, on some of the triplets. Cheap enough to ask of every answer. `None` when the data cannot tell.
pub fn suspected_clocks(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: &[f64; 3],
    distance_sigma_m: f64,
) -> Option<SuspectedClocks> {
    let stride = triplets.len().div_ceil(SUSPICION_TRIPLETS).max(1);
    let data = MovingTriplets::every(triplets, stride);
    let some = &data.triplets;
    let state = start(plain, inter_prism_m);
    let settings = CalibrationSettings {
        inter_prism_sigma_m: distance_sigma_m,
        estimate: Estimated { clocks: true, distances: true, tilt: false },
        ..CalibrationSettings::default()
    };
    let (places, mut precision) = (estimated(&settings), precisions(&settings));
    precision.fixed_rows_mut::<2>(DRIFTS).fill(JUMP_SIGMA_S.powi(-2));
    let noise =
        Noise::new(some, &plain.map(RigidTransform::from)).no_larger_than_residuals(&data, &state);
    let blocks = time_blocks::of(&some.time_s, &some.interval);
    // A few gross errors must not decide.
    let loss = Loss::Huber;
    let scale = loss_scale(&data, &state, &noise, loss);
    let sums = accumulate(&data, &state, &noise, loss, scale, &blocks);
    let lambda = prior_weight(&sums)?;
    let state = state - step(&sums.normal, &precision, lambda, &sums.gradient, &places)?;
    // What the clocks explained is no error any more.
    let scale = loss_scale(&data, &state, &noise, loss);
    let sums = accumulate(&data, &state, &noise, loss, scale, &blocks);
    let covariance = covariance(&sums, &precision, lambda, &places, distance_sigma_m)?;
    let estimate = |place: usize| Estimate {
        value: state[place],
        sigma: covariance[(place, place)].max(0.0).sqrt(),
    };
    Some(SuspectedClocks {
        offsets_s: [CLOCKS, CLOCKS + 1].map(estimate),
        jumps_s: [DRIFTS, DRIFTS + 1].map(estimate),
    })
}

/// Of stations 2 and 3.
pub struct SuspectedClocks {
    pub offsets_s: [Estimate; 2],
    /// How much later they are in the second half of the drive.
    pub jumps_s: [Estimate; 2],
}

/// Velocities of the three prisms at each triplet, each in its station's frame (m/s).
pub fn velocities_m_per_s(triplets: &Triplets) -> [Vec<Vector3<f64>>; 3] {
    model::velocities(triplets, 1)
}

/// The triplets as they would be had the clocks of stations 2 and 3 been right.
pub fn with_clocks(triplets: &Triplets, clocks: [Clock; 2]) -> Triplets {
    let data = MovingTriplets::all(triplets);
    let mut points_m = triplets.points_m.clone();
    for station in 1..3 {
        points_m[station] = (0..triplets.len())
            .map(|index| data.at_true_time(station, index, clocks[station - 1]))
            .collect();
    }
    Triplets { points_m, ..triplets.clone() }
}

fn start(plain: &[LevelTransform; 3], inter_prism_m: &[f64; 3]) -> State {
    let mut state = State::zeros();
    for slot in 0..2 {
        let transform = &plain[slot + 1];
        state.fixed_rows_mut::<3>(4 * slot).copy_from(&transform.translation_m);
        state[4 * slot + 3] = transform.yaw_rad;
    }
    state.fixed_rows_mut::<3>(DISTANCES).copy_from_slice(inter_prism_m);
    state
}

/// Places of the unknowns that are not held.
fn estimated(settings: &CalibrationSettings) -> Vec<usize> {
    let estimate = settings.estimate;
    let groups = [
        (true, 0..CLOCKS),
        (estimate.clocks, CLOCKS..DISTANCES),
        (estimate.distances, DISTANCES..TILTS),
        (estimate.tilt, TILTS..DRIFTS),
        (estimate.clocks, DRIFTS..CONSTANT),
        (estimate.distances, CONSTANT..UNKNOWNS),
    ];
    groups.into_iter().filter(|(on, _)| *on).flat_map(|(_, places)| places).collect()
}

/// 1/σ² of the priors; zero where nothing is known beforehand.
fn precisions(settings: &CalibrationSettings) -> State {
    let mut precision = State::zeros();
    // A distance known exactly is one that is hardly estimated.
    let distance_sigma_m = settings.inter_prism_sigma_m.max(1e-6);
    precision.fixed_rows_mut::<3>(DISTANCES).fill(distance_sigma_m.powi(-2));
    precision.fixed_rows_mut::<4>(TILTS).fill(TILT_SIGMA_RAD.powi(-2));
    precision.fixed_rows_mut::<2>(DRIFTS).fill(DRIFT_SIGMA.powi(-2));
    precision[CONSTANT] = PRISM_CONSTANT_SIGMA_M.powi(-2);
    precision
}

/// Sums over the triplets.
struct Sums {
    /// Σ w J Jᵀ with w = ψ(r)/r.
    normal: Matrix,
    /// Σ ψ'(r) J Jᵀ.
    hessian: Matrix,
    /// Σ ψ(r) J, less what noise alone makes of it.
    gradient: State,
    /// What noise alone makes of it.
    by_noise: State,
    /// Σ over blocks of the outer products of their gradients.
    middle: Matrix,
    blocks: usize,
}

impl Sums {
    fn zeros(blocks: usize) -> Self {
        Self {
            normal: Matrix::zeros(),
            hessian: Matrix::zeros(),
            gradient: State::zeros(),
            by_noise: State::zeros(),
            middle: Matrix::zeros(),
            blocks,
        }
    }
}

fn accumulate(
    data: &MovingTriplets<'_>,
    state: &State,
    noise: &Noise,
    loss: Loss,
    scale: Option<f64>,
    blocks: &[std::ops::Range<usize>],
) -> Sums {
    let placed = transforms(state);
    let mut sums = Sums::zeros(blocks.len());
    for block in blocks {
        let (mut pull, mut by_noise) = (State::zeros(), State::zeros());
        for index in block.clone() {
            let found = distances(data, index, state, &placed);
            for pair in 0..3 {
                let stated = noise.weights[index][pair];
                let residual = found.residual_m[pair];
                let size = residual.abs() * stated.sqrt();
                let (weight, slope) = robust_weight(loss, size, scale);
                let (weight, slope) = (stated * weight, stated * slope);
                let derivative = &found.derivative[pair];
                sums.normal.ger(weight, derivative, derivative, 1.0);
                sums.hessian.ger(slope, derivative, derivative, 1.0);
                pull += weight * residual * derivative;
                by_noise += slope * found.noise_pull(pair, &noise.covariance_m2[index][pair]);
            }
        }
        pull -= by_noise;
        sums.by_noise += by_noise;
        sums.gradient += pull;
        sums.middle.ger(1.0, &pull, &pull, 1.0);
    }
    sums
}

/// ψ(x)/x and ψ'(x) of the loss at an error of this size.
fn robust_weight(loss: Loss, size: f64, scale: Option<f64>) -> (f64, f64) {
    match (loss, scale) {
        (Loss::Cauchy, Some(scale)) => {
            let square = (size / scale.max(1e-12)).powi(2);
            let weight = 1.0 / (1.0 + square);
            (weight, (1.0 - square) * weight * weight)
        }
        (Loss::Huber, Some(scale)) if size > scale => (scale / size, 0.0),
        _ => (1.0, 1.0),
    }
}

/// λ of the module's documentation; `None` when the transforms are not held by the data.
fn prior_weight(sums: &Sums) -> Option<f64> {
    let hessian = sums.hessian.fixed_view::<8, 8>(0, 0).into_owned();
    let middle = sums.middle.fixed_view::<8, 8>(0, 0);
    let inverse = hessian.cholesky()?.inverse();
    Some(((inverse * middle).trace() / 8.0).max(f64::MIN_POSITIVE))
}

fn reduced(matrix: &Matrix, places: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(places.len(), places.len(), |i, j| matrix[(places[i], places[j])])
}

/// The step of the estimated unknowns, zero for the held ones; `None` where the matrix has no minimum.
fn step(
    matrix: &Matrix,
    precision: &State,
    lambda: f64,
    gradient: &State,
    places: &[usize],
) -> Option<State> {
    let matrix = matrix + Matrix::from_diagonal(&(lambda * precision));
    let right = DVector::from_iterator(places.len(), places.iter().map(|place| gradient[*place]));
    let step = reduced(&matrix, places).cholesky()?.solve(&right);
    let mut full = State::zeros();
    for (place, value) in places.iter().zip(&step) {
        full[*place] = *value;
    }
    full.iter().all(|value| value.is_finite()).then_some(full)
}

/// Of the estimated unknowns. Distances and tilts that are not estimated are not known exactly either: their σ is
/// propagated, since an error of theirs acts on every triplet alike and no residual shows it.
fn covariance(
    sums: &Sums,
    precision: &State,
    lambda: f64,
    places: &[usize],
    distance_sigma_m: f64,
) -> Option<Matrix> {
    let priors = Matrix::from_diagonal(&(lambda * precision));
    let inverse = reduced(&(sums.hessian + priors), places).cholesky()?.inverse();
    // Residuals are smaller than errors by what was fitted to them.
    let freedom = sums.blocks.saturating_sub(places.len()).max(1) as f64;
    let middle = sums.middle * (sums.blocks as f64 / freedom) + lambda * priors;
    let mut small = &inverse * reduced(&middle, places) * &inverse;
    let held = (DISTANCES..DRIFTS).chain([CONSTANT]).filter(|place| !places.contains(place));
    for held in held {
        let sigma = match held {
            CONSTANT => PRISM_CONSTANT_SIGMA_M,
            TILTS.. => TILT_SIGMA_RAD,
            _ => distance_sigma_m,
        };
        let pull = places.iter().map(|place| sums.hessian[(*place, held)]);
        let moved = &inverse * DVector::from_iterator(places.len(), pull) * sigma;
        small += &moved * moved.transpose();
    }
    let by_noise = places.iter().map(|place| sums.by_noise[*place]);
    let moved = &inverse * DVector::from_iterator(places.len(), by_noise) * NOISE_SHARE_SIGMA;
    small += &moved * moved.transpose();
    let mut full = Matrix::zeros();
    for (i, row) in places.iter().enumerate() {
        for (j, column) in places.iter().enumerate() {
            full[(*row, *column)] = small[(i, j)];
        }
    }
    full.iter().all(|entry| entry.is_finite()).then_some(full)
}

fn summary(
    state: &State,
    start: &State,
    covariance: &Matrix,
    settings: &CalibrationSettings,
    converged: bool,
) -> Refinement {
    let sigma = |place: usize| covariance[(place, place)].max(0.0).sqrt();
    let estimate = |place: usize| Estimate { value: state[place], sigma: sigma(place) };
    let chosen = settings.estimate;
    Refinement {
        station1_from_station: transforms(state),
        sigma: [0, 4].map(|at| TransformSigma {
            translation_m: Vector3::new(sigma(at), sigma(at + 1), sigma(at + 2)),
            yaw_rad: sigma(at + 3),
        }),
        covariance: covariance.fixed_view::<8, 8>(0, 0).into_owned(),
        clock_offsets_s: chosen.clocks.then(|| [0, 1].map(|slot| estimate(CLOCKS + slot))),
        prism_constant_error_m: chosen.distances.then(|| estimate(CONSTANT)),
        clock_drifts: chosen.clocks.then(|| [0, 1].map(|slot| estimate(DRIFTS + slot))),
        distances_m: chosen.distances.then(|| [0, 1, 2].map(|pair| estimate(DISTANCES + pair))),
        tilts_rad: chosen
            .tilt
            .then(|| [0, 1].map(|slot| [0, 1].map(|axis| estimate(TILTS + 2 * slot + axis)))),
        moves_sigmas: std::array::from_fn(|place| estimate(place).sigmas_from(start[place])),
        joint: None,
        support: support(state, start, covariance, chosen),
        converged,
    }
}

/// 99 % of χ² with one to six degrees of freedom.
const CHI_SQUARE_99: [f64; 6] = [6.635, 9.210, 11.345, 13.277, 15.086, 16.812];

fn support(state: &State, start: &State, covariance: &Matrix, chosen: Estimated) -> Vec<Support> {
    let groups: [(bool, &str, &[usize]); 4] = [
        (chosen.clocks, "clock offsets", &[CLOCKS, CLOCKS + 1]),
        (chosen.clocks, "clock drifts", &[DRIFTS, DRIFTS + 1]),
        (chosen.distances, "inter-prism distances", &[DISTANCES, DISTANCES + 1, DISTANCES + 2]),
        (chosen.tilt, "tilts", &[TILTS, TILTS + 1, TILTS + 2, TILTS + 3]),
    ];
    let wald = |what: &'static str, places: &[usize]| {
        let off =
            DVector::from_iterator(places.len(), places.iter().map(|p| state[*p] - start[*p]));
        let solved = reduced(covariance, places).cholesky()?.solve(&off);
        let (chi_square, unknowns) = (off.dot(&solved), places.len());
        let supported = chi_square > CHI_SQUARE_99[unknowns - 1];
        Some(Support { what, chi_square, unknowns, supported })
    };
    groups.into_iter().filter(|g| g.0).filter_map(|(_, what, places)| wald(what, places)).collect()
}
