//! The opening manoeuvre, driven before there is any calibration, after which the readings are sufficient soonest.

use nalgebra::Vector2;

use super::manoeuvres::{TURN_STEP_M, once_around_m};

/// Distance between the two turns of the vehicle (m).
const LEG_M: f64 = 15.0;

/// The opening in words, as an instruction.
///
/// Inter-prism distances along the line of sight constrain the transforms least, because ranges are noisier than angles.
/// They need every heading. A vehicle that turns on the spot provides all headings within seconds, slowly enough for every
/// lock. `tests/calibration/advice.rs` compares this opening with others.
pub const OPENING: &str = "turn around on the spot, drive 15 m straight towards the stations if the place allows, and turn \
                           once around there";

/// Lays the opening out as waypoints (m), from a position and heading towards the centroid of the stations.
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
        // All headings of the vehicle, including towards the stations and away from them.
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
        // A vehicle at the stations themselves keeps its heading.
        let there = opening_m(stations_m, Vector2::x(), stations_m);
        assert!((there[3] - stations_m - Vector2::x() * LEG_M).norm() < 1e-9);
        assert!(OPENING.contains("15 m"), "{OPENING} for {LEG_M} m");
    }
}
