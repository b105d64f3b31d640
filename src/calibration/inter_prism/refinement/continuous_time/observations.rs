//! What is observed, as rows of linear equations: readings, the rig's distances, and how smooth a drive is.

use nalgebra::Vector3;

use super::super::INSTRUMENT;
use super::super::model::{CLOCKS, CONSTANT, DISTANCES, DRIFTS, State, TILTS};
use super::arrow::Row;
use super::spline::{PER_KNOT, Place, Spans};
use crate::deployment::PAIRS;
use crate::geometry::RigidTransform;
use crate::pipeline::Triplets;

/// How far the rig's distances vary on the way (m, 1 σ): masts flex, and prisms are not seen in their very centre.
const RIGID_M: f64 = 0.0005;

/// One reading of one station.
pub struct Reading {
    span: usize,
    pub time_s: f64,
    /// In the station's frame.
    point_m: Vector3<f64>,
    range_m: f64,
    /// Unit vectors along the sight, and twice across it.
    axes: [Vector3<f64>; 3],
}

/// The readings of a drive and the splines that they are to be explained by.
pub struct Drive {
    pub spans: Spans,
    pub readings: [Vec<Reading>; 3],
    /// Drifts of the clocks count from here (s).
    pub middle_s: f64,
}

/// How well stations read, and how jerky a drive is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NoiseLevels {
    /// What the stated noise of a range is multiplied by.
    pub range: f64,
    /// One standard deviation of an angle (rad).
    pub angle_rad: f64,
    /// Third derivative of the prisms' positions, 1 σ (m/s³).
    pub jerk_m_per_s3: f64,
}

/// What kind of equation a row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    Range,
    /// Across the sight.
    Across,
    Distance,
    Jerk,
}

/// Everything unknown.
#[derive(Clone, Debug)]
pub struct Estimates {
    pub global: State,
    /// [`PER_KNOT`] a knot.
    pub coefficients_m: Vec<f64>,
}

impl NoiseLevels {
    /// Of a range of no length (m).
    pub fn range_m(&self) -> f64 {
        self.range * INSTRUMENT.range_m
    }

    fn along_m(&self, range_m: f64) -> f64 {
        self.range * (INSTRUMENT.range_m + INSTRUMENT.range_share * range_m)
    }

    /// Across the sight, at a range (m).
    pub fn across_m(&self, range_m: f64) -> f64 {
        self.angle_rad * range_m
    }
}

impl Drive {
    /// `None` without readings to go by.
    pub fn new(triplets: &Triplets) -> Option<Self> {
        let (first_s, last_s) = (*triplets.time_s.first()?, *triplets.time_s.last()?);
        let knot_s =
            triplets.readings.iter().map(|track| median_step_s(&track.time_s)).fold(0.0, f64::max);
        if !(0.01..=2.0).contains(&knot_s) {
            return None;
        }
        let spans = Spans::of(&triplets.time_s, &triplets.interval, knot_s);
        let readings = triplets.readings.each_ref().map(|track| {
            track
                .time_s
                .iter()
                .zip(&track.position_m)
                .filter_map(|(time_s, point_m)| {
                    let span = spans.at(*time_s)?;
                    let index = spans.spans.partition_point(|other| other.end_s < span.end_s);
                    Some(Reading::new(index, *time_s, *point_m))
                })
                .collect()
        });
        Some(Self { spans, readings, middle_s: 0.5 * (first_s + last_s) })
    }

    /// How late a station's stamp is (s).
    pub fn late_s(&self, station: usize, time_s: f64, state: &State) -> f64 {
        match station {
            0 => 0.0,
            _ => {
                state[CLOCKS + station - 1] + state[DRIFTS + station - 1] * (time_s - self.middle_s)
            }
        }
    }

    /// Splines through the triplets.
    pub fn start(&self, triplets: &Triplets, transforms: &[RigidTransform; 3]) -> Vec<f64> {
        let mut coefficients_m = vec![0.0; PER_KNOT * self.spans.knots()];
        for span in &self.spans.spans {
            for knot in 0..span.knots {
                let time_s =
                    span.knot_time_s(knot, self.spans.knot_s).clamp(span.start_s, span.end_s);
                let after =
                    triplets.time_s.partition_point(|t| *t < time_s).min(triplets.len() - 1);
                let at = PER_KNOT * (span.first_knot + knot);
                for (prism, transform) in transforms.iter().enumerate() {
                    let point_m = transform.apply(&triplets.points_m[prism][after]);
                    coefficients_m[at + 3 * prism..][..3].copy_from_slice(point_m.as_slice());
                }
            }
        }
        coefficients_m
    }

