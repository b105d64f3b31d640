//! Flight of the camera to a picked position.

use nalgebra::Vector3;

use crate::app::model::Camera;

/// Duration (s), long enough for the eye to follow.
const LASTS_S: f64 = 0.3;
/// Largest final distance (m), at which the rig fills about a tenth of the picture.
const CLOSE_M: f32 = 15.0;

/// A flight of the camera from its target to another one.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    from: (Vector3<f32>, f32),
    to: (Vector3<f32>, f32),
    /// Time of the first frame (s, the window's clock).
    started_s: Option<f64>,
}

impl Flight {
    pub fn new(camera: &Camera, target_m: Vector3<f32>) -> Self {
        Self {
            from: (camera.target_m, camera.distance_m),
            to: (target_m, camera.distance_m.min(CLOSE_M)),
            started_s: None,
        }
    }

    /// Moves the camera along the flight; returns true on arrival.
    pub fn advance(&mut self, camera: &mut Camera, now_s: f64) -> bool {
        let started_s = *self.started_s.get_or_insert(now_s);
        let share = ((now_s - started_s) / LASTS_S).clamp(0.0, 1.0) as f32;
        // Smoothstep.
        let eased = share * share * (3.0 - 2.0 * share);
        camera.target_m = self.from.0.lerp(&self.to.0, eased);
        // Equal steps of the logarithm look equal.
        camera.distance_m = self.from.1 * (self.to.1 / self.from.1).powf(eased);
        share >= 1.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_arrives_after_a_third_of_a_second_and_comes_closer_but_never_backs_off() {
        for (distance_m, close_m) in [(80.0, CLOSE_M), (3.0, 3.0)] {
            let mut camera = Camera { distance_m, ..Camera::default() };
            let wanted = Vector3::new(10.0, -4.0, 1.0);
            let mut flight = Flight::new(&camera, wanted);
            assert!(!flight.advance(&mut camera, 100.0));
            assert_eq!(camera.distance_m, distance_m);
            assert!(!flight.advance(&mut camera, 100.15));
            let half_way = camera.target_m.norm() / wanted.norm();
            assert!(half_way > 0.3 && half_way < 0.7, "{half_way}");
            assert!(flight.advance(&mut camera, 100.31));
            assert!((camera.target_m - wanted).norm() < 1e-5);
            assert!((camera.distance_m - close_m).abs() < 1e-4);
        }
    }
}
