//! The path dialog inside the window, for systems without a dialog of their own.

use egui::{Key, Modifiers, RichText};

use crate::app::file_dialog::{Entry, PathPrompt, PromptCommand, Wanted};
use crate::app::model::{Commands, DialogCommand};
use crate::app::theme;

const WIDTH: f32 = 620.0;
const LIST_HEIGHT: f32 = 300.0;
const MOST_PLACES: usize = 6;

pub fn ui(ctx: &egui::Context, prompt: &PathPrompt, commands: &mut Commands) {
    let mut asked = Vec::new();
    let modal = egui::Modal::new(egui::Id::unique("path prompt"))
        .frame(egui::Frame::popup(&ctx.global_style()).inner_margin(12.0));
    let response = modal.show(ctx, |ui| {
        ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 40.0));
        ui.heading(&prompt.question.title);
        ui.add_space(4.0);
        match (&prompt.overwrite, &prompt.new_folder) {
            (Some(path), _) => overwrite(ui, &path.display().to_string(), &mut asked),
            (None, Some(name)) => new_folder(ui, prompt, name, &mut asked),
            (None, None) => {
                let Keys { moved, enter } = keys(ui, prompt, &mut asked);
                places(ui, prompt, &mut asked);
                field(ui, prompt, &mut asked);
                if enter {
                    // After the text typed in the same frame: a slow frame may contain a whole path.
                    asked.push(PromptCommand::Accept);
                }
                ui.add_space(4.0);
                list(ui, prompt, moved, &mut asked);
                ui.add_space(6.0);
                buttons(ui, prompt, &mut asked);
            }
        }
    });
    if asked.is_empty() && response.should_close() {
        asked.push(match (&prompt.overwrite, &prompt.new_folder) {
            (Some(_), _) => PromptCommand::KeepFile,
            (None, Some(_)) => PromptCommand::MakeNoFolder,
            (None, None) => PromptCommand::Cancel,
        });
    }
    commands.extend(asked.into_iter().map(|input| DialogCommand::Prompt(input).into()));
}

struct Keys {
    /// True if the keys moved the selection.
    moved: bool,
    enter: bool,
}

/// Reads the keys before the text field receives them.
fn keys(ui: &mut egui::Ui, prompt: &PathPrompt, asked: &mut Vec<PromptCommand>) -> Keys {
    let typing = ui.ctx().text_edit_focused() || ui.memory(|memory| memory.focused().is_none());
    let lines = prompt.shown().len();
    let (up_a_folder, down, up, enter) = ui.input_mut(|input| {
        (
            input.consume_key(Modifiers::ALT, Key::ArrowUp)
                || (!typing && input.consume_key(Modifiers::NONE, Key::Backspace)),
            input.consume_key(Modifiers::NONE, Key::ArrowDown),
            input.consume_key(Modifiers::NONE, Key::ArrowUp),
            // On a button, Enter presses it.
            typing && input.consume_key(Modifiers::NONE, Key::Enter),
        )
    });
    if up_a_folder {
        asked.push(PromptCommand::GoUp);
    }
    if (down || up) && lines > 0 {
        let line = match prompt.chosen {
            None if down => 0,
            None => lines - 1,
            Some(line) if down => (line + 1).min(lines - 1),
            Some(line) => line.saturating_sub(1),
        };
        asked.push(PromptCommand::Choose(Some(line)));
    }
    Keys { moved: down || up, enter }
}

fn places(ui: &mut egui::Ui, prompt: &PathPrompt, asked: &mut Vec<PromptCommand>) {
    ui.horizontal_wrapped(|ui| {
        let up = egui::Button::new("⬆ Up").shortcut_text(RichText::new("Alt+↑").weak());
        if ui.add_enabled(prompt.folder().parent().is_some(), up).clicked() {
            asked.push(PromptCommand::GoUp);
        }
        for (name, path) in prompt.places.iter().take(MOST_PLACES) {
            if ui.button(name).on_hover_text(path.display().to_string()).clicked() {
                asked.push(PromptCommand::GoTo(path.clone()));
            }
        }
    });
}

