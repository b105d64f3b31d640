//! Uncertainty of the vehicle's path as a tube about it: rings of the 95 % confidence region across the path, enlarged.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use super::SceneContent;
use super::vertices::{LineVertex, WORLD, f32s};
use crate::app::prepared::way::{Instant, Way};
use resect_tools::palette;

/// Radius of the 95 % confidence circle of a normal distribution in a plane,
/// in σ: the square root of the quantile of χ² with two degrees of freedom.
const SIGMAS_95: f64 = 2.4477;
/// Greatest number of rings along the path, and corners of each.
const MOST_RINGS: usize = 600;
const CORNERS: usize = 12;
/// Least displacement between two rings (m): at rest the path has no direction.
const SHORTEST_M: f64 = 0.02;

impl SceneContent {
    /// Draws the tube, enlarged by a factor; `None` removes it.
    pub fn set_tube(&mut self, way: Option<&Way>, scale: f64) {
        self.tube.clear();
        let Some(way) = way else { return };
        let stride = way.instants.len().div_ceil(MOST_RINGS).max(1);
        for piece in way.pieces([f64::NEG_INFINITY, f64::INFINITY]) {
            let some: Vec<&Instant> = piece.iter().step_by(stride).collect();
            let mut before: Option<[Vector3<f64>; CORNERS]> = None;
            for pair in some.windows(2) {
                let ahead_m = pair[1].position_m - pair[0].position_m;
                if ahead_m.norm() < SHORTEST_M {
                    continue;
                }
                let Some(ring) = ring(pair[0], &ahead_m, scale) else { continue };
                for corner in 0..CORNERS {
                    self.add_tube_line(&ring[corner], &ring[(corner + 1) % CORNERS]);
                }
                // Four lines along it.
                for corner in (0..CORNERS).step_by(CORNERS / 4) {
                    if let Some(before) = &before {
                        self.add_tube_line(&before[corner], &ring[corner]);
                    }
                }
                before = Some(ring);
            }
        }
    }

    fn add_tube_line(&mut self, from_m: &Vector3<f64>, to_m: &Vector3<f64>) {
        let [r, g, b] = palette::METRICS[0];
        self.tube.lines.push(LineVertex {
            from_m: f32s(from_m),
            from_frame: WORLD,
            to_m: f32s(to_m),
            to_frame: WORLD,
            colour: [r, g, b, 150],
            width_points: 1.0,
        });
    }
}

/// Returns the corners of the 95 % confidence ellipse of the position, across a direction.
fn ring(at: &Instant, ahead_m: &Vector3<f64>, scale: f64) -> Option<[Vector3<f64>; CORNERS]> {
    let side = Vector3::z().cross(ahead_m).try_normalize(1e-9)?;
    let up = ahead_m.cross(&side).normalize();
    let across = across(&at.position_covariance_m2, &side, &up);
    let root = across.cholesky()?.l();
    Some(std::array::from_fn(|corner| {
        let (sin, cos) = (std::f64::consts::TAU * corner as f64 / CORNERS as f64).sin_cos();
        let out = scale * SIGMAS_95 * (root * Vector2::new(cos, sin));
        at.position_m + out.x * side + out.y * up
    }))
}

/// Returns the covariance in the plane of two directions.
fn across(covariance: &Matrix3<f64>, side: &Vector3<f64>, up: &Vector3<f64>) -> Matrix2<f64> {
    let between = |a: &Vector3<f64>, b: &Vector3<f64>| a.dot(&(covariance * b));
    Matrix2::new(between(side, side), between(side, up), between(up, side), between(up, up))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A drive along x whose height is three times as uncertain as its lateral position: the ring has these proportions.
    #[test]
    fn a_ring_is_as_wide_as_the_covariance_across_the_way() {
        let instant = |index: u32| Instant {
            time_s: 0.1 * f64::from(index),
            position_m: Vector3::new(f64::from(index), 0.0, 5.0),
            position_covariance_m2: Matrix3::from_diagonal(&Vector3::new(1.0, 1e-6, 9e-6)),
            speed_m_per_s: None,
            attitude: None,
            turn_sigma_rad: None,
        };
        let instants = (0..20).map(instant).collect();
        let way = Way { instants, step_s: 0.1, why_not: None };
        let mut content = SceneContent::default();
        content.set_tube(Some(&way), 100.0);
        let largest = |axis: usize| {
            let ends = content.tube.lines.iter().map(|line| line.from_m[axis]);
            ends.fold(f32::NEG_INFINITY, f32::max)
        };
        assert!((largest(1) - 0.24477).abs() < 1e-4, "{}", largest(1));
        assert!((largest(2) - 5.0 - 3.0 * 0.24477).abs() < 1e-3, "{}", largest(2));
        content.set_tube(None, 100.0);
        assert!(content.tube.lines.is_empty());
    }
}
