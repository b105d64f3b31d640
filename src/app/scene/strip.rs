//! The strip under the picture: scale bar, position at the cursor, measured distance, and notes on hidden or enlarged content.

use std::sync::Arc;

use egui::{
    Align2, Color32, FontId, Galley, Mesh, Painter, Pos2, Rect, Role, Sense, Shape, Stroke, Vec2,
    WidgetInfo,
};

use super::SceneContent;
use super::colouring::Scale;
use super::projection::Projection;
use super::strip_text;
use crate::app::state::State;
use crate::app::theme;
use resect_tools::palette;

const ROW: f32 = 17.0;
const MARGIN: Vec2 = Vec2::new(8.0, 3.0);
const BETWEEN: f32 = 16.0;
/// Room at the end of the last row for the number of omitted texts (points).
const MORE: f32 = 46.0;
const FONT: f32 = 11.5;
/// Wanted length of the scale bar (points).
const BAR_POINTS: f32 = 90.0;
/// Size of the colour bar, and number of segments in which it is painted.
const COLOURS: Vec2 = Vec2::new(96.0, 9.0);
const PIECES: usize = 24;

/// Returns the height of the strip, by the size of the pane. It must not depend on the text, or the picture would change with every digit.
pub fn height(pane: Vec2) -> f32 {
    let rows = match pane {
        Vec2 { x, .. } if x >= 760.0 => 2.0,
        Vec2 { y, .. } if y >= 330.0 => 3.0,
        _ => 2.0,
    };
    rows * ROW + 2.0 * MARGIN.y
}

/// An item of the strip.
enum Item {
    Text(Arc<Galley>),
    Colours { title: Arc<Galley>, low: Arc<Galley>, high: Arc<Galley> },
}

impl Item {
    fn width(&self) -> f32 {
        match self {
            Self::Text(text) => text.size().x,
            Self::Colours { title, low, high } => {
                title.size().x + low.size().x + high.size().x + COLOURS.x + 15.0
            }
        }
    }
}

/// Paints the strip; a tooltip shows the texts that do not fit.
pub fn ui(
    ui: &mut egui::Ui,
    rect: Rect,
    state: &State,
    content: &SceneContent,
    projection: &Projection,
) {
    let Some((open, analysis)) = state.analysed() else { return };
    let painter = ui.painter_at(rect);
    painter.rect_filled(rect, 0.0, ui.visuals().panel_fill);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    painter.hline(rect.x_range(), rect.top(), line);
    let (colour, faint) = (ui.visuals().text_color(), theme::faint(ui.visuals().dark_mode));
    let area = rect.shrink2(MARGIN);
    let bar = paint_bar(&painter, area, projection, faint);

    let font = FontId::proportional(FONT);
    let layout = |text: &str, colour| {
        let mut job =
            egui::text::LayoutJob::simple_singleline(text.to_owned(), font.clone(), colour);
        job.wrap = egui::text::TextWrapping::truncate_at_width(area.width() - MORE);
        painter.layout_job(job)
    };
    // Each item with its text, for the tooltip if it does not fit.
    let mut items = Vec::new();
    let texts = strip_text::texts(open, analysis, state, content);
    for text in &texts {
        // A text that stands out says that the picture is not to scale.
        let colour = if text.faint { faint } else { colour };
        items.push((text.text.clone(), Item::Text(layout(&text.text, colour))));
    }
    let coloured = [&content.raw_shown, &content.tracks_shown]
        .into_iter()
        .any(|shown| shown.as_slice().contains(&true));
    let scale = content.colours.scale.as_ref().filter(|_| coloured);
    if let Some(scale) = scale {
        let [low, high] = ends_of(scale);
        let said = format!("{}: {low} to {high}", scale.title);
        let [low, high] = [low, high].map(|end| layout(&end, colour));
        let title = layout(scale.title, colour);
        // Right behind the most important texts.
        items.insert(items.len().min(2), (said, Item::Colours { title, low, high }));
    }
    // Each item is placed in the first row with room.
    let count = (area.height() / ROW).round() as usize;
    let mut ends = vec![area.left(); count];
    let mut left_out = Vec::new();
    for (said, item) in items {
        let fits = |(row, end): (usize, &f32)| {
            let right = match row {
                0 => bar.left() - BETWEEN,
                _ if row + 1 == count => area.right() - MORE,
                _ => area.right(),
            };
            end + item.width() <= right
        };
        let Some(row) = ends.iter().enumerate().position(fits) else {
            left_out.push(said);
            continue;
        };
        if matches!(&item, Item::Text(text) if text.elided) {
            left_out.push(said);
        }
        paint(&painter, Pos2::new(ends[row], area.top() + row as f32 * ROW), &item, colour);
        ends[row] += item.width() + BETWEEN;
    }
    // A saved picture has no tooltip.
    if !left_out.is_empty() && !state.workspace.picturing {
        let more = format!("+{} more", left_out.len());
        painter.text(area.right_bottom(), Align2::RIGHT_BOTTOM, more, font.clone(), faint);
    }
    let all: Vec<String> = texts.into_iter().map(|text| text.text).collect();
    let response = ui.interact(rect, ui.scope_id().with("strip"), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Status, true, all.join(" · ")));
    if !left_out.is_empty() {
        response.on_hover_text_at_pointer(left_out.join("\n"));
    }
}

