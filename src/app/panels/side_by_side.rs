//! Comparison of the results of all open deployments and of the pinned ones: one column each, with differences from the active one.

mod columns;

use egui::RichText;

use self::columns::{Cell, Column, Whose, columns};
use super::result::{NOTABLE_SIGMAS, badge};
use super::validation;
use crate::app::model::{Commands, DeploymentCommand};
use crate::app::plots::in_the_middle;
use crate::app::short;
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::analysis::Settings;
use resect_core::deployment::Severity;
use resect_report::summary::ResultSummary;

/// Widths of names, numbers and differences (points). A narrower pane shows differences below their numbers.
const NAMES: f32 = 110.0;
const NUMBER: f32 = 185.0;
const DIFFERENCE: f32 = 140.0;
/// Longest text below a row's name (points); the rest is omitted.
const LONGEST_NAME: f32 = 150.0;
/// Text size in a narrow table (points).
const NARROW_TEXT: f32 = 11.0;
/// Greatest number of σ shown; larger values carry no information.
const MOST_SIGMAS: f64 = 999.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.deployments.open.is_empty() {
        in_the_middle(ui, "Nothing open.");
        return;
    }
    let width = ui.available_width() - 24.0;
    // A visible scroll bar shows that there are more columns.
    let thin = egui::style::ScrollStyle::thin();
    ui.spacing_mut().scroll = egui::style::ScrollStyle { handle_min_length: 0.0, ..thin };
    egui::ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(8.0).show(ui, |ui| {
            // Its answer would be below the table's end.
            validation::ui(ui, state, width, commands);
            let (columns, reference) = columns(state);
            let others = columns.len().saturating_sub(1) as f32;
            let wanted = NAMES + NUMBER * (others + 1.0) + DIFFERENCE * others;
            // The remaining width is shared by the result columns, for the deployments' names.
            let spare = ((width - wanted) / (others + 1.0)).max(0.0);
            let table =
                ComparisonTable { columns, reference, beside: width > wanted, column: NUMBER + spare };
            egui::Grid::new(("side by side", table.beside))
                .num_columns(2 * table.columns.len())
                .spacing([if table.beside { 12.0 } else { 6.0 }, 4.0])
                .striped(true)
                .show(ui, |ui| table.rows(ui, state, commands));
            ui.set_max_width(width);
            if table.columns.len() > 1 {
                let against = &table.columns[table.reference].title;
                ui.small(format!(
                    "± one standard deviation, where it is estimated. Differences are from {against}, in σ if both σ are known: σ of the column \
                     for the same readings, otherwise σ of both combined."
                ));
                if columns::any_elsewhere(&table.columns, table.reference) {
                    ui.small("Differences of stations that were set up elsewhere have no σ.");
                }
            } else {
                ui.small("± one standard deviation, where it is estimated. Pinned results and other open deployments appear beside it.");
            }
            give_all(ui, state, commands);
        });
    });
}

struct ComparisonTable<'a> {
    columns: Vec<Column<'a>>,
    reference: usize,
    /// True if differences have columns of their own.
    beside: bool,
    /// Width of a column (points).
    column: f32,
}

