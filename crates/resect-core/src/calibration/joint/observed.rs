//! What is observed: readings, the rig's distances, and how smooth a drive is, each with its error about where everything is
//! taken to be.

use crate::geometry::ARCSECOND_RAD;
use nalgebra::{Matrix3, Vector3};

use super::band::PartVector;
use super::band_rows::TIED;
use super::motion::{Place, Stretch};
use super::unknowns::{PART_LATE, PART_LATENCIES, Sight, Station};

/// How far the rig's distances vary from knot to knot (m, 1 σ): masts flex, and prisms are not seen in their very centre.
pub const RIGID_M: f64 = 0.00035;
/// The Trimble S7: 2 mm + 2 ppm, one arcsecond (Vaidis et al. 2022, "Experiments").
const RANGE_M: f64 = 0.002;
const RANGE_SHARE: f64 = 2e-6;
pub const ANGLE_RAD: f64 = ARCSECOND_RAD;

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

/// What the instrument states as one standard deviation of a range of this length (m).
pub fn stated_range_m(range_m: f64) -> f64 {
    RANGE_M + RANGE_SHARE * range_m
}

/// One reading of one station, in its own frame. The directions about it are made whenever they are asked for: long drives
/// have millions of them.
#[derive(Clone, Debug)]
pub struct Reading {
    pub time_s: f64,
    pub point_m: Vector3<f64>,
}

impl Reading {
    pub fn sight(&self) -> Sight {
        Sight::at(&self.point_m)
    }
}

/// A stretch with its readings by station.
#[derive(Clone, Debug)]
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

/// A reading about where everything is taken to be.
pub struct Seen {
    pub place: Place,
    pub part: usize,
    pub prism: usize,
    pub velocity: Vector3<f64>,
    pub across: Vector3<f64>,
    /// Directions along the sight, to its right, and up, as columns.
    pub axes: Matrix3<f64>,
    /// Errors of the spline over the reading, along these axes (m).
    pub errors: Vector3<f64>,
    /// Inverse covariance of these errors, and what it is made of.
    pub information: Matrix3<f64>,
    pub range_sigma_m: f64,
    pub across_sigma_m: f64,
    pub jitter: Vector3<f64>,
}

impl Seen {
    pub fn of<const LOCAL: usize>(
        stretch: &Stretch,
        at: &At<'_>,
        levels: &Levels,
        station: usize,
        reading: &Reading,
    ) -> Self {
        let own = &at.stations[station];
        let sight = &reading.sight();
        let mut late_s = own.late_s + own.drift * (reading.time_s - at.middle_s);
        let part = stretch.part(reading.time_s - late_s);
        let slow = &at.slow[part];
        let mut placed = own.turn * own.corrected(sight) + own.place_m;
        if station > 0 {
            late_s += slow[PART_LATE + station - 1];
            placed += slow.fixed_rows::<3>(3 * (station - 1));
        }
        let prism = if LOCAL == 3 { 0 } else { station };
        let place = stretch.place(reading.time_s - late_s);
        let velocity = sum::<LOCAL>(at, &place, &place.velocity, prism);
        let axes = own.turn * Matrix3::from_columns(&[sight.along, sight.side, sight.up]);
        let along = axes.column(0).into_owned();
        let across = velocity - along * along.dot(&velocity);
        let error =
            sum::<LOCAL>(at, &place, &place.position, prism) - across * own.latency_s - placed;

        let range_sigma_m = levels.range * stated_range_m(sight.range_m);
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
    pub fn columns(&self, station: usize) -> [Option<(usize, Vector3<f64>)>; 5] {
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
pub fn knots_s(stretch: &Stretch) -> impl Iterator<Item = f64> + use<> {
    let (start_s, end_s, knot_s) = (stretch.start_s, stretch.end_s, stretch.knot_s);
    let steps = ((end_s - start_s) / knot_s).ceil() as usize;
    (0..=steps).map(move |step| (start_s + knot_s * step as f64).min(end_s))
}

/// Unit vector from the second prism to the first, and how much longer their distance is than the rig has it (m).
pub fn apart<const LOCAL: usize>(
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
pub fn jerk_factors(stretch: &Stretch, levels: &Levels) -> [f64; TIED] {
    let scale = 1.0 / (levels.jerk_m_per_s3 * stretch.knot_s.powi(3));
    [-scale, 3.0 * scale, -3.0 * scale, scale]
}

/// The jerk from a knot on, by coordinate, in σ.
pub fn jerks<const LOCAL: usize>(at: &At<'_>, first: usize, factors: &[f64; TIED]) -> [f64; LOCAL] {
    let mut errors = [0.0; LOCAL];
    for (k, factor) in factors.iter().enumerate() {
        let knot = &at.coefficients_m[LOCAL * (first + k)..][..LOCAL];
        errors.iter_mut().zip(knot).for_each(|(error, value)| *error += factor * value);
    }
    errors
}
