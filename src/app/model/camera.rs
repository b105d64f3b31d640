//! An orbit camera: z is up, in metres of station 1's frame.

use nalgebra::{Matrix4, Point3, Vector3};

/// Ways to look that a button offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPreset {
    /// Everything, from where the camera is turned now.
    Fit,
    /// The view from above at a slant, as a deployment is seen at first.
    Slanted,
    Top,
    /// The view along y, x to the right.
    Front,
    /// The view against x, y to the right.
    Side,
    /// The view from where this station (0 to 2) stands, towards the prisms.
    Station(usize),
}

/// Looks at `target` from `distance_m` away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub target_m: Vector3<f32>,
    pub distance_m: f32,
    /// Direction from the target to the eye, counter-clockwise from x.
    pub yaw_rad: f32,
    /// Height of the eye: 0 on the horizon, π/2 straight above.
    pub pitch_rad: f32,
}

const FIELD_OF_VIEW_RAD: f32 = 0.7;
/// Part of the picture that is filled by what is fitted in.
const FILLED: f32 = 0.88;
const STEEPEST_RAD: f32 = std::f32::consts::FRAC_PI_2 - 1e-3;

impl Default for Camera {
    fn default() -> Self {
        Self { target_m: Vector3::zeros(), distance_m: 60.0, yaw_rad: -2.1, pitch_rad: 0.62 }
    }
}

impl Camera {
    pub fn eye_m(&self) -> Vector3<f32> {
        self.target_m + self.distance_m * self.back()
    }

