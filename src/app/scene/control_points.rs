//! Control points as observed by each station, and the deviations of these positions from their mean.

use nalgebra::Vector3;

use super::content::{DrawnArrows, SceneContent};
use super::vertices::{Label, Landmark, LineVertex, Rank, WORLD, opaque};
use crate::app::prepared::control_points::{PointResidual, point_name, residuals};
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::network::{Number, PerStation};
use resect_core::pipeline::SampleFate;
use resect_core::statistics::quantile_of_sorted;
use resect_tools::palette;
use resect_tools::palette::Rgb;

/// Half the length of a cross (m); constant, so that the stations' observations of a point can be distinguished.
const ARM_M: f32 = 0.35;
/// Length of an arrow's head relative to the arrow.
const HEAD: f32 = 0.2;
/// Length of the longest arrow relative to the extent of the scene, and that at which arrows are cut.
const LONG: f64 = 0.05;
const LONGEST: f64 = 0.075;
/// Share of the arrows that the automatic scale leaves uncut: a point that was confused with another must not hide the others.
const UNCUT: f64 = 0.95;

impl SceneContent {
    /// Adds the positions of the control points as observed by a station, each with its name.
    pub fn add_control_points(
        &mut self,
        deployment: &Deployment,
        station: usize,
        transform: &RigidTransform,
    ) {
        for (number, set) in deployment.control_points.iter().enumerate() {
            for point in &set.points {
                let Some(polar) = point.readings[station] else { continue };
                let position_m = transform.apply(&polar.to_cartesian());
                let place = position_m.cast::<f32>();
                for axis in 0..3 {
                    let mut arm = Vector3::zeros();
                    arm[axis] = ARM_M;
                    self.add_arrow_line([place - arm, place + arm], palette::station(station));
                }
                let kind = if set.pillars { "pillar" } else { "control point" };
                let (marker, file) = (point.marker, &set.file);
                let name = format!("{kind} {marker} of {file} from station {}", station + 1);
                self.landmarks.push(Landmark { position_m, name });
                if station == 0 {
                    let name = point_name(deployment, number, marker);
                    self.labels.push(Label {
                        position_m: place,
                        text: if set.pillars { format!("pillar {name}") } else { name },
                        colour: palette::fate(SampleFate::Kept),
                        rank: Rank::ControlPoint,
                    });
                }
            }
        }
    }

    /// Adds arrows from each point's mean to its position by each visible station, enlarged by a factor. Without one, the factor
    /// makes the longest arrow about a twentieth of the scene.
    ///
    /// Arrows of a wrong calibration would cover everything: longer ones are cut and have no head. Returns `None` without arrows.
    pub fn add_residuals(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        shown: &PerStation<bool>,
        scale: Option<u32>,
    ) -> Option<DrawnArrows> {
        let points = residuals(deployment, analysis);
        let (low_m, high_m) = self.bounds_m.filter(|_| !points.is_empty())?;
        let extent_m = f64::from((high_m - low_m).norm());
        let longest_m = (LONGEST * extent_m).max(f64::from(ARM_M));
        let scale = scale.unwrap_or_else(|| suitable_scale(&points, LONG * extent_m));
        let mut cut = 0;
        for PointResidual { mean_m, residuals_m, .. } in &points {
            for (station, residual_m) in residuals_m.each().filter(|(station, _)| shown[*station]) {
                let Some(residual_m) = residual_m else { continue };
                let (from, colour) = (mean_m.cast::<f32>(), palette::station(station.index()));
                let arrow_m = f64::from(scale) * *residual_m;
                if arrow_m.norm() > longest_m {
                    let end_m = mean_m + arrow_m.normalize() * longest_m;
                    self.add_arrow_line([from, end_m.cast()], colour);
                    cut += 1;
                } else {
                    self.add_arrow([from, (mean_m + arrow_m).cast()], colour);
                }
            }
        }
        shown.as_slice().contains(&true).then_some(DrawnArrows { scale, cut })
    }

    fn add_arrow(&mut self, [from, tip]: [Vector3<f32>; 2], colour: Rgb) {
        self.add_arrow_line([from, tip], colour);
        let Some(back) = (from - tip).try_normalize(1e-6) else { return };
        // Any side is suitable for a vertical arrow.
        let side = back.cross(&Vector3::z()).try_normalize(0.1).unwrap_or_else(Vector3::x);
        for side in [side, -side] {
            let barb = tip + HEAD * (from - tip).norm() * (back + 0.5 * side);
            self.add_arrow_line([tip, barb], colour);
        }
    }

    fn add_arrow_line(&mut self, [from, to]: [Vector3<f32>; 2], colour: Rgb) {
        self.data.lines.push(LineVertex {
            from_m: from.into(),
            from_frame: WORLD,
            to_m: to.into(),
            to_frame: WORLD,
            colour: opaque(colour),
            width_points: 1.5,
        });
    }
}

/// Returns the largest scale of the series 1, 2, 5, 10 … with which nearly all residuals are at most this long (m).
fn suitable_scale(points: &[PointResidual], long_m: f64) -> u32 {
    let lengths_m = points.iter().flat_map(|point| point.residuals_m.iter().flatten());
    let mut lengths_m: Vec<f64> = lengths_m.map(Vector3::norm).collect();
    lengths_m.sort_by(f64::total_cmp);
    let largest_m = quantile_of_sorted(&lengths_m, UNCUT).unwrap_or_default();
    let scales = (0..6).flat_map(|power| [1, 2, 5].map(|digit| digit * 10_u32.pow(power)));
    scales.take_while(|scale| f64::from(*scale) * largest_m <= long_m).last().unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrows_suit_the_scene_whatever_the_residuals() {
        let point = |residual_m: f64| PointResidual {
            name: "1".to_owned(),
            file: "GCP.txt".to_owned(),
            marker: 1,
            pillar: false,
            mean_m: Vector3::zeros(),
            residuals_m: [Some(Vector3::x() * residual_m), None, None].into(),
            used: true,
        };
        let scale = |residuals_m: &[f64]| {
            suitable_scale(&residuals_m.iter().copied().map(point).collect::<Vec<_>>(), 5.0)
        };
        assert_eq!(scale(&[0.001, 0.002]), 2000);
        assert_eq!(scale(&[0.030]), 100);
        assert_eq!(scale(&[60.0]), 1);
        assert_eq!(scale(&[0.0]), 500_000);
        // One confused point among many is cut.
        let mut many = vec![0.002; 60];
        many.push(30.0);
        assert_eq!(scale(&many), 2000);
    }
}
