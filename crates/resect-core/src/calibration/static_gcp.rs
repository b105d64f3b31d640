//! Method B: point-to-point alignment of static control points.
//!
//! If the coordinates of the points in a global frame are known, every station is aligned to that frame. Otherwise the others are
//! aligned to station 1 (Vaidis et al. 2022, section "Static methods", "Static GCPs calibration"). All files of control points
//! are used, except pillars.

use crate::deployment::findings::points::{
    control_point_outlier, control_points_aligned, control_points_fit_poorly,
};
use nalgebra::Vector3;

use super::common_errors::{self, CommonErrors, Displaced};
use super::judgement::Judgement;
use super::method::FEWEST_POINTS;
use super::method_answer::MethodAnswer;
use super::point_to_point::{self, Errors, Matches};
use super::{CalibrationError, CalibrationSettings, Method, Offer, Verdict, checks};
use crate::deployment::{ControlPoint, Deployment, Finding};
use crate::geometry::{Polar, RigidTransform};
use crate::network::{Number, PerStation, Station};
use crate::pipeline::Triplets;
use crate::statistics::median;

/// Fewest points for a σ by the sandwich estimator.
const FEWEST_FOR_SANDWICH: usize = 10;
/// A point with an error of more than this multiple of the median is reported, if it exceeds the other limit as well.
const BLUNDER: f64 = 5.0;
/// A point with a larger error is reported, if it exceeds the multiple of the median as well.
const LEAST_BLUNDER_M: f64 = 0.010;

/// Position of a point in the target frame, and in the station's frame (m).
type Correspondence = (Vector3<f64>, Vector3<f64>);

#[derive(Clone, Debug, PartialEq)]
pub struct StaticGcpDetails {
    /// Number of points that each station shares with station 1 (or with the global frame); all points of station 1 itself.
    pub shared_points: PerStation<usize>,
    /// Root mean square of the point errors after alignment (m).
    pub rms_m: f64,
    /// Transform from station 1's frame to the global frame; `None` if the points have no global coordinates.
    pub world_from_station1: Option<RigidTransform>,
}

/// Calibrates by the alignment of the control points.
pub fn solve(
    deployment: &Deployment,
    triplets: &Triplets,
    settings: &CalibrationSettings,
    offer: &Offer,
) -> Result<MethodAnswer<StaticGcpDetails>, CalibrationError> {
    let lacking = || CalibrationError::lacking(deployment, Method::StaticGcp, offer);
    let points: Vec<&ControlPoint> = numbered_points(deployment).map(|(_, point)| point).collect();
    let stations = || deployment.tracks.numbers();
    let to_world: Vec<Matches> = stations()
        .map(|station| matches(&points, |point| Some((point.known_m?, read_m(point, station)?))))
        .collect();
    let is_global = to_world.iter().all(|m| m.len() >= FEWEST_POINTS);
    let first = Station::FIRST;
    let matches = if is_global {
        to_world
    } else {
        stations()
            .skip(1)
            .map(|station| {
                matches(&points, |point| Some((read_m(point, first)?, read_m(point, station)?)))
            })
            .collect()
    };
    if matches.is_empty() || matches.iter().any(|m| m.len() < FEWEST_POINTS) {
        return Err(lacking());
    }
    // Ranges are noisier than directions, so errors differ by axis and point. With enough points the sandwich accounts for this.
    let enough = matches.iter().all(|m| m.len() >= FEWEST_FOR_SANDWICH);
    let errors = if enough { Errors::ByBlock } else { Errors::AsResiduals };
    let aligned = point_to_point::align(&matches, settings.alignment, errors).ok_or_else(|| {
        CalibrationError::PointsOnALine {
            deployment: deployment.name.clone(),
            method: Method::StaticGcp,
        }
    })?;
    let (station1_from_station, covariance, world_from_station1) = if is_global {
        let worlds: PerStation<RigidTransform> = aligned.to_from.iter().copied().collect();
        let (transforms, covariance) =
            point_to_point::relative_to_station1(&worlds, aligned.covariance.as_ref());
        (transforms, covariance, Some(worlds[first]))
    } else {
        let others = aligned.to_from.iter().copied();
        let transforms = std::iter::once(RigidTransform::IDENTITY).chain(others).collect();
        (transforms, aligned.covariance, None)
    };
    let of_errors = shared_errors(&matches, is_global, settings, &station1_from_station);
    let covariance = covariance
        .zip(of_errors)
        .map(|(own, of_errors)| point_to_point::level_part(&own) + of_errors.covariance);
    let residuals = || aligned.residuals_m.iter().flatten();
    let rms_m = (residuals().map(Vector3::norm_squared).sum::<f64>()
        / residuals().count().max(1) as f64)
        .sqrt();
    let mut shared_points: PerStation<usize> = matches.iter().map(Matches::len).collect();
    if !is_global {
        let own = points.iter().filter(|point| read_m(point, first).is_some()).count();
        shared_points = std::iter::once(own).chain(shared_points).collect();
    }
    let count = shared_points.iter().skip(1).max().copied().unwrap_or(0);
    let mut judgement = Judgement::good(vec![control_points_aligned(count, is_global, rms_m)]);
    if rms_m > checks::POOR_POINT_FIT_M {
        let is_hopeless = rms_m > checks::HOPELESS_FIT_M;
        judgement.lower(Verdict::Weak, control_points_fit_poorly(rms_m, is_hopeless));
    }
    judgement.doubt(blunders(deployment, &matches, &aligned.residuals_m));
    let mut answer = MethodAnswer {
        method: Method::StaticGcp,
        station1_from_station,
        covariance,
        judgement,
        checked_by: Vec::new(),
        details: StaticGcpDetails { shared_points, rms_m, world_from_station1 },
        prior_ms: 0.0,
    };
    checks::check_with_unused_data(&mut answer, rms_m, deployment, triplets, None);
    Ok(answer)
}

