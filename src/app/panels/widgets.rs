//! Widgets that several panes share.

use std::ops::RangeInclusive;

use crate::app::actions::remedies;
use crate::app::model::units::unbroken;
use crate::app::model::{Commands, ResultsCommand};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::deployment::Finding;

/// Shortest wait that is reported.
pub const SHORTEST_WAIT: std::time::Duration = std::time::Duration::from_millis(250);

/// Space around a pane's content (points).
pub const MARGIN: f32 = 8.0;

/// Shows a pane's content with a margin, scrolling if it does not fit.
pub fn scrolled(ui: &mut egui::Ui, add: impl FnOnce(&mut egui::Ui)) {
    theme::keep_handle(ui);
    egui::ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        egui::Frame::new().inner_margin(MARGIN).show(ui, |ui| {
            ui.set_width(ui.available_width());
            add(ui);
        });
    });
}

/// Shows a finding with its sign and wrapped text, and below it buttons that follow its advice.
pub fn finding(ui: &mut egui::Ui, state: &State, finding: &Finding, commands: &mut Commands) {
    let (colour, sign) = theme::severity(finding.severity, ui.visuals().dark_mode);
    ui.horizontal_top(|ui| {
        // Signs differ in width; a fixed width aligns the texts.
        let width = 14.0;
        let (place, _) = ui.allocate_exact_size(egui::vec2(width, 16.0), egui::Sense::hover());
        let font = egui::TextStyle::Body.resolve(ui.style());
        ui.painter().text(place.center(), egui::Align2::CENTER_CENTER, sign, font, colour);
        ui.vertical(|ui| {
            let message = state.workspace.units.message(finding);
            let label = ui.add(egui::Label::new(unbroken(&message)).wrap());
            words::explain_text(label, &message);
            remedies_of(ui, state, finding, commands);
        });
    });
}

/// Shows buttons that follow the advice of a finding.
pub fn remedies_of(ui: &mut egui::Ui, state: &State, finding: &Finding, commands: &mut Commands) {
    if !finding.remedies.is_empty() {
        ui.horizontal_wrapped(|ui| {
            for remedy in &finding.remedies {
                advised(ui, remedies::offer(remedy, state), commands);
            }
        });
    }
}

/// Adds a button that follows an advice, or shows the reason why it is disabled.
fn advised(ui: &mut egui::Ui, offer: remedies::Offer, commands: &mut Commands) {
    let remedies::Offer { name, command } = offer;
    let button = ui.add_enabled(command.is_ok(), egui::Button::new(name).small());
    match command {
        Ok(command) if button.clicked() => commands.push(command),
        Ok(_) => {}
        Err(why) => {
            button.on_disabled_hover_text(why);
        }
    }
}

/// Adds a button that gives the active deployment the settings of a pinned result.
pub fn use_pinned(ui: &mut egui::Ui, state: &State, id: u64, commands: &mut Commands) {
    let Some(settings) = state.settings_of_pin(id) else { return };
    let possible = settings != *state.settings();
    let button = ui
        .add_enabled(possible, egui::Button::new("Use these settings").small())
        .on_hover_text("Calibrate with the settings of the pinned result; Undo reverts it")
        .on_disabled_hover_text("These settings are in use already");
    let pin = state.results.pins.iter().find(|pin| pin.id == id);
    let name = format!("Use the settings of {}", pin.map_or("", |pin| pin.name.as_str()));
    button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, possible, &name));
    if button.clicked() {
        commands.push(ResultsCommand::UsePinned(id).into());
    }
}

/// Heading of a column of numbers, right-aligned at this width (figures).
pub fn number_head(ui: &mut egui::Ui, text: &str, width: usize) -> egui::Response {
    right_aligned(ui, egui::RichText::new(text).strong(), width)
}

/// Shows the buttons for one fewer and one more of some things; returns the number that is chosen.
pub fn fewer_or_more(
    ui: &mut egui::Ui,
    what: &str,
    count: usize,
    range: RangeInclusive<usize>,
) -> Option<usize> {
    let button = |ui: &mut egui::Ui, text: String, enabled: bool| {
        ui.add_enabled(enabled, egui::Button::new(text)).clicked()
    };
    let buttons = ui.horizontal(|ui| {
        let fewer = button(ui, format!("− {what}"), count > *range.start());
        let more = button(ui, format!("+ {what}"), count < *range.end());
        (fewer, more)
    });
    match buttons.inner {
        (true, _) => Some(count - 1),
        (_, true) => Some(count + 1),
        _ => None,
    }
}

/// A number of a column, right-aligned at this width (figures).
pub fn number_cell(
    ui: &mut egui::Ui,
    text: impl Into<egui::RichText>,
    width: usize,
) -> egui::Response {
    right_aligned(ui, text.into().text_style(egui::TextStyle::Monospace), width)
}

/// A text that ends where the numbers of its column end.
pub fn right_aligned(ui: &mut egui::Ui, text: egui::RichText, width: usize) -> egui::Response {
    let font = egui::TextStyle::Monospace.resolve(ui.style());
    let figure = ui.fonts_mut(|fonts| fonts.glyph_width(&font, '0'));
    let size = egui::vec2(width as f32 * figure, ui.text_style_height(&egui::TextStyle::Monospace));
    let (rect, _) = ui.allocate_exact_size(size, egui::Sense::hover());
    let layout = egui::Layout::right_to_left(egui::Align::Center);
    let builder = egui::UiBuilder::new().max_rect(rect).layout(layout);
    ui.new_child(builder).add(egui::Label::new(text).extend())
}

/// Shows a heading inside a pane.
pub fn heading(ui: &mut egui::Ui, text: &str) {
    ui.add_space(4.0);
    words::explain_text(ui.strong(text), text);
}