impl ComparisonTable<'_> {
    fn rows(&self, ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
        self.titles(ui, state, commands);
        if !state.results.pins.is_empty() {
            self.of_results(ui, "data", |ui, summary| {
                let name = &summary.deployment;
                let font = egui::TextStyle::Body.resolve(ui.style());
                let shown = short::in_the_middle(ui, name, &font, self.column);
                short::whole_on_hover(ui.label(&shown), &shown, name);
            });
        }
        self.of_results(ui, "verdict", |ui, summary| {
            // One cell of the grid.
            ui.horizontal(|ui| {
                badge(ui, summary.verdict, 10.0);
                if !summary.verdict.caveat(summary.independently_checked).is_empty() {
                    ui.small("unchecked").on_hover_text(summary.verdict_in_words());
                }
            });
        });
        self.of_results(ui, "method", |ui, summary| {
            let method = summary.answered_by();
            ui.label(method.short_name()).on_hover_text(method.title());
        });
        let transforms = columns::transforms(&self.columns, self.reference, state.workspace.units);
        for (index, number) in (2..=columns::stations(&self.columns)).enumerate() {
            for (axis, name) in ["x", "y", "z", "yaw"].into_iter().enumerate() {
                let cell = |column: usize| &transforms[column][4 * index + axis];
                self.numbers(ui, &format!("{name} of T1{number}"), cell);
            }
        }
        for row in columns::estimates(&self.columns, self.reference, state.workspace.units) {
            self.numbers_of(ui, [&row.name, &row.subject], |column| &row.cells[column]);
        }
        // In a narrow table, the wide heading would push the last units out of the pane.
        let heading = RichText::new("median / IQR (mm)").strong();
        let heading = if self.beside { heading } else { heading.small() };
        ui.label(heading)
            .on_hover_text("The two metrics: errors of distances and of control points");
        ui.end_row();
        let inter_prism = columns::inter_prism(&self.columns, self.reference);
        self.numbers(ui, "inter-prism", |column| &inter_prism[column]);
        for row in columns::control_points(&self.columns, self.reference) {
            let whose = row.whose.map_or(String::new(), |title| format!("of {title}"));
            self.numbers_of(ui, [&row.file, &whose], |column| &row.cells[column]);
        }
        self.of_results(ui, "triplets", |ui, summary| {
            ui.monospace(summary.triplets.to_string());
        });
        self.row(ui, "settings", |ui, column| settings(ui, state, column, commands));
    }

    /// Draws the title of each column, and the reference of its differences.
    fn titles(&self, ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
        let against = &self.columns[self.reference].title;
        ui.label("");
        for (index, column) in self.columns.iter().enumerate() {
            ui.scope(|ui| {
                ui.set_max_width(self.column);
                title(ui, state, column, commands);
            });
            if self.beside && index != self.reference {
                let hint = format!("{} minus {against}", column.title);
                ui.weak("difference").on_hover_text(hint);
            }
        }
        ui.end_row();
    }

    /// Draws a row with one cell per column, leaving the columns of differences empty.
    fn row(&self, ui: &mut egui::Ui, name: &str, mut cell: impl FnMut(&mut egui::Ui, &Column<'_>)) {
        words::explain_text(ui.label(name), name);
        for (index, column) in self.columns.iter().enumerate() {
            ui.scope(|ui| {
                ui.set_max_width(self.column);
                cell(ui, column);
            });
            if self.beside && index != self.reference {
                ui.label("");
            }
        }
        ui.end_row();
    }

    /// Draws a row of cells from results; a missing result has a dash, and the reason on hover.
    fn of_results(
        &self,
        ui: &mut egui::Ui,
        name: &str,
        cell: impl Fn(&mut egui::Ui, &ResultSummary),
    ) {
        self.row(ui, name, |ui, column| match &column.result {
            Some(Ok(summary)) => cell(ui, summary),
            Some(Err(why)) => {
                let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
                ui.label(RichText::new(sign).color(colour)).on_hover_text(why);
            }
            None => {
                ui.weak("–");
            }
        });
    }

    fn numbers<'c>(&self, ui: &mut egui::Ui, name: &str, cell: impl Fn(usize) -> &'c Cell) {
        self.numbers_of(ui, [name, ""], cell);
    }

    /// Draws a row of numbers with their differences beside or below them; `whose`, below the name, distinguishes rows of the same name.
    fn numbers_of<'c>(
        &self,
        ui: &mut egui::Ui,
        [name, whose]: [&str; 2],
        cell: impl Fn(usize) -> &'c Cell,
    ) {
        if self.beside && whose.is_empty() {
            words::explain_text(ui.label(name), name);
        } else {
            ui.vertical(|ui| {
                ui.spacing_mut().item_spacing.y = 0.0;
                words::explain_text(ui.label(name), name);
                // If differences are below their numbers, this line is as high as theirs, so that they line up.
                let font = egui::TextStyle::Small.resolve(ui.style());
                let shown = short::in_the_middle(ui, whose, &font, LONGEST_NAME);
                short::whole_on_hover(ui.small(&shown), &shown, whose);
            });
        }
        for index in 0..self.columns.len() {
            let cell = cell(index);
            if self.beside {
                ui.monospace(&cell.text);
                if index != self.reference {
                    difference(ui, cell);
                }
            } else {
                ui.vertical(|ui| {
                    ui.spacing_mut().item_spacing.y = 0.0;
                    let text = RichText::new(&cell.text).monospace().size(NARROW_TEXT);
                    ui.add(egui::Label::new(text).extend());
                    difference(ui, cell);
                });
            }
        }
        ui.end_row();
    }
}

