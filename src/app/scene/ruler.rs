//! The ruler in the picture, and what its ends snap to.

use super::content::SceneContent;
use super::projection::Projection;
use super::vertices::{LineVertex, PointVertex, WORLD, f32s, opaque};
use crate::app::model::{Ruler, RulerEnd, Units};
use crate::palette::Rgb;
use eframe::egui::Pos2;

/// A click this near (points) to a prism, a station or a control point means it, even where readings are nearer.
const SNAP_POINTS: f32 = 11.0;

/// What the ruler shows over the picture.
pub struct RulerText {
    /// On the screen, between the ends.
    pub at: Pos2,
    pub ends: [Option<Pos2>; 2],
    pub lines: Vec<String>,
}

impl SceneContent {
    /// Draws the line between the ends, if it is not what is drawn.
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

    /// The ruler's text, once it has both ends and its middle is seen.
    pub fn ruler_text(
        &self,
        ruler: &Ruler,
        inter_prism_m: Option<&[f64; 3]>,
        projection: &Projection,
        units: Units,
    ) -> Option<RulerText> {
        let [from_m, to_m] = ruler.ends_m(self.prisms_m.as_ref())[..] else { return None };
        let at = projection.screen(&((from_m + to_m) / 2.0).cast::<f32>())?;
        let ends = [from_m, to_m].map(|end_m| projection.visible(&end_m));
        Some(RulerText {
            at,
            ends,
            lines: ruler.lines(self.prisms_m.as_ref(), inter_prism_m, units),
        })
    }

    /// The prism, station or control point at a place on the screen.
    pub fn snap(&self, projection: &Projection, at: Pos2) -> Option<RulerEnd> {
        let prisms = self.prisms_m.iter().flatten().enumerate().map(|(prism, position_m)| {
            let what = format!("prism {}", prism + 1);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn end(position_m: [f64; 3], prism: Option<usize>) -> RulerEnd {
        RulerEnd { position_m: position_m.into(), what: String::new(), prism }
    }

    #[test]
    fn it_says_distance_parts_and_for_two_prisms_what_the_rig_says() {
        let units = Units::default();
        let ruler = Ruler { active: true, ends: Vec::new() };
        let ruler = ruler.with(end([1.0, 2.0, 3.0], None));
        assert!(ruler.lines(None, None, units).is_empty());
        let ruler = ruler.with(end([4.0, 6.0, 1.0], None));
        assert_eq!(
            ruler.lines(None, None, units),
            ["5.3852 m", "horizontal 5.0000 m, height -2.0000 m"]
        );
        // The ends were set when the prisms were elsewhere; they go with them.
        let prisms = [[0.0; 3], [0.9031, 0.0, 0.0], [0.0, 0.5, 0.0]].map(Vector3::from);
        let ruler = Ruler::default().with(end([7.0; 3], Some(1))).with(end([9.0; 3], Some(0)));
        assert_eq!(
            ruler.lines(Some(&prisms), Some(&[0.9021, 0.5, 1.0]), units)[0],
            "prisms 1–2: 0.9031 m, rig 0.9021 m, +1.0 mm"
        );
        // Twice the same prism is no pair.
        let ruler = Ruler::default().with(end([7.0; 3], Some(1))).with(end([9.0; 3], Some(1)));
        assert_eq!(ruler.lines(Some(&prisms), Some(&[1.0; 3]), units)[0], "0.0000 m");
    }

    #[test]
    fn a_third_end_starts_anew_and_esc_goes_back() {
        let mut ruler = Ruler { active: true, ends: Vec::new() };
        for _ in 0..3 {
            ruler = ruler.with(end([0.0; 3], None));
        }
        assert_eq!(ruler.ends.len(), 1);
        let cleared = ruler.escaped();
        assert!(cleared.active && cleared.ends.is_empty());
        assert!(!cleared.escaped().active);
    }
}
