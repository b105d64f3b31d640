//! Paths of the vehicle in other open runs, one line each in the frame of the active run.

use super::SceneContent;
use super::vertices::{LineVertex, WORLD, f32s, opaque};
use crate::app::prepared::beside::RunBeside;
use resect_tools::palette;

/// Greatest number of line segments of one run.
const MOST_LINES: usize = 20_000;
const WIDTH_POINTS: f32 = 2.0;

impl SceneContent {
    /// Draws the paths of other runs; an empty slice removes them.
    pub fn set_beside(&mut self, runs: &[RunBeside]) {
        self.beside.clear();
        for (number, run) in runs.iter().enumerate() {
            let Ok((way, _)) = &run.way else { continue };
            let stride = way.instants.len().div_ceil(MOST_LINES).max(1);
            for piece in way.pieces([f64::NEG_INFINITY, f64::INFINITY]) {
                let some: Vec<_> = piece.iter().step_by(stride).collect();
                self.beside.lines.extend(some.windows(2).map(|pair| LineVertex {
                    from_m: f32s(&pair[0].position_m),
                    from_frame: WORLD,
                    to_m: f32s(&pair[1].position_m),
                    to_frame: WORLD,
                    colour: opaque(palette::run_beside(number)),
                    width_points: WIDTH_POINTS,
                }));
            }
        }
    }
}
