//! The bar at the bottom: play, speed, time of the cursor, and the whole drive as a strip.

use egui::{Align2, FontId, Key, Pos2, Rect, Sense, Stroke, StrokeKind, Vec2};

use crate::app::model::time_scale::decimals;
use crate::app::model::{
    Commands, OpenDeployment, Playback, SceneCommand, SceneOptions, TimeCommand, TimeScale,
    Timeline,
};
use crate::app::plots::quads::Quads;
use crate::app::prepared::gaps;
use crate::app::prepared::gaps::Seen;
use crate::app::state::State;
use crate::app::theme;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some(open) = state.active() else { return };
    egui::Panel::bottom("time bar").show(ui, |ui| {
        ui.horizontal(|ui| {
            transport(ui, state, commands);
            if state.live.is_running() && state.live.id == Some(open.id) {
                now(ui, open, commands);
            }
            scene(ui, state, commands);
            let [start_s, end_s] = open.timeline.whole_s;
            let at_s = open.timeline.cursor_s.unwrap_or(start_s) - start_s;
            let scale = TimeScale::new(state.workspace.units.time, start_s);
            let (at, end) = (scale.number(at_s, 1), scale.text(end_s - start_s, 1));
            let hint = format!("The time cursor: {}", scale.text_and_seconds(at_s, 1));
            // The width is the same for every time, so that the strip beside it does not move.
            let width = end.len();
            ui.monospace(format!("{at:>width$} / {end}")).on_hover_text(hint);
            strip(ui, state, open, commands);
        });
    });
}

fn transport(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let playing = state.time.playback.playing;
    for (icon, name, command) in [
        (Icon::Back, "Step backwards (←)", TimeCommand::StepCursor(-1)),
        if playing {
            (Icon::Pause, "Pause (Space)", TimeCommand::TogglePlay)
        } else {
            (Icon::Play, "Play (Space)", TimeCommand::TogglePlay)
        },
        (Icon::Forward, "Step forwards (→)", TimeCommand::StepCursor(1)),
    ] {
        let button = ui.add(egui::Button::new("").min_size(Vec2::new(26.0, 0.0)));
        paint_icon(ui, button.rect.center(), icon);
        let button = button.on_hover_text(name);
        button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, name));
        if button.clicked() {
            commands.push(command.into());
        }
    }
    let mut speed = state.time.playback.speed;
    let combo = egui::ComboBox::from_id_salt("speed")
        .width(52.0)
        .selected_text(format!("{speed}×"))
        .show_ui(ui, |ui| {
            for choice in Playback::SPEEDS {
                ui.selectable_value(&mut speed, choice, format!("{choice}×"));
            }
        });
    let name = "Speed of playing";
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    combo.response.on_hover_text("Seconds of the drive per second");
    if speed != state.time.playback.speed {
        commands.push(TimeCommand::SetPlaySpeed(speed).into());
    }
}

/// Shows if the cursor follows the newest readings, with a button that makes it do so.
fn now(ui: &mut egui::Ui, open: &OpenDeployment, commands: &mut Commands) {
    let now_s = open.now_s();
    let follows = open.timeline.cursor_s.is_some_and(|at_s| at_s >= now_s);
    let button = egui::Button::selectable(follows, "Now").frame_when_inactive(true);
    let hint = "The time cursor follows the newest readings (End) until you move it";
    if ui.add(button).on_hover_text(hint).clicked() {
        commands.push(TimeCommand::MoveCursor(now_s).into());
    }
}

/// Shows the playback settings of the scene.
fn scene(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut options = state.scene.options;
    let combo = egui::ComboBox::from_id_salt("trail")
        .width(74.0)
        .selected_text(format!("Trail {}", SceneOptions::trail_in_words(options.trail_s)))
        .show_ui(ui, |ui| {
            for choice in SceneOptions::TRAILS_S {
                let text = SceneOptions::trail_in_words(choice);
                ui.selectable_value(&mut options.trail_s, choice, text);
            }
        });
    let name = "Trail in the scene";
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
    combo.response.on_hover_text("Length of the track drawn behind each prism");
    let follow = egui::Button::selectable(options.follow, "Follow").frame_when_inactive(true);
    let hint = "The camera of the scene follows the rig (C) until you move it or press Fit";
    if ui.add(follow).on_hover_text(hint).clicked() {
        options.follow ^= true;
    }
    if options != state.scene.options {
        commands.push(SceneCommand::SetOptions(options).into());
    }
}

/// Drawn icons, because fonts may lack these characters.
#[derive(Clone, Copy)]
enum Icon {
    Play,
    Pause,
    Back,
    Forward,
}

fn paint_icon(ui: &egui::Ui, centre: Pos2, icon: Icon) {
    let colour = ui.visuals().text_color();
    let bar = |left: f32| {
        let rect = Rect::from_min_size(centre + Vec2::new(left, -5.0), Vec2::new(2.5, 10.0));
        ui.painter().rect_filled(rect, 0.0, colour);
    };
    let triangle = |base: f32, tip: f32| {
        let corners = [(base, -5.0), (tip, 0.0), (base, 5.0)];
        let corners = corners.map(|(x, y)| centre + Vec2::new(x, y)).to_vec();
        ui.painter().add(egui::Shape::convex_polygon(corners, colour, Stroke::NONE));
    };
    match icon {
        Icon::Play => triangle(-3.0, 5.0),
        Icon::Pause => [-4.0, 1.5].into_iter().for_each(bar),
        Icon::Back => {
            bar(-5.0);
            triangle(5.0, -2.0);
        }
        Icon::Forward => {
            triangle(-5.0, 2.0);
            bar(2.5);
        }
    }
}

