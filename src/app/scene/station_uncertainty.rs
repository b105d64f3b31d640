//! Uncertainties of stations 2, 3, …: ellipsoids of their covariance, and double arrows along the unconstrained or weak directions.

use nalgebra::{Matrix3, Vector3};

use super::content::SceneContent;
use super::vertices::{Label, LineVertex, Rank, WORLD, opaque};
use resect_core::calibration::Calibration;
use resect_core::calibration::inter_prism::observability::{Hold, Observability, StationMotion};
use resect_core::network::{MOST_STATIONS, Number as _};
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// Semi-axes of the 95 % confidence ellipsoid of a three-dimensional normal distribution, in
/// standard deviations: the square root of the quantile of χ² with three degrees of freedom.
const SIGMAS_95: f64 = 2.7955;
/// Corners of each of an ellipsoid's three ellipses.
const CORNERS: usize = 32;
/// Half the length of a direction's longest arrow, as a share of the scene; and the
/// least displacement of a station, relative to the larger one, that has an arrow.
const ARROW: f32 = 0.07;
const SHORTEST_ARROW: f64 = 0.15;
/// Displacement of the track's points by a station's yaw, as a share of the whole, from which an arc is drawn.
const TURNS: f64 = 0.5;
const ARC_RAD: f32 = 0.9;

/// Adds the ellipsoids of the visible stations, enlarged by a factor; returns true if there are any: without a covariance there are none.
pub fn add_ellipsoids(
    content: &mut SceneContent,
    calibration: &Calibration,
    shown: &[bool; MOST_STATIONS],
    scale: f64,
) -> bool {
    let Some(covariance) = &calibration.covariance else { return false };
    for (station, transform) in calibration.station1_from_station.iter().enumerate().skip(1) {
        if !shown[station] {
            continue;
        }
        let row = 4 * (station - 1);
        let axes = semi_axes_m(&covariance.fixed_view::<3, 3>(row, row).into_owned());
        let origin = transform.translation_m;
        for flat in 0..3 {
            let (first, second) = (axes[(flat + 1) % 3], axes[(flat + 2) % 3]);
            let corner = |at: usize| {
                let (sin, cos) = (std::f64::consts::TAU * at as f64 / CORNERS as f64).sin_cos();
                (origin + scale * (first * cos + second * sin)).cast::<f32>()
            };
            let corners: Vec<_> = (0..=CORNERS).map(corner).collect();
            add_path(&mut content.data.lines, &corners, palette::station(station), 1.4);
        }
    }
    shown[1..calibration.station1_from_station.len()].contains(&true)
}

/// Returns the semi-axes of the 95 % confidence ellipsoid, the shortest first.
fn semi_axes_m(covariance_m2: &Matrix3<f64>) -> [Vector3<f64>; 3] {
    let eigen = covariance_m2.symmetric_eigen();
    let mut axes = [0, 1, 2].map(|k| {
        let sigma_m = eigen.eigenvalues[k].max(0.0).sqrt();
        eigen.eigenvectors.column(k) * (SIGMAS_95 * sigma_m)
    });
    axes.sort_by(|a, b| a.norm().total_cmp(&b.norm()));
    axes
}

/// Adds arrows along unconstrained or weak directions, with a label at the station that moves most.
pub fn add_weak_directions(
    content: &mut SceneContent,
    calibration: &Calibration,
    observed: &Observability,
    shown: &[bool; MOST_STATIONS],
) {
    let Some(extent_m) = extent_m(content) else { return };
    // Labels are placed from the last to the first: the least constrained direction, which the findings name, must find room.
    for direction in observed.directions.iter().rev().filter(|d| d.hold != Hold::Held) {
        let colour = palette::hold(direction.hold);
        let move_m = |motion: &StationMotion| motion.translation_m.norm();
        let most = direction.motion.iter().map(move_m).fold(0.0, f64::max);
        let mover = direction.motion.each().find(|(_, motion)| move_m(motion) >= most);
        for (station, motion) in direction.motion.each().skip(1) {
            if !shown[station.index()] {
                continue;
            }
            let StationMotion { translation_m, yaw_rad } = *motion;
            let origin = calibration.station1_from_station[station].translation_m.cast::<f32>();
            let mut tip = origin;
            if move_m(motion) > SHORTEST_ARROW * most {
                let half = (translation_m / most).cast::<f32>() * (ARROW * extent_m);
                add_double_arrow(&mut content.data.lines, &[origin - half, origin + half], colour);
                tip = origin + half;
                // The camera fits them in.
                content.outline_m.extend([origin - half, tip]);
            }
            if yaw_rad.abs() * observed.track_radius_m > TURNS {
                let arc = arc_towards(content, origin, 0.5 * ARROW * extent_m);
                add_double_arrow(&mut content.data.lines, &arc, colour);
            }
            if mover.is_some_and(|(mover, _)| mover == station) {
                let text = direction.short().to_owned();
                let label = Label { position_m: tip, text, colour, rank: Rank::Direction };
                content.labels.push(label);
            }
        }
    }
}

