//! What to drive before there is any answer: the beginning after which it is enough soonest.

use nalgebra::Vector2;

use super::manoeuvres::{TURN_STEP_M, once_around_m};

/// How far apart the two places are at which the vehicle turns (m).
const LEG_M: f64 = 15.0;

/// These are the words that tell the opening to whoever drives.
///
/// Distances of the rig along the sight hold the transforms worst, because ranges are noisier than angles, and they need every heading.
/// A vehicle that turns on the spot shows them all within seconds, slowly enough for every lock; `tests/calibration/advice.rs` has what this is
/// worth, and what other ways are.
pub const OPENING: &str =
    "turn around on the spot, drive 15 m straight towards the stations, and turn once around there";

/// Lays the opening out as places to drive through (m), from a place and a heading there towards the middle of the stations.
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_opening_leads_to_the_stations_and_turns_at_both_ends() {
        let (at_m, stations_m) = (Vector2::new(60.0, 8.0), Vector2::new(1.0, -1.0));
        let towards = (stations_m - at_m).normalize();
        // Whichever way the vehicle stands, towards the stations and away from them included.
        for eighth in 0..8 {
            let rad = f64::from(eighth) * std::f64::consts::FRAC_PI_4;
            let heading = nalgebra::Rotation2::new(rad) * towards;
            let places_m = opening_m(at_m, heading, stations_m);
            let legs = places_m.windows(2).map(|pair| (pair[1] - pair[0]).normalize());
            let legs: Vec<Vector2<f64>> = legs.collect();
            let turns = legs.windows(2).map(|pair| pair[0].dot(&pair[1]).clamp(-1.0, 1.0).acos());
            let turned_rad: f64 = turns.sum();
            assert!(turned_rad > 3.0 * std::f64::consts::PI - 1e-6, "{turned_rad} rad from {rad}");
            assert!(
                (legs[0] - heading).norm() < 1e-9 && (legs[legs.len() - 1] - towards).norm() < 1e-9
            );
            assert!((places_m[places_m.len() - 1] - at_m - towards * LEG_M).norm() < 1e-9);
        }
        // Where the vehicle is at the stations themselves, it goes as it heads.
        let there = opening_m(stations_m, Vector2::x(), stations_m);
        assert!((there[3] - stations_m - Vector2::x() * LEG_M).norm() < 1e-9);
        assert!(OPENING.contains("15 m"), "{OPENING} for {LEG_M} m");
    }
}