fn paint(painter: &Painter, at: Pos2, item: &Item, colour: Color32) {
    match item {
        Item::Text(text) => painter.galley(at, Arc::clone(text), colour),
        Item::Colours { title, low, high } => {
            painter.galley(at, Arc::clone(title), colour);
            let mut at = at + Vec2::new(title.size().x + 6.0, 0.0);
            painter.galley(at, Arc::clone(low), colour);
            at.x += low.size().x + 4.0;
            paint_colours(painter, Rect::from_min_size(at + Vec2::new(0.0, 3.0), COLOURS));
            at.x += COLOURS.x + 5.0;
            painter.galley(at, Arc::clone(high), colour);
        }
    }
}

fn paint_colours(painter: &Painter, bar: Rect) {
    let mut mesh = Mesh::default();
    for piece in 0..=PIECES {
        let share = piece as f32 / PIECES as f32;
        let x = bar.left() + share * bar.width();
        let colour = theme::rgb(palette::continuous(share));
        let first = 2 * piece as u32;
        mesh.colored_vertex(Pos2::new(x, bar.top()), colour);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), colour);
        if piece < PIECES {
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    painter.add(Shape::mesh(mesh));
}

fn ends_of(scale: &Scale) -> [String; 2] {
    let more = if scale.exceeded { "≥ " } else { "" };
    [number(scale.low), format!("{more}{}", number(scale.high))]
}

/// Formats a value with three significant digits.
fn number(value: f64) -> String {
    let decimals = (2.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 3.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// Paints a scale bar of a round length on the right of the first row;
/// returns the rectangle reserved for it, which is the same for every length.
fn paint_bar(painter: &Painter, area: Rect, projection: &Projection, colour: Color32) -> Rect {
    let length_m = round_length(BAR_POINTS / projection.points_per_metre);
    let length = length_m * projection.points_per_metre;
    let y = area.top() + 0.5 * ROW;
    let (left, right) = (Pos2::new(area.right() - length, y), Pos2::new(area.right(), y));
    let stroke = Stroke::new(1.5, colour);
    painter.line_segment([left, right], stroke);
    for end in [left, right] {
        painter.line_segment([end - Vec2::new(0.0, 4.0), end + Vec2::new(0.0, 4.0)], stroke);
    }
    // In perspective the scale is correct only at the target.
    let where_it_is = if projection.parallel { "" } else { " at view centre" };
    let text = format!("{length_m} m{where_it_is}");
    let at = Pos2::new(left.x - 6.0, y);
    painter.text(at, Align2::RIGHT_CENTER, text, FontId::proportional(FONT), colour);
    let kept = if projection.parallel { 140.0 } else { 210.0 };
    Rect::from_min_max(
        Pos2::new(area.right() - kept, area.top()),
        Pos2::new(area.right(), area.top() + ROW),
    )
}

/// Rounds down to 1, 2 or 5 times a power of ten.
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

    #[test]
    fn numbers_on_the_scale_are_short() {
        assert_eq!(
            [0.0, 0.65, 1.3, 7.5, 210.0, 420.0].map(number),
            ["0", "0.65", "1.3", "7.5", "210", "420"]
        );
    }
}
