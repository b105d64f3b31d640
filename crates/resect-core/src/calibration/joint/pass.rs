//! One step of Gauss & Newton: everything linear about where it is taken to be, and the way from there.

use std::mem::take;
use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;

use super::band::{Band, Part, PartVector, Rows};
use super::chain::{Columns, Data, Linear};
use super::chain_factor::Factor;
use super::drive::Drive;
use super::equations::{Squares, Weighing, equations};
use super::gradients::gradients;
use super::moves::Moves;
use super::observed::{At, Levels, Piece};
use super::slow_priors::{SlowPrecisions, SlowPriors};
use super::unknowns::{Constants, DISTANCES, Slow, Station};
use crate::pipeline::Triplets;
use crate::progress::{Cancelled, Progress};

/// Everything unknown.
#[derive(Clone, Debug)]
pub struct Estimates {
    pub constants: Constants,
    pub slow: Vec<Slow>,
    /// Coefficients of the splines: x, y, z of each prism by knot, for each stretch (m).
    pub coefficients_m: Vec<Vec<f64>>,
}

impl Estimates {
    pub fn start(drive: &Drive, triplets: &Triplets, constants: &Constants, prisms: usize) -> Self {
        let stations = [0, 1, 2].map(|station| Station::of(constants, station));
        Self {
            constants: *constants,
            slow: vec![Slow::zeros(); drive.outlooks.len()],
            coefficients_m: drive.coefficients_m(triplets, &stations, prisms),
        }
    }
}

/// What is known beforehand.
#[derive(Clone, Debug)]
pub struct Model {
    pub precision: Constants,
    pub start: Constants,
    pub priors: SlowPriors,
}

/// What equations count by; the weights are by stretch.
#[derive(Clone, Debug)]
pub struct Weigh {
    pub levels: Levels,
    pub redundancy: f64,
    pub held: Option<Vec<Vec<f64>>>,
}

/// Room for the rows of each stretch, used again by the next pass: to ask for new memory takes as long as to fill it.
pub type Spare<const LOCAL: usize, const ROW: usize> = Vec<Rows<LOCAL, ROW>>;

/// One stretch, eliminated; of a long drive without the rows of its band.
pub struct Eliminated<const LOCAL: usize, const ROW: usize> {
    pub band: Band<LOCAL, ROW>,
    pub squares: Squares,
    pub weights: Vec<f64>,
}

/// Everything linear about some estimates, and the step from there.
pub struct Pass<const LOCAL: usize, const ROW: usize> {
    pub eliminated: Vec<Eliminated<LOCAL, ROW>>,
    pub linear: Linear,
    pub slow_priors: SlowPrecisions,
    pub factor: Factor,
    pub step: Columns<1>,
    /// The square of the step in units of the data's covariance; what decides whether it was the last.
    pub moved: f64,
}

/// `None` where a direction stays free.
pub fn pass<const LOCAL: usize, const ROW: usize>(
    drive: &Arc<Drive>,
    at: &Estimates,
    by: &Weigh,
    model: &Model,
    spare: &mut Spare<LOCAL, ROW>,
    progress: &Progress,
) -> Result<Option<Pass<LOCAL, ROW>>, Cancelled> {
    let moves = Moves::about(drive, &at.constants);
    let around = Around::new(drive, at, &moves);
    let kept = drive.kept_pieces();
    spare.resize_with(drive.pieces.len(), Rows::default);
    let one = |passing: &mut Rows<LOCAL, ROW>, (index, own): (usize, &mut Rows<LOCAL, ROW>)| {
        progress.check()?;
        let rows = if index < kept { own } else { passing };
        let (piece, at) = around.stretch::<LOCAL>(index);
        let held = by.held.as_ref().map(|held| &held[index][..]);
        let mut found = eliminate(piece, &at, by, held, take(rows));
        if let Some(found) = found.as_mut().filter(|_| index >= kept) {
            *rows = found.band.take_rows();
        }
        Ok(found)
    };
    let spare = spare.par_iter_mut().enumerate();
    let all: Result<Vec<_>, Cancelled> = spare.map_init(Rows::default, one).collect();
    let Some(mut eliminated) = all?.into_iter().collect::<Option<Vec<_>>>() else {
        return Ok(None);
    };
    let mut parts: Vec<Part> = Vec::with_capacity(drive.part_times_s.len());
    eliminated.iter_mut().for_each(|one| parts.extend(take(&mut one.band.parts)));
    let data = Data::new(parts, moves);
    let gradient = data.gradient(data.gradients());
    let linear = Linear { data: Arc::new(data), gradient };
    progress.check()?;
    let found = solved(&linear, drive, at, model);
    Ok(found.map(|Solved { slow_priors, factor, step, moved }| Pass {
        eliminated,
        linear,
        slow_priors,
        factor,
        step,
        moved,
    }))
}

