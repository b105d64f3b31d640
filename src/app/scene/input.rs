//! Camera control by mouse and keyboard, and the effects of clicks.

use egui::{EventFilter, Key, Modifiers, Rect};

use super::content::SceneContent;
use super::projection::Projection;
use super::under_pointer::UnderPointer;
use crate::app::model::{Commands, SceneCommand, TimeCommand, View, ViewPreset};
use crate::app::state::State;

/// Length of the drag to which one key press corresponds (points).
const KEY_DRAG: f32 = 14.0;
const KEY_ZOOM: f32 = 1.15;

pub fn move_camera(
    view: &mut View,
    ui: &egui::Ui,
    response: &egui::Response,
    rect: Rect,
    state: &State,
) {
    let drag: [f32; 2] = response.drag_delta().into();
    let shift = ui.input(|i| i.modifiers.shift);
    use egui::PointerButton::{Middle, Primary, Secondary};
    if response.drag_started() || response.clicked() {
        response.request_focus();
    }
    if response.dragged_by(Secondary)
        || response.dragged_by(Middle)
        || (shift && response.dragged_by(Primary))
    {
        view.flight = None;
        view.camera.pan(drag, rect.height());
    } else if response.dragged_by(Primary) {
        view.flight = None;
        view.camera.orbit(drag);
    }
    if response.hovered() {
        let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
        if scroll != 0.0 || pinch != 1.0 {
            view.flight = None;
            let factor = (-0.004 * scroll).exp() / pinch;
            view.camera.zoom(factor);
            // The point under the pointer stays there, unless the camera follows the rig.
            if let Some(pointer) = response.hover_pos().filter(|_| !state.scene.options.follow) {
                let shift = (pointer - rect.center()) * (1.0 - 1.0 / factor);
                view.camera.pan(shift.into(), rect.height());
            }
        }
    }
}

/// Handles keys while the scene has the focus: arrows rotate, with shift they pan, + and − zoom, Esc clears the ruler.
pub fn take_keys(
    view: &mut View,
    ui: &egui::Ui,
    response: &egui::Response,
    rect: Rect,
    state: &State,
    commands: &mut Commands,
) {
    if !response.has_focus() {
        return;
    }
    let measuring = state.scene.ruler.active || !state.scene.ruler.ends.is_empty();
    // Without a ruler Esc leaves the scene, as in other panes.
    let filter = EventFilter {
        horizontal_arrows: true,
        vertical_arrows: true,
        escape: measuring,
        ..Default::default()
    };
    ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, filter));
    let presses = |modifiers, key| ui.input_mut(|i| i.count_and_consume_key(modifiers, key)) as f32;
    let arrows = |modifiers| {
        let of = |less, more| presses(modifiers, more) - presses(modifiers, less);
        [of(Key::ArrowLeft, Key::ArrowRight), of(Key::ArrowUp, Key::ArrowDown)]
    };
    // Shift first: plain arrows match with any modifier.
    let pan = arrows(Modifiers::SHIFT);
    let orbit = arrows(Modifiers::NONE);
    let closer = presses(Modifiers::NONE, Key::Plus) + presses(Modifiers::NONE, Key::Equals);
    let further = presses(Modifiers::NONE, Key::Minus);
    if pan != [0.0; 2] || orbit != [0.0; 2] || closer != further {
        view.flight = None;
        // Orbiting moves the scene in the direction of the arrow, panning moves the camera.
        view.camera.orbit(orbit.map(|presses| KEY_DRAG * presses));
        view.camera.pan(pan.map(|presses| -KEY_DRAG * presses), rect.height());
        view.camera.zoom(KEY_ZOOM.powf(further - closer));
    }
    if measuring && presses(Modifiers::NONE, Key::Escape) > 0.0 {
        commands.push(SceneCommand::Measure(state.scene.ruler.escaped()).into());
    }
}

/// Handles a click. It sets an end of the ruler while that is active. Otherwise it picks a reading, moves the cursor to a point of a track,
/// or on the background clears the selection. A double-click flies to the point under it, or on the background fits everything.
pub fn click(
    content: &SceneContent,
    response: &egui::Response,
    projection: &Projection,
    state: &State,
    commands: &mut Commands,
) {
    let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) else {
        return;
    };
    let Some((open, analysis)) = state.analysed() else { return };
    let under = UnderPointer::find(content, projection, at);
    if response.double_clicked() {
        let snapped = content.snap(projection, at).map(|end| end.position_m);
        let under = under.and_then(|under| under.position_m(open, analysis, content));
        let fit = SceneCommand::Look(ViewPreset::Fit);
        commands.push(snapped.or(under).map_or(fit, SceneCommand::ComeTo).into());
        return;
    }
    if state.scene.ruler.active {
        let end = content
            .snap(projection, at)
            .or_else(|| under.and_then(|under| under.ruler_end(open, analysis, content)));
        commands.extend(end.map(|end| SceneCommand::Measure(state.scene.ruler.with(end)).into()));
        return;
    }
    match under {
        Some(UnderPointer::Reading(picked)) => {
            commands.push(TimeCommand::PickInScene(picked).into());
        }
        Some(track @ UnderPointer::Track { .. }) => {
            commands.extend(
                track.time_s(open, analysis).map(|time_s| TimeCommand::MoveCursor(time_s).into()),
            );
        }
        None => {
            commands.extend(open.timeline.picked.map(|_| TimeCommand::Unpick.into()));
            let point = state.scene.shown_point.as_ref();
            commands.extend(point.map(|_| SceneCommand::ForgetPoint.into()));
        }
    }
}
