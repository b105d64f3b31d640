//! The joint estimate: motion, transforms, clocks, rig and the errors of the instruments, out of the readings themselves.
//!
//! Nothing is interpolated: the prisms move along splines that keep the rig's distances, and each reading counts by its
//! own noise (continuous-time batch estimation: Furgale, Barfoot & Sibley 2012). What instruments do wrong and the data may
//! not show is unknown as well, with a prior of its physical size ([`unknowns::ErrorSizes`]): it is estimated where the data
//! tells, and otherwise it widens σ.
//!
//! One step of Gauss & Newton: [`equations`] of each stretch → [`band`] eliminates the motion, which leaves a [`chain`] of
//! the drive's parts → constants and slow changes → and back. The noise of ranges, angles and stamps and the drive's
//! smoothness are learned on the way as Helmert's variance components, their redundancies by random probes (Girard 1989).

mod band;
mod chain;
mod corrected;
mod equations;
pub mod in_words;
mod motion;
mod stability;
mod unknowns;

use nalgebra::{Matrix4, SMatrix, SVector, Vector3};
use rayon::prelude::*;

use self::band::{BORDER, Band, PART, PartVector, TIED};
pub use self::chain::Wander;
use self::chain::{Columns, Data, Factor, Link, SlowPrecisions, SlowPriors};
pub use self::equations::Levels;
use self::equations::{
    At, OF_ANGLES, OF_JERKS, OF_RANGES, OF_STAMPS, Piece, Reading, Squares, Weighing, equations,
};
use self::motion::stretches;
pub use self::stability::{Step, Stepped};
pub use self::unknowns::ErrorSizes;
use self::unknowns::{
    CLOCKS, COLLIMATIONS, CONSTANTS, Constants, DISTANCES, DRIFTS, INDICES, LATENCIES, LEANS,
    OFFSETS, Outlook, SCALES, SLOW, Slow, Station, moves, precisions, start,
};
use super::TransformSigma;
use super::inter_prism::Estimate;
use crate::geometry::LevelTransform;
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

const MOST_STEPS: usize = 20;
/// What is slow is constant for about this long (s). Longer where the data holds a direction so weakly that a part's end
/// matters, and at last for as long as a stretch.
const PARTS_S: [f64; 3] = [6.0, 30.0, f64::INFINITY];
/// A step whose square is below this many of the answer's variances brings the motion near the readings.
const NEAR: f64 = 100.0;
/// Noise is learned from stretches of about so many knots, in so many steps.
const LEARNING_KNOTS: usize = 300;
const LEARNING_STEPS: usize = 9;
/// How far the published answer may be off meanwhile (1 σ).
const NEAR_M: f64 = 0.1;
const NEAR_RAD: f64 = 0.002;
/// A step whose square is this share of the answer's variances changes nothing that anyone can see.
const SMALL_STEP: f64 = 1e-3;
/// What is learned begins here: what is stated, and a motion that is free to follow the readings.
const FIRST_LEVELS: Levels =
    Levels { range: 1.0, angle_rad: equations::ANGLE_RAD, jitter_s: 0.001, jerk_m_per_s3: 1.0 };
/// No vehicle is smoother than this (m/s³), and no instrument ten times as good as it says.
const LEAST_JERK_M_PER_S3: f64 = 0.01;
const LEAST_NOISE_FACTOR: f64 = 0.1;
/// What Cauchy's weights leave of the mean square of three normal errors, over the mean weight.
const CONSISTENCY: f64 = 0.915;
const LEAST_JITTER_S: f64 = 1e-5;
const MOST_JITTER_S: f64 = 0.1;

/// Wanderings of ranges that are tried.
const WANDER_SIGMAS_M: [f64; 6] = [1e-4, 4e-4, 8e-4, 0.0014, 0.0025, 0.0045];
const WANDER_TIMES_S: [f64; 3] = [3.0, 12.0, 50.0];

/// Steps of stations and clocks that are looked for, at most.
const MOST_STEPS_FOUND: usize = 4;
/// A step this many times the size of what is usual is none of that.
const UNUSUAL: f64 = 4.0;
const LEAST_JUMP_S: f64 = 0.002;

