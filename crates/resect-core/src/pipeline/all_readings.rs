//! The triplets of all readings, by limits that no setting changes. The joint estimate starts from them.

use std::sync::Arc;

use nalgebra::Vector3;

use super::interpolation::{grid, linear};
use super::triplets::Triplets;
use super::{interval_filter, interval_split, outlier_filter};
use crate::deployment::Deployment;
use crate::network::PerStation;

/// Longest gap of a station that positions are interpolated across (s).
const LONGEST_GAP_S: f64 = 2.0;
/// Intervals up to this length are dropped (s): they have too few readings for a motion.
const SHORTEST_S: f64 = 1.0;
/// Triplets per second. Source: the paper's rate.
const RATE_HZ: f64 = 10.0;

/// Interpolates all readings that the user does not exclude, from their [`outlier_filter::positions_m`].
pub fn triplets_of_all_readings(
    deployment: &Deployment,
    positions_m: &PerStation<Vec<Vector3<f64>>>,
) -> Triplets {
    let tracks = outlier_filter::filter(deployment, positions_m, None);
    let intervals = interval_split::split(&tracks, LONGEST_GAP_S);
    let intervals = interval_filter::filter(&intervals, Some(SHORTEST_S));
    let (time_s, interval) = grid(&intervals, RATE_HZ);
    let points_m = tracks.map(|track| linear::at(track, &time_s));
    let triplets = Triplets {
        restarts_s: deployment.restarts_s.clone(),
        readings: Arc::new(tracks),
        ..Triplets::new(time_s, interval, points_m)
    };
    match deployment.prism_schedule() {
        schedule if schedule.is_constant() => triplets,
        schedule => triplets.of_most_followed(&schedule),
    }
}
