//! Normal equations of one stretch.

use nalgebra::{SMatrix, SVector, Vector3};

use super::band::{Band, KnotFactors, PartUnknown, Rows};
use super::band_rows::{PROBES, TIED};
use super::loss::robust_weight;
use super::motion::Stretch;
use super::observed::{
    At, Levels, Piece, RIGID_M, Reading, Seen, apart, jerk_factors, jerks, knots_s,
};
use super::unknowns::PART_DISTANCES;
use crate::deployment::PAIRS;

/// Noise levels and robust weights of the equations.
#[derive(Clone, Copy)]
pub struct Weighing<'a> {
    pub levels: Levels,
    /// Redundancy number of a reading: the share of its errors that the motion does not absorb.
    pub redundancy: f64,
    /// Fixed weights of readings and then of knots, in their order; `None` while they are re-estimated.
    pub held: Option<&'a [f64]>,
}

/// Sums of squared residuals by kind of noise, and their expectation before anything is fitted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Squares {
    pub found: [f64; PROBES],
    pub expected: [f64; PROBES],
    /// Squares that the motion has absorbed.
    pub taken_up: [f64; PROBES],
}

pub const OF_RANGES: usize = 0;
pub const OF_ANGLES: usize = 1;
pub const OF_STAMPS: usize = 2;
pub const OF_JERKS: usize = 3;

impl Squares {
    pub fn add(&mut self, other: &Self) {
        for kind in 0..PROBES {
            self.found[kind] += other.found[kind];
            self.expected[kind] += other.expected[kind];
            self.taken_up[kind] += other.taken_up[kind];
        }
    }
}

/// The equations of a stretch, not yet eliminated.
pub struct Equations<const LOCAL: usize, const ROW: usize> {
    pub band: Band<LOCAL, ROW>,
    pub squares: Squares,
    pub weights: Vec<f64>,
}

/// Linearises a stretch at the linearisation point; reuses the memory of `rows`.
pub fn equations<const LOCAL: usize, const ROW: usize>(
    piece: &Piece,
    at: &At<'_>,
    by: &Weighing<'_>,
    rows: Rows<LOCAL, ROW>,
) -> Equations<LOCAL, ROW> {
    let stretch = &piece.stretch;
    let mut building = Building::<LOCAL, ROW> {
        band: Band::new(rows, stretch.knots, stretch.first_knots()),
        squares: Squares::default(),
        weights: Vec::new(),
        at,
        by,
        signs: Signs(0x5eed),
    };
    for (station, readings) in piece.readings.iter().enumerate() {
        for reading in readings {
            building.reading(stretch, station, reading);
        }
    }
    if let Some(distances_m) = at.distances_m {
        building.distances(stretch, &distances_m);
    }
    building.jerks(stretch);
    Equations { band: building.band, squares: building.squares, weights: building.weights }
}

struct Building<'a, const LOCAL: usize, const ROW: usize> {
    band: Band<LOCAL, ROW>,
    squares: Squares,
    weights: Vec<f64>,
    at: &'a At<'a>,
    by: &'a Weighing<'a>,
    signs: Signs,
}

