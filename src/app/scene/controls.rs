//! Buttons in the scene's corner: view presets, the ruler, and the colouring.

use egui::{Pos2, Rect, RichText, Role, Vec2, WidgetInfo};

use crate::app::model::{Colouring, Commands, Ruler, SceneCommand, SceneOptions, ViewPreset};
use crate::app::state::State;
use crate::app::theme;
use resect_tools::palette;

/// Least width for all controls in one row beside the legend, and in two rows (points); narrower pictures have a menu.
const ONE_ROW_POINTS: f32 = 860.0;
const TWO_ROWS_POINTS: f32 = 290.0;
const MARGIN: f32 = 8.0;

/// Shows the controls in the upper right corner; returns their rectangle. `size` is their size in the last frame.
pub fn ui(
    ui: &mut egui::Ui,
    rect: Rect,
    size: &mut Vec2,
    state: &State,
    commands: &mut Commands,
) -> Rect {
    let corner = Pos2::new(rect.right() - MARGIN - size.x, rect.top() + 6.0);
    let room = Rect::from_min_max(corner, rect.right_bottom());
    // Left to right, so that Tab follows the reading order; the width is known after the first frame.
    let response = ui.scope_builder(egui::UiBuilder::new().max_rect(room), |ui| {
        ui.spacing_mut().item_spacing = Vec2::splat(4.0);
        if rect.width() >= ONE_ROW_POINTS {
            ui.horizontal(|ui| {
                presets(ui, &PRESETS, commands);
                stations(ui, state, commands);
                ruler(ui, state, commands);
                heights(ui, state, commands);
                colouring(ui, state, true, commands);
            });
        } else if rect.width() < TWO_ROWS_POINTS {
            ui.menu_button("Views", |ui| {
                presets(ui, &PRESETS, commands);
                stations(ui, state, commands);
                ruler(ui, state, commands);
                heights(ui, state, commands);
                colouring(ui, state, true, commands);
            });
        } else {
            // Beside the legend, which is folded in a small picture.
            ui.horizontal(|ui| {
                presets(ui, &PRESETS, commands);
                ruler(ui, state, commands);
            });
            ui.horizontal(|ui| {
                stations(ui, state, commands);
                heights(ui, state, commands);
                colouring(ui, state, false, commands);
            });
        }
    });
    let taken = response.response.rect;
    if (taken.size() - *size).length() > 0.5 {
        *size = taken.size();
        ui.ctx().request_discard("the scene's controls have another width");
    }
    taken
}

type Preset = (&'static str, ViewPreset, &'static str);

/// Name, preset, hint.
const PRESETS: [Preset; 5] = [
    ("Fit", ViewPreset::Fit, "Show all that is not hidden (F, or double-click)"),
    ("3D", ViewPreset::Slanted, "Oblique view from above, in perspective (D)"),
    ("Top", ViewPreset::Top, "Look down, x to the right, all lengths true (T)"),
    ("Front", ViewPreset::Front, "Look along y, x to the right, all lengths true (R)"),
    ("Side", ViewPreset::Side, "Look against x, y to the right, all lengths true (S)"),
];

fn presets(ui: &mut egui::Ui, some: &[Preset], commands: &mut Commands) {
    for (name, preset, hint) in some {
        if ui.button(*name).on_hover_text(*hint).clicked() {
            commands.push(SceneCommand::Look(*preset).into());
        }
    }
}

/// Returns true if the active deployment has readings, which have stations and colours; a trajectory has none.
fn has_readings(state: &State) -> bool {
    state.active().is_none_or(|open| open.deployment.ground_truth.is_none())
}

fn stations(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if !has_readings(state) {
        return;
    }
    let dark = ui.visuals().dark_mode;
    for station in 0..state.stations() {
        let name = format!("From station {}", station + 1);
        let text = RichText::new(format!("S{}", station + 1))
            .color(theme::readable(palette::station(station), dark));
        let button = ui.button(text);
        button.widget_info(|| WidgetInfo::labeled(Role::Button, true, &name));
        if button.on_hover_text(format!("{name}, towards the prisms at the cursor")).clicked() {
            commands.push(SceneCommand::Look(ViewPreset::Station(station)).into());
        }
    }
}

fn ruler(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let hint = "Click two points to measure between them: readings, tracks, stations, control points, prisms at the \
                cursor. Esc clears";
    let active = state.scene.ruler.active;
    let button = ui.add(egui::Button::selectable(active, "Ruler").frame_when_inactive(true));
    if button.on_hover_text(hint).clicked() {
        commands.push(SceneCommand::Measure(Ruler { active: !active, ends: Vec::new() }).into());
    }
}

fn colouring(ui: &mut egui::Ui, state: &State, labelled: bool, commands: &mut Commands) {
    if !has_readings(state) {
        return;
    }
    if labelled {
        ui.label(RichText::new("Colour by").small());
    }
    let mut chosen = state.scene.colouring;
    let combo = egui::ComboBox::from_id_salt("colour by")
        .width(84.0)
        .selected_text(chosen.title())
        .show_ui(ui, |ui| {
            for colouring in Colouring::ALL {
                ui.selectable_value(&mut chosen, colouring, colouring.title())
                    .on_hover_text(colouring.hint());
            }
        });
    combo.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Colour by"));
    combo.response.on_hover_text(format!("Colour by: {}", chosen.hint()));
    if chosen != state.scene.colouring {
        commands.push(SceneCommand::Colour(chosen).into());
    }
}

fn heights(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut scale = state.scene.options.height_scale;
    let combo = egui::ComboBox::from_id_salt("heights")
        .width(44.0)
        .selected_text(format!("z ×{scale}"))
        .show_ui(ui, |ui| {
            for choice in SceneOptions::HEIGHT_SCALES {
                ui.selectable_value(&mut scale, choice, format!("z ×{choice}"));
            }
        });
    combo.response.widget_info(|| WidgetInfo::labeled(Role::ComboBox, true, "Heights drawn"));
    combo.response.on_hover_text("Vertical exaggeration of the drawing");
    if scale != state.scene.options.height_scale {
        commands.push(
            SceneCommand::SetOptions(SceneOptions { height_scale: scale, ..state.scene.options })
                .into(),
        );
    }
}