/// What was found.
#[derive(Clone, Debug)]
pub struct JointEstimate {
    /// Level frames of the stations into station 1's, as they stood on average.
    pub station1_from_station: [LevelTransform; 3],
    /// Of (x, y, z, yaw) of stations 2 and 3 (m, rad).
    pub covariance: SMatrix<f64, 8, 8>,
    /// What each of these variances is made of.
    pub budget: Vec<(&'static str, SVector<f64, 8>)>,
    pub clock_offsets_s: [Estimate; 2],
    pub clock_drifts: [Estimate; 2],
    pub latencies_s: [Estimate; 3],
    pub distances_m: Option<[Estimate; 3]>,
    pub leans_rad: [[Estimate; 2]; 3],
    pub range_offsets_m: [Estimate; 3],
    pub range_scales: [Estimate; 3],
    pub indices_rad: [Estimate; 3],
    pub collimations_rad: [Estimate; 3],
    pub levels: Levels,
    pub wander: Wander,
    /// What was known of all that beforehand.
    pub sizes: ErrorSizes,
    /// Stations and clocks that did not stay as they were, the clearest first.
    pub stepped: Vec<Step>,
    pub converged: bool,
    pub steps: usize,
}

impl JointEstimate {
    pub fn sigma(&self) -> [TransformSigma; 2] {
        let sigma = self.covariance.diagonal().map(f64::sqrt);
        [0, 1].map(|slot| TransformSigma {
            translation_m: sigma.fixed_rows::<3>(4 * slot).into(),
            yaw_rad: sigma[4 * slot + 3],
        })
    }
}

/// Estimates everything from `plain` on, the answer of a published method. `inter_prism_m` is `None` where all stations
/// follow one prism. `Ok(None)` without readings, or where they leave a direction free.
pub fn estimate(
    triplets: &Triplets,
    plain: &[LevelTransform; 3],
    inter_prism_m: Option<&[f64; 3]>,
    sizes: &ErrorSizes,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    const RIG: usize = 9;
    const PRISM: usize = 3;
    let start = start(plain, inter_prism_m);
    for part_s in PARTS_S {
        let Some(drive) = Drive::new(triplets, part_s) else { return Ok(None) };
        let found = match inter_prism_m {
            Some(_) => {
                solve::<RIG, { TIED * RIG + BORDER }>(&drive, triplets, &start, sizes, progress)
            }
            None => {
                solve::<PRISM, { TIED * PRISM + BORDER }>(&drive, triplets, &start, sizes, progress)
            }
        }?;
        if found.is_some() {
            return Ok(found);
        }
    }
    Ok(None)
}

/// The readings of a drive, by stretch, and what its parts look like.
struct Drive {
    pieces: Vec<Piece>,
    /// By part, over all stretches.
    outlooks: Vec<[Outlook; 3]>,
    part_times_s: Vec<f64>,
    tied_to_next: Vec<bool>,
    middle_s: f64,
}

impl Drive {
    fn new(triplets: &Triplets, part_s: f64) -> Option<Self> {
        let (first_s, last_s) = (*triplets.time_s.first()?, *triplets.time_s.last()?);
        let knot_s =
            triplets.readings.iter().map(|track| median_step_s(&track.time_s)).fold(0.0, f64::max);
        if !(0.01..=2.0).contains(&knot_s) {
            return None;
        }
        let mut drive = Self {
            pieces: Vec::new(),
            outlooks: Vec::new(),
            part_times_s: Vec::new(),
            tied_to_next: Vec::new(),
            middle_s: 0.5 * (first_s + last_s),
        };
        for stretch in stretches(&triplets.time_s, &triplets.interval, knot_s, part_s) {
            let readings = triplets.readings.each_ref().map(|track| {
                let from = track.time_s.partition_point(|t| *t < stretch.start_s);
                let to = track.time_s.partition_point(|t| *t <= stretch.end_s);
                let both = track.time_s[from..to].iter().zip(&track.position_m[from..to]);
                both.map(|(time_s, point_m)| Reading::new(*time_s, point_m)).collect::<Vec<_>>()
            });
            if readings.iter().any(Vec::is_empty) {
                continue;
            }
            for part in 0..stretch.parts {
                drive.outlooks.push(readings.each_ref().map(|readings| {
                    let of_part = readings.iter().filter(|r| stretch.part(r.time_s) == part);
                    let all = readings.iter().map(|reading| reading.sight);
                    Outlook::over(of_part.map(|reading| reading.sight))
                        .or_else(|| Outlook::over(all))
                        .unwrap_or_default()
                }));
                drive.part_times_s.push(stretch.part_time_s(part));
                drive.tied_to_next.push(part + 1 < stretch.parts);
            }
            drive.pieces.push(Piece { stretch, readings });
        }
        (!drive.pieces.is_empty()).then_some(drive)
    }

