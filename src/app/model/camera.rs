//! An orbit camera; z is up, lengths in metres (station 1's frame).

use nalgebra::{Matrix4, Vector3};

/// View presets of the buttons.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ViewPreset {
    /// Everything, in the present direction.
    Fit,
    /// Oblique view from above, the initial view of a deployment.
    Slanted,
    Top,
    /// View along y, x to the right.
    Front,
    /// View against x, y to the right.
    Side,
    /// View from this station (0 to 2) towards the prisms.
    Station(usize),
}

/// Camera that looks at `target_m` from `distance_m` away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    pub target_m: Vector3<f32>,
    /// Distance from the eye to the target (m); in parallel projection, the distance at which a perspective shows the same scale.
    pub distance_m: f32,
    /// Direction from the target to the eye, counter-clockwise from x.
    pub yaw_rad: f32,
    /// Elevation of the eye: 0 at the horizon, π/2 straight above.
    pub pitch_rad: f32,
    /// True for parallel projection.
    pub parallel: bool,
    /// Vertical exaggeration of the drawing. All positions outside the camera are true ones.
    pub vertical: f32,
}

/// Shape of a picture, and its uncovered area.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Width over height.
    pub aspect: f32,
    /// Left and right bound of the uncovered area, from −1 at the left to 1 at the right of the picture.
    pub across: [f32; 2],
    /// Lower and upper bound, from −1 at the bottom to 1 at the top.
    pub upwards: [f32; 2],
}

impl Frame {
    /// Returns the frame of a picture without covered areas.
    pub fn whole(aspect: f32) -> Self {
        Self { aspect, across: [-1.0, 1.0], upwards: [-1.0, 1.0] }
    }
}

const FIELD_OF_VIEW_RAD: f32 = 0.7;
/// Fraction of the uncovered area that fitted points fill.
const FILLED: f32 = 0.88;
const STEEPEST_RAD: f32 = std::f32::consts::FRAC_PI_2;
/// Depth before and behind the target that is drawn, at any distance of the camera.
const DEEP_M: f32 = 20_000.0;
/// Limits of the distance: from a hand's breadth to the whole scene in a tenth of the picture.
const NEAREST_M: f32 = 0.05;
const FURTHEST_RADII: f32 = 30.0;

impl Default for Camera {
    fn default() -> Self {
        Self {
            target_m: Vector3::zeros(),
            distance_m: 60.0,
            yaw_rad: -2.1,
            pitch_rad: 0.62,
            parallel: false,
            vertical: 1.0,
        }
    }
}

impl Camera {
    pub fn eye_m(&self) -> Vector3<f32> {
        self.lowered(&(self.raised(&self.target_m) + self.distance_m * self.back()))
    }

    /// Returns the unit vector towards the eye, from the angles alone. Computed from eye and target, its last digits would
    /// depend on the previous view.
    pub fn back(&self) -> Vector3<f32> {
        let (sin_pitch, cos_pitch) = self.pitch_rad.sin_cos();
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        Vector3::new(cos_pitch * cos_yaw, cos_pitch * sin_yaw, sin_pitch)
    }

    /// Unit vectors to the right, up, and back towards the eye.
    fn axes(&self) -> [Vector3<f32>; 3] {
        let (sin_yaw, cos_yaw) = self.yaw_rad.sin_cos();
        let right = Vector3::new(-sin_yaw, cos_yaw, 0.0);
        let back = self.back();
        [right, back.cross(&right), back]
    }

    /// Applies the vertical exaggeration to a position or vector; `lowered` is the inverse.
    fn raised(&self, v: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(v.x, v.y, v.z * self.vertical)
    }

    fn lowered(&self, v: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(v.x, v.y, v.z / self.vertical)
    }

    /// Returns the matrix from world to clip coordinates, with depths from 0 to 1 as wgpu requires.
    pub fn clip_from_world(&self, aspect: f32) -> Matrix4<f32> {
        let [right, up, back] = self.axes();
        let eye = self.raised(&self.target_m) + self.distance_m * back;
        let row = |axis: Vector3<f32>| axis.push(-axis.dot(&eye)).transpose();
        let world = nalgebra::RowVector4::new(0.0, 0.0, 0.0, 1.0);
        let view = Matrix4::from_rows(&[row(right), row(up), row(back), world]);
        let raised = Matrix4::new_nonuniform_scaling(&Vector3::new(1.0, 1.0, self.vertical));
        self.clip_from_view(aspect) * view * raised
    }

