//! Motions that determine more: for a direction of the lever arm, the time offset, and the rotation.

use nalgebra::Vector3;

use super::driven_motion::DrivenMotion;
use super::lever_direction::LeverDirection;
use super::solution::{GOOD_LEVER_M, GOOD_ROTATION_RAD, GOOD_TIME_S, Solution};
use crate::estimates::fit::LEVER_SIGMA_M;

/// A motion that would determine more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AdvisedMotion {
    /// Rotations by an angle (rad, root mean square) about axes across a direction of a; `now_rad` is their size during the drive. With them,
    /// σ along the direction would be about `sigma_m`, if the drive shows how large errors are. `is_main_axis`: only rotations about other axes than the main one help.
    Turn {
        direction: Vector3<f64>,
        now_rad: f64,
        by_rad: f64,
        sigma_m: Option<f64>,
        is_main_axis: bool,
    },
    /// The same motion for this many times as long.
    Longer { times: f64 },
    /// Changes of speed and direction; the present ones (m/s²), if known.
    ChangeSpeed { now_m_per_s2: Option<f64>, sigma_s: f64 },
    /// Rotations about all axes and paths in all directions, for the rotation of b.
    TurnAll { sigma_rad: f64 },
}

/// Rotations that are proposed (rad): ramps, tilts by hand, turns.
const TURNS_RAD: [f64; 4] = [0.1, 0.2, 0.5, 1.0];
/// A direction is the main axis of rotation if the cosine between both is larger.
const ALONG: f64 = 0.9;

/// Smallest information of the data, relative to that of the prior, from which σ of another drive is predicted.
const LEAST_INFORMATION: f64 = 0.1;

/// Returns the motions that would make a good calibration of a weak one.
pub fn advised_motions(
    solution: &Solution,
    directions: &[LeverDirection],
    motion: &DrivenMotion,
) -> Vec<AdvisedMotion> {
    let mut all: Vec<AdvisedMotion> = Vec::new();
    let weak = directions.iter().filter(|direction| direction.sigma_m > GOOD_LEVER_M);
    for advised in weak.map(|direction| of_direction(direction, motion)) {
        let is_longer = |other: &AdvisedMotion| matches!(other, AdvisedMotion::Longer { .. });
        if !(is_longer(&advised) && all.iter().any(is_longer)) {
            all.push(advised);
        }
    }
    if let Some(sigma_s) = solution.time_offset_sigma_s.filter(|sigma_s| *sigma_s > GOOD_TIME_S) {
        all.push(AdvisedMotion::ChangeSpeed {
            now_m_per_s2: motion.acceleration_m_per_s2,
            sigma_s,
        });
    }
    let sigma_rad = solution.rotation_sigma_rad.map(|sigma| sigma.max());
    if let Some(sigma_rad) = sigma_rad.filter(|sigma_rad| *sigma_rad > GOOD_ROTATION_RAD) {
        all.push(AdvisedMotion::TurnAll { sigma_rad });
    }
    all
}

/// σ along a direction falls as the rotations across it grow, until they reach a radian.
fn of_direction(direction: &LeverDirection, motion: &DrivenMotion) -> AdvisedMotion {
    // Without the prior, which an undetermined direction has instead of data.
    let prior = LEVER_SIGMA_M.powi(-2);
    let information = (direction.sigma_m.powi(-2) - prior).max(0.0);
    let sigma_m = (information > LEAST_INFORMATION * prior).then(|| information.sqrt().recip());
    let predicted_m = |by_rad: f64| Some(sigma_m? * direction.turned / by_rad.sin());
    let mut larger = TURNS_RAD.into_iter().filter(|by_rad| by_rad.sin() > direction.turned);
    let is_good = |by_rad: &f64| predicted_m(*by_rad).is_some_and(|it| it < GOOD_LEVER_M);
    let enough = larger.clone().find(is_good);
    match enough.or_else(|| larger.next_back()) {
        Some(by_rad) => AdvisedMotion::Turn {
            direction: direction.direction,
            now_rad: direction.turned.asin(),
            by_rad,
            sigma_m: predicted_m(by_rad),
            is_main_axis: direction.direction.dot(&motion.main_axis).abs() > ALONG,
        },
        None => AdvisedMotion::Longer { times: (direction.sigma_m / GOOD_LEVER_M).powi(2) },
    }
}
