//! Camera that follows the rig.

use nalgebra::Vector3;

use super::Camera;

/// Time in which the camera makes up two thirds of its distance to the rig (s): a compromise between lag and jerk.
const CATCHES_UP_S: f64 = 0.2;
/// Longest time step of a frame (s); prevents a jump of the camera after a gap in the drawing.
const LONGEST_FRAME_S: f64 = 0.05;
/// The camera has arrived at less than this fraction of its distance to its target, less than a pixel.
const THERE: f32 = 1e-4;

/// A camera that follows the rig; it keeps its distance and its angles.
#[derive(Clone, Copy, Debug, Default)]
pub struct Follow {
    /// Time of the last frame (s of the window's clock).
    last_frame_s: Option<f64>,
}

impl Follow {
    /// Moves the camera towards the middle of the rig (m, station 1's frame); does not move it for `None`.
    ///
    /// Returns true once the camera has arrived, and for `None`.
    pub fn advance(
        &mut self,
        camera: &mut Camera,
        middle_m: Option<Vector3<f32>>,
        now_s: f64,
    ) -> bool {
        let last_s = self.last_frame_s.replace(now_s).unwrap_or(now_s);
        let Some(middle_m) = middle_m else { return true };
        let elapsed_s = (now_s - last_s).clamp(0.0, LONGEST_FRAME_S);
        let left = (-elapsed_s / CATCHES_UP_S).exp() as f32;
        let away_m = (camera.target_m - middle_m) * left;
        let there = away_m.norm() < THERE * camera.distance_m;
        camera.target_m = if there { middle_m } else { middle_m + away_m };
        there
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME_S: f64 = 1.0 / 60.0;

    #[test]
    fn it_comes_to_the_rig_smoothly_and_changes_neither_distance_nor_angles() {
        let before = Camera::default();
        let (mut camera, mut follow) = (before, Follow::default());
        let rig_m = Vector3::new(20.0, -10.0, 1.0);
        let mut last_m = (camera.target_m - rig_m).norm();
        let whole_m = last_m;
        let mut frames = 0;
        while !follow.advance(&mut camera, Some(rig_m), 5.0 + FRAME_S * f64::from(frames)) {
            let away_m = (camera.target_m - rig_m).norm();
            assert!(last_m - away_m < 0.1 * whole_m, "a jump of {} m", last_m - away_m);
            last_m = away_m;
            frames += 1;
            assert!(frames < 180, "three seconds");
        }
        assert!(frames > 20, "it can be seen to move: {frames} frames");
        assert_eq!(camera, Camera { target_m: rig_m, ..before });
    }

    #[test]
    fn a_moving_rig_stays_before_the_camera_whoever_turns_and_zooms_it() {
        let (mut camera, mut follow) = (Camera::default(), Follow::default());
        for frame in 0..240 {
            let now_s = FRAME_S * f64::from(frame);
            let rig_m = Vector3::new(2.0 * now_s as f32, 0.0, 0.0);
            follow.advance(&mut camera, Some(rig_m), now_s);
            camera.orbit([3.0, 0.0]);
            camera.zoom(0.999);
            assert!((camera.target_m - rig_m).norm() < 0.5, "{now_s}: {camera:?}");
        }
    }

    #[test]
    fn it_waits_where_the_rig_was_last_seen_and_does_not_jump_to_where_it_comes_back() {
        let (mut camera, mut follow) = (Camera::default(), Follow::default());
        let seen_m = Vector3::new(1.0, 2.0, 0.0);
        for frame in 0..120 {
            follow.advance(&mut camera, Some(seen_m), FRAME_S * f64::from(frame));
        }
        assert_eq!(camera.target_m, seen_m);
        // A gap of a minute without the rig needs no redrawing.
        assert!(follow.advance(&mut camera, None, 10.0));
        assert!(follow.advance(&mut camera, None, 60.0));
        assert_eq!(camera.target_m, seen_m);
        assert!(!follow.advance(&mut camera, Some(Vector3::new(31.0, 2.0, 0.0)), 70.0));
        let went_m = (camera.target_m - seen_m).norm();
        assert!(went_m > 0.0 && went_m < 10.0, "{went_m} m in one frame");
    }
}