    /// The three equations of a reading: range, angle, angle.
    pub fn reading(
        &self,
        station: usize,
        reading: &Reading,
        at: &Estimates,
        transforms: &[RigidTransform; 3],
        noise: &NoiseLevels,
        rows: &mut [Row; 3],
    ) {
        let late_s = self.late_s(station, reading.time_s, &at.global);
        let place = self.spans.place(&self.spans.spans[reading.span], reading.time_s - late_s);
        let predicted = at.sum(&place, &place.position, station);
        let velocity = at.sum(&place, &place.velocity, station);
        let transform = &transforms[station];
        let shorter = reading.axes[0] * at.global[CONSTANT];
        let turned = transform.rotate(&(reading.point_m - shorter));
        let error_m = predicted - (turned + transform.translation_m);
        for (axis, row) in rows.iter_mut().enumerate() {
            let sigma_m = match axis {
                0 => noise.along_m(reading.range_m),
                _ => noise.across_m(reading.range_m),
            };
            let along = transform.rotate(&reading.axes[axis]) / sigma_m;
            row.local.clear();
            place_at(&mut row.local, &place, station, &along);
            row.error = along.dot(&error_m);
            row.global.fill(0.0);
            row.global[CONSTANT] = if axis == 0 { 1.0 / sigma_m } else { 0.0 };
            if station > 0 {
                let (slot, moved) = (station - 1, -along);
                row.global.fixed_rows_mut::<3>(4 * slot).copy_from(&moved);
                row.global[4 * slot + 3] = moved.dot(&Vector3::z().cross(&turned));
                let by_clock = moved.dot(&velocity);
                row.global[CLOCKS + slot] = by_clock;
                row.global[DRIFTS + slot] = by_clock * (reading.time_s - self.middle_s);
                for (k, axis) in [Vector3::x(), Vector3::y()].into_iter().enumerate() {
                    let tilted = transform.rotate(&axis.cross(&reading.point_m));
                    row.global[TILTS + 2 * slot + k] = moved.dot(&tilted);
                }
            }
        }
    }

    /// That the splines keep the distances of the rig, twice a knot, each with its time (s).
    pub fn distances(&self, at: &Estimates, mut each: impl FnMut(f64, &Row)) {
        let half_knot_s = 0.5 * self.spans.knot_s;
        let mut row = Row::default();
        for span in &self.spans.spans {
            let steps = ((span.end_s - span.start_s) / half_knot_s).ceil() as usize;
            for step in 0..=steps {
                let time_s = (span.start_s + half_knot_s * step as f64).min(span.end_s);
                let place = self.spans.place(span, time_s);
                let points: [Vector3<f64>; 3] =
                    std::array::from_fn(|prism| at.sum(&place, &place.position, prism));
                for (pair, (a, b)) in PAIRS.into_iter().enumerate() {
                    let between = points[a] - points[b];
                    let length_m = between.norm().max(1e-9);
                    let along = between / (length_m * RIGID_M);
                    row.local.clear();
                    place_at(&mut row.local, &place, a, &along);
                    place_at(&mut row.local, &place, b, &-along);
                    row.global.fill(0.0);
                    row.global[DISTANCES + pair] = -1.0 / RIGID_M;
                    row.error = (length_m - at.global[DISTANCES + pair]) / RIGID_M;
                    each(time_s, &row);
                }
            }
        }
    }

    /// That the motion is smooth: the nine equations of each knot, with their time (s).
    pub fn jerks(
        &self,
        at: &Estimates,
        noise: &NoiseLevels,
        mut each: impl FnMut(f64, &[Row; PER_KNOT]),
    ) {
        let knot_s = self.spans.knot_s;
        let scale = 1.0 / (noise.jerk_m_per_s3 * knot_s.powi(3));
        let factors = [-scale, 3.0 * scale, -3.0 * scale, scale];
        let mut rows: [Row; PER_KNOT] = std::array::from_fn(|_| Row::default());
        for span in &self.spans.spans {
            for knot in 3..span.knots {
                let first = PER_KNOT * (span.first_knot + knot - 3);
                for (coordinate, row) in rows.iter_mut().enumerate() {
                    row.local.clear();
                    row.error = 0.0;
                    for (k, factor) in factors.into_iter().enumerate() {
                        let index = first + PER_KNOT * k + coordinate;
                        row.local.push((index, factor));
                        row.error += factor * at.coefficients_m[index];
                    }
                }
                each(span.knot_time_s(knot, knot_s) - 1.5 * knot_s, &rows);
            }
        }
    }
}

impl Reading {
    fn new(span: usize, time_s: f64, point_m: Vector3<f64>) -> Self {
        let range_m = point_m.norm().max(1e-9);
        let sight = point_m / range_m;
        // Any two directions across will do: both angles are as good.
        let side = sight.cross(&Vector3::z()).try_normalize(1e-6).unwrap_or_else(Vector3::x);
        Self { span, time_s, point_m, range_m, axes: [sight, side, side.cross(&sight)] }
    }
}

impl Estimates {
    fn sum(&self, place: &Place, weights: &[f64; 4], prism: usize) -> Vector3<f64> {
        let mut sum = Vector3::zeros();
        for (k, weight) in weights.iter().enumerate() {
            let at = PER_KNOT * (place.first + k) + 3 * prism;
            sum += *weight * Vector3::from_column_slice(&self.coefficients_m[at..at + 3]);
        }
        sum
    }
}

fn place_at(local: &mut Vec<(usize, f64)>, place: &Place, prism: usize, along: &Vector3<f64>) {
    for (k, weight) in place.position.iter().enumerate() {
        let at = PER_KNOT * (place.first + k) + 3 * prism;
        local.extend((0..3).map(|axis| (at + axis, weight * along[axis])));
    }
}

fn median_step_s(time_s: &[f64]) -> f64 {
    let mut steps_s: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
    steps_s.sort_by(f64::total_cmp);
    steps_s.get(steps_s.len() / 2).copied().unwrap_or(f64::NAN)
}