/// What is linear with the priors, solved.
struct Solved {
    slow_priors: SlowPrecisions,
    factor: Factor,
    step: Columns<1>,
    moved: f64,
}

fn solved(linear: &Linear, drive: &Drive, at: &Estimates, model: &Model) -> Option<Solved> {
    let slow_priors = SlowPrecisions::new(&model.priors, &drive.part_times_s)?;
    // On the way, what is slow may have to wait until the motion is known better.
    let by = |slow_precisions: &SlowPrecisions| {
        let right = with_priors(linear, model, &slow_priors, at);
        Factor::new(&linear.data, &model.precision, slow_precisions, right)
    };
    let (factor, step) = by(&slow_priors).or_else(|| by(&slow_priors.stiffer()))?;
    let moved = moved(&factor, &step, &with_priors(linear, model, &slow_priors, at), model);
    Some(Solved { slow_priors, factor, step, moved })
}

impl<const LOCAL: usize, const ROW: usize> Pass<LOCAL, ROW> {
    pub fn squares(&self) -> Squares {
        let mut squares = Squares::default();
        self.eliminated.iter().for_each(|one| squares.add(&one.squares));
        squares
    }

    /// The room that it took.
    pub fn spare(self) -> Spare<LOCAL, ROW> {
        self.eliminated.into_iter().map(|one| one.band.into_rows()).collect()
    }

    /// Solves the same equations again with other priors; `false` where a direction stays free.
    pub fn solve(&mut self, drive: &Drive, at: &Estimates, model: &Model) -> bool {
        let found = solved(&self.linear, drive, at, model);
        let is_held = found.is_some();
        if let Some(Solved { slow_priors, factor, step, moved }) = found {
            (self.slow_priors, self.factor) = (slow_priors, factor);
            (self.step, self.moved) = (step, moved);
        }
        is_held
    }

    /// The step from a place nearby, where all that is linear is about as it was: by the gradients there alone.
    pub fn turn_to(
        &mut self,
        drive: &Drive,
        at: &Estimates,
        levels: &Levels,
        model: &Model,
        progress: &Progress,
    ) -> Result<(), Cancelled> {
        let around = Around::new(drive, at, &self.linear.data.moves);
        let one = |(index, own): (usize, &mut Eliminated<LOCAL, ROW>)| {
            progress.check()?;
            let (piece, at) = around.stretch::<LOCAL>(index);
            let found = gradients::<LOCAL>(piece, &at, levels, &own.weights);
            Ok(own.band.exchange_gradient(found.local, found.parts))
        };
        let stretches = self.eliminated.par_iter_mut().enumerate();
        let of_parts: Result<Vec<Vec<PartVector>>, Cancelled> = stretches.map(one).collect();
        self.linear.gradient = self.linear.data.gradient(of_parts?.into_iter().flatten());
        let right = with_priors(&self.linear, model, &self.slow_priors, at);
        self.step = self.factor.solve(right.clone());
        self.moved = moved(&self.factor, &self.step, &right, model);
        Ok(())
    }

    /// How far the step moves any of the constants (σ).
    pub fn longest_move(&self) -> f64 {
        let variance = self.factor.of_constants().diagonal();
        self.step
            .constants
            .zip_map(&variance, |step, variance| step.powi(2) / variance)
            .max()
            .sqrt()
    }

