//! Manoeuvres to drive next from the vehicle's current position, ranked by the information they add to the readings so far.

use std::sync::Arc;

use nalgebra::{DMatrix, Vector2, Vector3};
use rayon::prelude::*;

use super::from_here::Here;
use super::so_far::SoFar;
use resect_core::calibration::inter_prism;
use resect_core::calibration::inter_prism::PrismNetwork;
use resect_core::calibration::inter_prism::observability::{Hold, Observability};
use resect_core::calibration::joint;
use resect_core::calibration::joint::Layout;
use resect_core::deployment::pairwise_distances;
use resect_core::evaluation::far_end::{FarEnd, far_end};
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation, Prism};
use resect_core::pipeline::Triplets;
use resect_core::progress::{Cancelled, Progress};

/// Largest number of positions at which the far-end error is evaluated, by station.
const MOST_PLACES: usize = 300;

/// Information of a drive in progress.
#[derive(Clone, Debug)]
pub struct Known {
    /// Current error at the far end; `None` if a direction is unobservable.
    pub far_end: Option<FarEnd>,
    /// Observability of the directions so far; `None` with one prism.
    pub observability: Option<Observability>,
    /// True if the target is met and no direction is free or weak.
    pub is_enough: bool,
}

/// State of a drive in progress, and manoeuvres to drive next.
#[derive(Clone, Debug)]
pub struct DriveAdvice {
    pub now: Known,
    /// Sorted by the number of free or weak directions left, then by the gain per second. Moves without a gain are omitted.
    pub moves: Vec<NextMove>,
}

/// A manoeuvre from the vehicle's current position.
#[derive(Clone, Debug)]
pub struct NextMove {
    /// "drive a figure-eight of 16 m here, 40 s: 1.6 mm predicted". The prediction for the readings so far is omitted,
    /// because it differs from the σ of their estimate.
    pub sentence: String,
    /// Path from the vehicle's current position (m, station 1's frame).
    pub waypoints_m: Vec<Vector2<f64>>,
    /// Predicted error at the far end from the readings so far (m; `None` if a direction is unobservable), and after the
    /// manoeuvre (m).
    pub before_m: Option<f64>,
    pub after_m: f64,
    pub takes_s: f64,
    /// Number of directions that remain free or weak after the manoeuvre.
    pub open: usize,
    /// Gain of information at the far end per second (1/σ², 1/m²/s); information is additive, σ is not.
    pub gain_per_m2_s: f64,
}

/// Returns the information of the readings so far, and whether it is sufficient.
///
/// `covariance` is that of (x, y, z, yaw) of stations 2, 3, … by the joint estimate, if there is one. Otherwise the
/// predicted covariance is used, which does not account for steps of stations and clocks.
pub fn known(
    so_far: &SoFar<'_>,
    covariance: Option<&DMatrix<f64>>,
    progress: &Progress,
) -> Result<Known, Cancelled> {
    let found = foreseen(so_far, so_far.triplets, progress)?;
    let places_m = places_m(so_far);
    let covariance = found.held.map(|foreseen| covariance.cloned().unwrap_or(foreseen));
    let far_end = covariance.and_then(|open| far_end(&rigid(so_far), &open, &places_m));
    let is_steady = found.observability.as_ref().is_none_or(|seen| unheld(seen) == 0);
    let is_met = far_end.is_some_and(|far_end| far_end.sigma_m <= so_far.target_m);
    Ok(Known { far_end, observability: found.observability, is_enough: is_steady && is_met })
}

