//! Control points as observed by each station, and the deviations of these positions from their mean.

use nalgebra::Vector3;

use super::content::SceneContent;
use super::vertices::{Label, Landmark, LineVertex, Rank, WORLD, opaque};
use crate::app::prepared::control_points::{PointResidual, point_name, residuals};
use resect_core::analysis::Analysis;
use resect_core::deployment::Deployment;
use resect_core::geometry::RigidTransform;
use resect_core::palette;
use resect_core::palette::Rgb;
use resect_core::pipeline::SampleFate;

/// Half the length of a cross (m); constant, so that the stations' observations of a point can be distinguished.
const ARM_M: f32 = 0.35;
/// Length of an arrow's head relative to the arrow.
const HEAD: f32 = 0.2;
/// Greatest length of an arrow relative to the extent of all points.
const LONGEST: f64 = 0.05;

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
                    self.add_arrow_line([place - arm, place + arm], palette::STATIONS[station]);
                }
                let kind = if set.pillars { "pillar" } else { "control point" };
                let (marker, file) = (point.marker, &set.file);
                let name = format!("{kind} {marker} of {file} from station {}", station + 1);
                let fitted_in = !set.pillars;
                self.landmarks.push(Landmark { position_m, name, fitted_in });
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

    /// Adds arrows from each point's mean to its position by each visible station, enlarged by a factor.
    ///
    /// Arrows of a wrong calibration would cover everything: longer ones are cut
    /// and have no head. Returns the number of cut arrows; `None` without arrows.
    pub fn add_residuals(
        &mut self,
        deployment: &Deployment,
        analysis: &Analysis,
        shown: &[bool; 3],
        scale: f64,
    ) -> Option<usize> {
        let points = residuals(deployment, analysis);
        let corners = points.iter().map(|point| (point.mean_m, point.mean_m));
        let (low, high) = corners.reduce(|(low, high), (a, b)| (low.inf(&a), high.sup(&b)))?;
        let longest_m = (LONGEST * (high - low).norm()).max(f64::from(ARM_M));
        let mut cut = 0;
        for PointResidual { mean_m, residuals_m, .. } in &points {
            for station in (0..3).filter(|station| shown[*station]) {
                let Some(residual_m) = residuals_m[station] else { continue };
                let (from, colour) = (mean_m.cast::<f32>(), palette::STATIONS[station]);
                let arrow_m = scale * residual_m;
                if arrow_m.norm() > longest_m {
                    let end_m = mean_m + arrow_m.normalize() * longest_m;
                    self.add_arrow_line([from, end_m.cast()], colour);
                    cut += 1;
                } else {
                    self.add_arrow([from, (mean_m + arrow_m).cast()], colour);
                }
            }
        }
        shown.contains(&true).then_some(cut)
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
