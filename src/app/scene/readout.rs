//! What the picture says in words along its lower edge: the cursor on the left, lengths on the right.

use eframe::egui::{self, Align2, FontId, Painter, Pos2, Rect, Stroke, Vec2};
use nalgebra::Vector3;

use super::projection::Projection;
use super::{SceneContent, labels};
use crate::analysis::Analysis;
use crate::app::model::{OpenDeployment, Units};
use crate::app::state::State;
use crate::app::theme;
use crate::evaluation::trajectory::Pose;

/// Wanted length of the bar that says how long a metre is (points).
const BAR_POINTS: f32 = 90.0;

/// Paints time, position and attitude at the cursor; gives the place they take.
pub fn paint_cursor(
    ui: &egui::Ui,
    rect: Rect,
    state: &State,
    content: &SceneContent,
) -> Option<Rect> {
    let (open, analysis) = state.analysed()?;
    let dark = ui.visuals().dark_mode;
    let mut lines = cursor_lines(open, analysis, content, state.units)?;
    if state.ruler.active {
        lines.push(match &state.ruler.ends[..] {
            [] => "ruler: click its first end".to_owned(),
            [end] => format!("ruler: from {}; click its other end", end.what),
            [from, .., to] => format!("ruler: from {} to {}", from.what, to.what),
        });
    }
    let painter = ui.painter_at(rect);
    let colour = ui.visuals().text_color();
    let width = (rect.width() - 20.0).max(60.0);
    let galley = painter.layout(lines.join("\n"), FontId::proportional(11.5), colour, width);
    let corner = rect.left_bottom() + Vec2::new(8.0, -6.0);
    let place = Align2::LEFT_BOTTOM.anchor_size(corner, galley.size() + Vec2::new(10.0, 6.0));
    labels::ground(&painter, place, dark);
    painter.galley(place.min + Vec2::new(5.0, 3.0), galley, colour);
    Some(place)
}

fn cursor_lines(
    open: &OpenDeployment,
    analysis: &Analysis,
    content: &SceneContent,
    units: Units,
) -> Option<Vec<String>> {
    let since_s = open.timeline.cursor_s? - open.start_s();
    let time = format!("{since_s:.2} s");
    let Some(prisms_m) = &content.prisms_m else {
        let answer = analysis.answer.as_ref().map(|answer| &answer.calibration);
        let why = match answer.map(|answer| answer.placing_tracks(&open.deployment)) {
            Err(_) => "no result places the prisms",
            Ok(None) => "the tracks are in another frame than this answer",
            Ok(Some(_)) => "no triplet here",
        };
        return Some(vec![format!("{time}  {why}")]);
    };
    let Some(pose) = &content.pose else {
        return Some(vec![format!("{time}  prism 1 {}", position(&prisms_m[0], units))]);
    };
    // Without a σ of the interpolation, that of one pose is a guess from three distances.
    let sigma = analysis.triplets().sigma_m.as_ref().map(|_| pose.sigma());
    let mut lines =
        vec![format!("{time}  {}", position(&pose.position_m, units)), attitude(pose, units)];
    if let Some(sigma) = sigma {
        let [position_m, orientation_rad] = [sigma.position_m, sigma.orientation_rad].map(Some);
        lines[0] += &format!("  ± {} mm", units.length_sigma(position_m));
        let small = units.angle.small_name();
        lines[1] += &format!("  ± {} {small}", units.angle_sigma(orientation_rad));
    }
    Some(lines)
}

fn position(p: &Vector3<f64>, units: Units) -> String {
    let [x, y, z] = [p.x, p.y, p.z].map(|coordinate| units.length(coordinate));
    format!("x {x}  y {y}  z {z} {}", units.length.name())
}

fn attitude(pose: &Pose, units: Units) -> String {
    let (roll, pitch, yaw) = pose.orientation.euler_angles();
    let [roll, pitch, yaw] = [roll, pitch, yaw].map(|angle| units.angle(angle));
    format!("heading {yaw}  roll {roll}  pitch {pitch} {}", units.angle.name())
}

/// Paints a bar of a round length and what the grid is, in the lower right corner; gives the place they take.
pub fn paint_scale(
    painter: &Painter,
    projection: &Projection,
    content: &SceneContent,
    above: Option<Rect>,
    dark: bool,
) -> Option<Rect> {
    let grid = content.grid.as_ref()?;
    let rect = projection.rect;
    let colour = theme::faint(dark);
    let mut text = format!("grid {} m · frame of station 1, z up", grid.spacing_m);
    if let Some(factor) = content.exaggeration {
        text = format!("ellipsoids 2σ of the interpolation, ×{factor} · {text}");
    }
    let width = (rect.width() - 16.0).max(60.0);
    let galley = painter.layout(text, FontId::proportional(11.0), colour, width);
    let mut corner = rect.right_bottom() - Vec2::new(8.0, 6.0);
    let mut place = Align2::RIGHT_BOTTOM.anchor_size(corner, galley.size());
    // In a narrow picture it stands above what the cursor says.
    if let Some(above) = above.filter(|above| above.expand(4.0).intersects(place)) {
        corner.y = above.top() - 6.0;
        place = Align2::RIGHT_BOTTOM.anchor_size(corner, galley.size());
    }
    painter.galley(place.min, galley, colour);
    let length_m = round_length(BAR_POINTS / projection.points_per_metre);
    let length = length_m * projection.points_per_metre;
    let right = Pos2::new(corner.x, place.top() - 8.0);
    let left = right - Vec2::new(length, 0.0);
    let stroke = Stroke::new(1.5, colour);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - Vec2::new(0.0, 3.0), end + Vec2::new(0.0, 3.0)], stroke);
    }
    let middle = left.lerp(right, 0.5) - Vec2::new(0.0, 4.0);
    let text = format!("{length_m} m in the middle");
    let font = FontId::proportional(11.0);
    let written = Align2::RIGHT_BOTTOM;
    let at = Pos2::new(right.x, middle.y);
    Some(place.union(painter.text(at, written, text, font, colour)).expand2(Vec2::new(0.0, 3.0)))
}

/// The next shorter of 1, 2 and 5 times a power of ten.
fn round_length(length_m: f32) -> f32 {
    let decade = 10_f32.powf(length_m.max(1e-4).log10().floor());
    [5.0, 2.0, 1.0].map(|step| step * decade).into_iter().find(|m| *m <= length_m).unwrap_or(decade)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bar_is_round_and_not_longer_than_wanted() {
        for (wanted_m, round_m) in [(0.7, 0.5), (12.0, 10.0), (49.0, 20.0), (5.0, 5.0)] {
            assert!((round_length(wanted_m) - round_m).abs() < 1e-5, "{wanted_m}");
        }
    }
}
