//! Trajectories of other systems in the scene, coloured by their errors.

use super::SceneContent;
use super::vertices::{Label, LineVertex, Rank, WORLD, f32s, opaque};
use nalgebra::Vector3;
use resect_core::deployment::{Deployment, EstimatedPose};
use resect_core::statistics::quantiles;
use resect_tools::estimates::Judged;
use resect_tools::estimates::errors::EpochError;
use resect_tools::palette;

/// Share of all errors that the colours span: one outlier must not give the rest one colour.
const SHOWN: f64 = 0.98;
/// Longest gap in the ground truth that a line bridges (s).
const GAP_S: f64 = 1.0;
/// Greatest number of line segments of one trajectory.
const MOST_LINES: usize = 20_000;
/// Line width, wider than the tracks, which a correct trajectory covers; the outline has the trajectory's own colour.
const WIDTH_POINTS: f32 = 5.0;
const OUTLINE_POINTS: f32 = 8.0;

/// Width of the ground truth's line, and its colour.
const TRUTH_POINTS: f32 = 2.0;
const TRUTH_COLOUR: palette::Rgb = [150, 150, 150];

impl SceneContent {
    /// Draws a ground truth of another system as a line; nothing for a deployment with readings.
    pub fn set_ground_truth(&mut self, deployment: &Deployment) {
        let truth = deployment.ground_truth.as_ref();
        let poses = truth.map_or(&[][..], |truth| &truth.poses);
        self.truth_origin_m = poses.first().map_or(Vector3::zeros(), |pose| pose.position_m);
        let stride = poses.len().div_ceil(MOST_LINES).max(1);
        let place_m = |pose: &EstimatedPose| (pose.position_m - self.truth_origin_m).cast();
        let some = || poses.iter().step_by(stride);
        let drawn_m: Vec<Vector3<f32>> = some().map(place_m).collect();
        for (times, pair) in some().zip(some().skip(1)).zip(drawn_m.windows(2)) {
            if times.1.time_s - times.0.time_s <= GAP_S * stride as f64 {
                self.data.lines.push(LineVertex {
                    from_m: pair[0].into(),
                    from_frame: WORLD,
                    to_m: pair[1].into(),
                    to_frame: WORLD,
                    colour: opaque(TRUTH_COLOUR),
                    width_points: TRUTH_POINTS,
                });
            }
        }
        self.truth_m = drawn_m;
    }

    /// Draws evaluated trajectories, aligned, where there is ground truth; each with the number of its colour.
    pub fn set_estimates(&mut self, judged: &[(usize, &Judged)]) {
        self.estimates.clear();
        self.estimate_labels.clear();
        let errors = judged.iter().flat_map(|(_, one)| &one.errors);
        self.worst_m = quantiles(errors.map(|error| error.position_m.norm()), [SHOWN])
            .map(|[worst_m]| worst_m.max(1e-6));
        let Some(worst_m) = self.worst_m else { return };
        let by_error =
            |error: &EpochError| palette::continuous((error.position_m.norm() / worst_m) as f32);
        // Later lines cover earlier ones: first all outlines, then all errors.
        for (number, one) in judged {
            let outline = palette::estimate(*number);
            self.add_estimate(&one.errors, OUTLINE_POINTS, |_| outline);
        }
        for (_, one) in judged {
            self.add_estimate(&one.errors, WIDTH_POINTS, by_error);
        }
        self.estimate_labels.extend(judged.iter().filter_map(|(number, one)| {
            let last = one.errors.last()?;
            Some(Label {
                position_m: (last.true_position_m + last.position_m - self.truth_origin_m).cast(),
                text: one.estimate.name.clone(),
                colour: palette::estimate(*number),
                rank: Rank::Trajectory,
            })
        }));
    }

    fn add_estimate(
        &mut self,
        errors: &[EpochError],
        width_points: f32,
        colour: impl Fn(&EpochError) -> palette::Rgb,
    ) {
        let stride = errors.len().div_ceil(MOST_LINES).max(1);
        let some: Vec<&EpochError> = errors.iter().step_by(stride).collect();
        let place_m = |error: &EpochError| {
            f32s(&(error.true_position_m + error.position_m - self.truth_origin_m))
        };
        for pair in some.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            if b.time_s - a.time_s > GAP_S * stride as f64 {
                continue;
            }
            self.estimates.lines.push(LineVertex {
                from_m: place_m(a),
                from_frame: WORLD,
                to_m: place_m(b),
                to_frame: WORLD,
                colour: opaque(colour(b)),
                width_points,
            });
        }
    }
}