fn field(ui: &mut egui::Ui, prompt: &PathPrompt, asked: &mut Vec<PromptCommand>) {
    let mut text = prompt.text.clone();
    let id = ui.make_persistent_id("path");
    let field = egui::TextEdit::singleline(&mut text)
        .id(id)
        .hint_text("A path; typing filters the list")
        .desired_width(f32::INFINITY);
    let response = ui.add(field).accessible_name("Path");
    if ui.memory(|memory| memory.focused().is_none()) {
        response.request_focus();
    }
    if response.changed() {
        asked.push(PromptCommand::Type(text));
    } else if cursor_is_elsewhere(ui, id, &text) {
        // The folder changed other than by typing: place the cursor behind it, or select the proposed file name.
        let [from, to] = match &prompt.question.wanted {
            Wanted::NewFile { extension, .. } => {
                let name = prompt.typed_name();
                let stem = name.strip_suffix(extension).and_then(|it| it.strip_suffix('.'));
                let behind = name.chars().count() - stem.unwrap_or(name).chars().count();
                [name.chars().count(), behind]
            }
            _ => [0, 0],
        }
        .map(|before_end| egui::text::CCursor::new(text.chars().count() - before_end));
        if let Some(mut state) = egui::TextEdit::load_state(ui.ctx(), id) {
            state.cursor.set_char_range(Some(egui::text::CCursorRange::two(from, to)));
            state.store(ui.ctx(), id);
        }
    }
}

/// Returns true if the text differs from the field's text in the last frame.
fn cursor_is_elsewhere(ui: &egui::Ui, id: egui::Id, text: &str) -> bool {
    ui.data_mut(|data| {
        let last: &mut String = data.get_temp_mut_or_default(id);
        let other = last != text;
        if other {
            text.clone_into(last);
        }
        other
    })
}

fn list(ui: &mut egui::Ui, prompt: &PathPrompt, moved: bool, asked: &mut Vec<PromptCommand>) {
    let shown = prompt.shown();
    let height = ui.spacing().interact_size.y;
    let frame = egui::Frame::new().fill(ui.visuals().extreme_bg_color).inner_margin(4.0);
    frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let list_height = LIST_HEIGHT.min(ui.ctx().content_rect().height() - 240.0).max(80.0);
        ui.set_min_height(list_height);
        if let Some(said) = nothing_to_show(prompt, &shown) {
            let colour = theme::faint(ui.visuals().dark_mode);
            ui.label(RichText::new(said).color(colour));
            return;
        }
        theme::keep_handle(ui);
        let scroll = egui::ScrollArea::vertical().max_height(list_height).auto_shrink(false);
        scroll.show_rows(ui, height, shown.len(), |ui, rows| {
            let step = height + ui.spacing().item_spacing.y;
            if let (true, Some(line)) = (moved, prompt.chosen) {
                // The line may be outside the visible region, and then is not drawn.
                let top = ui.max_rect().top() + (line as f32 - rows.start as f32) * step;
                let size = egui::vec2(ui.available_width(), 2.0 * step);
                let at = egui::pos2(ui.max_rect().left(), top - 0.5 * step);
                ui.scroll_to_rect(egui::Rect::from_min_size(at, size), None);
            }
            for (line, entry) in shown.iter().enumerate().take(rows.end).skip(rows.start) {
                row(ui, entry, line, prompt.chosen == Some(line), height, asked);
            }
        });
    });
}

fn nothing_to_show(prompt: &PathPrompt, shown: &[&Entry]) -> Option<String> {
    if prompt.is_reading() {
        return Some("Reading the folder…".to_owned());
    }
    if prompt.trouble().is_some() && prompt.complaint.is_none() {
        return prompt.trouble().map(str::to_owned);
    }
    let wants_folder = matches!(prompt.question.wanted, Wanted::Folder);
    let why = match (prompt.typed_name().is_empty(), wants_folder) {
        (true, true) => "No folder here.",
        (true, false) => "This folder is empty.",
        (false, true) => "No matching folder.",
        (false, false) => "No matching file or folder.",
    };
    shown.is_empty().then(|| why.to_owned())
}