/// Returns the effect of errors that all points of a station share, and of settling until the drive.
fn shared_errors(
    matches: &[Matches],
    is_global: bool,
    settings: &CalibrationSettings,
    station1_from_station: &PerStation<RigidTransform>,
) -> Option<CommonErrors> {
    let (sizes, stations) = (&settings.errors, station1_from_station.len());
    let points: usize = matches.iter().map(Matches::len).sum();
    // Points of station 1 are those to which the others are aligned, or have an alignment of their own.
    let first_station = usize::from(!is_global);
    let mut common = common_errors::effect(sizes, stations, 3 * points, &[], |displace| {
        let displaced = |(index, matches): (usize, &Matches)| {
            let displaced_m = |station: Station, points_m: &[Vector3<f64>]| -> Vec<Vector3<f64>> {
                points_m.iter().map(|point| displace(station, point)).collect()
            };
            let station = Station::at(index + first_station);
            let to_m = if is_global {
                matches.to_m.clone()
            } else {
                displaced_m(Station::FIRST, &matches.to_m)
            };
            Matches {
                to_m,
                from_m: displaced_m(station, &matches.from_m),
                block: matches.block.clone(),
            }
        };
        let displaced: Vec<Matches> = matches.iter().enumerate().map(displaced).collect();
        let placed = point_to_point::transforms(&displaced, settings.alignment)?;
        let residuals_m = point_to_point::residuals_m(&displaced, &placed).concat();
        let station1_from_station = if is_global {
            point_to_point::relative_to_station1(&placed.into_iter().collect(), None).0
        } else {
            std::iter::once(RigidTransform::IDENTITY).chain(placed).collect()
        };
        Some(Displaced::new(station1_from_station, &residuals_m))
    })?;
    common.covariance += common_errors::settling(sizes, station1_from_station);
    Some(common)
}

/// Returns the position of a point in the frame of a station that measured it (m).
fn read_m(point: &ControlPoint, station: Station) -> Option<Vector3<f64>> {
    point.readings.get(station)?.map(Polar::to_cartesian)
}

/// Returns the correspondences of the points, each in a block of its own.
fn matches(
    points: &[&ControlPoint],
    correspondence: impl Fn(&ControlPoint) -> Option<Correspondence>,
) -> Matches {
    let mut matches = Matches::default();
    for (index, point) in points.iter().enumerate() {
        if let Some((to, from)) = correspondence(point) {
            matches.push(to, from, index as u32);
        }
    }
    matches
}

/// Returns all control points with their file, in the order of the block numbers.
fn numbered_points(deployment: &Deployment) -> impl Iterator<Item = (&str, &ControlPoint)> {
    deployment
        .control_points
        .iter()
        .filter(|set| !set.pillars)
        .flat_map(|set| set.points.iter().map(|point| (set.file.as_str(), point)))
}

/// Returns findings for points that fit far worse than the rest: a wrong marker, a wrong coordinate, a target that moved.
fn blunders(
    deployment: &Deployment,
    matches: &[Matches],
    residuals_m: &[Vec<Vector3<f64>>],
) -> Vec<Finding> {
    let points: Vec<(&str, &ControlPoint)> = numbered_points(deployment).collect();
    let mut worst = vec![0.0_f64; points.len()];
    for (matches, residuals) in matches.iter().zip(residuals_m) {
        for (block, residual) in matches.block.iter().zip(residuals) {
            let size = &mut worst[*block as usize];
            *size = size.max(residual.norm());
        }
    }
    let measured = worst.iter().copied().filter(|size| *size > 0.0);
    let Some(typical_m) = median(measured) else { return Vec::new() };
    let limit_m = (BLUNDER * typical_m).max(LEAST_BLUNDER_M);
    points
        .iter()
        .zip(&worst)
        .filter(|(_, size)| **size > limit_m)
        .map(|((file, point), size)| control_point_outlier(file, point.marker, *size, typical_m))
        .collect()
}