    /// Every so many stretches, of about so many knots together.
    fn sample(&self, knots: usize) -> Self {
        let all: usize = self.pieces.iter().map(|piece| piece.stretch.knots).sum();
        let stride = (all / knots).max(1);
        let first_parts = self.first_parts();
        let taken: Vec<usize> = (stride / 2..self.pieces.len()).step_by(stride).collect();
        let parts = || taken.iter().flat_map(|index| first_parts[*index]..first_parts[*index + 1]);
        Self {
            pieces: taken.iter().map(|index| self.pieces[*index].clone()).collect(),
            outlooks: parts().map(|part| self.outlooks[part]).collect(),
            part_times_s: parts().map(|part| self.part_times_s[part]).collect(),
            tied_to_next: parts().map(|part| self.tied_to_next[part]).collect(),
            middle_s: self.middle_s,
        }
    }

    /// The first part of each stretch, and the number of all parts.
    fn first_parts(&self) -> Vec<usize> {
        let mut first = vec![0];
        for piece in &self.pieces {
            first.push(first[first.len() - 1] + piece.stretch.parts);
        }
        first
    }

    /// Splines through the triplets.
    fn coefficients_m(
        &self,
        triplets: &Triplets,
        plain: &[Station; 3],
        prisms: usize,
    ) -> Vec<Vec<f64>> {
        let of = |piece: &Piece| {
            let stretch = &piece.stretch;
            let mut coefficients_m = Vec::with_capacity(stretch.knots * 3 * prisms);
            for knot in 0..stretch.knots {
                let time_s = stretch.knot_time_s(knot).clamp(stretch.start_s, stretch.end_s);
                let after = triplets.time_s.partition_point(|t| *t < time_s);
                let at = after.min(triplets.len() - 1);
                for (prism, station) in plain.iter().enumerate().take(prisms) {
                    let point_m = station.turn * triplets.points_m[prism][at] + station.place_m;
                    coefficients_m.extend(point_m.iter());
                }
            }
            coefficients_m
        };
        self.pieces.iter().map(of).collect()
    }
}

/// Everything unknown.
#[derive(Clone)]
struct Estimates {
    constants: Constants,
    slow: Vec<Slow>,
    /// By stretch.
    coefficients_m: Vec<Vec<f64>>,
}

/// One stretch, eliminated.
struct Eliminated<const LOCAL: usize, const ROW: usize> {
    band: Band<LOCAL, ROW>,
    squares: Squares,
    weights: Vec<f64>,
}

fn solve<const LOCAL: usize, const ROW: usize>(
    drive: &Drive,
    triplets: &Triplets,
    start: &Constants,
    sizes: &ErrorSizes,
    progress: &Progress,
) -> Result<Option<JointEstimate>, Cancelled> {
    let model = Model {
        precision: precisions(sizes),
        start: *start,
        priors: SlowPriors {
            settling: settling(sizes, start),
            clocks_s2: sizes.clock_wander_s.powi(2),
            wander: Wander { sigma_m: WANDER_SIGMAS_M[0], correlation_s: WANDER_TIMES_S[1] },
            steps: Vec::new(),
        },
    };
    // How noisy the readings are is learned from a share of a long drive, and from all of a short one.
    let mut by = Weigh { levels: FIRST_LEVELS, redundancy: 0.5, held: None };
    let mut constants = *start;
    let sample = drive.sample(LEARNING_KNOTS);
    let mut at = Estimates::start(&sample, triplets, start, LOCAL / 3);
    let mut near = Model { priors: model.priors.clone(), ..model };
    // A share of the drive may leave open what the whole one holds.
    for place in 0..CLOCKS {
        let sigma = if place % 4 == 3 { NEAR_RAD } else { NEAR_M };
        near.precision[place] = sigma.powi(-2);
    }
    for steps in 0..LEARNING_STEPS {
        let Some(pass) = pass::<LOCAL, ROW>(&sample, &at, &by, &near, progress)? else {
            return Ok(None);
        };
        // The first steps bring the motion to the readings; only then do errors tell of noise.
        if steps > 1 {
            (by.levels, by.redundancy) = learned(&by.levels, &pass.squares());
        }
        pass.walk(&sample, &mut at);
        constants = at.constants;
    }
    let model = &mut { model };
    at = Estimates::start(drive, triplets, &constants, LOCAL / 3);
    let mut stepped = Vec::new();
    // Whether the motion of all stretches is near its readings: only then do errors tell of anything else.
    let mut near = false;
    for steps in 1..=MOST_STEPS {
        let Some(mut pass) = pass::<LOCAL, ROW>(drive, &at, &by, model, progress)? else {
            return Ok(None);
        };
        let settles = near && by.held.is_none();
        if settles {
            if sizes.ranges_wander {
                model.priors.wander = likeliest(&pass.data, model, drive, &at);
            }
            stepped = steps_found(&pass.data, model, drive, &at, sizes);
            if !pass.solve(drive, &at, model) {
                return Ok(None);
            }
        }
        let moved = pass.walk(drive, &mut at);
        let converged = by.held.is_some() && moved < SMALL_STEP;
        if converged || steps == MOST_STEPS {
            let rig = LOCAL == 9;
            let mut found = pass.summary(model, &at, by.levels, sizes, rig);
            (found.stepped, found.converged, found.steps) = (stepped, converged, steps);
            return Ok(Some(found));
        }
        if settles {
            by.held = Some(pass.eliminated.into_iter().map(|one| one.weights).collect());
        }
        near |= moved < NEAR;
    }
    Ok(None)
}

/// What is known beforehand.
struct Model {
    precision: Constants,
    start: Constants,
    priors: SlowPriors,
}

impl Estimates {
    fn start(drive: &Drive, triplets: &Triplets, constants: &Constants, prisms: usize) -> Self {
        let stations = [0, 1, 2].map(|station| Station::of(constants, station));
        Self {
            constants: *constants,
            slow: vec![Slow::zeros(); drive.outlooks.len()],
            coefficients_m: drive.coefficients_m(triplets, &stations, prisms),
        }
    }
}

/// Everything linear about some estimates, and the step from there.
struct Pass<const LOCAL: usize, const ROW: usize> {
    eliminated: Vec<Eliminated<LOCAL, ROW>>,
    moves: Vec<(SMatrix<f64, PART, CONSTANTS>, SMatrix<f64, PART, SLOW>)>,
    data: Data,
    slow_priors: SlowPrecisions,
    factor: Factor,
    step: Columns<1>,
}

/// `None` where a direction stays free.
fn pass<const LOCAL: usize, const ROW: usize>(
    drive: &Drive,
    at: &Estimates,
    by: &Weigh,
    model: &Model,
    progress: &Progress,
) -> Result<Option<Pass<LOCAL, ROW>>, Cancelled> {
    let stations = [0, 1, 2].map(|station| Station::of(&at.constants, station));
    let moves: Vec<_> = drive
        .outlooks
        .iter()
        .zip(&drive.part_times_s)
        .map(|(outlooks, time_s)| moves(&stations, outlooks, time_s - drive.middle_s))
        .collect();
    let Some(eliminated) = eliminate::<LOCAL, ROW>(drive, at, by, &moves, progress)? else {
        return Ok(None);
    };
    let parts = eliminated.iter().flat_map(|one| &one.band.parts);
    let links: Vec<_> = parts
        .zip(&moves)
        .zip(&drive.tied_to_next)
        .map(|((part, (by_constants, by_slow)), tied_to_next)| Link {
            part,
            tied_to_next: *tied_to_next,
            by_constants,
            by_slow,
        })
        .collect();
    let data = Data::of(&links);
    Ok(solved(&data, drive, at, model).map(|(slow_priors, factor, step)| Pass {
        eliminated,
        moves,
        data,
        slow_priors,
        factor,
        step,
    }))
}

fn solved(
    data: &Data,
    drive: &Drive,
    at: &Estimates,
    model: &Model,
) -> Option<(SlowPrecisions, Factor, Columns<1>)> {
    let slow_priors = SlowPrecisions::new(&model.priors, &drive.part_times_s)?;
    // On the way, what is slow may have to wait until the motion is known better.
    let factor = Factor::new(data, &model.precision, &slow_priors)
        .or_else(|| Factor::new(data, &model.precision, &slow_priors.stiffer()))?;
    let step = factor.solve(&with_priors(data, model, &slow_priors, at));
    Some((slow_priors, factor, step))
}

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    fn squares(&self) -> Squares {
        let mut squares = Squares::default();
        self.eliminated.iter().for_each(|one| squares.add(&one.squares));
        squares
    }

