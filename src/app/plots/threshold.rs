//! A draggable threshold in a plot: a slider without a track.

use std::ops::RangeInclusive;

use egui::{CursorIcon, EventFilter, Key, Pos2, Rect, Response, Sense, Stroke, Vec2, accesskit};

use crate::app::theme;
use crate::app::words;

/// A threshold with its range and unit.
pub struct Threshold<'a> {
    /// Symbol, for example τ_r.
    pub symbol: &'a str,
    pub value: f64,
    /// Value in the paper, restored by a right click.
    pub paper: f64,
    pub unit: &'a str,
    /// Permitted values, all positive.
    pub range: RangeInclusive<f64>,
    /// True if the module of this threshold is enabled.
    pub enabled: bool,
}

/// Distance from a line within which it can be dragged (points).
const REACH: f32 = 4.0;
/// Factor of an arrow key, without and with shift.
const KEY_STEP: f64 = 1.03;
const LARGE_KEY_STEP: f64 = 1.2;

impl Threshold<'_> {
    /// Label, for example "τ_r 2.00 m/s".
    pub fn label(&self) -> String {
        format!("{} {} {}", self.symbol, short(self.value), self.unit)
    }

    /// Draws a line across a frame at `y`, which the user drags up and down; returns the new value if it changed.
    pub fn horizontal_line(
        &self,
        ui: &mut egui::Ui,
        frame: Rect,
        y: f32,
        value_at: impl Fn(f32) -> f64,
    ) -> Option<f64> {
        let rect = Rect::from_x_y_ranges(frame.x_range(), y - REACH..=y + REACH);
        let place = egui::pos2(frame.right(), y);
        let (response, wanted) = self.interact(ui, "line", rect, place, |at| {
            value_at(at.y.clamp(frame.top(), frame.bottom()))
        });
        let ink = Ink::of(ui, self.enabled, &response);
        ink.line(
            ui,
            frame,
            [frame.left_center(), frame.right_center()].map(|p| egui::pos2(p.x, y)),
        );
        ink.handle(ui, frame, place, Vec2::X, &self.label());
        wanted
    }

    /// Draws a line across a frame at `x`, which the user drags sideways; returns the new value if it changed.
    pub fn vertical_line(
        &self,
        ui: &mut egui::Ui,
        frame: Rect,
        x: f32,
        value_at: impl Fn(f32) -> f64,
    ) -> Option<f64> {
        let rect = Rect::from_x_y_ranges(x - REACH..=x + REACH, frame.y_range());
        let place = egui::pos2(x, frame.top());
        let (response, wanted) = self.interact(ui, "line", rect, place, |at| {
            value_at(at.x.clamp(frame.left(), frame.right()))
        });
        let ink = Ink::of(ui, self.enabled, &response);
        ink.line(
            ui,
            frame,
            [frame.center_top(), frame.center_bottom()].map(|p| egui::pos2(x, p.y)),
        );
        ink.handle(ui, frame, place, -Vec2::Y, &self.label());
        wanted
    }

    /// Draws a bar as long as the threshold from the left of a frame, with a draggable end; returns the new value if it changed.
    pub fn bar(&self, ui: &mut egui::Ui, frame: Rect, points_per_unit: f32) -> Option<f64> {
        let font = egui::TextStyle::Small.resolve(ui.style());
        let lay_out = |text: String| {
            ui.painter().layout_no_wrap(text, font.clone(), egui::Color32::PLACEHOLDER)
        };
        let whole = lay_out(self.label());
        let is_room = whole.size().x + 3.0 * REACH < frame.width();
        let galley = if is_room { whole } else { lay_out(self.symbol.to_owned()) };
        let left = frame.left_center() + Vec2::new(1.0, 0.0);
        let longest = (frame.width() - galley.size().x - 8.0).max(1.0);
        let end = left + Vec2::new((self.value as f32 * points_per_unit).min(longest), 0.0);
        let rect = Rect::from_two_pos(left, end).expand2(Vec2::new(REACH, frame.height() / 2.0));
        let (response, wanted) = self.interact(ui, "bar", rect, end, |at| {
            f64::from((at.x - left.x).min(longest) / points_per_unit)
        });
        let ink = Ink::of(ui, self.enabled, &response);
        let painter = ui.painter().with_clip_rect(frame);
        let tick = Vec2::new(0.0, 4.0);
        for ends in [[left, end], [left - tick, left + tick], [end - tick, end + tick]] {
            painter.line_segment(ends, ink.stroke);
        }
        let place = end + Vec2::new(5.0, -galley.size().y / 2.0);
        painter.galley(place, galley, ink.stroke.color);
        wanted
    }

    /// Handles the pointer and keys; named for example "τ_r line" for screen readers. `place` is the position of the threshold, and
    /// `value_at` converts a position to a value.
    fn interact(
        &self,
        ui: &egui::Ui,
        what: &str,
        rect: Rect,
        place: Pos2,
        value_at: impl Fn(Pos2) -> f64,
    ) -> (Response, Option<f64>) {
        let name = format!("{} {what}", self.symbol);
        let sense = if self.enabled { Sense::click_and_drag() } else { Sense::hover() };
        let response = ui.interact(rect, ui.scope_id().with(&name), sense);
        response.widget_info(|| egui::WidgetInfo::slider(self.enabled, self.value, &name));
        words::mark_text(&response, self.symbol);
        if !self.enabled {
            return (response.on_hover_text("This module of the pipeline is off"), None);
        }
        self.describe(ui, &response);
        let mut wanted = self.by_keys(ui, &response);
        // The threshold keeps its distance from the pointer during a drag.
        let grip_id = response.id.with("grip");
        if response.drag_started()
            && let Some(origin) = ui.input(|i| i.pointer.press_origin())
        {
            ui.data_mut(|data| data.insert_temp(grip_id, origin - place));
        }
        if response.dragged_by(egui::PointerButton::Primary)
            && let Some(pointer) = response.interact_pointer_pos()
        {
            let grip: Vec2 = ui.data(|data| data.get_temp(grip_id)).unwrap_or_default();
            wanted = Some(value_at(pointer - grip));
        }
        if response.clicked() {
            response.request_focus();
        }
        if response.secondary_clicked() {
            wanted = Some(self.paper);
        }
        let wanted = wanted
            .map(|value| rounded(value).clamp(*self.range.start(), *self.range.end()))
            .filter(|value| *value != self.value);
        let icon = if rect.width() > rect.height() && what == "line" {
            CursorIcon::ResizeVertical
        } else {
            CursorIcon::ResizeHorizontal
        };
        let hint = format!(
            "Drag, or use the arrow keys. Paper: {} {} (right click)",
            self.paper, self.unit
        );
        (response.on_hover_and_drag_cursor(icon).on_hover_text(hint), wanted)
    }

    /// Reports the range and the actions to screen readers.
    fn describe(&self, ui: &egui::Ui, response: &Response) {
        ui.ctx().accesskit_node_builder(response.id, |node| {
            node.set_min_numeric_value(*self.range.start());
            node.set_max_numeric_value(*self.range.end());
            for action in [
                accesskit::Action::SetValue,
                accesskit::Action::Increment,
                accesskit::Action::Decrement,
            ] {
                node.add_action(action);
            }
        });
    }

    fn by_keys(&self, ui: &egui::Ui, response: &Response) -> Option<f64> {
        let mut steps = 0.0;
        if response.has_focus() {
            let arrows = EventFilter {
                horizontal_arrows: true,
                vertical_arrows: true,
                ..Default::default()
            };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
            let presses = |keys: [Key; 2]| {
                let count = |i: &egui::InputState| keys.map(|key| i.num_presses(key)).iter().sum();
                ui.input(|i| -> usize { count(i) }) as f64
            };
            steps += presses([Key::ArrowUp, Key::ArrowRight])
                - presses([Key::ArrowDown, Key::ArrowLeft]);
        }
        let (id, set) = (response.id, accesskit::Action::SetValue);
        let asked = |action| ui.input(|i| i.num_accesskit_action_requests(id, action)) as f64;
        steps += asked(accesskit::Action::Increment) - asked(accesskit::Action::Decrement);
        let by_name = ui.input(|i| {
            let values =
                i.accesskit_action_requests(id, set).filter_map(|request| match request.data {
                    Some(accesskit::ActionData::NumericValue(value)) => Some(value),
                    _ => None,
                });
            values.last()
        });
        let step = if ui.input(|i| i.modifiers.shift) { LARGE_KEY_STEP } else { KEY_STEP };
        let value = self.value.max(*self.range.start());
        by_name.or((steps != 0.0).then(|| value * step.powf(steps)))
    }
}

