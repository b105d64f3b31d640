//! Trajectories of other systems in the scene, coloured by their errors.

use super::SceneContent;
use super::vertices::{Label, LineVertex, PointVertex, Rank, WORLD, f32s, opaque};
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

/// Width of the ground truth's line, and diameter of its isolated points.
const TRUTH_POINTS: f32 = 2.0;
const TRUTH_DIAMETER_POINTS: f32 = 18.0;
/// Colour of the ground truth.
pub const TRUTH_COLOUR: palette::Rgb = [150, 150, 150];

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
        let longest_s = GAP_S * stride as f64;
        for (times, pair) in some().zip(some().skip(1)).zip(drawn_m.windows(2)) {
            if times.1.time_s - times.0.time_s <= longest_s {
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
        let times_s: Vec<f64> = some().map(|pose| pose.time_s).collect();
        let isolated = drawn_m.iter().zip(isolated(&times_s, longest_s));
        self.data.points.extend(isolated.filter(|(_, alone)| *alone).map(|(position_m, _)| {
            point((*position_m).into(), TRUTH_COLOUR, TRUTH_DIAMETER_POINTS)
        }));
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
        for (number, one) in judged {
            self.add_whole_path(one, palette::estimate(*number));
        }
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

    /// Draws the whole path of an estimate if the ground truth is only some points along it.
    fn add_whole_path(&mut self, one: &Judged, colour: palette::Rgb) {
        let times_s: Vec<f64> = one.errors.iter().map(|error| error.time_s).collect();
        if isolated(&times_s, GAP_S).filter(|alone| *alone).count() * 2 < times_s.len() {
            return;
        }
        let poses = &one.estimate.poses;
        let stride = poses.len().div_ceil(MOST_LINES).max(1);
        let placed_m = poses
            .iter()
            .step_by(stride)
            .map(|pose| f32s(&(one.fit.placed_position_m(pose) - self.truth_origin_m)));
        let placed_m: Vec<[f32; 3]> = placed_m.collect();
        self.estimates.lines.extend(placed_m.windows(2).map(|pair| LineVertex {
            from_m: pair[0],
            from_frame: WORLD,
            to_m: pair[1],
            to_frame: WORLD,
            colour: opaque(colour),
            width_points: TRUTH_POINTS,
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
        let longest_s = GAP_S * stride as f64;
        let times_s: Vec<f64> = some.iter().map(|error| error.time_s).collect();
        for (error, _) in some.iter().zip(isolated(&times_s, longest_s)).filter(|(_, alone)| *alone)
        {
            self.estimates.points.push(point(place_m(error), colour(error), 2.0 * width_points));
        }
        for pair in some.windows(2) {
            let [a, b] = [pair[0], pair[1]];
            if b.time_s - a.time_s > longest_s {
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

/// Returns true for each time (s) that is further than `longest_s` from both of its neighbours.
fn isolated(times_s: &[f64], longest_s: f64) -> impl Iterator<Item = bool> {
    let is_far = move |index: usize, other: Option<usize>| {
        let other_s = other.and_then(|other| times_s.get(other));
        other_s.is_none_or(|other_s| (times_s[index] - other_s).abs() > longest_s)
    };
    (0..times_s.len())
        .map(move |index| is_far(index, index.checked_sub(1)) && is_far(index, Some(index + 1)))
}

fn point(position_m: [f32; 3], colour: palette::Rgb, diameter_points: f32) -> PointVertex {
    PointVertex { position_m, frame: WORLD, colour: opaque(colour), diameter_points }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_points_far_from_both_neighbours_are_isolated() {
        let alone = |times_s: &[f64]| isolated(times_s, 1.0).collect::<Vec<_>>();
        assert_eq!(alone(&[0.0, 0.5, 1.0, 9.0, 20.0]), [false, false, false, true, true]);
        assert_eq!(alone(&[3.0]), [true]);
        assert!(alone(&[]).is_empty());
    }
}
