//! Stations and control points outside of the picture: their names and directions at its edge.

use egui::{Align2, FontId, Painter, Pos2, Rect, Shape, Stroke, Vec2};

use super::content::SceneContent;
use super::labels::{Placer, inside};
use super::projection::Projection;
use super::vertices::{Label, Rank};
use crate::app::theme;

/// Distance of a mark from the edge, and its length (points).
const MARGIN: f32 = 7.0;
const LENGTH: f32 = 7.0;

/// Paints marks as far as there is room.
pub fn paint(
    painter: &Painter,
    projection: &Projection,
    content: &SceneContent,
    placer: &mut Placer,
    dark: bool,
) {
    let edge = projection.rect.shrink(MARGIN);
    let within = edge.shrink(LENGTH + 1.0);
    if !within.is_positive() {
        return;
    }
    let is_place = |label: &&Label| matches!(label.rank, Rank::Station | Rank::ControlPoint);
    let is_outside = |label: &&Label| projection.visible(&label.position_m.cast()).is_none();
    for label in content.labels.iter().rev().filter(is_place).filter(is_outside) {
        let Some(towards) = projection.direction(&label.position_m) else { continue };
        let colour = theme::readable(label.colour, dark);
        let font = FontId::proportional(10.0);
        let galley = painter.layout_no_wrap(label.text.clone(), font, colour);
        let tip = at_edge(edge, towards);
        let name = Align2::CENTER_CENTER.anchor_size(within.clamp(tip), galley.size());
        let name = inside(name, within);
        if placer.place([name]).is_some() {
            let (back, side) = (tip - LENGTH * towards, 0.5 * LENGTH * towards.rot90());
            let corners = vec![tip, back + side, back - side];
            painter.add(Shape::convex_polygon(corners, colour, Stroke::NONE));
            painter.galley(name.min, galley, colour);
        }
    }
}

/// Returns the point on the edge of a rectangle in a direction from its centre.
fn at_edge(rect: Rect, towards: Vec2) -> Pos2 {
    let half = 0.5 * rect.size();
    let steps = [half.x / towards.x.abs(), half.y / towards.y.abs()];
    rect.center() + steps[0].min(steps[1]) * towards
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_on_the_edge_towards_their_points() {
        let rect = Rect::from_min_max(Pos2::new(100.0, 50.0), Pos2::new(500.0, 250.0));
        assert_eq!(at_edge(rect, Vec2::new(1.0, 0.0)), Pos2::new(500.0, 150.0));
        assert_eq!(at_edge(rect, Vec2::new(0.0, -1.0)), Pos2::new(300.0, 50.0));
        let corner = at_edge(rect, Vec2::new(-2.0, 1.0).normalized());
        assert!((corner - Pos2::new(100.0, 250.0)).length() < 1e-3, "{corner}");
    }
}
