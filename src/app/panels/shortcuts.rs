//! The list of keyboard shortcuts, from the same table as the menus, and of mouse actions.

use egui::RichText;

use crate::app::actions;
use crate::app::actions::Menu;
use crate::app::model::{Commands, DialogCommand};
use crate::app::state::State;

/// Mouse actions by pane.
const MOUSE: [(&str, &[(&str, &str)]); 2] = [
    (
        "Scene",
        &[
            ("drag", "turn"),
            ("right drag, Shift+drag", "move; stops following the rig"),
            ("wheel", "zoom to the pointer"),
            ("click", "pick a reading, or move the time cursor"),
            ("double-click", "go to a point; on empty space, fit all"),
            ("click in the legend", "hide or show this item"),
            ("arrows, + −", "turn and zoom, when the scene has the focus"),
        ],
    ),
    (
        "Plots over time",
        &[
            ("click", "move the time cursor, or pick a reading"),
            ("drag", "select a span of time"),
            ("wheel", "zoom in time, in all plots"),
            ("right drag, Shift+wheel", "move through time"),
            ("double-click", "show all times"),
            ("drag a τ line", "set the threshold"),
            ("right click on a τ", "the paper's value"),
            ("+ −, Page Up, Page Down", "zoom and move, when a plot has the focus"),
            ("wheel in a histogram", "zoom in mm; double-click: all"),
        ],
    ),
];

const WIDTH: f32 = 1020.0;
/// Size of the letters (points).
const SIZE: f32 = 12.0;

pub fn ui(ctx: &egui::Context, state: &State, commands: &mut Commands) {
    let modal = egui::Modal::new(egui::Id::unique("shortcuts"));
    let response = modal.show(ctx, |ui| {
        // Uses the wanted width if there is room.
        ui.set_min_width(WIDTH.min(ctx.content_rect().width() - 60.0));
        ui.horizontal(|ui| {
            ui.heading("Keyboard and mouse");
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Close").clicked() {
                    commands.push(DialogCommand::CloseOverlay.into());
                }
            });
        });
        // Scrolls only if the window is lower than the list; without a least height, the first frame would have little room.
        let size = ui.ctx().content_rect().size() - egui::vec2(60.0, 90.0);
        let area = egui::ScrollArea::both().max_width(size.x).max_height(size.y);
        area.min_scrolled_height(size.y).show(ui, |ui| {
            ui.horizontal_top(|ui| {
                let actions = actions::all(state);
                for menus in [
                    &[Menu::File, Menu::Edit, Menu::Export, Menu::Help][..],
                    &[Menu::Time, Menu::View],
                ] {
                    ui.vertical(|ui| {
                        for menu in menus {
                            let keyed = actions.iter().filter(|a| a.menu == *menu);
                            let rows: Vec<(String, &str)> = keyed
                                .filter_map(|action| Some((action.shortcut?, action)))
                                .map(|(keys, action)| {
                                    // The menu names the present object of the action; this list describes the action in general.
                                    let general =
                                        Some(action.in_general).filter(|it| !it.is_empty());
                                    (
                                        actions::keys_in_words(ctx, &keys),
                                        general.unwrap_or(&action.name),
                                    )
                                })
                                .collect();
                            if !rows.is_empty() {
                                table(ui, menu.title(), rows.iter().map(|(k, n)| (k.as_str(), *n)));
                            }
                        }
                    });
                    ui.add_space(16.0);
                }
                ui.vertical(|ui| {
                    for (place, rows) in MOUSE {
                        table(ui, place, rows.iter().copied());
                    }
                });
            });
        });
    });
    if response.should_close() {
        commands.push(DialogCommand::CloseOverlay.into());
    }
}

fn table<'a>(ui: &mut egui::Ui, title: &str, rows: impl Iterator<Item = (&'a str, &'a str)>) {
    ui.add_space(4.0);
    ui.strong(title);
    // Low rows, so that a small window shows the whole list.
    let grid = egui::Grid::new(title).num_columns(2).spacing([14.0, 2.0]).min_row_height(0.0);
    grid.show(ui, |ui| {
        for (keys, what) in rows {
            ui.label(RichText::new(keys).size(SIZE));
            ui.label(RichText::new(what).size(SIZE));
            ui.end_row();
        }
    });
}