fn difference(ui: &mut egui::Ui, cell: &Cell) {
    let Some(difference) = &cell.difference else {
        ui.label("");
        return;
    };
    let text = match difference.sigmas {
        Some(sigmas) if sigmas > MOST_SIGMAS => format!("{} (> {MOST_SIGMAS} σ)", difference.text),
        Some(sigmas) => format!("{} ({sigmas:.1} σ)", difference.text),
        None => difference.text.clone(),
    };
    let text = RichText::new(text).small();
    let (notable, _) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
    let large = difference.sigmas.is_some_and(|sigmas| sigmas > NOTABLE_SIGMAS);
    let text = if large { text.color(notable).strong() } else { text.weak() };
    ui.add(egui::Label::new(text).extend());
}

fn title(ui: &mut egui::Ui, state: &State, column: &Column<'_>, commands: &mut Commands) {
    let font = egui::TextStyle::Button.resolve(ui.style());
    let room = ui.available_width() - 2.0 * ui.spacing().button_padding.x;
    let shown = short::in_the_middle(ui, &column.title, &font, room);
    let name = RichText::new(&shown).strong();
    match column.whose {
        Whose::Open(id) => {
            let active = state.active().is_some_and(|active| active.id == id);
            let button = ui.add(egui::Button::selectable(active, name).truncate());
            button.widget_info(|| {
                egui::WidgetInfo::selected(egui::Role::Button, true, active, &column.title)
            });
            if short::whole_on_hover(button, &shown, &column.title).clicked() {
                commands.push(DeploymentCommand::Activate(id).into());
            }
        }
        Whose::Pinned(_) => {
            ui.label(name);
        }
    }
}

fn settings(ui: &mut egui::Ui, state: &State, column: &Column<'_>, commands: &mut Commands) {
    let (settings, pin) = match column.whose {
        Whose::Open(id) => (state.deployments.get(id).map(|o| o.settings), None),
        Whose::Pinned(id) => (state.settings_of_pin(id), Some(id)),
    };
    let Some(settings) = settings else { return };
    let changes = state.workspace.units.changes(&Settings::default(), &settings);
    let (name, hint) = match changes.as_str() {
        "" => ("the defaults", "Nothing is changed"),
        changes => ("changed", changes),
    };
    ui.horizontal(|ui| {
        ui.label(name).on_hover_text(hint);
        if let Some(id) = pin {
            super::use_pinned(ui, state, id, commands);
        }
    });
}

fn give_all(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.deployments.open.len() < 2 {
        return;
    }
    let differ = state.deployments.open.iter().any(|open| open.settings != *state.settings());
    let button = egui::Button::new("Copy these settings to all runs");
    let response = ui
        .add_enabled(differ, button)
        .on_disabled_hover_text("They have the same settings already");
    if response.clicked() {
        commands.push(DeploymentCommand::SetAll.into());
    }
}