/// Height of the numbers below the strip, and their least distance (points).
const TIMES: f32 = 13.0;
const TIMES_APART: f32 = 90.0;

/// Draws round times of the whole drive, as on the axes of the plots.
fn times(ui: &egui::Ui, place: Rect, scale: &TimeScale, timeline: &Timeline) {
    let length_s = timeline.whole_s[1] - timeline.whole_s[0];
    let s_per_point = length_s / f64::from(place.width().max(1.0));
    let times = scale.round_times([0.0, length_s], f64::from(TIMES_APART) * s_per_point);
    let step_s = times.iter().map(|time| time.step_s).fold(0.0, f64::max);
    let colour = theme::faint(ui.visuals().dark_mode);
    for time in times.iter().filter(|time| time.step_s == step_s) {
        let x = place.left() + (time.since_s / s_per_point) as f32;
        ui.painter().vline(x, place.top()..=place.top() + 3.0, Stroke::new(1.0, colour));
        let text = scale.number(time.since_s, decimals(step_s));
        let galley = ui.painter().layout_no_wrap(text, FontId::proportional(10.0), colour);
        let half = 0.5 * galley.size().x;
        // Numbers at the ends are shifted to be fully visible.
        let left = (x - half).clamp(place.left(), (place.right() - 2.0 * half).max(place.left()));
        ui.painter().galley(Pos2::new(left, place.top() + 1.0), galley, colour);
    }
}

/// Draws the whole drive: accepted intervals, the plots' time window, the selection, and the cursor, which a drag moves.
fn strip(ui: &mut egui::Ui, state: &State, open: &OpenDeployment, commands: &mut Commands) {
    let height = ui.spacing().interact_size.y;
    let size = Vec2::new(ui.available_width(), height + TIMES);
    let (whole, response) = ui.allocate_exact_size(size, Sense::click_and_drag());
    let (rect, below) = whole.split_top_bottom_at_y(whole.top() + height);
    times(ui, below, &TimeScale::new(state.workspace.units.time, open.start_s()), &open.timeline);
    let Timeline { whole_s, window_s, cursor_s, selection_s, .. } = open.timeline;
    let [start_s, end_s] = whole_s;
    response.widget_info(|| {
        let at_s = cursor_s.unwrap_or(start_s) - start_s;
        egui::WidgetInfo::slider(true, at_s, "Time cursor")
    });
    let x = |time_s: f64| {
        let share = ((time_s - start_s) / (end_s - start_s)).clamp(0.0, 1.0);
        rect.left() + share as f32 * rect.width()
    };
    let band = |span_s: [f64; 2], inset: f32| {
        Rect::from_x_y_ranges(x(span_s[0])..=x(span_s[1]), rect.y_range())
            .shrink2(Vec2::new(0.0, inset))
    };
    let (painter, visuals) = (ui.painter_at(rect), ui.visuals());
    let dark = visuals.dark_mode;
    painter.rect_filled(rect, 3.0, visuals.extreme_bg_color);
    if let Some(analysis) = &open.analysis {
        let kept = theme::faint(dark).gamma_multiply(0.55);
        let s_per_point = (end_s - start_s) / f64::from(rect.width());
        let mut quads = Quads::default();
        for Seen { span, .. } in
            gaps::visible(&analysis.pipeline.kept_intervals, whole_s, s_per_point)
        {
            quads.add(band([span.start_s, span.end_s], 6.0), kept);
        }
        painter.add(quads.into_shape());
    }
    if let Some(span_s) = selection_s {
        painter.rect_filled(band(span_s, 1.0), 1.0, visuals.selection.bg_fill.gamma_multiply(0.5));
    }
    if window_s != whole_s {
        let stroke = Stroke::new(1.0, visuals.text_color());
        painter.rect_stroke(band(window_s, 1.0), 2.0, stroke, StrokeKind::Inside);
    }
    if let Some(hover_s) = state.time.hover_s {
        painter.vline(x(hover_s), rect.y_range(), Stroke::new(1.0, theme::faint(dark)));
    }
    if let Some(cursor_s) = cursor_s {
        let colour = theme::rgb(theme::cursor(dark));
        painter.vline(x(cursor_s), rect.y_range(), Stroke::new(2.0, colour));
    }
    if response.has_focus() {
        painter.rect_stroke(rect, 3.0, visuals.selection.stroke, StrokeKind::Inside);
        let pressed = |key| ui.input(|input| input.num_presses(key)) as i32;
        let steps = pressed(Key::ArrowRight) - pressed(Key::ArrowLeft);
        if steps != 0 {
            commands.push(TimeCommand::StepCursor(steps).into());
        }
        let arrows = egui::EventFilter { horizontal_arrows: true, ..Default::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(response.id, arrows));
    }
    let time_at = |at: Pos2| {
        let share = ((at.x - rect.left()) / rect.width()).clamp(0.0, 1.0);
        start_s + f64::from(share) * (end_s - start_s)
    };
    if let Some(at) = response.interact_pointer_pos() {
        commands.push(TimeCommand::MoveCursor(time_at(at)).into());
    } else if let Some(at) = response.hover_pos() {
        let time_s = time_at(at);
        commands.push(TimeCommand::Hover(time_s).into());
        let text = TimeScale::new(state.workspace.units.time, start_s).text(time_s - start_s, 1);
        let align = if at.x > rect.center().x { Align2::RIGHT_CENTER } else { Align2::LEFT_CENTER };
        let offset = if align == Align2::RIGHT_CENTER { -6.0 } else { 6.0 };
        let place = Pos2::new(at.x + offset, rect.center().y);
        painter.text(place, align, text, FontId::proportional(11.0), visuals.text_color());
    }
}