/// Style of a threshold: strong while it is dragged, faint while its module is disabled.
struct Ink {
    stroke: Stroke,
    enabled: bool,
    held: bool,
}

impl Ink {
    fn of(ui: &egui::Ui, enabled: bool, response: &Response) -> Self {
        let held = enabled && (response.hovered() || response.dragged() || response.has_focus());
        let dark = ui.visuals().dark_mode;
        let colour = match (enabled, held) {
            (false, _) => theme::faint(dark).gamma_multiply(0.7),
            (true, false) => ui.visuals().text_color(),
            (true, true) => ui.visuals().strong_text_color(),
        };
        Self { stroke: Stroke::new(if held { 2.5 } else { 1.5 }, colour), enabled, held }
    }

    fn line(&self, ui: &egui::Ui, frame: Rect, ends: [Pos2; 2]) {
        let painter = ui.painter().with_clip_rect(frame);
        if self.enabled {
            painter.line_segment(ends, self.stroke);
        } else {
            painter.extend(egui::Shape::dashed_line(&ends, self.stroke, 4.0, 4.0));
        }
    }

    /// Draws a handle at the end of a line, outside the frame in the direction `out`. The value is shown only during a drag, because it
    /// covers data.
    fn handle(&self, ui: &egui::Ui, frame: Rect, place: Pos2, out: Vec2, text: &str) {
        if self.held {
            return self.tag(ui, frame, place, text);
        }
        let corners = [Vec2::ZERO, 7.0 * out + 4.0 * out.rot90(), 7.0 * out - 4.0 * out.rot90()];
        let corners = corners.map(|corner| place + corner).to_vec();
        ui.painter().add(egui::Shape::convex_polygon(corners, self.stroke.color, Stroke::NONE));
    }

