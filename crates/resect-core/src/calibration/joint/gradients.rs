//! What the equations of a stretch pull at, where all else about them is known from a place nearby.

use super::band::PartVector;
use super::band_rows::TIED;
use super::observed::{At, Levels, Piece, RIGID_M, Seen, apart, jerk_factors, jerks, knots_s};
use super::unknowns::PART_DISTANCES;
use crate::deployment::PAIRS;

/// Gradients of the equations of a stretch.
pub struct Gradients<const LOCAL: usize> {
    /// Gradients of the splines' coefficients, by knot.
    pub local: Vec<[f64; LOCAL]>,
    /// Gradients of the parts' unknowns, by part of the stretch.
    pub parts: Vec<PartVector>,
}

/// The gradients of the equations of a stretch about where everything is taken to be, by weights that are held.
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
