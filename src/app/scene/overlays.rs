//! Overlays of a calibration on the tracks: the vehicle's frame along its path, and the uncertainty of each point.

use nalgebra::Vector3;

use super::content::SceneContent;
use super::vehicle::VehicleAt;
use super::vertices::{LineVertex, WORLD, f32s};
use resect_core::analysis::Analysis;
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// Length of the axes of the vehicle's frame along the path (m).
const POSE_AXIS_M: f64 = 0.8;
/// Greatest number of ellipsoids of a station, and corners of each of their ellipses.
const MOST_ELLIPSOIDS: usize = 240;
const CORNERS: usize = 12;

/// Axes x, y, z of any frame, with their colours.
pub const AXES: [(Vector3<f64>, Rgb); 3] = [
    (Vector3::new(1.0, 0.0, 0.0), [214, 73, 60]),
    (Vector3::new(0.0, 1.0, 0.0), [84, 168, 74]),
    (Vector3::new(0.0, 0.0, 1.0), [70, 130, 220]),
];

/// Adds the axes of poses along the path, faint outside of the selection.
pub fn add_poses(lines: &mut Vec<LineVertex>, poses: &[VehicleAt], selection_s: Option<[f64; 2]>) {
    for pose in poses {
        let selected = selection_s.is_none_or(|[a, b]| (a..=b).contains(&pose.time_s));
        add_axes(lines, pose, POSE_AXIS_M, 1.2, if selected { 170 } else { 30 });
    }
}

/// Adds the axes of one pose, larger than those along the path.
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

/// Adds 2 σ ellipsoids at even steps of the stations' tracks, enlarged by a factor, each as three ellipses; returns true if there are any.
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
    let [r, g, b] = palette::station(station);
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