    /// Again with other priors.
    fn solve(&mut self, drive: &Drive, at: &Estimates, model: &Model) -> bool {
        let found = solved(&self.data, drive, at, model);
        let is_held = found.is_some();
        if let Some((slow_priors, factor, step)) = found {
            (self.slow_priors, self.factor, self.step) = (slow_priors, factor, step);
        }
        is_held
    }

    /// Takes the step; its square in units of the covariance.
    fn walk(&self, drive: &Drive, at: &mut Estimates) -> f64 {
        let step = &self.step;
        let of_parts: Vec<PartVector> = self
            .moves
            .iter()
            .zip(&step.slow)
            .map(|((by_constants, by_slow), slow)| by_constants * step.constants + by_slow * slow)
            .collect();
        at.constants -= step.constants;
        at.slow.iter_mut().zip(&step.slow).for_each(|(slow, step)| *slow -= step);
        let first_parts = drive.first_parts();
        at.coefficients_m.par_iter_mut().zip(&self.eliminated).enumerate().for_each(
            |(index, (coefficients_m, one))| {
                let parts = first_parts[index]..first_parts[index + 1];
                let local = one.band.local_step(&of_parts[parts]);
                coefficients_m.iter_mut().zip(&local).for_each(|(value, step)| *value -= step);
            },
        );
        step.dot(&self.data.times(step))[0]
    }
}