    #[rustfmt::skip]
    fn clip_from_view(&self, aspect: f32) -> Matrix4<f32> {
        let tangent = (FIELD_OF_VIEW_RAD / 2.0).tan();
        if self.parallel {
            let high = 1.0 / (self.distance_m * tangent);
            let near = self.distance_m - DEEP_M;
            return Matrix4::new(
                high / aspect, 0.0, 0.0, 0.0,
                0.0, high, 0.0, 0.0,
                0.0, 0.0, -0.5 / DEEP_M, -0.5 * near / DEEP_M,
                0.0, 0.0, 0.0, 1.0,
            );
        }
        let (near, far) = (0.01 * self.distance_m, self.distance_m + DEEP_M);
        let high = 1.0 / tangent;
        Matrix4::new(
            high / aspect, 0.0, 0.0, 0.0,
            0.0, high, 0.0, 0.0,
            0.0, 0.0, far / (near - far), near * far / (near - far),
            0.0, 0.0, -1.0, 0.0,
        )
    }

    /// Rotates about the target by a drag in points.
    pub fn orbit(&mut self, drag: [f32; 2]) {
        self.yaw_rad -= 0.006 * drag[0];
        self.pitch_rad = (self.pitch_rad + 0.006 * drag[1]).clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Moves the target by a drag in points, so that the point under the pointer stays there.
    pub fn pan(&mut self, drag: [f32; 2], viewport_height: f32) {
        let metres_per_point = self.metres_per_point(viewport_height);
        let [right, up, _] = self.axes();
        self.target_m += self.lowered(&(metres_per_point * (up * drag[1] - right * drag[0])));
    }

    /// Returns the length that a point of the screen covers at the distance of the target (m).
    pub fn metres_per_point(&self, viewport_height: f32) -> f32 {
        2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / viewport_height.max(1.0)
    }

    /// Moves the eye to a position and looks at another.
    pub fn stand(&mut self, eye_m: &Vector3<f32>, target_m: &Vector3<f32>) {
        let back = self.raised(&(eye_m - target_m));
        let distance_m = back.norm();
        if distance_m < 1e-3 {
            return;
        }
        self.parallel = false;
        self.target_m = *target_m;
        self.distance_m = distance_m;
        self.yaw_rad = back.y.atan2(back.x);
        self.pitch_rad = (back.z / distance_m).asin().clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Moves closer (factor below 1) or away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m *= factor;
    }

    /// Clamps target and distance so that the box between two corners stays visible.
    pub fn stay_near(&mut self, [low_m, high_m]: [Vector3<f32>; 2]) {
        let radius_m = (0.5 * (high_m - low_m).norm()).max(1.0);
        self.distance_m = self.distance_m.clamp(NEAREST_M, FURTHEST_RADII * radius_m);
        let margin = Vector3::repeat(2.0 * radius_m);
        self.target_m = self.target_m.sup(&(low_m - margin)).inf(&(high_m + margin));
    }

    /// Rotates as the preset requires; the target does not change.
    pub fn turn(&mut self, preset: ViewPreset) {
        let face = |pitch_rad: f32, yaw_rad: f32, parallel: bool| (pitch_rad, yaw_rad, parallel);
        let ahead_rad = -std::f32::consts::FRAC_PI_2;
        (self.pitch_rad, self.yaw_rad, self.parallel) = match preset {
            // The view places the camera at a station itself; a station comes here only without bounds or a result.
            ViewPreset::Fit | ViewPreset::Station(_) => return,
            ViewPreset::Slanted => {
                let Self { pitch_rad, yaw_rad, .. } = Self::default();
                face(pitch_rad, yaw_rad, false)
            }
            ViewPreset::Top => face(STEEPEST_RAD, ahead_rad, true),
            ViewPreset::Front => face(0.0, ahead_rad, true),
            ViewPreset::Side => face(0.0, 0.0, true),
        };
    }

    /// Rotates as the preset requires and moves back until all points are within the uncovered area, as large as possible.
    pub fn look(&mut self, preset: ViewPreset, points_m: &[Vector3<f32>], frame: &Frame) {
        let Some(first) = points_m.first().map(|first| self.raised(first)) else { return };
        self.turn(preset);
        let [right, up, back] = self.axes();
        let half_height = (FIELD_OF_VIEW_RAD / 2.0).tan();
        let points: Vec<Vector3<f32>> = points_m.iter().map(|p| self.raised(p) - first).collect();
        // In perspective, nearer points look larger.
        let nearness = if self.parallel { 0.0 } else { 1.0 };
        // A point is between two sides of the picture if its distance from the line of sight is between `low` and `high`
        // times its depth. That is linear in the position of the eye, so the nearest eye that sees all points follows for
        // each picture axis.
        let fit = |axis: &Vector3<f32>, half: f32, [low, high]: [f32; 2]| {
            let (middle, reach) = ((low + high) / 2.0, FILLED * (high - low) / 2.0);
            let (low, high) = (half * (middle - reach), half * (middle + reach));
            let (mut most, mut least) = (f32::NEG_INFINITY, f32::INFINITY);
            for p in &points {
                let (along, before) = (axis.dot(p), nearness * back.dot(p));
                most = most.max(along + high * before);
                least = least.min(along + low * before);
            }
            let away_m = (most - least) / (high - low);
            (away_m, move |away_m: f32| (most + least - (high + low) * away_m) / 2.0)
        };
        let (wide_m, across) = fit(&right, half_height * frame.aspect, frame.across);
        let (high_m, above) = fit(&up, half_height, frame.upwards);
        let away_m = wide_m.max(high_m);
        // The target, about which the camera rotates, is in the middle of the points.
        let before = points.iter().map(|p| back.dot(p));
        let (nearest, furthest) =
            before.fold((f32::NEG_INFINITY, f32::INFINITY), |(a, b), p| (a.max(p), b.min(p)));
        let middle = (nearest + furthest) / 2.0;
        let target = first + across(away_m) * right + above(away_m) * up + middle * back;
        self.target_m = self.lowered(&target);
        self.distance_m = (away_m - nearness * middle).max(0.5);
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
        let covered = Frame { aspect: 1.2, across: [-0.3, 1.0], upwards: [-0.9, 0.6] };
        for preset in [ViewPreset::Fit, ViewPreset::Top, ViewPreset::Front, ViewPreset::Side] {
            for frame in [Frame::whole(0.7), Frame::whole(1.6), covered] {
                let mut camera = Camera { vertical: 5.0, ..Camera::default() };
                camera.look(preset, &points, &frame);
                let clip = camera.clip_from_world(frame.aspect);
                // Position in the uncovered area; its sides are −1 and 1.
                let inside =
                    |at: f32, [low, high]: [f32; 2]| (2.0 * at - low - high) / (high - low);
                let mut widest: f32 = 0.0;
                for p in &points {
                    let c = clip * Vector4::new(p.x, p.y, p.z, 1.0);
                    widest = widest.max(inside(c.x / c.w, frame.across).abs());
                    widest = widest.max(inside(c.y / c.w, frame.upwards).abs());
                    assert!(c.z / c.w > 0.0 && c.z / c.w < 1.0, "{preset:?}");
                }
                assert!((widest - FILLED).abs() < 0.01, "{preset:?} in {frame:?}: {widest}");
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

    #[test]
    fn in_a_view_from_a_side_a_metre_is_as_long_near_and_far() {
        let points = [Vector3::new(0.0, 0.0, 0.0), Vector3::new(40.0, 80.0, 3.0)];
        let mut camera = Camera::default();
        let length = |camera: &Camera, from: Vector3<f32>, way: Vector3<f32>| {
            let clip = camera.clip_from_world(1.0);
            let at = |p: Vector3<f32>| clip * p.push(1.0);
            let (a, b) = (at(from), at(from + way));
            ((b.x / b.w - a.x / a.w).powi(2) + (b.y / b.w - a.y / a.w).powi(2)).sqrt()
        };
        for (preset, way) in [
            (ViewPreset::Top, Vector3::new(0.6, 0.8, 0.0)),
            (ViewPreset::Front, Vector3::new(0.6, 0.0, 0.8)),
            (ViewPreset::Side, Vector3::new(0.0, 0.6, 0.8)),
        ] {
            camera.look(preset, &points, &Frame::whole(1.0));
            let [near, far] = points.map(|from| length(&camera, from, way));
            assert!((near - far).abs() < 1e-4 * near, "{preset:?}: {near} {far}");
            // A length along the line of sight vanishes.
            assert!(length(&camera, points[0], camera.back()) < 1e-5, "{preset:?}");
            let points_high = 500.0;
            let wanted = 2.0 / (points_high * camera.metres_per_point(points_high));
            assert!((near - wanted).abs() < 1e-4 * wanted, "{preset:?}: {near} {wanted}");
        }
        camera.look(ViewPreset::Slanted, &points, &Frame::whole(1.0));
        let [near, far] = points.map(|from| length(&camera, from, Vector3::z()));
        assert!(far < 0.8 * near, "{near} {far}");
    }

    #[test]
    fn it_cannot_be_moved_or_zoomed_until_nothing_is_left() {
        let corners = [Vector3::new(-5.0, -5.0, -1.0), Vector3::new(60.0, 30.0, 2.0)];
        for (factor, drag) in [(1e9, 1e9), (1e-9, -1e9), (1.0, 1e9)] {
            let mut camera = Camera::default();
            camera.zoom(factor);
            camera.pan([drag, drag], 800.0);
            camera.stay_near(corners);
            assert!(camera.distance_m >= NEAREST_M && camera.distance_m < 2000.0, "{camera:?}");
            assert!((camera.target_m - corners[0]).norm() < 500.0, "{camera:?}");
        }
    }
}
