//! An orbit camera: z is up, in metres of station 1's frame.

use nalgebra::{Matrix4, Vector3};

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
    /// Distance from the eye to the target; in parallel projection, the distance from which the target looks as large.
    pub distance_m: f32,
    /// Direction from the target to the eye, counter-clockwise from x.
    pub yaw_rad: f32,
    /// Height of the eye: 0 on the horizon, π/2 straight above.
    pub pitch_rad: f32,
    /// Whether lines of sight are parallel: what is equally long looks equally long, near or far.
    pub parallel: bool,
    /// How many times higher than true everything is drawn. Places are true ones all the same: the camera alone knows.
    pub vertical: f32,
}

/// The shape of a picture, and the part of it that nothing covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// Width over height.
    pub aspect: f32,
    /// Where the free part begins and ends, from −1 at the left to 1 at the right.
    pub across: [f32; 2],
    /// Where it begins and ends from −1 at the bottom to 1 at the top.
    pub upwards: [f32; 2],
}

impl Frame {
    /// A picture that is free everywhere.
    pub fn whole(aspect: f32) -> Self {
        Self { aspect, across: [-1.0, 1.0], upwards: [-1.0, 1.0] }
    }
}

const FIELD_OF_VIEW_RAD: f32 = 0.7;
/// Part of the free picture that is filled by what is fitted in.
const FILLED: f32 = 0.88;
const STEEPEST_RAD: f32 = std::f32::consts::FRAC_PI_2;
/// What is this far before or behind the target is drawn, however near the camera is.
const DEEP_M: f32 = 20_000.0;
/// Between a hand's breadth and the whole in a tenth of the picture.
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

    /// Towards the eye, of length 1. By the angles alone: told from eye and target, it would depend in its last digits on
    /// what was looked at before.
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

    /// A place or a way as high as it is drawn, and one that is drawn so high as it is.
    fn raised(&self, v: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(v.x, v.y, v.z * self.vertical)
    }

    fn lowered(&self, v: &Vector3<f32>) -> Vector3<f32> {
        Vector3::new(v.x, v.y, v.z / self.vertical)
    }

    /// Clip coordinates from world, depth from 0 to 1 as wgpu wants it.
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

    /// Turns about the target by a drag in points.
    pub fn orbit(&mut self, drag: [f32; 2]) {
        self.yaw_rad -= 0.006 * drag[0];
        self.pitch_rad = (self.pitch_rad + 0.006 * drag[1]).clamp(-STEEPEST_RAD, STEEPEST_RAD);
    }

    /// Moves the target by a drag in points, so that what is under the pointer stays there.
    pub fn pan(&mut self, drag: [f32; 2], viewport_height: f32) {
        let metres_per_point = self.metres_per_point(viewport_height);
        let [right, up, _] = self.axes();
        self.target_m += self.lowered(&(metres_per_point * (up * drag[1] - right * drag[0])));
    }

    /// Length that a point of the screen covers at the distance of the target (m).
    pub fn metres_per_point(&self, viewport_height: f32) -> f32 {
        2.0 * self.distance_m * (FIELD_OF_VIEW_RAD / 2.0).tan() / viewport_height.max(1.0)
    }

    /// Stands at a place and looks at another.
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

    /// Comes closer (factor below 1) or goes away.
    pub fn zoom(&mut self, factor: f32) {
        self.distance_m *= factor;
    }

    /// Stays where something of what lies between two corners can be seen, however far it was moved or zoomed.
    pub fn stay_near(&mut self, [low_m, high_m]: [Vector3<f32>; 2]) {
        let radius_m = (0.5 * (high_m - low_m).norm()).max(1.0);
        self.distance_m = self.distance_m.clamp(NEAREST_M, FURTHEST_RADII * radius_m);
        let margin = Vector3::repeat(2.0 * radius_m);
        self.target_m = self.target_m.sup(&(low_m - margin)).inf(&(high_m + margin));
    }

    /// Turns as a preset says, and stays where it looks.
    pub fn turn(&mut self, preset: ViewPreset) {
        let face = |pitch_rad: f32, yaw_rad: f32, parallel: bool| (pitch_rad, yaw_rad, parallel);
        let ahead_rad = -std::f32::consts::FRAC_PI_2;
        (self.pitch_rad, self.yaw_rad, self.parallel) = match preset {
            // The view stands at the station before it comes here for what the station cannot look at.
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

    /// Turns as the preset says and steps back until all points are in the free part of the picture, as large as they can
    /// be.
    pub fn look(&mut self, preset: ViewPreset, points_m: &[Vector3<f32>], frame: &Frame) {
        let Some(first) = points_m.first().map(|first| self.raised(first)) else { return };
        self.turn(preset);
        let [right, up, back] = self.axes();
        let half_height = (FIELD_OF_VIEW_RAD / 2.0).tan();
        let points: Vec<Vector3<f32>> = points_m.iter().map(|p| self.raised(p) - first).collect();
        // What is nearer to the eye looks larger, unless the lines of sight are parallel.
        let nearness = if self.parallel { 0.0 } else { 1.0 };
        // A point is between two sides of the picture while its distance from the line of sight is between `low` and
        // `high` times its distance before the eye. That is linear in where the eye stands, so the eye nearest to them all
        // is known for each direction on the picture.
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
        // The target, about which the camera turns, is amid them.
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
                // Where in the free part: −1 and 1 are its sides.
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
            // Neither does it lean: along the line of sight there is no length.
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