/// What equations count by; the weights are by stretch.
struct Weigh {
    levels: Levels,
    redundancy: f64,
    held: Option<Vec<Vec<f64>>>,
}

/// `None` where the motion is not held.
fn eliminate<const LOCAL: usize, const ROW: usize>(
    drive: &Drive,
    at: &Estimates,
    by: &Weigh,
    moves: &[(SMatrix<f64, PART, CONSTANTS>, SMatrix<f64, PART, SLOW>)],
    progress: &Progress,
) -> Result<Option<Vec<Eliminated<LOCAL, ROW>>>, Cancelled> {
    let stations = [0, 1, 2].map(|station| Station::of(&at.constants, station));
    let distances_m = (LOCAL == 9).then(|| {
        let distances = at.constants.fixed_rows::<3>(DISTANCES);
        [distances[0], distances[1], distances[2]]
    });
    let slow: Vec<PartVector> =
        moves.iter().zip(&at.slow).map(|((_, by_slow), slow)| by_slow * slow).collect();
    let first_parts = drive.first_parts();
    let one = |(index, piece): (usize, &Piece)| {
        progress.check()?;
        let here = At {
            stations: &stations,
            distances_m,
            middle_s: drive.middle_s,
            slow: &slow[first_parts[index]..first_parts[index + 1]],
            coefficients_m: &at.coefficients_m[index],
        };
        let held = by.held.as_ref().map(|held| &held[index][..]);
        let weighing = Weighing { levels: by.levels, redundancy: by.redundancy, held };
        let mut found = equations::<LOCAL, ROW>(piece, &here, &weighing);
        let is_held = found.band.eliminate();
        found.squares.taken_up = found.band.taken_up;
        let (band, squares, weights) = (found.band, found.squares, found.weights);
        Ok(is_held.then_some(Eliminated { band, squares, weights }))
    };
    let all: Result<Vec<_>, Cancelled> = drive.pieces.par_iter().enumerate().map(one).collect();
    Ok(all?.into_iter().collect())
}

/// The gradient of everything but the motion.
fn with_priors(
    data: &Data,
    model: &Model,
    slow_priors: &SlowPrecisions,
    at: &Estimates,
) -> Columns<1> {
    let mut gradient = data.gradient.clone();
    gradient.constants += model.precision.component_mul(&(at.constants - model.start));
    let pulls = slow_priors.times(&at.slow);
    gradient.slow.iter_mut().zip(&pulls).for_each(|(slow, pull)| *slow += pull);
    gradient
}

