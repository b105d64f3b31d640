//! Trajectories of other systems in the scene: where they say the vehicle was, coloured by how far off that is.

use super::SceneContent;
use super::vertices::{LineVertex, WORLD, f32s, opaque};
use crate::estimates::Judgement;
use crate::palette;
use crate::statistics::quantiles;

/// The colours end at this share of all errors: one outlier must not make the rest one colour.
const SHOWN: f64 = 0.98;
/// A line is broken where there is no ground truth for longer (s).
const GAP_S: f64 = 1.0;
/// So many lines of one trajectory at most.
const MOST_LINES: usize = 20_000;
/// Wider than the tracks, which lie on it where it is right.
const WIDTH_POINTS: f32 = 5.0;

impl SceneContent {
    /// Draws the trajectories of a judgement, aligned, where there is ground truth.
    pub fn set_estimates(&mut self, judgement: Option<&Judgement>) {
        self.estimates.clear();
        let judged = judgement.map_or(&[][..], |judgement| &judgement.judged);
        let sizes = judged.iter().flat_map(|one| one.errors.iter().map(|e| e.position_m.norm()));
        self.worst_m = quantiles(sizes, [SHOWN]).map(|[worst_m]| worst_m.max(1e-6));
        let Some(worst_m) = self.worst_m else { return };
        for one in judged {
            let stride = one.errors.len().div_ceil(MOST_LINES).max(1);
            let some: Vec<_> = one.errors.iter().step_by(stride).collect();
            for pair in some.windows(2) {
                let [a, b] = [pair[0], pair[1]];
                if b.time_s - a.time_s > GAP_S * stride as f64 {
                    continue;
                }
                let share = b.position_m.norm() / worst_m;
                self.estimates.lines.push(LineVertex {
                    from_m: f32s(&(a.true_position_m + a.position_m)),
                    from_frame: WORLD,
                    to_m: f32s(&(b.true_position_m + b.position_m)),
                    to_frame: WORLD,
                    colour: opaque(palette::continuous(share as f32)),
                    width_points: WIDTH_POINTS,
                });
            }
        }
    }
}