    /// Towards the eye, of length 1. By the angles alone: told from eye and target, it would depend in its last digits on
    /// what was looked at before.
    fn back(&self) -> Vector3<f32> {
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        Vector3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch)
    }

    /// Clip coordinates from world, depth from 0 to 1 as wgpu wants it.
    pub fn clip_from_world(&self, aspect: f32) -> Matrix4<f32> {
        let view = Matrix4::look_at_rh(
            &Point3::from(self.eye_m()),
            &Point3::from(self.target_m),
            &Vector3::z(),
        );
        let (near, far) = (0.01 * self.distance_m, 60.0 * self.distance_m);
        let f = 1.0 / (FIELD_OF_VIEW_RAD / 2.0).tan();
        let projection = Matrix4::new(
            f / aspect,
            0.0,
            0.0,
            0.0, //
            0.0,
            f,
            0.0,
            0.0, //
            0.0,
            0.0,
            far / (near - far),
            near * far / (near - far), //
            0.0,
            0.0,
            -1.0,
            0.0,
        );
        projection * view
    }

    /// Turns about the target by a drag in points.
    pub fn orbit(&mut self, drag: [f32; 2]) {
        self.yaw_rad -= 0.006 * drag[0];
        self.pitch_rad = (self.pitch_rad + 0.006 * drag[1]).clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Moves the target by a drag in points, so that what is under the pointer stays there.
    pub fn pan(&mut self, drag: [f32; 2], viewport_height: f32) {
        let metres_per_point = self.metres_per_point(viewport_height);
        let [right, up, _] = self.axes();
        self.target_m += metres_per_point * (up * drag[1] - right * drag[0]);
    }

    /// Length that a point of the screen covers at the distance of the target (m).
    pub fn metres_per_point(&self, viewport_height: f32) -> f32 {
        2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / viewport_height.max(1.0)
    }

    /// Stands at a place and looks at another.
    pub fn stand(&mut self, eye_m: &Vector3<f32>, target_m: &Vector3<f32>) {
        let back = eye_m - target_m;
        let distance_m = back.norm();
        if distance_m < 1e-3 {
            return;
        }
        self.target_m = *target_m;
        self.distance_m = distance_m;
        self.yaw_rad = back.y.atan2(back.x);
        self.pitch_rad = (back.z / distance_m).asin().clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Comes closer (factor below 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m = (self.distance_m * factor).clamp(0.05, 20_000.0);
    }

    /// Turns as the preset says and steps back until all points are in the picture, as large as they can be.
    pub fn look(&mut self, preset: ViewPreset, points_m: &[Vector3<f32>], aspect: f32) {
        let Some(first) = points_m.first() else { return };
        match preset {
            // The view stands at the station before it comes here for what the station cannot look at.
            ViewPreset::Fit | ViewPreset::Station(_) => {}
            ViewPreset::Slanted => {
                let Camera { pitch_rad, yaw_rad, .. } = Camera::default();
                (self.pitch_rad, self.yaw_rad) = (pitch_rad, yaw_rad);
            }
            ViewPreset::Top => {
                self.pitch_rad = STEEPEST_RAD;
                self.yaw_rad = -std::f32::consts::FRAC_PI_2;
            }
            ViewPreset::Front => {
                self.pitch_rad = 0.06;
                self.yaw_rad = -std::f32::consts::FRAC_PI_2;
            }
            ViewPreset::Side => {
                self.pitch_rad = 0.06;
                self.yaw_rad = 0.0;
            }
        }
        let [right, up, back] = self.axes();
        let half_height = FILLED * (FIELD_OF_VIEW_RAD / 2.0).tan();
        // A point is between two sides of the picture while its distance from the line of sight is at most `half` times
        // its distance before the eye. That is linear in where the eye stands, so the eye nearest to them all is
        // known for each direction on the picture.
        let fit = |axis: &Vector3<f32>, half: f32| {
            let (mut most, mut least) = (f32::NEG_INFINITY, f32::INFINITY);
            for p in points_m.iter().map(|p| p - first) {
                let (along, before) = (axis.dot(&p), half * back.dot(&p));
                most = most.max(along + before);
                least = least.min(along - before);
            }
            ((most + least) / 2.0, (most - least) / (2.0 * half))
        };
        let (across, wide_m) = fit(&right, half_height * aspect);
        let (above, high_m) = fit(&up, half_height);
        let eye_before_m = wide_m.max(high_m);
        // The target, about which the camera turns, is amid them.
        let before = points_m.iter().map(|p| back.dot(&(p - first)));
        let (nearest, furthest) =
            before.fold((f32::NEG_INFINITY, f32::INFINITY), |(a, b), p| (a.max(p), b.min(p)));
        let middle = (nearest + furthest) / 2.0;
        self.target_m = first + across * right + above * up + middle * back;
        self.distance_m = (eye_before_m - middle).max(0.5);
    }

    /// Unit vectors to the right, up, and back towards the eye.
    fn axes(&self) -> [Vector3<f32>; 3] {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let right = Vector3::new(-sin_yaw, cos_yaw, 0.0);
        let back = self.back();
        [right, back.cross(&right), back]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector4;

    #[test]
    fn what_is_fitted_fills_the_picture_and_stays_inside() {
        let points: Vec<Vector3<f32>> = (0..200)
            .map(|i| {
                let s = i as f32 * 0.1;
                Vector3::new(40.0 + 30.0 * s.sin(), -5.0 + 12.0 * (1.7 * s).cos(), 0.1 * s)
            })
            .collect();
        for preset in [ViewPreset::Fit, ViewPreset::Top, ViewPreset::Front, ViewPreset::Side] {
            for aspect in [0.7, 1.6] {
                let mut camera = Camera::default();
                camera.look(preset, &points, aspect);
                let clip = camera.clip_from_world(aspect);
                let mut widest: f32 = 0.0;
                for p in &points {
                    let c = clip * Vector4::new(p.x, p.y, p.z, 1.0);
                    widest = widest.max((c.x / c.w).abs()).max((c.y / c.w).abs());
                    assert!(c.z / c.w > 0.0 && c.z / c.w < 1.0, "{preset:?}");
                }
                assert!((widest - FILLED).abs() < 0.01, "{preset:?} at {aspect}: {widest}");
            }
        }
    }

    #[test]
    fn who_stands_at_a_station_sees_the_target_in_the_middle() {
        let (eye, target) = (Vector3::new(-5.4, 0.4, -0.2), Vector3::new(40.0, -12.0, 1.5));
        let mut camera = Camera::default();
        camera.stand(&eye, &target);
        assert!((camera.eye_m() - eye).norm() < 1e-4);
        let c = camera.clip_from_world(1.5) * Vector4::new(target.x, target.y, target.z, 1.0);
        assert!((c.x / c.w).abs() < 1e-5 && (c.y / c.w).abs() < 1e-5);
    }

    #[test]
    fn panning_keeps_what_is_under_the_pointer() {
        let mut camera = Camera { pitch_rad: 1.2, ..Camera::default() };
        let (height, aspect) = (800.0, 1.5);
        let project = |camera: &Camera, p: Vector3<f32>| {
            let c = camera.clip_from_world(aspect) * Vector4::new(p.x, p.y, p.z, 1.0);
            [(c.x / c.w) * height * aspect / 2.0, -(c.y / c.w) * height / 2.0]
        };
        let point = camera.target_m;
        let before = project(&camera, point);
        camera.pan([30.0, -20.0], height);
        let after = project(&camera, point);
        assert!((after[0] - before[0] - 30.0).abs() < 0.5, "{before:?} {after:?}");
        assert!((after[1] - before[1] + 20.0).abs() < 0.5, "{before:?} {after:?}");
    }
}
