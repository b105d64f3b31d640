//! The projection from the world to the screen.

use egui::{Pos2, Rect, Vec2};
use nalgebra::{Matrix4, Vector3, Vector4};

use crate::app::model::Camera;
use crate::app::prepared::pick::PickView;
use resect_core::geometry::RigidTransform;

/// Projection of the camera into a rectangle of the window.
#[derive(Clone, Copy, Debug)]
pub struct Projection {
    clip_from_world: Matrix4<f32>,
    pub rect: Rect,
    /// True for a parallel projection.
    pub parallel: bool,
    /// Scale at the camera's target (points on the screen a metre).
    pub points_per_metre: f32,
}

/// Distance from the eye below which a point has no position on the screen (m).
const NEAREST_M: f32 = 1e-3;

impl Projection {
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        Self {
            clip_from_world: camera.clip_from_world(rect.width() / rect.height().max(1.0)),
            rect,
            parallel: camera.parallel,
            points_per_metre: 1.0 / camera.metres_per_point(rect.height()),
        }
    }

    /// Returns the screen position of a point; `None` behind the camera.
    pub fn screen(&self, position_m: &Vector3<f32>) -> Option<Pos2> {
        let clip =
            self.clip_from_world * Vector4::new(position_m.x, position_m.y, position_m.z, 1.0);
        if clip.w <= NEAREST_M {
            return None;
        }
        let ndc = Vec2::new(clip.x / clip.w, -clip.y / clip.w);
        Some(self.rect.center() + 0.5 * ndc * self.rect.size())
    }

    /// Returns the direction on the screen from the centre of the picture to a point, which may be behind the camera; `None`
    /// in the centre.
    pub fn direction(&self, position_m: &Vector3<f32>) -> Option<Vec2> {
        let clip =
            self.clip_from_world * Vector4::new(position_m.x, position_m.y, position_m.z, 1.0);
        let towards = Vec2::new(clip.x * self.rect.width(), -clip.y * self.rect.height());
        (towards.length() > 0.0).then(|| towards.normalized())
    }

    /// Returns the screen position of a point; `None` outside of the picture.
    pub fn visible(&self, position_m: &Vector3<f64>) -> Option<Pos2> {
        self.screen(&position_m.cast::<f32>()).filter(|at| self.rect.contains(*at))
    }

    /// Returns the view for picking among the points of a station.
    pub fn pick_view(
        &self,
        station1_from_station: &RigidTransform,
        pointer: Pos2,
        reach_points: f32,
    ) -> PickView {
        PickView {
            clip_from_points: self.clip_from_world * station1_from_station.matrix().cast::<f32>(),
            rect: self.rect,
            pointer,
            reach_points,
        }
    }
}