    /// Shows the eliminated motion of each stretch; `None` where one that was not kept cannot be made again.
    pub fn with_bands<T: Send>(
        &self,
        drive: &Drive,
        at: &Estimates,
        levels: &Levels,
        show: impl Fn(usize, &Band<LOCAL, ROW>) -> T + Sync,
    ) -> Vec<Option<T>> {
        let around = Around::new(drive, at, &self.linear.data.moves);
        let by = Weigh { levels: *levels, redundancy: 1.0, held: None };
        let one = |rows: &mut Rows<LOCAL, ROW>, index: usize| {
            let one = &self.eliminated[index];
            if one.band.has_rows() {
                return Some(show(index, &one.band));
            }
            let (piece, at) = around.stretch::<LOCAL>(index);
            let found = eliminate(piece, &at, &by, Some(&one.weights), take(rows))?;
            let shown = show(index, &found.band);
            *rows = found.band.into_rows();
            Some(shown)
        };
        (0..drive.pieces.len()).into_par_iter().map_init(Rows::default, one).collect()
    }

    /// Takes the step. The rows of a stretch that were not kept are made again.
    pub fn walk(&self, drive: &Drive, at: &mut Estimates, levels: &Levels) {
        let step = &self.step;
        let of_part = |part: usize| -> PartVector {
            let (by_constants, by_slow) = self.linear.data.moves.of(part);
            by_constants * step.constants + by_slow * step.slow[part]
        };
        let mut all_m = take(&mut at.coefficients_m);
        let around = Around::new(drive, at, &self.linear.data.moves);
        // Weights are those of the pass, which settle nothing else.
        let by = Weigh { levels: *levels, redundancy: 1.0, held: None };
        let one = |rows: &mut Rows<LOCAL, ROW>, (index, own_m): (usize, &mut Vec<f64>)| {
            let one = &self.eliminated[index];
            let parts = around.first_parts[index]..around.first_parts[index + 1];
            let of_parts: Vec<PartVector> = parts.map(of_part).collect();
            let local = if one.band.has_rows() {
                one.band.local_step(&of_parts)
            } else {
                let (piece, at) = around.stretch_at::<LOCAL>(index, own_m);
                let found = eliminate(piece, &at, &by, Some(&one.weights), take(rows));
                // It was held when the same was eliminated before.
                let Some(found) = found else { return };
                let local = found.band.local_step(&of_parts);
                *rows = found.band.into_rows();
                local
            };
            own_m.iter_mut().zip(&local).for_each(|(value, step)| *value -= step);
        };
        all_m.par_iter_mut().enumerate().for_each_init(Rows::default, one);
        at.coefficients_m = all_m;
        at.constants -= step.constants;
        at.slow.iter_mut().zip(&step.slow).for_each(|(slow, step)| *slow -= step);
    }
}

/// One step of the motion alone, all else staying as it is, and what the errors before it tell of noise.
///
/// `None` where the motion is not held.
pub fn move_motion<const LOCAL: usize, const ROW: usize>(
    drive: &Arc<Drive>,
    at: &mut Estimates,
    by: &Weigh,
    progress: &Progress,
) -> Result<Option<Squares>, Cancelled> {
    let around = Around::new(drive, at, &Moves::about(drive, &at.constants));
    let one = |rows: &mut Rows<LOCAL, ROW>, index: usize| {
        progress.check()?;
        let (piece, at) = around.stretch::<LOCAL>(index);
        let held = by.held.as_ref().map(|held| &held[index][..]);
        let Some(found) = eliminate(piece, &at, by, held, take(rows)) else { return Ok(None) };
        let step = found.band.local_step(&[]);
        *rows = found.band.into_rows();
        Ok(Some((step, found.squares)))
    };
    let indices = (0..drive.pieces.len()).into_par_iter();
    let all: Result<Vec<_>, Cancelled> = indices.map_init(Rows::default, one).collect();
    let Some(all) = all?.into_iter().collect::<Option<Vec<_>>>() else { return Ok(None) };
    let mut squares = Squares::default();
    for (coefficients_m, (step, own)) in at.coefficients_m.iter_mut().zip(&all) {
        coefficients_m.iter_mut().zip(step).for_each(|(value, step)| *value -= step);
        squares.add(own);
    }
    Ok(Some(squares))
}

