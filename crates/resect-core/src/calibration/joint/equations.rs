//! What is observed, as equations of one stretch.

use nalgebra::{SMatrix, SVector, Vector3};

use super::band::{Band, Rows};
use super::band_rows::{PROBES, TIED};
use super::motion::Stretch;
use super::observed::{
    At, Levels, Piece, RIGID_M, Reading, Seen, apart, jerk_factors, jerks, knots_s,
};
use super::unknowns::PART_DISTANCES;
use crate::deployment::PAIRS;
use crate::statistics::robust::cauchy;

/// Errors that are together this many times what is usual count half (Cauchy's loss).
const LOSS_SCALE: f64 = 2.4;

/// What equations count by.
#[derive(Clone, Copy)]
pub struct Weighing<'a> {
    pub levels: Levels,
    /// The share of a reading's errors that the motion does not take up.
    pub redundancy: f64,
    /// The weights of readings and of knots in their order, once they have settled.
    pub held: Option<&'a [f64]>,
}

/// Squares of errors by what makes them, and what these would be on average if nothing were fitted to them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Squares {
    pub found: [f64; PROBES],
    pub expected: [f64; PROBES],
    /// Squares of errors that the motion has taken up.
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

/// The equations of a stretch about where everything is taken to be, in the room of earlier ones.
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
    /// Cauchy's, of an error of this many σ squared, unless weights are held.
    fn weight(&mut self, square: f64) -> f64 {
        let weight = match self.by.held {
            Some(held) => held[self.weights.len()],
            None => cauchy(square.sqrt(), LOSS_SCALE).weight,
        };
        self.weights.push(weight);
        weight
    }

    /// Range and two angles of a reading, whose stamp may be off.
    fn reading(&mut self, stretch: &Stretch, station: usize, reading: &Reading) {
        let seen = Seen::of::<LOCAL>(stretch, self.at, &self.by.levels, station, reading);
        let Seen { place, axes, errors, information, .. } = &seen;
        let at = 3 * seen.prism;
        let pulls = information * errors;
        let weight = self.weight(errors.dot(&pulls) / (3.0 * self.by.redundancy));

        // What of the errors is made by which noise.
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
            // By the square of the weight: what is far off must not count for how far off the others are.
            self.squares.found[kind] += (weight * pull.dot(errors)).powi(2);
            self.squares.expected[kind] += weight * weight * pull.dot(&axis);
            let values = axes * pull * (weight * self.signs.next());
            self.band.add_probe(place.first, at, &place.position, kind, &values);
        }
        let weighted = axes * information * axes.transpose() * weight;
        let pull = axes * pulls * weight;
        self.band.add(place.first, at, &place.position, &weighted, &pull);
        if !Band::<LOCAL, ROW>::HAS_PARTS {
            return;
        }
        let columns = seen.columns(station);
        for (i, (column, moved)) in columns.iter().flatten().enumerate() {
            let values = weighted * moved;
            self.band.add_border(place.first, at, &place.position, seen.part, *column, &values);
            let part = &mut self.band.parts[seen.part];
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

    /// Adds that the splines keep the distances of the rig, once a knot.
    fn distances(&mut self, stretch: &Stretch, distances_m: &[f64; 3]) {
        const PRISMS: usize = 9;
        let weight = RIGID_M.powi(-2);
        for time_s in knots_s(stretch) {
            let place = stretch.place(time_s);
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
                self.band.add_border(place.first, 0, &place.position, part, column, &values);
                let part = &mut self.band.parts[part];
                part.information[(column, column)] += weight;
                part.gradient[column] -= weight * error_m;
            }
            self.band.add(place.first, 0, &place.position, &information, &gradient);
        }
    }

    /// Adds that the motion is smooth: one equation a coordinate and knot.
    fn jerks(&mut self, stretch: &Stretch) {
        let factors = jerk_factors(stretch, &self.by.levels);
        for first in 0..stretch.knots - (TIED - 1) {
            let errors = jerks::<LOCAL>(self.at, first, &factors);
            // Vehicles start and stop.
            let square = errors.iter().map(|error| error * error).sum::<f64>();
            let weight = self.weight(square / LOCAL as f64);
            // Turns and stops count in full when it comes to how jerky a vehicle is: who leaves them out holds the motion
            // so stiffly that what the vehicle does looks like noise of stamps.
            self.squares.found[OF_JERKS] += square;
            self.squares.expected[OF_JERKS] += LOCAL as f64;
            if self.by.held.is_none() {
                let values = SVector::<f64, LOCAL>::from_fn(|_, _| self.signs.next());
                self.band.add_probe(first, 0, &factors, OF_JERKS, &values);
            }
            self.band.add_each(first, &factors, weight, &errors.map(|error| weight * error));
        }
    }
}

/// +1 and −1 by chance; the same every time (Steele, Lea & Flood 2014, "splitmix64").
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
