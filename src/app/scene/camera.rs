//! An orbit camera: z is up, in metres of station 1's frame.

use nalgebra::{Matrix4, Point3, Vector3, Vector4};

/// Ways to look that a button offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPreset {
    /// Everything, from where the camera is turned now.
    Fit,
    Top,
    Side,
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
const STEEPEST_RAD: f32 = std::f32::consts::FRAC_PI_2 - 1e-3;

impl Default for Camera {
    fn default() -> Self {
        Self { target_m: Vector3::zeros(), distance_m: 60.0, yaw_rad: -2.1, pitch_rad: 0.62 }
    }
}

impl Camera {
    pub fn eye_m(&self) -> Vector3<f32> {
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        self.target_m
            + self.distance_m * Vector3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch)
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
        let metres_per_point =
            2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / viewport_height.max(1.0);
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let right = Vector3::new(-sin_yaw, cos_yaw, 0.0);
        let back = (self.eye_m() - self.target_m) / self.distance_m;
        let up = back.cross(&right);
        self.target_m += metres_per_point * (up * drag[1] - right * drag[0]);
    }

    /// Comes closer (factor below 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m = (self.distance_m * factor).clamp(0.05, 20_000.0);
    }

    /// Turns as the preset says and steps back until all points are in the picture, as large as they can be.
    pub fn look(&mut self, preset: ViewPreset, points_m: &[Vector3<f32>], aspect: f32) {
        let Some(first) = points_m.first() else { return };
        match preset {
            ViewPreset::Fit => {}
            ViewPreset::Top => {
                self.pitch_rad = STEEPEST_RAD;
                self.yaw_rad = -std::f32::consts::FRAC_PI_2;
            }
            ViewPreset::Side => {
                self.pitch_rad = 0.06;
                self.yaw_rad = -std::f32::consts::FRAC_PI_2;
            }
        }
        let (low, high) =
            points_m.iter().fold((*first, *first), |(low, high), p| (low.inf(p), high.sup(p)));
        self.target_m = (low + high) / 2.0;
        self.distance_m = (high - low).norm().max(0.5);
        // Perspective makes this a small fixed-point problem: centre what is seen, scale, and look again.
        for _ in 0..20 {
            let clip = self.clip_from_world(aspect);
            let (mut least, mut most) = ([f32::INFINITY; 2], [f32::NEG_INFINITY; 2]);
            let mut behind = false;
            for p in points_m {
                let c = clip * Vector4::new(p.x, p.y, p.z, 1.0);
                behind |= c.w <= 0.0;
                for axis in 0..2 {
                    let at = c[axis] / c.w;
                    least[axis] = least[axis].min(at);
                    most[axis] = most[axis].max(at);
                }
            }
            if behind {
                self.distance_m *= 2.0;
                continue;
            }
            let middle = [(least[0] + most[0]) / 2.0, (least[1] + most[1]) / 2.0];
            let height = 2.0;
            self.pan([-middle[0] * aspect, middle[1]], height);
            let widest = (0..2).map(|axis| (most[axis] - least[axis]) / 2.0).fold(0.0, f32::max);
            self.distance_m = (self.distance_m * (widest / 0.88).clamp(0.5, 2.0)).max(0.5);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_fitted_fills_the_picture_and_stays_inside() {
        let points: Vec<Vector3<f32>> = (0..200)
            .map(|i| {
                let s = i as f32 * 0.1;
                Vector3::new(40.0 + 30.0 * s.sin(), -5.0 + 12.0 * (1.7 * s).cos(), 0.1 * s)
            })
            .collect();
        for preset in [ViewPreset::Fit, ViewPreset::Top, ViewPreset::Side] {
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
                assert!(widest > 0.8 && widest < 0.96, "{preset:?} at {aspect}: {widest}");
            }
        }
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
