//! The prism triangle at an instant, and the vehicle there.

use super::content::SceneContent;
use super::overlays;
use super::vertices::{LineVertex, PointVertex, f32s};
use crate::analysis::Analysis;
use crate::deployment::{Deployment, PAIRS};
use crate::palette::{self, Rgb};

impl SceneContent {
    /// Puts the prism triangle and the vehicle's axes at an instant of the triplets, or takes them away.
    pub fn set_cursor(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        instant: Option<usize>,
        colour: Rgb,
    ) {
        self.cursor.clear();
        (self.prisms_m, self.pose) = (None, None);
        let Some(instant) = instant else { return };
        if let [Some(a), Some(b), Some(c)] = self.station1_from_tracks {
            let [p, q, r] = analysis.triplets().triplet_m(instant);
            self.prisms_m = Some([a.apply(&p), b.apply(&q), c.apply(&r)]);
            self.pose = overlays::pose_at(deployment, analysis, instant);
        }
        if let Some(pose) = &self.pose {
            overlays::add_pose(&mut self.cursor.lines, pose);
        }
        let (points, lines) = self.triangle(analysis, instant, colour, [10.0, 2.5], 255);
        self.cursor.points.extend(points);
        self.cursor.lines.extend(lines);
    }

    /// Puts a faint triangle where another pane's pointer is in time, or takes it away.
    pub fn set_hover(&mut self, analysis: &Analysis, instant: Option<usize>, colour: Rgb) {
        if instant.is_none() && self.hover.points.is_empty() {
            return;
        }
        self.hover.clear();
        let Some(instant) = instant else { return };
        let (points, lines) = self.triangle(analysis, instant, colour, [7.0, 1.5], 120);
        self.hover.points.extend(points);
        self.hover.lines.extend(lines);
    }

    /// The prisms whose stations have a place, joined where all have one.
    fn triangle(
        &self,
        analysis: &Analysis,
        instant: usize,
        [r, g, b]: Rgb,
        [diameter_points, width_points]: [f32; 2],
        alpha: u8,
    ) -> (Vec<PointVertex>, Vec<LineVertex>) {
        let corners = analysis.triplets().triplet_m(instant).map(|p| f32s(&p));
        let placed = |station: &usize| self.station1_from_tracks[*station].is_some();
        let points: Vec<_> = (0..3)
            .filter(placed)
            .map(|station| {
                let [r, g, b] = palette::STATIONS[station];
                PointVertex {
                    position_m: corners[station],
                    frame: station as u32,
                    colour: [r, g, b, alpha],
                    diameter_points,
                }
            })
            .collect();
        let sides = if points.len() == 3 { &PAIRS[..] } else { &[] };
        let lines = sides.iter().map(|&(from, to)| LineVertex {
            from_m: corners[from],
            from_frame: from as u32,
            to_m: corners[to],
            to_frame: to as u32,
            colour: [r, g, b, alpha],
            width_points,
        });
        (points, lines.collect())
    }
}
