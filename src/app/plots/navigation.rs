//! Navigation in plots over time. All panes share one time window, so they move together.

use egui::{Key, PointerButton};
use egui_plot::PlotTransform;

use super::times::Times;
use crate::app::model::{Commands, TimeCommand};

/// The user's change to an axis of values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Moved {
    To([f64; 2]),
    /// Resets the axis to the automatic range.
    Back,
}

/// Zoom factor of a key, and the share of the window by which a key moves it.
const KEY_ZOOM: f64 = 1.25;
const KEY_STEP: f64 = 0.2;

/// Handles mouse and keys. A drag selects, and scrolling zooms in time at the pointer. Shift and scrolling, sideways scrolling, and a drag
/// with the right or middle button move the window. Ctrl and scrolling zooms in y. A double click shows everything. Keys: plus, minus, page
/// up and page down.
pub fn navigate(
    ui: &egui::Ui,
    response: &egui::Response,
    transform: &PlotTransform,
    times: &Times,
    commands: &mut Commands,
) -> Option<Moved> {
    let frame = transform.frame();
    let s_per_point = transform.dvalue_dpos()[0];
    let mut window_s = times.window_s;
    let mut moved_y = None;
    let pointer = ui.input(|i| i.pointer.latest_pos()).filter(|at| frame.contains(*at));
    if let Some(at) = pointer.filter(|_| response.contains_pointer()) {
        let value = transform.value_from_position(at);
        commands.push(TimeCommand::Hover(value.x + times.start_s).into());
        let speed = ui.ctx().options(|options| options.input_options.scroll_zoom_speed);
        let (scroll, zoom, in_y) =
            ui.input(|i| (i.smooth_scroll_delta(), i.zoom_delta(), i.modifiers.command));
        if in_y {
            let bounds = transform.bounds();
            if zoom != 1.0 {
                let range = [bounds.min()[1], bounds.max()[1]];
                moved_y = Some(Moved::To(zoomed(range, value.y, f64::from(zoom))));
            }
        } else {
            let factor = f64::from((scroll.y * speed).exp() * zoom);
            window_s = zoomed(window_s, value.x, factor);
            window_s = window_s.map(|t| t - f64::from(scroll.x) * s_per_point);
        }
    }
    if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
        window_s = window_s.map(|t| t - f64::from(response.drag_delta().x) * s_per_point);
    }
    if response.has_focus() {
        window_s = by_keys(ui, window_s, times.cursor_s);
    }
    if window_s != times.window_s {
        commands.push(TimeCommand::ShowTimes(window_s.map(|t| t + times.start_s)).into());
    }
    if response.double_clicked() {
        commands.push(TimeCommand::ShowAllTimes.into());
        moved_y = Some(Moved::Back);
    }
    select(ui, response, transform, times, commands);
    moved_y
}

/// Handles navigation in plots whose x is not time. Scrolling zooms along x at the pointer, and a drag with the right or middle button
/// moves. A double click shows everything.
pub fn along_x(
    ui: &egui::Ui,
    response: &egui::Response,
    transform: &PlotTransform,
) -> Option<Moved> {
    if response.double_clicked() {
        return Some(Moved::Back);
    }
    let shown = [transform.bounds().min()[0], transform.bounds().max()[0]];
    let mut range = shown;
    let pointer = ui.input(|i| i.pointer.latest_pos());
    if let Some(at) = pointer.filter(|at| transform.frame().contains(*at))
        && response.contains_pointer()
    {
        let speed = ui.ctx().options(|options| options.input_options.scroll_zoom_speed);
        let (scroll, zoom) = ui.input(|i| (i.smooth_scroll_delta(), i.zoom_delta()));
        let factor = f64::from((scroll.y * speed).exp() * zoom);
        range = zoomed(range, transform.value_from_position(at).x, factor);
    }
    if response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle) {
        let by = f64::from(response.drag_delta().x) * transform.dvalue_dpos()[0];
        range = range.map(|end| end - by);
    }
    (range != shown).then_some(Moved::To(range))
}