impl<const LOCAL: usize, const ROW: usize> Building<'_, LOCAL, ROW> {
    /// Returns the fixed weight, or Cauchy's of a squared error in σ².
    fn weight(&mut self, square: f64) -> f64 {
        let weight = match self.by.held {
            Some(held) => held[self.weights.len()],
            None => robust_weight(square),
        };
        self.weights.push(weight);
        weight
    }

    /// Adds range and two angles of a reading, with the noise of its stamp.
    fn reading(&mut self, stretch: &Stretch, station: usize, reading: &Reading) {
        let seen = Seen::of::<LOCAL>(stretch, self.at, &self.by.levels, station, reading);
        let Seen { place, axes, errors, information, part, .. } = &seen;
        let knots = KnotFactors { first: place.first, factors: &place.position };
        let at = 3 * seen.prism;
        let pulls = information * errors;
        let weight = self.weight(errors.dot(&pulls) / (3.0 * self.by.redundancy));

        // Directions of the noise sources.
        let kinds = [
            (OF_RANGES, Vector3::x() * seen.range_sigma_m),
            (OF_ANGLES, Vector3::y() * seen.across_sigma_m),
            (OF_ANGLES, Vector3::z() * seen.across_sigma_m),
            (OF_STAMPS, seen.jitter),
        ];
        for (kind, axis) in kinds {
            if self.by.held.is_some() {
                continue;
            }
            let pull = information * axis;
            // The weight is squared: outliers must not raise the noise level.
            self.squares.found[kind] += (weight * pull.dot(errors)).powi(2);
            self.squares.expected[kind] += weight * weight * pull.dot(&axis);
            let values = axes * pull * (weight * self.signs.next());
            self.band.add_probe(knots, at, kind, &values);
        }
        let weighted = axes * information * axes.transpose() * weight;
        let pull = axes * pulls * weight;
        self.band.add(knots, at, &weighted, &pull);
        if !Band::<LOCAL, ROW>::HAS_PARTS {
            return;
        }
        let columns = seen.columns(station);
        for (i, (column, moved)) in columns.iter().flatten().enumerate() {
            let values = weighted * moved;
            self.band.add_border(knots, at, PartUnknown { part: *part, column: *column }, &values);
            let part = &mut self.band.parts[*part];
            part.gradient[*column] += moved.dot(&pull);
            for (other, other_moved) in columns[..=i].iter().flatten() {
                let value = values.dot(other_moved);
                part.information[(*column, *other)] += value;
                if other != column {
                    part.information[(*other, *column)] += value;
                }
            }
        }
    }

    /// Adds the distances of the rig as constraints on the splines, once a knot.
    fn distances(&mut self, stretch: &Stretch, distances_m: &[f64; 3]) {
        const PRISMS: usize = 9;
        let weight = RIGID_M.powi(-2);
        for time_s in knots_s(stretch) {
            let place = stretch.place(time_s);
            let knots = KnotFactors { first: place.first, factors: &place.position };
            let part = stretch.part(time_s);
            let mut information = SMatrix::<f64, PRISMS, PRISMS>::zeros();
            let mut gradient = SVector::<f64, PRISMS>::zeros();
            for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
                let (along, error_m) = apart::<LOCAL>(self.at, &place, (a, b), distances_m[pair]);
                let mut row = SVector::<f64, PRISMS>::zeros();
                row.fixed_rows_mut::<3>(3 * a).copy_from(&along);
                row.fixed_rows_mut::<3>(3 * b).copy_from(&-along);
                information.ger(weight, &row, &row, 1.0);
                gradient.axpy(weight * error_m, &row, 1.0);
                if !Band::<LOCAL, ROW>::HAS_PARTS {
                    continue;
                }
                let column = PART_DISTANCES + pair;
                let values = row * -weight;
                self.band.add_border(knots, 0, PartUnknown { part, column }, &values);
                let part = &mut self.band.parts[part];
                part.information[(column, column)] += weight;
                part.gradient[column] -= weight * error_m;
            }
            self.band.add(knots, 0, &information, &gradient);
        }
    }

    /// Adds the smoothness prior of the motion: one equation a coordinate and knot.
    fn jerks(&mut self, stretch: &Stretch) {
        let factors = jerk_factors(stretch, &self.by.levels);
        for first in 0..stretch.knots - (TIED - 1) {
            let errors = jerks::<LOCAL>(self.at, first, &factors);
            let knots = KnotFactors { first, factors: &factors };
            // Vehicles start and stop.
            let square = errors.iter().map(|error| error * error).sum::<f64>();
            let weight = self.weight(square / LOCAL as f64);
            // Turns and stops are not down-weighted in the process noise: without them the motion is so stiff that the
            // vehicle's movements look like noise of stamps.
            self.squares.found[OF_JERKS] += square;
            self.squares.expected[OF_JERKS] += LOCAL as f64;
            if self.by.held.is_none() {
                let values = SVector::<f64, LOCAL>::from_fn(|_, _| self.signs.next());
                self.band.add_probe(knots, 0, OF_JERKS, &values);
            }
            self.band.add_each(knots, weight, &errors.map(|error| weight * error));
        }
    }
}

/// A reproducible random sequence of +1 and −1 (Steele, Lea & Flood 2014, "splitmix64").
struct Signs(u64);

impl Signs {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        if (z ^ (z >> 31)) & 1 == 0 { 1.0 } else { -1.0 }
    }
}
