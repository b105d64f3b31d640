//! What an answer adds to the tracks: the vehicle's frame along its way, and how well each point is known.

use nalgebra::Vector3;

use super::content::SceneContent;
use super::vertices::{LineVertex, WORLD, f32s};
use crate::analysis::Analysis;
use crate::deployment::Deployment;
use crate::evaluation::trajectory::{Pose, PoseSigma};
use crate::evaluation::vehicle::{LARGEST_POSE_ERROR_M, vehicle_at, vehicle_trajectory};
use crate::geometry::RigidTransform;
use crate::palette::{self, Rgb};
use crate::pipeline::Triplets;

/// The vehicle's frame is drawn so many times along the way, with axes of this length (m).
const MOST_POSES: usize = 150;
const POSE_AXIS_M: f64 = 0.8;
/// Ellipsoids a station, and corners of each of their ellipses.
const MOST_ELLIPSOIDS: usize = 240;
const CORNERS: usize = 12;

/// Axes x, y, z of any frame, with their colours.
pub const AXES: [(Vector3<f64>, Rgb); 3] = [
    (Vector3::new(1.0, 0.0, 0.0), [214, 73, 60]),
    (Vector3::new(0.0, 1.0, 0.0), [84, 168, 74]),
    (Vector3::new(0.0, 0.0, 1.0), [70, 130, 220]),
];

/// The vehicle at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct VehicleAt {
    pub time_s: f64,
    pub station1_from_vehicle: RigidTransform,
    pub by: PoseBy,
}

/// What says where the vehicle is.
#[derive(Clone, Debug, PartialEq)]
pub enum PoseBy {
    /// The motion of the joint estimate, which rests on the readings around; its σ is made beside the window.
    Motion,
    /// One triplet, by three distances.
    Triplet(PoseSigma),
}

/// The vehicle at some instants; nowhere where there is no rig or no answer.
fn vehicles(deployment: &Deployment, analysis: &Analysis, some: &Triplets) -> Vec<VehicleAt> {
    let Ok(answer) = &analysis.answer else { return Vec::new() };
    let calibration = &answer.calibration;
    if calibration.joint().is_some() {
        let at = |time_s: &f64| {
            let station1_from_vehicle = vehicle_at(deployment, calibration, *time_s)?;
            Some(VehicleAt { time_s: *time_s, station1_from_vehicle, by: PoseBy::Motion })
        };
        return some.time_s.iter().filter_map(at).collect();
    }
    let (targets, transforms) = (analysis.offer.targets, calibration.placing_tracks(deployment));
    let found = vehicle_trajectory(deployment, some, targets, transforms, LARGEST_POSE_ERROR_M);
    let at = |pose: &Pose| VehicleAt {
        time_s: pose.time_s,
        station1_from_vehicle: RigidTransform {
            rotation: pose.orientation.to_rotation_matrix(),
            translation_m: pose.position_m,
        },
        by: PoseBy::Triplet(pose.sigma()),
    };
    found.map_or(Vec::new(), |(trajectory, _)| trajectory.poses.iter().map(at).collect())
}

/// The vehicle at even steps along the way.
pub fn poses_along(deployment: &Deployment, analysis: &Analysis) -> Vec<VehicleAt> {
    let count = analysis.triplets().len();
    let instants: Vec<usize> = (0..count).step_by(count.div_ceil(MOST_POSES).max(1)).collect();
    vehicles(deployment, analysis, &analysis.triplets().select(&instants))
}

/// Adds the axes of poses along the way; outside of what is selected they are faint.
pub fn add_poses(lines: &mut Vec<LineVertex>, poses: &[VehicleAt], selection_s: Option<[f64; 2]>) {
    for pose in poses {
        let selected = selection_s.is_none_or(|[a, b]| (a..=b).contains(&pose.time_s));
        add_axes(lines, pose, POSE_AXIS_M, 1.2, if selected { 170 } else { 30 });
    }
}

/// The vehicle at the instant of one triplet; `None` where there is no rig and no answer, and where one triplet alone would
/// have to say it and contradicts the rig.
pub fn pose_of(
    deployment: &Deployment,
    analysis: &Analysis,
    triplet: &Triplets,
) -> Option<VehicleAt> {
    vehicles(deployment, analysis, triplet).pop()
}

/// Adds the axes of one pose, larger than those along the way.
pub fn add_pose(lines: &mut Vec<LineVertex>, pose: &VehicleAt) {
    add_axes(lines, pose, 2.0 * POSE_AXIS_M, 2.5, 255);
}

fn add_axes(
    lines: &mut Vec<LineVertex>,
    pose: &VehicleAt,
    length_m: f64,
    width_points: f32,
    alpha: u8,
) {
    let place = &pose.station1_from_vehicle;
    for (axis, [r, g, b]) in AXES {
        lines.push(LineVertex {
            from_m: f32s(&place.translation_m),
            from_frame: WORLD,
            to_m: f32s(&place.apply(&(length_m * axis))),
            to_frame: WORLD,
            colour: [r, g, b, alpha],
            width_points,
        });
    }
}

/// Adds 2 σ ellipsoids, so many times larger than true and each as three ellipses, at even steps of the stations' tracks;
/// gives whether there are any.
pub fn add_uncertainty(
    content: &mut SceneContent,
    analysis: &Analysis,
    stations: &[usize],
    scale: f64,
) -> bool {
    let triplets = analysis.triplets();
    let Some(sigma_m) = &triplets.sigma_m else { return false };
    let step = triplets.len().div_ceil(MOST_ELLIPSOIDS).max(1);
    for &station in stations {
        for index in (0..triplets.len()).step_by(step) {
            let centre_m = triplets.points_m[station][index];
            let radii_m = 2.0 * scale * sigma_m[station][index];
            add_ellipsoid(&mut content.data.lines, station, &centre_m, &radii_m);
        }
    }
    !stations.is_empty() && !triplets.is_empty()
}

/// Adds an ellipsoid in the station's frame, along its axes.
fn add_ellipsoid(
    lines: &mut Vec<LineVertex>,
    station: usize,
    centre_m: &Vector3<f64>,
    radii_m: &Vector3<f64>,
) {
    let [r, g, b] = palette::STATIONS[station];
    for flat in 0..3 {
        let (first, second) = ((flat + 1) % 3, (flat + 2) % 3);
        let place = |at: usize| {
            let (sin, cos) = (std::f64::consts::TAU * at as f64 / CORNERS as f64).sin_cos();
            let mut place = *centre_m;
            place[first] += radii_m[first] * cos;
            place[second] += radii_m[second] * sin;
            f32s(&place)
        };
        lines.extend((0..CORNERS).map(|at| LineVertex {
            from_m: place(at),
            from_frame: station as u32,
            to_m: place(at + 1),
            to_frame: station as u32,
            colour: [r, g, b, 120],
            width_points: 1.0,
        }));
    }
}
