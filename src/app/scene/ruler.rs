//! The ruler in the picture, and the snapping of its ends.

use super::content::SceneContent;
use super::projection::Projection;
use super::vertices::{LineVertex, PointVertex, WORLD, f32s, opaque};
use crate::app::model::{Ruler, RulerEnd};
use egui::Pos2;
use resect_core::network::PerPrism;
use resect_tools::palette::Rgb;

/// Distance from a prism, a station or a control point within which a click selects it, even if readings are nearer (points).
const SNAP_POINTS: f32 = 11.0;

impl SceneContent {
    /// Draws the line between the ends, if it has changed.
    pub fn set_ruler(&mut self, ruler: &Ruler, colour: Rgb) {
        let ends_m = ruler.ends_m(self.prisms_m.as_ref());
        let points: Vec<PointVertex> = ends_m
            .iter()
            .map(|end_m| PointVertex {
                position_m: f32s(end_m),
                frame: WORLD,
                colour: opaque(colour),
                diameter_points: 8.0,
            })
            .collect();
        if points == self.ruler.points {
            return;
        }
        self.ruler.clear();
        self.ruler.lines.extend(ends_m.windows(2).map(|ends_m| LineVertex {
            from_m: f32s(&ends_m[0]),
            from_frame: WORLD,
            to_m: f32s(&ends_m[1]),
            to_frame: WORLD,
            colour: opaque(colour),
            width_points: 2.0,
        }));
        self.ruler.points = points;
    }

    /// Returns the prism, station or control point at a position on the screen.
    pub fn snap(&self, projection: &Projection, at: Pos2) -> Option<RulerEnd> {
        let prisms = self.prisms_m.iter().flat_map(PerPrism::each).map(|(prism, position_m)| {
            let what = format!("prism {prism}");
            RulerEnd { position_m: *position_m, what, prism: Some(prism) }
        });
        let landmarks = self.landmarks.iter().map(|landmark| RulerEnd {
            position_m: landmark.position_m,
            what: landmark.name.clone(),
            prism: None,
        });
        prisms
            .chain(landmarks)
            .filter_map(|end| Some((projection.visible(&end.position_m)?.distance(at), end)))
            .filter(|(distance, _)| *distance < SNAP_POINTS)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map(|(_, end)| end)
    }
}