fn row(
    ui: &mut egui::Ui,
    entry: &Entry,
    line: usize,
    chosen: bool,
    height: f32,
    asked: &mut Vec<PromptCommand>,
) {
    let name = if entry.is_folder {
        RichText::new(format!("{}/", entry.name)).strong()
    } else if entry.what.is_empty() {
        RichText::new(&entry.name).color(theme::faint(ui.visuals().dark_mode))
    } else {
        RichText::new(&entry.name)
    };
    let mut button = egui::Button::selectable(chosen, name)
        .min_size(egui::vec2(ui.available_width(), height))
        .truncate();
    if !entry.what.is_empty() {
        button = button.right_text(RichText::new(entry.what).weak());
    }
    let response = ui.add(button);
    let enter = response.has_focus() && ui.input(|input| input.key_pressed(Key::Enter));
    if response.double_clicked() || enter {
        asked.extend([PromptCommand::Choose(Some(line)), PromptCommand::Accept]);
    } else if response.clicked() {
        asked.push(PromptCommand::Choose(Some(line)));
    }
}

fn complaint(ui: &mut egui::Ui, prompt: &PathPrompt) {
    if let Some(complaint) = &prompt.complaint {
        let (colour, sign) =
            theme::severity(resect_core::deployment::Severity::Problem, ui.visuals().dark_mode);
        ui.label(RichText::new(format!("{sign} {complaint}")).color(colour));
    }
}

fn buttons(ui: &mut egui::Ui, prompt: &PathPrompt, asked: &mut Vec<PromptCommand>) {
    complaint(ui, prompt);
    ui.horizontal(|ui| {
        if ui.button("Cancel").clicked() {
            asked.push(PromptCommand::Cancel);
        }
        if prompt.saves() && ui.button("New folder…").clicked() {
            asked.push(PromptCommand::NameFolder(String::new()));
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let (accept, folder) = match prompt.question.wanted {
                Wanted::ToOpen { .. } => ("Open", Some("Open this folder")),
                Wanted::Saved => ("Open", None),
                Wanted::Folder => ("Go in", Some("Choose this folder")),
                Wanted::NewFile { .. } => ("Save", None),
            };
            let named = prompt.chosen.is_some() || !prompt.typed_name().is_empty();
            let possible = named || matches!(prompt.question.wanted, Wanted::NewFile { .. });
            if ui.add_enabled(possible, egui::Button::new(accept)).clicked() {
                asked.push(PromptCommand::Accept);
            }
            if let Some(name) = folder
                && ui.button(name).on_hover_text(prompt.folder().display().to_string()).clicked()
            {
                asked.push(PromptCommand::AcceptFolder);
            }
        });
    });
}

/// Asks for the name of a new folder.
fn new_folder(ui: &mut egui::Ui, prompt: &PathPrompt, name: &str, asked: &mut Vec<PromptCommand>) {
    ui.label(format!("A new folder in {}", prompt.folder().display()));
    let mut name = name.to_owned();
    let enter = ui.input_mut(|input| input.consume_key(Modifiers::NONE, Key::Enter));
    let field = egui::TextEdit::singleline(&mut name).desired_width(f32::INFINITY);
    let field = ui.add(field).accessible_name("Name of the folder");
    if ui.memory(|memory| memory.focused().is_none()) {
        field.request_focus();
    }
    if field.changed() {
        asked.push(PromptCommand::NameFolder(name));
    }
    complaint(ui, prompt);
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        if ui.button("Back").clicked() {
            asked.push(PromptCommand::MakeNoFolder);
        } else if ui.button("Create the folder").clicked() || enter {
            asked.push(PromptCommand::MakeFolder);
        }
    });
}

fn overwrite(ui: &mut egui::Ui, path: &str, asked: &mut Vec<PromptCommand>) {
    ui.label(format!("{path} exists. Replace it?"));
    ui.add_space(6.0);
    ui.horizontal(|ui| {
        let keep = ui.button("Keep it");
        if ui.memory(|memory| memory.focused().is_none()) {
            keep.request_focus();
        }
        if keep.clicked() {
            asked.push(PromptCommand::KeepFile);
        }
        if ui.button("Replace").clicked() {
            asked.push(PromptCommand::Replace);
        }
    });
}
