//! The advised next move in a live deployment: an arrow along the path from the vehicle's position.

use nalgebra::{Rotation2, Vector2, Vector3};

use super::SceneContent;
use super::vertices::{LineVertex, WORLD, f32s, opaque};
use resect_tools::palette;

const WIDTH_POINTS: f32 = 4.0;
/// Length of the arrow's head (m), and half its opening angle (rad).
const HEAD_M: f64 = 1.2;
const OPENING_RAD: f64 = 0.5;

impl SceneContent {
    /// Draws the path to drive at a height (m), in the frame of station 1; an empty path removes it.
    pub fn set_advised(&mut self, way_m: &[Vector2<f64>], height_m: f64) {
        self.advised.clear();
        for pair in way_m.windows(2) {
            self.add_advised(pair[0], pair[1], height_m);
        }
        if let [.., before, last] = way_m
            && let Some(back) = (before - last).try_normalize(1e-9)
        {
            for turn_rad in [OPENING_RAD, -OPENING_RAD] {
                let side = last + Rotation2::new(turn_rad) * back * HEAD_M;
                self.add_advised(*last, side, height_m);
            }
        }
    }

    fn add_advised(&mut self, from: Vector2<f64>, to: Vector2<f64>, height_m: f64) {
        let at = |place: Vector2<f64>| f32s(&Vector3::new(place.x, place.y, height_m));
        self.advised.lines.push(LineVertex {
            from_m: at(from),
            from_frame: WORLD,
            to_m: at(to),
            to_frame: WORLD,
            colour: opaque(palette::DONE),
            width_points: WIDTH_POINTS,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_ends_in_a_head_and_goes_when_there_is_none() {
        let mut content = SceneContent::default();
        let way_m = [[0.0, 0.0], [5.0, 0.0], [5.0, 5.0]].map(Vector2::from);
        content.set_advised(&way_m, -1.0);
        assert_eq!(content.advised.lines.len(), 4);
        let ends = content.advised.lines[2..].iter().map(|line| line.from_m);
        assert!(ends.into_iter().all(|end| end == [5.0, 5.0, -1.0]));
        content.set_advised(&[], 0.0);
        assert!(content.advised.lines.is_empty());
    }
}
