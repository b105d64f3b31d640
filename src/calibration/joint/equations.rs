//! What is observed, as equations of one stretch: readings, the rig's distances, and how smooth a drive is.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::band::{Band, PROBES, PartVector, Rows, TIED};
use super::motion::{Place, Stretch};
use super::unknowns::{PART_DISTANCES, PART_LATE, PART_LATENCIES, Sight, Station};
use crate::deployment::PAIRS;
use crate::statistics::robust::cauchy;

/// How far the rig's distances vary from knot to knot (m, 1 σ): masts flex, and prisms are not seen in their very centre.
const RIGID_M: f64 = 0.00035;
/// The Trimble S7: 2 mm + 2 ppm, one arcsecond (Vaidis et al. 2022, "Experiments").
const RANGE_M: f64 = 0.002;
const RANGE_SHARE: f64 = 2e-6;
pub const ANGLE_RAD: f64 = std::f64::consts::PI / 180.0 / 3600.0;
/// Errors that are together this many times what is usual count half (Cauchy's loss).
const LOSS_SCALE: f64 = 2.4;

/// How well stations read, and how jerky a drive is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Levels {
    /// What the stated noise of a range is multiplied by.
    pub range: f64,
    /// One standard deviation of an angle (rad).
    pub angle_rad: f64,
    /// One standard deviation of a stamp (s).
    pub jitter_s: f64,
    /// Third derivative of the prisms' positions, 1 σ (m/s³).
    pub jerk_m_per_s3: f64,
}

impl Levels {
    /// One standard deviation of a range of no length (m).
    pub fn range_m(&self) -> f64 {
        self.range * RANGE_M
    }
}

/// One reading of one station.
#[derive(Clone, Debug)]
pub struct Reading {
    pub time_s: f64,
    pub sight: Sight,
}

impl Reading {
    pub fn new(time_s: f64, point_m: &Vector3<f64>) -> Self {
        Self { time_s, sight: Sight::at(point_m) }
    }
}

/// A stretch with its readings by station.
#[derive(Clone)]
pub struct Piece {
    pub stretch: Stretch,
    pub readings: [Vec<Reading>; 3],
    /// Drifts of clocks count from here (s).
    pub middle_s: f64,
}

/// Where everything is taken to be.
pub struct At<'a> {
    pub stations: &'a [Station; 3],
    /// Inter-prism distances (m); `None` where all stations follow one prism.
    pub distances_m: Option<[f64; 3]>,
    /// Drifts of clocks count from here (s).
    pub middle_s: f64,
    /// What is slow, by part of this stretch.
    pub slow: &'a [PartVector],
    /// Coefficients of the splines: x, y, z of each prism by knot (m).
    pub coefficients_m: &'a [f64],
}

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

/// What the same equations pull at, all weights being held.
pub struct Gradients<const LOCAL: usize> {
    /// Gradients of the splines' coefficients, by knot.
    pub local: Vec<[f64; LOCAL]>,
    /// Gradients of the parts' unknowns, by part of the stretch.
    pub parts: Vec<PartVector>,
}

/// The gradients of the equations of a stretch alone, where what is linear about them is known from a place nearby.
pub fn gradients<const LOCAL: usize>(
    piece: &Piece,
    at: &At<'_>,
    levels: &Levels,
    held: &[f64],
) -> Gradients<LOCAL> {
    let stretch = &piece.stretch;
    let mut found = Gradients {
        local: vec![[0.0; LOCAL]; stretch.knots],
        parts: vec![PartVector::zeros(); stretch.parts],
    };
    let mut held = held.iter();
    let mut weight = || held.next().copied().unwrap_or(1.0);
    for (station, readings) in piece.readings.iter().enumerate() {
        for reading in readings {
            let seen = Seen::of::<LOCAL>(stretch, at, levels, station, reading);
            let pull = seen.axes * (seen.information * seen.errors) * weight();
            for (k, share) in seen.place.position.iter().enumerate() {
                for axis in 0..3 {
                    found.local[seen.place.first + k][3 * seen.prism + axis] += share * pull[axis];
                }
            }
            for (column, moved) in seen.columns(station).into_iter().flatten() {
                found.parts[seen.part][column] += moved.dot(&pull);
            }
        }
    }
    if let Some(distances_m) = at.distances_m {
        for time_s in knots_s(stretch) {
            let place = stretch.place(time_s);
            let part = &mut found.parts[stretch.part(time_s)];
            for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
                let (along, error_m) = apart::<LOCAL>(at, &place, (a, b), distances_m[pair]);
                let pull = along * (error_m * RIGID_M.powi(-2));
                for (k, share) in place.position.iter().enumerate() {
                    let knot = &mut found.local[place.first + k];
                    for axis in 0..3 {
                        knot[3 * a + axis] += share * pull[axis];
                        knot[3 * b + axis] -= share * pull[axis];
                    }
                }
                part[PART_DISTANCES + pair] -= error_m * RIGID_M.powi(-2);
            }
        }
    }
    let factors = jerk_factors(stretch, levels);
    for first in 0..stretch.knots - (TIED - 1) {
        let errors = jerks::<LOCAL>(at, first, &factors);
        let weight = weight();
        for (k, factor) in factors.iter().enumerate() {
            for (pull, error) in found.local[first + k].iter_mut().zip(&errors) {
                *pull += weight * factor * error;
            }
        }
    }
    found
}

