//! The form that starts a live deployment: source, prior knowledge, recording, and target.

use std::path::Path;

use egui::RichText;

use crate::app::model::Commands;
use crate::app::model::live::{LiveCommand, LiveForm};
use crate::app::panels::number;
use crate::app::state::State;
use crate::app::theme;
use resect_core::deployment::Severity;
use resect_io::source::Source;

const FIELD: f32 = 260.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let live = &state.live;
    let mut form = live.form.clone();
    ui.heading("Live");
    ui.label("Calibrates while you drive, and shows when the target is reached.");
    ui.add_space(6.0);
    source(ui, &mut form, commands);
    ui.add_space(6.0);
    beforehand(ui, state, &mut form, commands);
    if form.replay.is_none() {
        ui.horizontal_wrapped(|ui| {
            ui.label("Stations 1, 2, …");
            let field = egui::TextEdit::singleline(&mut form.stations)
                .hint_text("topics or instruments, with commas")
                .desired_width(FIELD);
            let field = ui.add(field).accessible_name("Topics or instruments of stations 1, 2, …");
            field.on_hover_text("Needed only if the messages do not name their station");
        });
    }
    if form.replay.is_none() {
        ui.horizontal_wrapped(|ui| {
            ui.label("Recording (MCAP)");
            let to = form.record.as_deref().map_or("into your documents".to_owned(), name);
            if ui.button(to).on_hover_text("Choose the file of the recording").clicked() {
                commands.push(LiveCommand::ChooseRecord.into());
            }
        });
    }
    ui.horizontal(|ui| {
        ui.label("Target at the far end of the track");
        target(ui, &mut form.target_mm);
    });
    ui.add_space(8.0);
    ui.horizontal(|ui| {
        let name = if form.replay.is_some() { "Replay" } else { "Connect" };
        let button = egui::Button::new(RichText::new(name).size(18.0));
        if ui.add_enabled(!live.is_changing, button).clicked() {
            commands.push(LiveCommand::Connect.into());
        }
        if live.is_changing {
            ui.spinner();
        }
    });
    if let Some(line) = &live.trouble {
        let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
        ui.add(egui::Label::new(RichText::new(format!("{sign} {line}")).color(colour)).wrap());
    }
    if form != live.form {
        // Before the other commands, because connecting uses the values in the form.
        commands.insert(0, LiveCommand::Edit(form).into());
    }
}

/// A field for the target σ, before and during a drive.
pub fn target(ui: &mut egui::Ui, target_mm: &mut f64) -> egui::Response {
    let (name, unit, range) = ("Target at the far end", " mm", 0.1..=100.0);
    let field = number::field(ui, (name, unit), target_mm, range.clone(), |ui, target, parse| {
        let target = egui::DragValue::new(target).range(range).speed(0.05).suffix(unit);
        ui.add(target.custom_parser(parse).custom_formatter(number::shown)).accessible_name(name)
    });
    field.on_hover_text("Largest acceptable σ at the far end of the track")
}

fn source(ui: &mut egui::Ui, form: &mut LiveForm, commands: &mut Commands) {
    ui.horizontal_wrapped(|ui| {
        if ui.radio(form.replay.is_none(), "A stream").clicked() {
            form.replay = None;
        }
        let field = egui::TextEdit::singleline(&mut form.address)
            .hint_text("ws://robot:8765")
            .desired_width(FIELD);
        let field = ui.add_enabled(form.replay.is_none(), field).accessible_name("Address");
        field.on_hover_text(
            "Address of foxglove_bridge, or …/ws/measurements/stream of rts-network",
        );
    });
    ui.horizontal_wrapped(|ui| {
        if ui.radio(form.replay.is_some(), "A replay").clicked() && form.replay.is_none() {
            commands.push(LiveCommand::ChooseReplay.into());
        }
        let Some(path) = &form.replay else {
            ui.weak("of a deployment, as if it were live");
            return;
        };
        if ui.button(name(path)).on_hover_text(path.display().to_string()).clicked() {
            commands.push(LiveCommand::ChooseReplay.into());
        }
        ui.label("speed");
        let (name, range) = ("Speed of the replay", 0.1..=1000.0);
        number::field(ui, (name, ""), &mut form.speed, range.clone(), |ui, speed, parse| {
            let speed = egui::DragValue::new(speed).range(range).speed(0.1).prefix("×");
            ui.add(speed.custom_parser(parse).custom_formatter(number::shown)).accessible_name(name)
        });
    });
}

fn beforehand(ui: &mut egui::Ui, state: &State, form: &mut LiveForm, commands: &mut Commands) {
    if form.replay.is_some() {
        ui.weak("Rig and control points come from the deployment.");
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("Rig and control points");
        let shown = form.known.as_deref().map_or("Choose…".to_owned(), name);
        if ui.button(shown).on_hover_text("A folder or file that describes the rig").clicked() {
            commands.push(LiveCommand::ChooseKnown.into());
        }
        let open = state.active().and_then(|open| open.source.as_ref()).and_then(Source::path);
        // Other files of a deployment are in the same folder as the file of tracks.
        let open = open.and_then(|path| if path.is_dir() { Some(path) } else { path.parent() });
        if let Some(path) = open.filter(|path| form.known.as_deref() != Some(*path))
            && ui.button("Use those of the deployment shown").clicked()
        {
            form.known = Some(path.to_owned());
        }
    });
}

fn name(path: &Path) -> String {
    path.file_name()
        .map_or_else(|| path.display().to_string(), |name| name.to_string_lossy().into_owned())
}
