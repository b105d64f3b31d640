//! One step of Gauss & Newton: everything linear about where it is taken to be, and the way from there.

use std::mem::take;

use rayon::prelude::*;

use super::band::{Band, PartVector, Rows};
use super::chain::{Columns, Data, Link};
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
    pub moves: Moves,
    pub data: Data,
    pub slow_priors: SlowPrecisions,
    pub factor: Factor,
    pub step: Columns<1>,
}

/// `None` where a direction stays free.
pub fn pass<const LOCAL: usize, const ROW: usize>(
    drive: &Drive,
    at: &Estimates,
    by: &Weigh,
    model: &Model,
    spare: &mut Spare<LOCAL, ROW>,
    progress: &Progress,
) -> Result<Option<Pass<LOCAL, ROW>>, Cancelled> {
    let moves = Moves::about(&at.constants);
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
    let parts = eliminated.iter().flat_map(|one| &one.band.parts);
    let links: Vec<_> = parts
        .zip(&drive.tied_to_next)
        .map(|(part, tied_to_next)| Link { part, tied_to_next: *tied_to_next })
        .collect();
    let data = Data::of(&links, |part| moves.of(drive, part));
    drop(links);
    eliminated[kept..].iter_mut().for_each(|one| one.band.parts = Vec::new());
    progress.check()?;
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
        let found = solved(&self.data, drive, at, model);
        let is_held = found.is_some();
        if let Some((slow_priors, factor, step)) = found {
            (self.slow_priors, self.factor, self.step) = (slow_priors, factor, step);
        }
        is_held
    }

    /// Gives the room of the solution away, which [`Self::solve`] makes anew.
    pub fn forget_solution(&mut self) {
        self.factor.forget();
        self.slow_priors.forget();
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
        let around = Around::new(drive, at, &self.moves);
        let one = |(index, own): (usize, &mut Eliminated<LOCAL, ROW>)| {
            progress.check()?;
            let (piece, at) = around.stretch::<LOCAL>(index);
            let found = gradients::<LOCAL>(piece, &at, levels, &own.weights);
            own.band.exchange_gradient(found.local, found.parts);
            Ok(())
        };
        self.eliminated.par_iter_mut().enumerate().try_for_each(one)?;
        let parts = self.eliminated.iter().flat_map(|one| &one.band.parts);
        let pulls = parts.enumerate().map(|(index, part)| {
            let (by_constants, by_slow) = self.moves.of(drive, index);
            (by_slow.tr_mul(&part.gradient), by_constants.tr_mul(&part.gradient))
        });
        self.data.exchange_gradient(pulls);
        self.step = self.factor.solve(&with_priors(&self.data, model, &self.slow_priors, at));
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
        let around = Around::new(drive, at, &self.moves);
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

    /// Takes the step; its square in units of the covariance. The rows of a stretch that were not kept are made again.
    pub fn walk(&self, drive: &Drive, at: &mut Estimates, levels: &Levels) -> f64 {
        let step = &self.step;
        let of_part = |part: usize| -> PartVector {
            let (by_constants, by_slow) = self.moves.of(drive, part);
            by_constants * step.constants + by_slow * step.slow[part]
        };
        let mut all_m = take(&mut at.coefficients_m);
        let around = Around::new(drive, at, &self.moves);
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
        step.dot(&self.data.times(step))[0]
    }
}

/// One step of the motion alone, all else staying as it is, and what the errors before it tell of noise.
///
/// `None` where the motion is not held.
pub fn move_motion<const LOCAL: usize, const ROW: usize>(
    drive: &Drive,
    at: &mut Estimates,
    by: &Weigh,
    progress: &Progress,
) -> Result<Option<Squares>, Cancelled> {
    let around = Around::new(drive, at, &Moves::about(&at.constants));
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
struct Around<'a> {
    drive: &'a Drive,
    at: &'a Estimates,
    stations: [Station; 3],
    slow: Vec<PartVector>,
    first_parts: Vec<usize>,
}

impl<'a> Around<'a> {
    fn new(drive: &'a Drive, at: &'a Estimates, moves: &Moves) -> Self {
        let parts = at.slow.iter().enumerate();
        Self {
            drive,
            at,
            stations: [0, 1, 2].map(|station| Station::of(&at.constants, station)),
            slow: parts.map(|(part, slow)| moves.of(drive, part).1 * slow).collect(),
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
        let distances = self.at.constants.fixed_rows::<3>(DISTANCES);
        let at = At {
            stations: &self.stations,
            distances_m: (LOCAL == 9).then(|| [distances[0], distances[1], distances[2]]),
            middle_s: piece.middle_s,
            slow: &self.slow[self.first_parts[index]..self.first_parts[index + 1]],
            coefficients_m,
        };
        (piece, at)
    }
}

/// `None` where the motion is not held.
fn eliminate<const LOCAL: usize, const ROW: usize>(
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
