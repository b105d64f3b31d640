//! The way of a plan: waypoints and manoeuvres, laid out as what a driver follows.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::manoeuvres::{FigureEight, Loop};
use crate::simulation;

/// A piece of the way; the vehicle goes straight from the end of one to the beginning of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Piece {
    Waypoints(Vec<Waypoint>),
    FigureEight(FigureEight),
    Loop(Loop),
}

/// A place on the way. In a file `[x, y]` (m), and where they differ from the plan's and from none, how fast it is driven to
/// (m/s) and how long the vehicle stands there (s).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "Vec<f64>", into = "Vec<f64>")]
pub struct Waypoint {
    pub x_m: f64,
    pub y_m: f64,
    pub speed_m_per_s: Option<f64>,
    pub stand_s: f64,
}

impl Waypoint {
    pub fn at(place_m: Vector2<f64>) -> Self {
        Self { x_m: place_m.x, y_m: place_m.y, speed_m_per_s: None, stand_s: 0.0 }
    }

    pub fn place_m(&self) -> Vector2<f64> {
        Vector2::new(self.x_m, self.y_m)
    }
}

impl TryFrom<Vec<f64>> for Waypoint {
    type Error = &'static str;

    fn try_from(numbers: Vec<f64>) -> Result<Self, Self::Error> {
        let (x_m, y_m, speed, stand_s) = match numbers[..] {
            [x_m, y_m] => (x_m, y_m, None, 0.0),
            [x_m, y_m, speed] => (x_m, y_m, Some(speed), 0.0),
            [x_m, y_m, speed, stand_s] => (x_m, y_m, Some(speed), stand_s),
            _ => return Err("a waypoint is [x, y], [x, y, speed] or [x, y, speed, stand]"),
        };
        Ok(Self { x_m, y_m, speed_m_per_s: speed.filter(|speed| *speed != 0.0), stand_s })
    }
}

impl From<Waypoint> for Vec<f64> {
    fn from(at: Waypoint) -> Self {
        let mut numbers = vec![at.x_m, at.y_m];
        if at.speed_m_per_s.is_some() || at.stand_s > 0.0 {
            // Nobody drives at 0: it stands for the plan's own speed.
            numbers.push(at.speed_m_per_s.unwrap_or(0.0));
        }
        if at.stand_s > 0.0 {
            numbers.push(at.stand_s);
        }
        numbers
    }
}

impl Piece {
    /// The places that it is driven through.
    pub fn waypoints(&self) -> Vec<Waypoint> {
        match self {
            Self::Waypoints(waypoints) => waypoints.clone(),
            Self::FigureEight(eight) => eight.places_m().into_iter().map(Waypoint::at).collect(),
            Self::Loop(one) => one.places_m().into_iter().map(Waypoint::at).collect(),
        }
    }

    /// The first thing that makes no sense, and what to do about it.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        match self {
            Self::Waypoints(waypoints) => {
                for at in waypoints {
                    let speed = at.speed_m_per_s.unwrap_or(1.0);
                    if !(0.01..=20.0).contains(&speed) {
                        let what = format!("a waypoint is driven to at {speed} m/s");
                        return Err((what, "give 0.01 to 20 m/s, or 0 for the plan's own"));
                    }
                    if !(0.0..=86_400.0).contains(&at.stand_s) {
                        let what = format!("the vehicle stands for {} s", at.stand_s);
                        return Err((what, "give 0 to 86400 s"));
                    }
                }
                Ok(())
            }
            Self::FigureEight(FigureEight { length_m, times, heading_rad, .. }) => {
                let is_sound = (1.0..=1000.0).contains(length_m)
                    && (1..=100).contains(times)
                    && heading_rad.is_finite();
                let what = "a figure-eight has no length, or is driven too often".to_owned();
                is_sound.then_some(()).ok_or((what, "give 1 to 1000 m, and 1 to 100 times"))
            }
            Self::Loop(Loop { radius_m, turns, from_rad, .. }) => {
                let is_sound = (0.5..=1000.0).contains(radius_m)
                    && (0.01..=100.0).contains(&turns.abs())
                    && from_rad.is_finite();
                let what = "a loop has no radius, or is driven too often".to_owned();
                is_sound.then_some(()).ok_or((what, "give 0.5 to 1000 m, and 0.01 to 100 turns"))
            }
        }
    }
}

/// How far it is from waypoint to waypoint (m).
pub fn length_m(waypoints: &[simulation::Waypoint]) -> f64 {
    waypoints.windows(2).map(|pair| (pair[1].place_m() - pair[0].place_m()).norm()).sum()
}

/// Waypoints about `apart_m` apart along where something was at some times (s, m): how fast it went, and where it stood.
pub fn waypoints_along(time_s: &[f64], places_m: &[Vector2<f64>], apart_m: f64) -> Vec<Waypoint> {
    /// Nobody drives as slowly as this.
    const STANDING_M_PER_S: f64 = 0.05;
    /// Over this long a speed is told from the noise of readings.
    const WINDOW_S: f64 = 2.0;
    let (Some(first_s), Some(first_m)) = (time_s.first(), places_m.first()) else {
        return Vec::new();
    };
    let mut waypoints = vec![Waypoint::at(*first_m)];
    let (mut from_s, mut stood_s, mut before_s) = (*first_s, 0.0, *first_s);
    for (now_s, here_m) in time_s.iter().zip(places_m).skip(1) {
        let back = time_s.partition_point(|t| *t < now_s - WINDOW_S);
        let gone_m = (here_m - places_m[back]).norm();
        let is_standing = gone_m < STANDING_M_PER_S * (now_s - time_s[back]);
        stood_s += if is_standing { now_s - before_s } else { 0.0 };
        before_s = *now_s;
        let last = waypoints.len() - 1;
        let leg_m = (here_m - waypoints[last].place_m()).norm();
        if leg_m < apart_m {
            continue;
        }
        let moving_s = (now_s - from_s - stood_s).max(0.1);
        // Where it stood is about where the last waypoint is.
        waypoints[last].stand_s += stood_s;
        let speed_m_per_s = Some((leg_m / moving_s).clamp(0.05, 20.0));
        waypoints.push(Waypoint { speed_m_per_s, ..Waypoint::at(*here_m) });
        (from_s, stood_s) = (*now_s, 0.0);
    }
    let last = waypoints.len() - 1;
    waypoints[last].stand_s += stood_s;
    waypoints
}
