//! Manoeuvres that improve a drive, laid out as waypoints.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

/// Lengths of the candidate figure-eights, from tip to tip (m).
pub const EIGHTS_M: [f64; 2] = [16.0, 28.0];
/// Radius of the candidate loops (m).
pub const LOOP_RADIUS_M: f64 = 6.0;
/// Distance of a near pass from the centroid of the stations (m).
pub const NEAR_M: f64 = 15.0;

/// Amplitude of a slalom (m), for bends of 4 m radius.
pub const ASIDE_M: f64 = 2.5;

/// Largest angle between waypoints on a bend (rad).
const STEP_RAD: f64 = TAU / 24.0;

/// Length of the step that represents a turn on the spot: back and ahead again (m).
pub const TURN_STEP_M: f64 = 0.3;

/// Two circles, one to each side, that touch at the centre.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureEight {
    pub centre_m: [f64; 2],
    /// Length from tip to tip (m).
    pub length_m: f64,
    /// Heading at the centre (rad, counter-clockwise from x).
    #[serde(default)]
    pub heading_rad: f64,
    #[serde(default = "once")]
    pub times: u32,
}

/// A circle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Loop {
    pub centre_m: [f64; 2],
    pub radius_m: f64,
    /// Direction of the start, as seen from the centre of the circle (rad, counter-clockwise from x).
    #[serde(default)]
    pub from_rad: f64,
    /// Number of turns; negative to the right.
    #[serde(default = "one_turn")]
    pub turns: f64,
}

fn once() -> u32 {
    1
}

fn one_turn() -> f64 {
    1.0
}

/// Returns the waypoints of a slalom between two positions (m), `aside_m` to each side. It swerves first to the side of the
/// vehicle's heading.
pub fn slalom_m(
    [from_m, to_m]: [Vector2<f64>; 2],
    aside_m: f64,
    heading: &Vector2<f64>,
) -> Vec<Vector2<f64>> {
    /// Approximate distance between swerves (m).
    const SWERVE_M: f64 = 10.0;
    const STEPS: usize = 8;
    let way_m = to_m - from_m;
    let length_m = way_m.norm();
    let swerves = (length_m / SWERVE_M).round().max(1.0);
    let across = Vector2::new(-way_m.y, way_m.x).try_normalize(1e-9).unwrap_or_default();
    let across = if across.dot(heading) < 0.0 { -across } else { across };
    let steps = STEPS * swerves as usize;
    let place = |step: usize| {
        let share = step as f64 / steps as f64;
        from_m + way_m * share + across * (aside_m * (PI * swerves * share).sin())
    };
    (0..=steps).map(place).collect()
}

/// Returns the waypoints of one full turn on the spot, after arrival at a position along a direction: a step back and ahead
/// again.
pub fn once_around_m(at_m: Vector2<f64>, along: Vector2<f64>) -> [Vector2<f64>; 2] {
    [at_m - along * TURN_STEP_M, at_m]
}

impl FigureEight {
    /// Returns a figure-eight that begins at a position, in the direction of travel there.
    pub fn from_here(place_m: &Vector2<f64>, along: &Vector2<f64>, length_m: f64) -> Self {
        let heading_rad = along.y.atan2(along.x);
        Self { centre_m: (*place_m).into(), length_m, heading_rad, times: 1 }
    }

    /// Lays the figure-eight out as waypoints, from its centre to its centre (m).
    pub fn places_m(&self) -> Vec<Vector2<f64>> {
        let radius_m = self.length_m / 4.0;
        let turned = Rotation2::new(self.heading_rad);
        let steps = (TAU / STEP_RAD).round() as u32;
        let of_lobe = |side: f64| {
            (1..=steps).map(move |step| {
                let around = f64::from(step) / f64::from(steps) * TAU;
                Vector2::new(around.sin(), side * (1.0 - around.cos())) * radius_m
            })
        };
        let one = || of_lobe(1.0).chain(of_lobe(-1.0));
        let all = (0..self.times).flat_map(|_| one());
        let middle_m = Vector2::from(self.centre_m);
        std::iter::once(Vector2::zeros()).chain(all).map(|p| middle_m + turned * p).collect()
    }
}

impl Loop {
    /// Returns a loop that begins at a position, in the direction of travel there; to the right if `turns` is negative.
    pub fn from_here(
        place_m: &Vector2<f64>,
        along: &Vector2<f64>,
        radius_m: f64,
        turns: f64,
    ) -> Self {
        let to_centre_rad = turns.signum() * FRAC_PI_2;
        let centre_m = (place_m + Rotation2::new(to_centre_rad) * along * radius_m).into();
        Self { centre_m, radius_m, from_rad: along.y.atan2(along.x) - to_centre_rad, turns }
    }

    pub fn places_m(&self) -> Vec<Vector2<f64>> {
        let steps = (self.turns.abs() * TAU / STEP_RAD).ceil().max(1.0) as u32;
        let place = |step: u32| {
            let angle = self.from_rad + self.turns * TAU * f64::from(step) / f64::from(steps);
            Vector2::from(self.centre_m) + Vector2::new(angle.cos(), angle.sin()) * self.radius_m
        };
        (0..=steps).map(place).collect()
    }
}