/// Returns an arc about a station's vertical, on the side of the scene's middle.
fn arc_towards(content: &SceneContent, origin: Vector3<f32>, radius_m: f32) -> Vec<Vector3<f32>> {
    let (low, high) = content.bounds_m.unwrap_or((origin, origin));
    let to_middle = (low + high) / 2.0 - origin;
    let middle_rad = to_middle.y.atan2(to_middle.x);
    (-8..=8)
        .map(|step| {
            let (sin, cos) = (middle_rad + ARC_RAD * step as f32 / 8.0).sin_cos();
            origin + radius_m * Vector3::new(cos, sin, 0.0)
        })
        .collect()
}

/// Adds a path with an arrowhead at both ends.
fn add_double_arrow(lines: &mut Vec<LineVertex>, path: &[Vector3<f32>], colour: Rgb) {
    add_path(lines, path, colour, 2.5);
    let length: f32 = path.windows(2).map(|ends| (ends[1] - ends[0]).norm()).sum();
    let last = path.len() - 1;
    for (tip, before) in [(path[0], path[1]), (path[last], path[last - 1])] {
        let Some(back) = (before - tip).try_normalize(1e-6) else { continue };
        // Any side is suitable for a vertical arrow.
        let side = back.cross(&Vector3::z()).try_normalize(0.1).unwrap_or_else(Vector3::x);
        for side in [side, -side] {
            let barb = tip + 0.12 * length * (back + 0.5 * side);
            add_path(lines, &[tip, barb], colour, 2.5);
        }
    }
}

fn add_path(lines: &mut Vec<LineVertex>, path: &[Vector3<f32>], colour: Rgb, width_points: f32) {
    lines.extend(path.windows(2).map(|ends| LineVertex {
        from_m: ends[0].into(),
        from_frame: WORLD,
        to_m: ends[1].into(),
        to_frame: WORLD,
        colour: opaque(colour),
        width_points,
    }));
}

/// Returns the longer horizontal side of the scene (m).
fn extent_m(content: &SceneContent) -> Option<f32> {
    let (low, high) = content.bounds_m?;
    Some((high.x - low.x).max(high.y - low.y).max(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn the_axes_of_a_known_covariance() {
        // σ 1, 2 and 4 mm, the longest rotated by 30° about z from x.
        let turn =
            *nalgebra::Rotation3::from_axis_angle(&Vector3::z_axis(), std::f64::consts::FRAC_PI_6)
                .matrix();
        let own = Matrix3::from_diagonal(&Vector3::new(16e-6, 1e-6, 4e-6));
        let [short, middle, long] = semi_axes_m(&(turn * own * turn.transpose()));
        assert_relative_eq!(short.norm(), 2.7955e-3, epsilon = 1e-12);
        assert_relative_eq!(middle.norm(), 5.591e-3, epsilon = 1e-12);
        assert_relative_eq!(middle.z.abs(), 5.591e-3, epsilon = 1e-12);
        assert_relative_eq!(long.norm(), 11.182e-3, epsilon = 1e-12);
        assert_relative_eq!((long.y / long.x).atan(), std::f64::consts::FRAC_PI_6, epsilon = 1e-9);
    }
}
