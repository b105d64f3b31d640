//! The path of a plan: waypoints and manoeuvres, laid out as waypoints.

use nalgebra::Vector2;
use serde::{Deserialize, Serialize};

use super::manoeuvres::{FigureEight, Loop};
use crate::simulation::Waypoint;

/// A segment of the path; the vehicle drives straight from the end of one to the beginning of the next.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Piece {
    Waypoints(Vec<Waypoint>),
    FigureEight(FigureEight),
    Loop(Loop),
}

impl Piece {
    /// Lays the segment out as waypoints.
    pub fn waypoints(&self) -> Vec<Waypoint> {
        match self {
            Self::Waypoints(waypoints) => waypoints.clone(),
            Self::FigureEight(eight) => eight.places_m().into_iter().map(Waypoint::at).collect(),
            Self::Loop(one) => one.places_m().into_iter().map(Waypoint::at).collect(),
        }
    }

    /// Returns the first invalid value, with a remedy.
    pub fn check(&self) -> Result<(), (String, &'static str)> {
        match self {
            Self::Waypoints(waypoints) => {
                for at in waypoints {
                    let speed = at.speed_m_per_s.unwrap_or(1.0);
                    if !(0.01..=20.0).contains(&speed) {
                        let what = format!("a waypoint has a speed of {speed} m/s");
                        return Err((what, "give 0.01 to 20 m/s, or 0 for the plan's speed"));
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
                let what = "a figure-eight has an invalid length or number of rounds".to_owned();
                is_sound.then_some(()).ok_or((what, "give 1 to 1000 m, and 1 to 100 times"))
            }
            Self::Loop(Loop { radius_m, turns, from_rad, .. }) => {
                let is_sound = (0.5..=1000.0).contains(radius_m)
                    && (0.01..=100.0).contains(&turns.abs())
                    && from_rad.is_finite();
                let what = "a loop has an invalid radius or number of turns".to_owned();
                is_sound.then_some(()).ok_or((what, "give 0.5 to 1000 m, and 0.01 to 100 turns"))
            }
        }
    }
}

/// Returns the length of the straight legs between waypoints (m).
pub fn length_m(waypoints: &[Waypoint]) -> f64 {
    waypoints.windows(2).map(|pair| (pair[1].place_m() - pair[0].place_m()).norm()).sum()
}

/// Thins a recorded track (s, m) to waypoints about `apart_m` apart, with speeds and stops.
pub fn waypoints_along(time_s: &[f64], places_m: &[Vector2<f64>], apart_m: f64) -> Vec<Waypoint> {
    /// Speed below which the vehicle stands (m/s).
    const STANDING_M_PER_S: f64 = 0.05;
    /// Window over which a speed is significant against the noise of readings (s).
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
        // The stop was near the previous waypoint.
        waypoints[last].stand_s += stood_s;
        let speed_m_per_s = Some((leg_m / moving_s).clamp(0.05, 20.0));
        waypoints.push(Waypoint { speed_m_per_s, ..Waypoint::at(*here_m) });
        (from_s, stood_s) = (*now_s, 0.0);
    }
    let last = waypoints.len() - 1;
    waypoints[last].stand_s += stood_s;
    waypoints
}