/// Selects the time span over which the main button drags.
fn select(
    ui: &egui::Ui,
    response: &egui::Response,
    transform: &PlotTransform,
    times: &Times,
    commands: &mut Commands,
) {
    if !response.dragged_by(PointerButton::Primary) {
        return;
    }
    // The anchor is a time, because the window may move under the pointer.
    let anchor_id = response.id.with("selected from");
    let time_at = |x: f32| {
        let x = x.clamp(transform.frame().left(), transform.frame().right());
        transform.value_from_position(egui::pos2(x, 0.0)).x + times.start_s
    };
    if response.drag_started()
        && let Some(origin) = ui.input(|i| i.pointer.press_origin())
    {
        ui.data_mut(|data| data.insert_temp(anchor_id, time_at(origin.x)));
    }
    let anchor_s: Option<f64> = ui.data(|data| data.get_temp(anchor_id));
    if let Some((anchor_s, at)) = anchor_s.zip(response.interact_pointer_pos()) {
        commands.push(TimeCommand::Select(Some([anchor_s, time_at(at.x)])).into());
    }
}

/// Zooms about the cursor if it is visible, and otherwise about the middle.
fn by_keys(ui: &egui::Ui, window_s: [f64; 2], cursor_s: Option<f64>) -> [f64; 2] {
    let [from_s, to_s] = window_s;
    let about_s = cursor_s.filter(|t| (from_s..=to_s).contains(t)).unwrap_or((from_s + to_s) / 2.0);
    let step_s = KEY_STEP * (to_s - from_s);
    let pressed = |keys: &[Key]| ui.input(|i| keys.iter().any(|key| i.key_pressed(*key)));
    if pressed(&[Key::Plus, Key::Equals]) {
        zoomed(window_s, about_s, KEY_ZOOM)
    } else if pressed(&[Key::Minus]) {
        zoomed(window_s, about_s, 1.0 / KEY_ZOOM)
    } else if pressed(&[Key::PageUp]) {
        window_s.map(|t| t - step_s)
    } else if pressed(&[Key::PageDown]) {
        window_s.map(|t| t + step_s)
    } else {
        window_s
    }
}

/// Zooms a range about a fixed value; a factor above 1 shows less.
fn zoomed(range: [f64; 2], about: f64, factor: f64) -> [f64; 2] {
    if factor == 1.0 { range } else { range.map(|end| about + (end - about) / factor) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::{Event, MouseWheelUnit, Pos2, RawInput, Rect, Sense, Vec2};
    use egui_plot::PlotBounds;

    #[test]
    fn what_is_zoomed_about_stays_where_it_is() {
        let [from, to] = zoomed([10.0, 30.0], 15.0, 2.0);
        assert_eq!([from, to], [12.5, 22.5]);
        assert!(((15.0 - from) / (to - from) - 0.25).abs() < 1e-12);
        assert_eq!(zoomed([from, to], 15.0, 0.5), [10.0, 30.0]);
    }

    #[test]
    fn the_wheel_comes_nearer_to_what_is_under_the_pointer() {
        let frame = Rect::from_min_size(Pos2::ZERO, Vec2::splat(100.0));
        let bounds = PlotBounds::from_min_max([-5.0, 0.0], [5.0, 1.0]);
        let ctx = egui::Context::default();
        let mut moved = None;
        let mut frame_with = |events: Vec<Event>| {
            let input = RawInput { events, ..RawInput::default() };
            let mut output = ctx.run_ui(input, |ui| {
                let transform = PlotTransform::new(frame, bounds, false);
                let response = ui.interact(frame, egui::Id::unique("plot"), Sense::click());
                moved = moved.or(along_x(ui, &response, &transform));
            });
            output.textures_delta.clear();
        };
        // At 2.5 of −5 to 5.
        frame_with(vec![Event::PointerMoved(egui::pos2(75.0, 50.0))]);
        let wheel = Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: Vec2::new(0.0, 60.0),
            modifiers: egui::Modifiers::NONE,
            phase: egui::TouchPhase::Move,
            source: egui::MouseWheelSource::Unknown,
        };
        frame_with(vec![wheel]);
        frame_with(vec![]);
        let Some(Moved::To([low, high])) = moved else { panic!("{moved:?}") };
        assert!(high - low < 9.9, "{low} to {high}");
        assert!(((2.5 - low) / (high - low) - 0.75).abs() < 1e-6, "{low} to {high}");
    }
}
