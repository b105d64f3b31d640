//! Manoeuvres that improve a drive, laid out as places that are driven through.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use nalgebra::{Rotation2, Vector2};
use serde::{Deserialize, Serialize};

/// Lengths of the figure-eights that are tried, from tip to tip (m).
pub const EIGHTS_M: [f64; 2] = [16.0, 28.0];
/// Radius of the loops that are tried (m).
pub const LOOP_RADIUS_M: f64 = 6.0;
/// Distance of a near pass from the middle of the stations (m).
pub const NEAR_M: f64 = 15.0;

/// Places on a bend are this far apart at most (rad of it).
const STEP_RAD: f64 = TAU / 24.0;

/// A turn on the spot is laid out as a step of this length (m), which is turned back from.
pub const TURN_STEP_M: f64 = 0.3;

/// Two circles, one to each side, that touch in the middle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureEight {
    pub centre_m: [f64; 2],
    /// From tip to tip.
    pub length_m: f64,
    /// Which way the middle is driven through (counter-clockwise from x).
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
    /// Where on the circle it begins, seen from its centre (counter-clockwise from x).
    #[serde(default)]
    pub from_rad: f64,
    /// How often around; to the right where it is negative.
    #[serde(default = "one_turn")]
    pub turns: f64,
}

fn once() -> u32 {
    1
}

fn one_turn() -> f64 {
    1.0
}

/// Places of a slalom from one place to another (m), which swerves first to the side that a vehicle heads to already.
pub fn slalom_m(
    from_m: Vector2<f64>,
    to_m: Vector2<f64>,
    heading: &Vector2<f64>,
) -> Vec<Vector2<f64>> {
    /// How far it swerves, and about how far it is from swerve to swerve (m): bends of 4 m radius.
    const ASIDE_M: f64 = 2.5;
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
        from_m + way_m * share + across * (ASIDE_M * (PI * swerves * share).sin())
    };
    (0..=steps).map(place).collect()
}

/// Places that are driven through after one where the vehicle arrives along a direction, to turn once around on the spot there: a
/// step back, and ahead again.
pub fn once_around_m(at_m: Vector2<f64>, along: Vector2<f64>) -> [Vector2<f64>; 2] {
    [at_m - along * TURN_STEP_M, at_m]
}

impl FigureEight {
    /// Returns one that begins at a place, in the direction of travel there.
    pub fn from_here(place_m: &Vector2<f64>, along: &Vector2<f64>, length_m: f64) -> Self {
        let heading_rad = along.y.atan2(along.x);
        Self { centre_m: (*place_m).into(), length_m, heading_rad, times: 1 }
    }

    /// Lays it out from its middle to its middle.
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
    /// Returns one that begins at a place, in the direction of travel there; to the right where `turns` is negative.
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
