//! Latitudes and longitudes that were read under each other's name, or as degrees although they are radians.

use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

use nalgebra::Vector3;

use super::unit_of_length::{ShapeFit, compare_shapes};
use crate::estimates::ground_truth::GroundTruth;
use resect_core::deployment::{EstimatedPose, EstimatedTrajectory};
use resect_core::evaluation::no_trajectory::NoTrajectory;
use resect_core::geometry::Geodetic;

/// A meaning has the shape of the other trajectory if it fits this many times better than as read.
/// Effect: at equal latitude and longitude, a flat drive has one shape by both meanings.
const TIMES_BETTER: f64 = 3.0;
/// Radians that were read as degrees are too small by this factor.
const RADIAN: f64 = 180.0 / PI;

/// The meaning of latitudes and longitudes that differs from their names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MisreadDegrees {
    Exchanged,
    Radians,
}

impl MisreadDegrees {
    /// States the meaning and its remedy.
    pub fn in_words(self) -> [&'static str; 2] {
        match self {
            Self::Exchanged => {
                ["latitude and longitude are exchanged", "exchange their names in the header"]
            }
            Self::Radians => {
                ["latitude and longitude are radians", "name the columns lat_rad and lon_rad"]
            }
        }
    }
}

/// Returns the meaning with which one of the two has the shape and size of the other, and true if it is that of the ground truth. `as_read` is
/// their comparison without it.
pub fn misread_degrees(
    truth: &Arc<EstimatedTrajectory>,
    estimate: &EstimatedTrajectory,
    as_read: Option<&ShapeFit>,
) -> Result<Option<(MisreadDegrees, bool)>, NoTrajectory> {
    for meaning in [MisreadDegrees::Exchanged, MisreadDegrees::Radians] {
        for is_of_truth in [true, false] {
            let owner = if is_of_truth { truth } else { estimate };
            let Some(converted) = converted(owner, meaning) else { continue };
            let shapes = if is_of_truth {
                let truth = Arc::new(EstimatedTrajectory { poses: converted, ..(**truth).clone() });
                compare_shapes(&GroundTruth::Trajectory(truth, None), &estimate.poses, None)?
            } else {
                let truth = GroundTruth::Trajectory(Arc::clone(truth), None);
                compare_shapes(&truth, &converted, None)?
            };
            let is_better = |shapes: &ShapeFit| {
                as_read.is_none_or(|as_read| {
                    as_read.relative_misfit > TIMES_BETTER * shapes.relative_misfit
                })
            };
            if shapes.is_some_and(|shapes| shapes.is_alike() && is_better(&shapes)) {
                return Ok(Some((meaning, is_of_truth)));
            }
        }
    }
    Ok(None)
}

/// Returns the positions east, north and up by another meaning; `None` if the numbers cannot have it.
fn converted(
    trajectory: &EstimatedTrajectory,
    meaning: MisreadDegrees,
) -> Option<Vec<EstimatedPose>> {
    let Geodetic { latitude_rad, longitude_rad, .. } = trajectory.origin?;
    let true_latitude_rad = match meaning {
        MisreadDegrees::Exchanged => longitude_rad,
        MisreadDegrees::Radians => RADIAN * latitude_rad,
    };
    let is_on_earth = true_latitude_rad.abs() < FRAC_PI_2
        && (meaning == MisreadDegrees::Exchanged || RADIAN * longitude_rad.abs() <= PI);
    let per_longitude = true_latitude_rad.cos();
    let converted = |pose: &EstimatedPose| {
        let [east_m, north_m, up_m]: [f64; 3] = pose.position_m.into();
        // Steps as read, times the radius of the Earth.
        let [longitude_m, latitude_m] = [east_m / latitude_rad.cos(), north_m];
        let position_m = match meaning {
            MisreadDegrees::Exchanged => {
                Vector3::new(per_longitude * latitude_m, longitude_m, up_m)
            }
            MisreadDegrees::Radians => {
                Vector3::new(RADIAN * per_longitude * longitude_m, RADIAN * latitude_m, up_m)
            }
        };
        EstimatedPose { position_m, ..*pose }
    };
    is_on_earth.then(|| trajectory.poses.iter().map(converted).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimates::simulated_odometry::trajectory;

    fn figure_eight() -> Vec<EstimatedPose> {
        let pose = |index: usize| {
            let phase = 0.01 * index as f64;
            let position_m = Vector3::new(
                20.0 * phase.sin() + 3.0 * (0.3 * phase).cos(),
                8.0 * (2.0 * phase).sin(),
                0.2 * (3.0 * phase).cos(),
            );
            EstimatedPose { time_s: 0.1 * index as f64, position_m, orientation: None }
        };
        (0..1200).map(pose).collect()
    }

    /// Positions about an origin (degrees) as they would be read with steps of latitude and longitude times some factors and exchanged or not.
    fn read_as(
        [latitude, longitude]: [f64; 2],
        meaning: Option<MisreadDegrees>,
    ) -> EstimatedTrajectory {
        let narrowing = latitude.to_radians().cos();
        let read = |pose: EstimatedPose| {
            let [x, y, z]: [f64; 3] = pose.position_m.into();
            let [longitude_m, latitude_m] = [x / narrowing, y];
            let position_m = match meaning {
                None => Vector3::new(x, y, z),
                Some(MisreadDegrees::Exchanged) => {
                    Vector3::new(longitude.to_radians().cos() * latitude_m, longitude_m, z)
                }
                Some(MisreadDegrees::Radians) => {
                    let narrowing = latitude.to_radians().to_radians().cos();
                    Vector3::new(narrowing * longitude_m / RADIAN, latitude_m / RADIAN, z)
                }
            };
            EstimatedPose { position_m, ..pose }
        };
        let [latitude_rad, longitude_rad] = match meaning {
            None => [latitude, longitude],
            Some(MisreadDegrees::Exchanged) => [longitude, latitude],
            Some(MisreadDegrees::Radians) => [latitude.to_radians(), longitude.to_radians()],
        }
        .map(f64::to_radians);
        EstimatedTrajectory {
            origin: Some(Geodetic { latitude_rad, longitude_rad, height_m: 0.0 }),
            ..trajectory("rtk", figure_eight().into_iter().map(read).collect())
        }
    }

    #[test]
    fn exchanged_names_and_radians_are_found_on_both_sides_and_right_ones_are_left() {
        let local = trajectory("local", figure_eight());
        // In Zürich, in Québec, and at equal numbers, where the shape is the same.
        for (place, tells) in [([47.4, 8.5], true), ([46.8, -71.2], true), ([45.0, 45.0], false)] {
            for meaning in [None, Some(MisreadDegrees::Exchanged), Some(MisreadDegrees::Radians)] {
                for is_of_truth in [true, false] {
                    let geodetic = read_as(place, meaning);
                    let (truth, estimate) =
                        if is_of_truth { (&geodetic, &local) } else { (&local, &geodetic) };
                    let truth = Arc::new(truth.clone());
                    let as_read = GroundTruth::Trajectory(Arc::clone(&truth), None);
                    let as_read = compare_shapes(&as_read, &estimate.poses, None).expect("times");
                    let found = misread_degrees(&truth, estimate, as_read.as_ref()).expect("times");
                    if tells || meaning.is_none() {
                        assert_eq!(
                            found,
                            meaning.map(|meaning| (meaning, is_of_truth)),
                            "{place:?}"
                        );
                    }
                }
            }
        }
    }
}