/// Returns manoeuvres to drive next. `None` if the readings so far show no motion of the vehicle.
pub fn what_next(
    so_far: &SoFar<'_>,
    progress: &Progress,
) -> Result<Option<DriveAdvice>, Cancelled> {
    let Some(here) = Here::of(so_far) else { return Ok(None) };
    let now = known(so_far, None, progress)?;
    let places_m = places_m(so_far);
    let transforms = rigid(so_far);
    let look = |triplets: &Triplets| -> Result<(Option<f64>, usize), Cancelled> {
        let found = foreseen(so_far, triplets, progress)?;
        let far = found.held.and_then(|covariance| far_end(&transforms, &covariance, &places_m));
        let open = found.observability.as_ref().map_or(0, unheld);
        Ok((far.map(|far| far.sigma_m), open))
    };
    // Predictions are compared with a prediction.
    let (before_m, _) = look(so_far.triplets)?;
    let one = |(what, way_m): (String, Vec<Vector2<f64>>)| {
        let Some((triplets, takes_s)) = here.driven(so_far, &way_m) else { return Ok(None) };
        let (Some(after_m), open) = look(&triplets)? else { return Ok(None) };
        let known = |sigma_m: f64| sigma_m.powi(-2);
        let gain_per_m2_s = (known(after_m) - before_m.map_or(0.0, known)) / takes_s.max(1.0);
        let sentence = format!("{what}, {takes_s:.0} s: {:.1} mm predicted", after_m * 1e3);
        let found = NextMove {
            sentence,
            waypoints_m: way_m,
            before_m,
            after_m,
            takes_s,
            open,
            gain_per_m2_s,
        };
        Ok((gain_per_m2_s > 0.0).then_some(found))
    };
    let tried = here.candidates(so_far).into_par_iter().map(one);
    let tried: Vec<Option<NextMove>> = tried.collect::<Result<_, Cancelled>>()?;
    let mut moves: Vec<NextMove> = tried.into_iter().flatten().collect();
    moves.sort_by(|a, b| a.open.cmp(&b.open).then(b.gain_per_m2_s.total_cmp(&a.gain_per_m2_s)));
    Ok(Some(DriveAdvice { now, moves }))
}

/// Returns the number of directions that are unobservable or weak.
fn unheld(observability: &Observability) -> usize {
    observability.directions.len() - observability.count(Hold::Held)
}

/// Predicted covariance and observability of some readings.
struct PredictedDrive {
    held: Option<DMatrix<f64>>,
    observability: Option<Observability>,
}

fn foreseen(
    so_far: &SoFar<'_>,
    triplets: &Triplets,
    progress: &Progress,
) -> Result<PredictedDrive, Cancelled> {
    let SoFar { station1_from_station, sizes, expected, .. } = so_far;
    let inter_prism_m = pairwise_distances(so_far.prisms_m.as_slice());
    let layout = Arc::new(Layout::new(so_far.followed));
    let here = (*station1_from_station, &inter_prism_m);
    let estimate = joint::predict(triplets, &layout, here, sizes, expected, progress)?;
    let covariance = estimate.map(|estimate| estimate.covariance);
    let seen = (!Prism::is_one(so_far.followed)).then(|| {
        let network = PrismNetwork::new(so_far.followed.clone(), &inter_prism_m);
        inter_prism::foresee(triplets, &network, station1_from_station, covariance.clone())
    });
    let seen = seen.flatten();
    let held = covariance.filter(|_| seen.as_ref().is_none_or(|seen| seen.is_held));
    Ok(PredictedDrive { held, observability: seen.map(|seen| seen.observability) })
}

fn rigid(so_far: &SoFar<'_>) -> PerStation<RigidTransform> {
    so_far.station1_from_station.map(|level| RigidTransform::from(*level))
}

/// Positions at which the far-end error is evaluated (m, by station in its own frame): the track so far and the places of
/// `so_far`.
fn places_m(so_far: &SoFar<'_>) -> PerStation<Vec<Vector3<f64>>> {
    let step = (so_far.triplets.len() / MOST_PLACES).max(1);
    so_far.triplets.points_m.map_each(|station, points_m| {
        let own = points_m.iter().step_by(step).copied();
        let station_from_station1 = so_far.station1_from_station[station.index()].inverse();
        let named = so_far.places_m.iter().map(|place_m| station_from_station1.apply(place_m));
        own.chain(named).collect()
    })
}
