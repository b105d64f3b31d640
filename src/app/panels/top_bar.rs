//! The bar at the top: menus, the deployment's name, progress, units and theme.

use egui::containers::menu::{MenuButton, MenuConfig};
use egui::{Label, RichText};

use crate::app::actions;
use crate::app::actions::{Action, Menu};
use crate::app::model::Commands;
use crate::app::state::State;
use crate::app::words;

/// Height that a menu leaves free in the window: the bar above it, and its own frame (points).
const BELOW_A_MENU: f32 = 60.0;
/// Width from which the bar has the program's name, and free width from which it has the time of the calculation (points).
const WIDE: f32 = 500.0;
const ELAPSED: f32 = 160.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    egui::Panel::top("top bar").show(ui, |ui| {
        egui::MenuBar::new().ui(ui, |ui| {
            if ui.available_width() > WIDE {
                ui.strong("resect");
                ui.separator();
            }
            for menu in Menu::ALL {
                // Entries close the menu themselves; switches in it leave it open.
                let config =
                    MenuConfig::new().close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
                MenuButton::new(menu.title()).config(config).ui(ui, |ui| {
                    let actions = actions::all(state);
                    let entries = actions.iter().filter(|action| action.menu == menu);
                    // A menu higher than the window scrolls.
                    let height = ui.ctx().content_rect().height() - BELOW_A_MENU;
                    egui::ScrollArea::vertical()
                        .max_height(height)
                        // Without this, a menu gets no more room than in the last frame.
                        .min_scrolled_height(height)
                        .show(ui, |ui| show_menu(ui, entries, commands));
                });
            }
            ui.separator();
            // The names have the rest of the bar, and are shortened to it.
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if state.is_busy() {
                    ui.add(egui::Spinner::new().size(14.0));
                }
                super::progress::ui(ui, state, commands);
                if let Some(elapsed_ms) = state.elapsed_ms()
                    && ui.available_width() > ELAPSED
                {
                    ui.label(format!("{elapsed_ms:.1} ms")).on_hover_text(
                        "Time from the settings to the new residuals, in the background",
                    );
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    names(ui, state);
                });
            });
        });
    });
}

/// Shows the names of the active deployment and of the session's file.
fn names(ui: &mut egui::Ui, state: &State) {
    let name = match state.active() {
        Some(open) => RichText::new(state.name_of(open.id).unwrap_or_default()),
        None => RichText::new("nothing open: choose File, or drop a folder or bag here").weak(),
    };
    ui.add(Label::new(name).truncate());
    if let Some(path) = &state.session.path {
        let file = path.file_name().unwrap_or_default().to_string_lossy();
        ui.add(Label::new(RichText::new(file).weak()).truncate())
            .on_hover_text(format!("The session's file: {}", path.display()));
    }
}

/// Shows the entries of a menu, with a heading for each section; a long section is a submenu.
fn show_menu<'a>(
    ui: &mut egui::Ui,
    entries: impl Iterator<Item = &'a Action>,
    commands: &mut Commands,
) {
    let entries: Vec<&Action> = entries.collect();
    let mut in_rows = false;
    for (index, section) in entries.chunk_by(|a, b| a.section == b.section).enumerate() {
        if section[0].in_a_row {
            // Rows are grouped under one separator.
            if !std::mem::replace(&mut in_rows, true) {
                ui.separator();
            }
            row(ui, section, commands);
            continue;
        }
        if section.len() > MOST_IN_A_SECTION {
            ui.menu_button(section[0].section, |ui| {
                section.iter().for_each(|action| entry(ui, action, commands));
            });
            continue;
        }
        if index > 0 {
            ui.separator();
        }
        section.iter().for_each(|action| entry(ui, action, commands));
    }
}

const MOST_IN_A_SECTION: usize = 8;

fn entry(ui: &mut egui::Ui, action: &Action, commands: &mut Commands) {
    let mut button = egui::Button::selectable(action.on == Some(true), action.name.as_str());
    if let Some(keys) = &action.shortcut {
        button = button.shortcut_text(actions::keys_in_words(ui.ctx(), keys));
    }
    let response = ui.add_enabled(action.command.is_some(), button);
    let response = words::on_hover_beside(response, action.hint);
    if response.clicked() {
        commands.extend(action.command.clone());
        ui.close();
    }
}

/// Shows a section of mutually exclusive actions as a row.
fn row(ui: &mut egui::Ui, section: &[&Action], commands: &mut Commands) {
    ui.horizontal(|ui| {
        ui.label(section[0].section);
        for action in section {
            let word = action.name.rsplit(' ').next().unwrap_or_default();
            let possible = action.command.is_some();
            let radio =
                ui.add_enabled(possible, egui::RadioButton::new(action.on == Some(true), word));
            let name = &action.name;
            let radio = if action.hint.is_empty() {
                radio
            } else {
                radio.on_hover_text(action.hint).on_disabled_hover_text(action.hint)
            };
            radio.widget_info(|| {
                egui::WidgetInfo::selected(
                    egui::Role::RadioButton,
                    possible,
                    action.on == Some(true),
                    name,
                )
            });
            if radio.clicked() {
                commands.extend(action.command.clone());
            }
        }
    });
}