impl JointEstimate {
    /// Whether a step is one that instruments in the field are expected to make.
    pub fn is_usual(&self, step: &Step) -> bool {
        is_usual(step, &self.sizes)
    }
}

fn is_usual(step: &Step, sizes: &ErrorSizes) -> bool {
    match &step.what {
        Stepped::Clock(by_s) => by_s.value.abs() < LEAST_JUMP_S,
        Stepped::Station { turned_rad, .. } => {
            let moved_m = step.moved_m().map_or(0.0, |moved| moved.value);
            turned_rad.value.abs() < UNUSUAL * sizes.settling_rad
                && moved_m < UNUSUAL * sizes.settling_m
        }
    }
}

/// Steps of stations and clocks, the clearest first; what is none of the usual gets room in the priors.
fn steps_found(
    data: &Data,
    model: &mut Model,
    drive: &Drive,
    at: &Estimates,
    sizes: &ErrorSizes,
) -> Vec<Step> {
    let mut found = Vec::new();
    while found.len() < MOST_STEPS_FOUND {
        let step = stability::clearest_step(&stability::Search {
            data,
            precision: &model.precision,
            priors: &model.priors,
            part_times_s: &drive.part_times_s,
            slow: &at.slow,
            from_priors: &(at.constants - model.start),
            known: &model.priors.steps,
            places_m: [0, 1].map(|slot| at.constants.fixed_rows::<3>(4 * slot).into()),
        });
        let Some(step) = step else { break };
        let usual = is_usual(&step, sizes);
        if !usual {
            model.priors.steps.push(step.part);
        }
        found.push(step);
        if usual {
            break;
        }
    }
    found
}

/// The wandering of ranges that makes what was read likeliest, the motion being what it is.
fn likeliest(data: &Data, model: &Model, drive: &Drive, at: &Estimates) -> Wander {
    let unlikeliness = |wander: Wander| {
        let priors = SlowPriors { wander, ..model.priors.clone() };
        let slow_priors = SlowPrecisions::new(&priors, &drive.part_times_s)?;
        let factor = Factor::new(data, &model.precision, &slow_priors)?;
        let gradient = with_priors(data, model, &slow_priors, at);
        let pulls = slow_priors.times(&at.slow);
        let held: f64 = at.slow.iter().zip(&pulls).map(|(slow, pull)| slow.dot(pull)).sum();
        Some(factor.log_determinant + held - gradient.dot(&factor.solve(&gradient))[0])
    };
    let best = |all: &mut dyn Iterator<Item = Wander>, otherwise: Wander| {
        all.filter_map(|wander| Some((unlikeliness(wander)?, wander)))
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(otherwise, |(_, wander)| wander)
    };
    let correlation_s = model.priors.wander.correlation_s;
    let first = best(
        &mut WANDER_SIGMAS_M.into_iter().map(|sigma_m| Wander { sigma_m, correlation_s }),
        model.priors.wander,
    );
    best(
        &mut WANDER_TIMES_S.into_iter().map(|correlation_s| Wander { correlation_s, ..first }),
        first,
    )
}

/// Variance of how stations 2 and 3 walk against station 1, which walks as well.
fn settling(sizes: &ErrorSizes, start: &Constants) -> SMatrix<f64, 8, 8> {
    let own = SVector::<f64, 4>::new(
        sizes.settling_m.powi(2),
        sizes.settling_m.powi(2),
        sizes.settling_m.powi(2),
        sizes.settling_rad.powi(2),
    )
    .map(|variance| variance.max(1e-14));
    let mut by_first = SMatrix::<f64, 8, 4>::zeros();
    for slot in 0..2 {
        let place: Vector3<f64> = start.fixed_rows::<3>(4 * slot).into();
        let mut turned = Matrix4::identity();
        turned.fixed_view_mut::<3, 1>(0, 3).copy_from(&Vector3::z().cross(&place));
        by_first.fixed_rows_mut::<4>(4 * slot).copy_from(&-turned);
    }
    let both = SVector::<f64, 8>::from_fn(|k, _| own[k % 4]);
    SMatrix::from_diagonal(&both) + by_first * Matrix4::from_diagonal(&own) * by_first.transpose()
}