/// Where everything is taken to be, for each stretch of a drive.
pub struct Around<'a> {
    pub drive: &'a Drive,
    pub at: &'a Estimates,
    stations: [Station; 3],
    slow: Vec<PartVector>,
    pub first_parts: Vec<usize>,
}

impl<'a> Around<'a> {
    pub fn new(drive: &'a Drive, at: &'a Estimates, moves: &Moves) -> Self {
        let parts = at.slow.iter().enumerate();
        Self {
            drive,
            at,
            stations: [0, 1, 2].map(|station| Station::of(&at.constants, station)),
            slow: parts.map(|(part, slow)| moves.of(part).1 * slow).collect(),
            first_parts: drive.first_parts(),
        }
    }

    fn stretch<const LOCAL: usize>(&self, index: usize) -> (&Piece, At<'_>) {
        self.stretch_at::<LOCAL>(index, &self.at.coefficients_m[index])
    }

    /// With these coefficients of its splines (m).
    fn stretch_at<'b, const LOCAL: usize>(
        &'b self,
        index: usize,
        coefficients_m: &'b [f64],
    ) -> (&'b Piece, At<'b>) {
        let piece = &self.drive.pieces[index];
        let parts = self.first_parts[index]..self.first_parts[index + 1];
        (piece, self.parts_at::<LOCAL>(piece, parts, coefficients_m))
    }

    /// Of a piece with these parts of the drive.
    pub fn parts_at<'b, const LOCAL: usize>(
        &'b self,
        piece: &Piece,
        parts: Range<usize>,
        coefficients_m: &'b [f64],
    ) -> At<'b> {
        let distances = self.at.constants.fixed_rows::<3>(DISTANCES);
        At {
            stations: &self.stations,
            distances_m: (LOCAL == 9).then(|| [distances[0], distances[1], distances[2]]),
            middle_s: piece.middle_s,
            slow: &self.slow[parts],
            coefficients_m,
        }
    }
}

/// `None` where the motion is not held.
pub fn eliminate<const LOCAL: usize, const ROW: usize>(
    piece: &Piece,
    at: &At<'_>,
    by: &Weigh,
    held: Option<&[f64]>,
    rows: Rows<LOCAL, ROW>,
) -> Option<Eliminated<LOCAL, ROW>> {
    let weighing = Weighing { levels: by.levels, redundancy: by.redundancy, held };
    let mut found = equations(piece, at, &weighing, rows);
    let is_held = found.band.eliminate();
    found.squares.taken_up = found.band.taken_up;
    let (band, squares, weights) = (found.band, found.squares, found.weights);
    is_held.then_some(Eliminated { band, squares, weights })
}

/// The gradient of everything but the motion.
pub fn with_priors(
    linear: &Linear,
    model: &Model,
    slow_priors: &SlowPrecisions,
    at: &Estimates,
) -> Columns<1> {
    let mut gradient = linear.gradient.clone();
    gradient.constants += pulled_constants(model, at);
    for (part, slow) in gradient.slow.iter_mut().enumerate() {
        *slow += slow_priors.pull(&at.slow, part);
    }
    gradient
}

/// The square `xᵀHx` of a step x in the data's normal matrix H, from its right-hand side `(H + P)x` less the priors' `Px`.
fn moved(factor: &Factor, step: &Columns<1>, right: &Columns<1>, model: &Model) -> f64 {
    let by_data = right.constants - model.precision.component_mul(&step.constants);
    let of_part = |(part, slow): (usize, &Slow)| {
        slow.dot(&(right.slow[part] - factor.priors.pull(&step.slow, part)))
    };
    step.constants.dot(&by_data) + step.slow.iter().enumerate().map(of_part).sum::<f64>()
}

/// How the priors pull at the constants.
pub fn pulled_constants(model: &Model, at: &Estimates) -> Constants {
    model.precision.component_mul(&(at.constants - model.start))
}
