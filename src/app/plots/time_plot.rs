//! What all plots over time share: one window of time, one cursor, one selection, and one way to move about.

use egui::{Pos2, Rect, Stroke};
use egui_plot::{AxisHints, Plot, PlotTransform, PlotUi};

use super::navigation::{self, Moved};
use super::strips::{Strip, time_marks};
use super::times::Times;
use crate::app::model::{Commands, TimeCommand};
use crate::app::theme;

/// A plot that was shown.
pub struct Shown {
    pub response: egui::Response,
    pub transform: PlotTransform,
    /// Bounds of y that the user asks for, where the plot lets him.
    pub moved_y: Option<Moved>,
}

/// A plot over time: where it is, how screen readers know it, and what it shows.
pub struct TimePlot<'t> {
    pub strip: &'t Strip,
    pub name: &'t str,
    pub times: &'t Times,
    pub y_bounds: [f64; 2],
}

impl TimePlot<'_> {
    /// Shows it with what `add` puts on it, and carries out what the user does in it. The caller paints what else it has
    /// and ends with [`Shown::paint_times`].
    pub fn show<'a>(
        &self,
        ui: &mut egui::Ui,
        plot: Plot<'a>,
        y_axis: AxisHints<'a>,
        commands: &mut Commands,
        add: impl FnOnce(&mut PlotUi<'a>) + 'a,
    ) -> Shown {
        let Self { strip, name, times, y_bounds } = *self;
        let (scale, [from_s, to_s]) = (times.scale, times.window_s);
        let x_axes = strip.time_axis(times).into_iter().collect();
        // Moving about is the same in all plots over time, and not egui_plot's.
        let plot = still(plot)
            .width(strip.plot.width())
            .height(strip.plot.height())
            .custom_x_axes(x_axes)
            .custom_y_axes(vec![y_axis])
            .x_grid_spacer(move |input| time_marks(&scale, &input));
        let builder = egui::UiBuilder::new().id_salt(name).max_rect(strip.plot);
        let ui = &mut ui.new_child(builder);
        let shown = plot.show(ui, move |plot_ui| {
            plot_ui.set_plot_bounds_x(from_s..=to_s);
            plot_ui.set_plot_bounds_y(y_bounds[0]..=y_bounds[1]);
            add(plot_ui);
        });
        let response = shown.response;
        response.widget_info(|| {
            egui::WidgetInfo::labeled(egui::accesskit::Role::Canvas, ui.is_enabled(), name)
        });
        if response.has_focus() {
            let frame = shown.transform.frame().shrink(1.0);
            let stroke = ui.visuals().selection.stroke;
            ui.painter().rect_stroke(frame, 2.0, stroke, egui::StrokeKind::Inside);
        }
        let moved_y = navigation::navigate(ui, &response, &shown.transform, times, commands);
        Shown { response, transform: shown.transform, moved_y }
    }
}

/// A plot that the mouse does not move.
pub fn still(plot: Plot<'_>) -> Plot<'_> {
    plot.allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
}

impl Shown {
    pub fn frame(&self) -> Rect {
        *self.transform.frame()
    }

    /// Where an instant is on the screen.
    pub fn x(&self, since_start_s: f64) -> f32 {
        self.transform.position_from_point_x(since_start_s)
    }

    /// Paints into the plot and no further.
    pub fn painter(&self, ui: &egui::Ui) -> egui::Painter {
        ui.painter().with_clip_rect(self.frame().intersect(ui.clip_rect()))
    }

    /// The pointer, while nothing is dragged and it is in the plot.
    pub fn pointer(&self, ui: &egui::Ui) -> Option<Pos2> {
        let pointer = ui.input(|i| i.pointer.hover_pos().filter(|_| !i.pointer.any_down()))?;
        (self.response.contains_pointer() && self.frame().contains(pointer)).then_some(pointer)
    }

    /// A click moves the cursor, unless the caller finds that it was meant for something.
    pub fn on_click(
        &self,
        times: &Times,
        commands: &mut Commands,
        meant_for: impl FnOnce(Pos2) -> Option<TimeCommand>,
    ) {
        if self.response.clicked()
            && let Some(at) = self.response.interact_pointer_pos()
        {
            let time_s = self.transform.value_from_position(at).x + times.start_s;
            commands.push(meant_for(at).unwrap_or(TimeCommand::MoveCursor(time_s)).into());
        }
    }

    /// The selection, the hovered instant and the cursor, over all else.
    pub fn paint_times(&self, ui: &egui::Ui, times: &Times) {
        let dark = ui.visuals().dark_mode;
        let (painter, frame) = (self.painter(ui), self.frame());
        let line =
            |time_s: f64, stroke: Stroke| painter.vline(self.x(time_s), frame.y_range(), stroke);
        if let Some(span_s) = times.selection_s {
            let [left, right] = span_s.map(|time_s| self.x(time_s));
            let colour = ui.visuals().selection.bg_fill;
            let shade = Rect::from_x_y_ranges(left..=right, frame.y_range());
            painter.rect_filled(shade, 0.0, colour.gamma_multiply(0.25));
            for time_s in span_s {
                line(time_s, Stroke::new(1.0, colour));
            }
        }
        if let Some(hover_s) = times.hover_s {
            line(hover_s, Stroke::new(1.0, theme::faint(dark).gamma_multiply(0.6)));
        }
        if let Some(cursor_s) = times.cursor_s {
            line(cursor_s, Stroke::new(1.0, theme::rgb(theme::cursor(dark))));
        }
    }
}

/// The line above a plot. What has no room in it is cut off: it must not make the pane wider.
pub fn head(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui)) {
    let size = egui::vec2(ui.available_width(), ui.spacing().interact_size.y);
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let left_to_right = egui::Layout::left_to_right(egui::Align::Center);
    let builder = egui::UiBuilder::new().id_salt("head").max_rect(rect).layout(left_to_right);
    let mut line = ui.new_child(builder);
    line.set_clip_rect(rect.expand(2.0).intersect(ui.clip_rect()));
    line.add_space(6.0);
    add(&mut line);
}

/// Of a hint in less than this there is nothing to read (points).
const LEAST_HINT: f32 = 40.0;

/// How to move about, for the line above a plot.
const HINT: &str =
    "drag: select · scroll: zoom · shift+scroll or right drag: move · double-click: all";

/// Shows, in the line above a plot, how much is selected and what can be done with it.
pub fn selection(ui: &mut egui::Ui, times: &Times, commands: &mut Commands) {
    let Some([from_s, to_s]) = times.selection_s else { return };
    ui.small(format!("{:.1} s selected", to_s - from_s))
        .on_hover_text([from_s, to_s].map(|t| times.scale.text_and_seconds(t, 1)).join(" to "));
    for (text, name, command) in [
        ("zoom", "Zoom to the selection", TimeCommand::ZoomToSelection),
        ("clear", "Clear the selection", TimeCommand::Select(None)),
    ] {
        let button = ui.small_button(text).on_hover_text(name);
        let role = egui::accesskit::Role::Button;
        button.widget_info(|| egui::WidgetInfo::labeled(role, ui.is_enabled(), name));
        if button.clicked() {
            commands.push(command.into());
        }
    }
}

/// Shows a hint at the end of the line above a plot, as far as there is room; in full under the pointer.
pub fn hint(ui: &mut egui::Ui, more: &str) {
    if ui.available_width() < LEAST_HINT {
        return;
    }
    let text = egui::RichText::new(format!("{HINT}{more}")).small().weak();
    ui.add(egui::Label::new(text).truncate());
}
