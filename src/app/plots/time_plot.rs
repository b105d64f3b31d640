//! Shared behaviour of all plots over time: time window, cursor, selection and navigation.

use egui::{Pos2, Rect, Stroke};
use egui_plot::{AxisHints, Plot, PlotTransform, PlotUi};

use super::navigation::{self, Moved};
use super::strips::{Strip, time_marks};
use super::times::Times;
use crate::app::model::{Commands, TimeCommand};
use crate::app::state::State;
use crate::app::theme;

/// A plot that was drawn.
pub struct ShownPlot {
    pub response: egui::Response,
    pub transform: PlotTransform,
    /// Change of the y axis that the user asks for, in plots that allow it.
    pub moved_y: Option<Moved>,
}

/// A plot over time: place, name for screen readers, and ranges.
pub struct TimePlot<'t> {
    pub strip: &'t Strip,
    pub name: &'t str,
    pub times: &'t Times,
    pub y_bounds: [f64; 2],
}

impl TimePlot<'_> {
    /// Shows the plot with the content that `add` draws, and handles the user's input. The caller then paints the rest, and ends with
    /// [`ShownPlot::paint_times`].
    pub fn show<'a>(
        &self,
        ui: &mut egui::Ui,
        plot: Plot<'a>,
        y_axis: AxisHints<'a>,
        commands: &mut Commands,
        add: impl FnOnce(&mut PlotUi<'a>) + 'a,
    ) -> ShownPlot {
        let Self { strip, name, times, y_bounds } = *self;
        let (scale, [from_s, to_s]) = (times.scale, times.window_s);
        let x_axes = strip.time_axis(times).into_iter().collect();
        // Navigation is the same in all plots over time, and replaces that of `egui_plot`.
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
        ShownPlot { response, transform: shown.transform, moved_y }
    }
}

/// Disables mouse navigation of a plot.
pub fn still(plot: Plot<'_>) -> Plot<'_> {
    plot.allow_zoom(false)
        .allow_scroll(false)
        .allow_drag(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_crosshair(false)
}

impl ShownPlot {
    pub fn frame(&self) -> Rect {
        *self.transform.frame()
    }

    /// Horizontal position of a time on the screen (points).
    pub fn x(&self, since_start_s: f64) -> f32 {
        self.transform.position_from_point_x(since_start_s)
    }

    /// Painter that is clipped to the plot.
    pub fn painter(&self, ui: &egui::Ui) -> egui::Painter {
        ui.painter().with_clip_rect(self.frame().intersect(ui.clip_rect()))
    }

    /// Position of the pointer in the plot; `None` outside, and during a drag.
    pub fn pointer(&self, ui: &egui::Ui) -> Option<Pos2> {
        let pointer = ui.input(|i| i.pointer.hover_pos().filter(|_| !i.pointer.any_down()))?;
        (self.response.contains_pointer() && self.frame().contains(pointer)).then_some(pointer)
    }

    /// Moves the cursor on a click, unless the caller assigns the click to an item.
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

    /// Draws the selection, the hovered time and the cursor above all else.
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

/// Lays out the line above a plot. Excess content is clipped, so that it does not widen the pane.
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

/// Navigation hints for the line above a plot, from the complete one to the shortest.
const HINTS: [&str; 3] = [
    "drag: select · scroll: zoom · shift+scroll or right drag: move · double-click: all",
    "drag: select · scroll: zoom · double-click: all",
    "scroll: zoom",
];

/// Shows the length of the selection and its commands, in the line above a plot.
pub fn selection(ui: &mut egui::Ui, state: &State, times: &Times, commands: &mut Commands) {
    let Some([from_s, to_s]) = times.selection_s else { return };
    ui.small(format!("{:.1} s selected", to_s - from_s))
        .on_hover_text([from_s, to_s].map(|t| times.scale.text_and_seconds(t, 1)).join(" to "));
    if state.workspace.picturing {
        return;
    }
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

/// Shows the longest hint that fits at the end of the line above a plot; hovering shows the complete one.
pub fn hint(ui: &mut egui::Ui, state: &State, more: &str) {
    if state.workspace.picturing {
        return;
    }
    let complete = format!("{}{more}", HINTS[0]);
    let font = egui::TextStyle::Small.resolve(ui.style());
    let room = ui.available_width();
    let fits = |text: &&str| {
        let colour = egui::Color32::PLACEHOLDER;
        ui.painter().layout_no_wrap((*text).to_owned(), font.clone(), colour).size().x <= room
    };
    let all = std::iter::once(complete.as_str()).chain(HINTS);
    if let Some(hint) = all.into_iter().find(fits) {
        ui.add(egui::Label::new(egui::RichText::new(hint).small().weak()).extend())
            .on_hover_text(complete.as_str());
    }
}
