//! The control point at which the user looks: a ring, its name and its residuals.

use egui::Painter;

use super::projection::Projection;
use super::under_pointer;
use crate::app::model::OpenDeployment;
use crate::app::prepared::control_points::{PointResidual, residuals};
use crate::app::state::State;
use resect_core::analysis::Analysis;

/// Radius of the ring (points).
const RING: f32 = 14.0;

pub fn paint(
    painter: &Painter,
    projection: &Projection,
    (open, analysis): (&OpenDeployment, &Analysis),
    state: &State,
    dark: bool,
) {
    let Some(point) = &state.scene.shown_point else { return };
    let Some(at) = projection.visible(&point.position_m) else { return };
    under_pointer::ring(painter, at, RING, dark);
    let all = residuals(&open.deployment, analysis);
    let residual = all.iter().find(|one| one.file == point.file && one.marker == point.marker);
    let lines = match residual {
        Some(residual) => lines(residual),
        None => vec![format!("point {} of {}", point.marker, point.file)],
    };
    under_pointer::tooltip(painter, projection.rect, at, &lines, dark);
}

/// Describes the position by each station relative to the mean of the stations.
fn lines(point: &PointResidual) -> Vec<String> {
    let kind = if point.pillar { "pillar" } else { "point" };
    let mut lines = vec![
        format!("{kind} {} of {}", point.name, point.file),
        "Position by each station, relative to the mean:".to_owned(),
    ];
    for (station, residual_m) in point.residuals_m.iter().enumerate() {
        let Some(residual_mm) = residual_m.map(|residual_m| 1e3 * residual_m) else { continue };
        lines.push(format!(
            "station {}: x {:+.1}, y {:+.1}, z {:+.1} mm ({:.1} mm)",
            station + 1,
            residual_mm.x,
            residual_mm.y,
            residual_mm.z,
            residual_mm.norm()
        ));
    }
    lines
}
