//! The command palette: runs an action that the user types.

use egui::{Event, Key};

use crate::app::actions;
use crate::app::actions::Action;
use crate::app::model::{Command, Commands, DialogCommand, Palette};
use crate::app::state::State;

const WIDTH: f32 = 520.0;
const MOST_LINES_IN_SIGHT: f32 = 14.0;
/// Height of the text field and the edges of the dialog (points).
const AROUND_THE_LIST: f32 = 114.0;

pub fn ui(ctx: &egui::Context, state: &State, palette: &Palette, commands: &mut Commands) {
    let mut edited = palette.clone();
    let all = actions::all(state);
    let modal = egui::Modal::new(egui::Id::unique("command palette"))
        .frame(egui::Frame::popup(&ctx.global_style()).inner_margin(10.0));
    let response = modal.show(ctx, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 40.0));
        // Reads these keys before the text field consumes them.
        let (down, up, enter) = ui.input_mut(|input| {
            let mut pressed = |key| input.consume_key(egui::Modifiers::NONE, key);
            (pressed(Key::ArrowDown), pressed(Key::ArrowUp), pressed(Key::Enter))
        });
        let field = egui::TextEdit::singleline(&mut edited.query)
            .hint_text("Search the commands")
            .desired_width(f32::INFINITY);
        let field = ui.add(field).accessible_name("Command");
        if !field.has_focus() {
            // Text typed in the first frame, before the field has the focus, would be lost.
            let typed = |event: &Event| match event {
                Event::Text(text) => Some(text.clone()),
                _ => None,
            };
            let typed: String = ui.input(|input| input.events.iter().filter_map(typed).collect());
            edited.query += &typed;
            field.request_focus();
        }
        if edited.query != palette.query {
            edited.chosen = 0;
        }
        // Uses the present text, because a slow frame may contain both words and Enter.
        let found = actions::matching(&all, &edited.query);
        let last = found.len().saturating_sub(1);
        edited.chosen = edited.chosen.min(last);
        if down {
            edited.chosen = if edited.chosen == last { 0 } else { edited.chosen + 1 };
        }
        if up {
            edited.chosen = if edited.chosen == 0 { last } else { edited.chosen - 1 };
        }
        ui.add_space(4.0);
        let mut done = enter.then(|| found.get(edited.chosen)).flatten();
        if found.is_empty() {
            ui.weak("No matching command.");
        }
        lines(ui, &found, &mut edited.chosen, up || down, &mut done);
        // Below the list, because a tooltip would cover the next lines.
        let hint = found.get(edited.chosen).map_or("", |action| action.hint);
        ui.add(egui::Label::new(egui::RichText::new(hint).weak()).truncate());
        done.and_then(|action| action.command.clone())
    });
    match response.inner {
        Some(command) => commands.extend([Command::Dialog(DialogCommand::CloseOverlay), command]),
        None if response.should_close() => commands.push(DialogCommand::CloseOverlay.into()),
        None if edited != *palette => commands.push(DialogCommand::EditPalette(edited).into()),
        None => {}
    }
}

/// Shows one line per action; a click runs it.
fn lines<'a>(
    ui: &mut egui::Ui,
    found: &'a [Action],
    chosen: &mut usize,
    moved: bool,
    done: &mut Option<&'a Action>,
) {
    let height = MOST_LINES_IN_SIGHT * (ui.spacing().interact_size.y + ui.spacing().item_spacing.y);
    let height = height.min(ui.ctx().content_rect().height() - AROUND_THE_LIST);
    // The height is constant, because a dialog gets no more room than in the last frame, and would stay small after a short list.
    ui.set_min_height(ui.min_rect().height() + height);
    egui::ScrollArea::vertical().max_height(height).auto_shrink(false).show(ui, |ui| {
        for (index, action) in found.iter().enumerate() {
            let mut text = egui::text::LayoutJob::default();
            let style = ui.style().clone();
            let part = |job: &mut egui::text::LayoutJob, part: &str, weak: bool| {
                let text = egui::RichText::new(part);
                let text = if weak { text.weak() } else { text };
                text.append_to(job, &style, egui::FontSelection::Default, egui::Align::Center);
            };
            part(&mut text, &format!("{}  ", action.menu.title()), true);
            part(&mut text, &action.name, false);
            let mut button = egui::Button::selectable(index == *chosen, text)
                .min_size(egui::vec2(ui.available_width(), 0.0));
            if let Some(keys) = &action.shortcut {
                button = button
                    .right_text(egui::RichText::new(actions::keys_in_words(ui.ctx(), keys)).weak());
            }
            let response = ui.add(button);
            if index == *chosen && moved {
                response.scroll_to_me(None);
            }
            // The pointer chooses as the arrow keys do, so that one line looks selected.
            if response.hovered() && ui.input(|input| input.pointer.is_moving()) {
                *chosen = index;
            }
            if response.clicked() {
                *done = Some(action);
            }
        }
    });
}