/// Noise levels out of the errors and their redundancies, and the mean redundancy of readings.
fn learned(levels: &Levels, squares: &Squares) -> (Levels, f64) {
    let left = |kind: usize| {
        let expected = squares.expected[kind];
        (expected - squares.taken_up[kind]).max(0.02 * expected)
    };
    let factor = |kind: usize| match squares.expected[kind] {
        expected if expected > 0.0 => (squares.found[kind] / (CONSISTENCY * left(kind))).sqrt(),
        _ => 1.0,
    };
    // The motion is hardly redundant where it is loosely held: expectation maximisation is slower and never astray.
    let jerks = squares.expected[OF_JERKS].max(1.0);
    let jerk_factor = ((squares.found[OF_JERKS] + squares.taken_up[OF_JERKS]) / jerks).sqrt();
    let least_rad = LEAST_NOISE_FACTOR * equations::ANGLE_RAD;
    // A kind that loses noise to another one gets some of it back the next time: half of each step ends that sooner.
    let levels = Levels {
        range: (levels.range * factor(OF_RANGES).sqrt()).max(LEAST_NOISE_FACTOR),
        angle_rad: (levels.angle_rad * factor(OF_ANGLES).sqrt()).max(least_rad),
        jitter_s: (levels.jitter_s * factor(OF_STAMPS).sqrt()).clamp(LEAST_JITTER_S, MOST_JITTER_S),
        jerk_m_per_s3: (levels.jerk_m_per_s3 * jerk_factor).max(LEAST_JERK_M_PER_S3),
    };
    let expected = squares.expected[OF_RANGES] + squares.expected[OF_ANGLES];
    (levels, ((left(OF_RANGES) + left(OF_ANGLES)) / expected.max(1e-9)).min(1.0))
}

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    /// `rig` is whether there are distances.
    fn summary(
        &self,
        model: &Model,
        at: &Estimates,
        levels: Levels,
        sizes: &ErrorSizes,
        rig: bool,
    ) -> JointEstimate {
        let parts = at.slow.len();
        // The answer: where the stations stood on average over the parts.
        let mut wanted = Columns::<8>::zeros(parts);
        for k in 0..8 {
            wanted.constants[(k, k)] = 1.0;
            wanted.slow.iter_mut().for_each(|slow| slow[(k, k)] = 1.0 / parts as f64);
        }
        let by = self.factor.solve(&wanted);
        let covariance = wanted.dot(&by);
        let mean = wanted.dot(&Columns::<1> { slow: at.slow.clone(), constants: at.constants });
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
                    unknowns::SLOW_RANGES.. => 2,
                    unknowns::SLOW_CLOCKS.. => 1,
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
        let mut each = Columns::<CONSTANTS>::zeros(parts);
        each.constants = SMatrix::identity();
        let constants = self.factor.solve(&each).constants;
        let estimate = |place: usize| Estimate {
            value: at.constants[place],
            sigma: constants[(place, place)].max(0.0).sqrt(),
        };
        JointEstimate {
            station1_from_station: [LevelTransform::IDENTITY, level(0), level(1)],
            covariance: covariance + stray,
            budget,
            clock_offsets_s: [0, 1].map(|slot| estimate(CLOCKS + slot)),
            clock_drifts: [0, 1].map(|slot| estimate(DRIFTS + slot)),
            latencies_s: [0, 1, 2].map(|station| estimate(LATENCIES + station)),
            distances_m: rig.then(|| [0, 1, 2].map(|pair| estimate(DISTANCES + pair))),
            leans_rad: [0, 1, 2]
                .map(|station| [0, 1].map(|axis| estimate(LEANS + 2 * station + axis))),
            range_offsets_m: [0, 1, 2].map(|station| estimate(OFFSETS + station)),
            range_scales: [0, 1, 2].map(|station| estimate(SCALES + station)),
            indices_rad: [0, 1, 2].map(|station| estimate(INDICES + station)),
            collimations_rad: [0, 1, 2].map(|station| estimate(COLLIMATIONS + station)),
            levels,
            wander: model.priors.wander,
            sizes: *sizes,
            stepped: Vec::new(),
            converged: false,
            steps: 0,
        }
    }
}

fn median_step_s(time_s: &[f64]) -> f64 {
    let mut steps_s: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    steps_s.sort_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).copied().unwrap_or(f64::NAN)
}
