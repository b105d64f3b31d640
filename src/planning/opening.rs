//! What to drive before there is any answer: the beginning after which it is enough soonest.

use nalgebra::Vector2;

use super::manoeuvres::{TURN_STEP_M, once_around_m};

/// How far apart the two places are at which the vehicle turns (m).
const LEG_M: f64 = 15.0;

/// The opening in words, for whoever drives.
///
/// Distances of the rig along the sight hold the transforms worst, because ranges are noisier than angles; they need every
/// heading, near readings of each other in time and place. A vehicle that turns on the spot shows them all within seconds, slowly enough for every lock,
/// and a second time further along the sight tells yaws from positions. `tests/advice.rs` has what it is worth.
pub const OPENING: &str =
    "turn around on the spot, drive 15 m straight towards the stations, and turn once around there";

/// The opening as places to drive through (m), from a place and a heading there, with the middle of the stations ahead in the end.
pub fn opening_m(
    at_m: Vector2<f64>,
    heading: Vector2<f64>,
    stations_m: Vector2<f64>,
) -> Vec<Vector2<f64>> {
    let towards = (stations_m - at_m).try_normalize(1e-9).unwrap_or(heading);
    let end_m = at_m + towards * LEG_M;
    let begin_m = [at_m, at_m + heading * TURN_STEP_M, at_m, end_m];
    begin_m.into_iter().chain(once_around_m(end_m, towards)).collect()
}