/// A reading about where everything is taken to be.
struct Seen {
    place: Place,
    part: usize,
    prism: usize,
    velocity: Vector3<f64>,
    across: Vector3<f64>,
    /// Directions along the sight, to its right, and up, as columns.
    axes: Matrix3<f64>,
    /// Errors of the spline over the reading, along these axes (m).
    errors: Vector3<f64>,
    /// Inverse covariance of these errors, and what it is made of.
    information: Matrix3<f64>,
    range_sigma_m: f64,
    across_sigma_m: f64,
    jitter: Vector3<f64>,
}

impl Seen {
    fn of<const LOCAL: usize>(
        stretch: &Stretch,
        at: &At<'_>,
        levels: &Levels,
        station: usize,
        reading: &Reading,
    ) -> Self {
        let own = &at.stations[station];
        let mut late_s = own.late_s + own.drift * (reading.time_s - at.middle_s);
        let part = stretch.part(reading.time_s - late_s);
        let slow = &at.slow[part];
        let mut placed = own.turn * own.corrected(&reading.sight) + own.place_m;
        if station > 0 {
            late_s += slow[PART_LATE + station - 1];
            placed += slow.fixed_rows::<3>(3 * (station - 1));
        }
        let prism = if LOCAL == 3 { 0 } else { station };
        let place = stretch.place(reading.time_s - late_s);
        let velocity = sum::<LOCAL>(at, &place, &place.velocity, prism);
        let sight = &reading.sight;
        let axes = own.turn * Matrix3::from_columns(&[sight.along, sight.side, sight.up]);
        let along = axes.column(0).into_owned();
        let across = velocity - along * along.dot(&velocity);
        let error =
            sum::<LOCAL>(at, &place, &place.position, prism) - across * own.latency_s - placed;

        let range_sigma_m = levels.range * (RANGE_M + RANGE_SHARE * sight.range_m);
        let across_sigma_m = levels.angle_rad * sight.range_m;
        let precision =
            Vector3::new(range_sigma_m.powi(-2), across_sigma_m.powi(-2), across_sigma_m.powi(-2));
        // Sherman & Morrison: a stamp that is off moves the reading along its velocity.
        let jitter = axes.tr_mul(&velocity) * levels.jitter_s;
        let spread = precision.component_mul(&jitter);
        let information = Matrix3::from_diagonal(&precision)
            - spread * spread.transpose() / (1.0 + spread.dot(&jitter));
        let errors = axes.tr_mul(&error);
        Self {
            place,
            part,
            prism,
            velocity,
            across,
            axes,
            errors,
            information,
            range_sigma_m,
            across_sigma_m,
            jitter,
        }
    }

    /// The unknowns of a part that move the error, with how they do.
    fn columns(&self, station: usize) -> [Option<(usize, Vector3<f64>)>; 5] {
        let latency = Some((PART_LATENCIES + station, -self.across));
        let Some(slot) = station.checked_sub(1) else { return [latency, None, None, None, None] };
        [
            latency,
            Some((3 * slot, -Vector3::x())),
            Some((3 * slot + 1, -Vector3::y())),
            Some((3 * slot + 2, -Vector3::z())),
            Some((PART_LATE + slot, -self.velocity)),
        ]
    }
}

/// What the knots of a prism add up to (m, or m/s).
fn sum<const LOCAL: usize>(
    at: &At<'_>,
    place: &Place,
    weights: &[f64; TIED],
    prism: usize,
) -> Vector3<f64> {
    let mut sum = Vector3::zeros();
    for (k, weight) in weights.iter().enumerate() {
        let at_knot = LOCAL * (place.first + k) + 3 * prism;
        sum += *weight * Vector3::from_column_slice(&at.coefficients_m[at_knot..at_knot + 3]);
    }
    sum
}

/// When the rig's distances are asked for: once a knot (s).
fn knots_s(stretch: &Stretch) -> impl Iterator<Item = f64> + use<> {
    let (start_s, end_s, knot_s) = (stretch.start_s, stretch.end_s, stretch.knot_s);
    let steps = ((end_s - start_s) / knot_s).ceil() as usize;
    (0..=steps).map(move |step| (start_s + knot_s * step as f64).min(end_s))
}

/// Unit vector from the second prism to the first, and how much longer their distance is than the rig has it (m).
fn apart<const LOCAL: usize>(
    at: &At<'_>,
    place: &Place,
    (a, b): (usize, usize),
    distance_m: f64,
) -> (Vector3<f64>, f64) {
    let point = |prism: usize| sum::<LOCAL>(at, place, &place.position, prism);
    let between = point(a) - point(b);
    let length_m = between.norm().max(1e-9);
    (between / length_m, length_m - distance_m)
}

/// What four knots add to a jerk, in σ.
fn jerk_factors(stretch: &Stretch, levels: &Levels) -> [f64; TIED] {
    let scale = 1.0 / (levels.jerk_m_per_s3 * stretch.knot_s.powi(3));
    [-scale, 3.0 * scale, -3.0 * scale, scale]
}

/// The jerk from a knot on, by coordinate, in σ.
fn jerks<const LOCAL: usize>(at: &At<'_>, first: usize, factors: &[f64; TIED]) -> [f64; LOCAL] {
    let mut errors = [0.0; LOCAL];
    for (k, factor) in factors.iter().enumerate() {
        let knot = &at.coefficients_m[LOCAL * (first + k)..][..LOCAL];
        errors.iter_mut().zip(knot).for_each(|(error, value)| *error += factor * value);
    }
    errors
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