    /// Draws the value, inside the frame beside `place`.
    fn tag(&self, ui: &egui::Ui, frame: Rect, place: Pos2, text: &str) {
        let font = egui::TextStyle::Small.resolve(ui.style());
        let painter = ui.painter().with_clip_rect(frame);
        let ground = ui.visuals().extreme_bg_color;
        let galley = painter.layout_no_wrap(text.to_owned(), font, ground);
        let size = galley.size() + Vec2::new(8.0, 2.0);
        let low = frame.min + Vec2::splat(1.0);
        let high = frame.max - size - Vec2::splat(1.0);
        let corner = place - 0.5 * size;
        let corner = egui::pos2(corner.x.min(high.x).max(low.x), corner.y.min(high.y).max(low.y));
        painter.rect_filled(Rect::from_min_size(corner, size), 3.0, self.stroke.color);
        painter.galley(corner + Vec2::new(4.0, 1.0), galley, ground);
    }
}

/// Rounds a value to three digits, so that the value set equals the value shown.
fn rounded(value: f64) -> f64 {
    if value <= 0.0 {
        return 0.0;
    }
    let unit = 10_f64.powf(value.log10().floor() - 2.0);
    let digits = (value / unit).round();
    // Division by a power of ten gives the nearest number; multiplication by its inverse does not.
    if unit < 1.0 { digits / (1.0 / unit).round() } else { digits * unit }
}

/// Formats a value with three digits and at most four decimals.
pub fn short(value: f64) -> String {
    match value {
        v if v < 0.0995 => format!("{v:.4}"),
        v if v < 0.995 => format!("{v:.3}"),
        v if v < 9.995 => format!("{v:.2}"),
        v if v < 99.95 => format!("{v:.1}"),
        v => format!("{v:.0}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_set_is_what_is_shown() {
        for (value, expected) in
            [(2.004_9, 2.0), (0.123_45, 0.123), (12.34, 12.3), (1234.0, 1230.0)]
        {
            assert_eq!(rounded(value), expected);
        }
        assert_eq!(["0.123", "2.00", "12.3", "123"], [0.123, 2.0, 12.3, 123.4].map(short));
    }
}
