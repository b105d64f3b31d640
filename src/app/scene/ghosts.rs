//! Ghosts: prisms at a time without a triplet, each at its last reading.

use egui::{Painter, Pos2, Shape, Stroke, Vec2};
use nalgebra::Vector3;

use super::projection::Projection;
use crate::app::prepared::rig_at::{LAST_READ_S, LastRead};
use crate::app::theme;
use resect_core::geometry::RigidTransform;
use resect_core::network::PerStation;
use resect_tools::palette;

/// A prism at its last reading.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ghost {
    /// Position of the prism (m, station 1's frame).
    pub position_m: Vector3<f64>,
    /// Age of the reading (s).
    pub age_s: f64,
    /// True if the reading was rejected: the prism was probably elsewhere.
    pub rejected: bool,
}

/// Returns the ghosts of the last readings, for tracks with a pose.
pub fn placed(
    last_read: &PerStation<Option<LastRead>>,
    station1_from_tracks: &PerStation<Option<RigidTransform>>,
) -> PerStation<Option<Ghost>> {
    last_read.zip(station1_from_tracks, |last_read, transform| {
        let LastRead { position_m, age_s, rejected } = (*last_read)?;
        let position_m = transform.as_ref()?.apply(&position_m);
        Some(Ghost { position_m, age_s, rejected })
    })
}

/// Radius of a ghost, larger than the disc of a prism, and width of its line (points).
const RADIUS: f32 = 7.0;
const WIDTH: f32 = 2.0;
/// Opacity of the inside, and of the whole ghost at its greatest age.
const INSIDE: f32 = 0.25;
const LEFT_AT_LAST: f32 = 0.35;
/// Number of dashes around a ghost, and of corners of each.
const DASHES: usize = 6;
const CORNERS: usize = 4;

/// Paints dashed rings in the colours of the stations, paler the older their readings are.
pub fn paint(
    painter: &Painter,
    projection: &Projection,
    ghosts: &PerStation<Option<Ghost>>,
    dark: bool,
) {
    for (station, ghost) in ghosts.iter().enumerate() {
        let Some(ghost) = ghost else { continue };
        let Some(at) = projection.visible(&ghost.position_m) else { continue };
        let age = (ghost.age_s / LAST_READ_S) as f32;
        let left = 1.0 - (1.0 - LEFT_AT_LAST) * age;
        let colour = theme::readable(palette::station(station), dark).gamma_multiply(left);
        // The background must not show through between the dashes.
        let ground = theme::scene_background(dark).gamma_multiply(0.8 * left);
        painter.circle_stroke(at, RADIUS, Stroke::new(WIDTH + 2.0, ground));
        painter.circle_filled(at, RADIUS, colour.gamma_multiply(INSIDE));
        dashed_ring(painter, at, Stroke::new(WIDTH, colour));
    }
}

fn dashed_ring(painter: &Painter, at: Pos2, stroke: Stroke) {
    // Gaps half as long as the dashes.
    let turn_rad = std::f32::consts::TAU / DASHES as f32;
    let step_rad = turn_rad * 2.0 / 3.0 / CORNERS as f32;
    for dash in 0..DASHES {
        let corner = |corner: usize| {
            let angle_rad = turn_rad * dash as f32 + step_rad * corner as f32;
            at + RADIUS * Vec2::angled(angle_rad)
        };
        painter.add(Shape::line((0..=CORNERS).map(corner).collect(), stroke));
    }
}
