//! Paints a drawing in the window as it appears in exported files.

use std::sync::Arc;

use egui::{Align2, Color32, FontId, Galley, Pos2, Rect, Shape, Stroke, Vec2};

use crate::app::theme;
use resect_report::drawing::{Anchor, Drawing, Ink, Mark};

/// Paints with the drawing's origin at the top left of the rectangle.
pub fn paint(painter: &egui::Painter, rect: Rect, drawing: &Drawing, dark: bool) {
    let colour = |ink: Ink| theme::rgb(ink.rgb(dark));
    let place = |[x, y]: [f32; 2]| rect.min + Vec2::new(x, y);
    painter.rect_filled(rect, 0.0, colour(Ink::Paper));
    for mark in &drawing.marks {
        match mark {
            Mark::Line { points, ink, width, dashed } => {
                let points: Vec<Pos2> = points.iter().map(|at| place(*at)).collect();
                let stroke = Stroke::new(*width, colour(*ink));
                if *dashed {
                    painter.extend(Shape::dashed_line(&points, stroke, 5.0, 4.0));
                } else {
                    painter.add(Shape::line(points, stroke));
                }
            }
            Mark::Rect { min, max, ink, opacity, outline } => {
                let shape = Rect::from_min_max(place(*min), place(*max));
                painter.rect_filled(shape, 0.0, colour(*ink).gamma_multiply(*opacity));
                if let Some(width) = outline {
                    let stroke = Stroke::new(*width, colour(*ink));
                    painter.rect_stroke(shape, 0.0, stroke, egui::StrokeKind::Middle);
                }
            }
            Mark::Text { at, text, size, ink, anchor, upwards, .. } => {
                let galley =
                    painter.layout_no_wrap(text.clone(), FontId::proportional(*size), colour(*ink));
                write(painter, place(*at), galley, *anchor, *upwards);
            }
        }
    }
}

fn write(painter: &egui::Painter, at: Pos2, galley: Arc<Galley>, anchor: Anchor, upwards: bool) {
    let along = match anchor {
        Anchor::Left => 0.0,
        Anchor::Middle => 0.5,
        Anchor::Right => 1.0,
    };
    let size = galley.size();
    if upwards {
        // Rotated by 90° anticlockwise about its top left corner, the text reads upwards from there.
        let corner = at + Vec2::new(-0.5 * size.y, along * size.x);
        let shape = egui::epaint::TextShape::new(corner, galley, Color32::PLACEHOLDER)
            .with_angle(-std::f32::consts::FRAC_PI_2);
        painter.add(shape);
    } else {
        let align = match anchor {
            Anchor::Left => Align2::LEFT_CENTER,
            Anchor::Middle => Align2::CENTER_CENTER,
            Anchor::Right => Align2::RIGHT_CENTER,
        };
        painter.galley(align.anchor_size(at, size).min, galley, Color32::PLACEHOLDER);
    }
}
