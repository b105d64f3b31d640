//! Questions to the user in a dialog: files, topics, columns, and the purpose of files.

mod columns;
mod station_count;
mod trouble;

use egui::RichText;

use self::station_count::choose_number;
use self::trouble::trouble;
use crate::app::model::{
    Asked, AskedAnswer, AskedFiles, AskedStations, AskedToml, AskedTracks, Commands, DialogCommand,
    StationsAre,
};
use crate::app::theme;

const WIDTH: f32 = 560.0;
/// Width of a dialog with a table (points).
const WIDE: f32 = 980.0;

pub fn ui(ctx: &egui::Context, asked: &Asked, commands: &mut Commands) {
    let modal = egui::Modal::new(egui::Id::unique("asked"))
        .frame(egui::Frame::popup(&ctx.global_style()).inner_margin(12.0));
    let width = if matches!(asked, Asked::Columns(_)) { WIDE } else { WIDTH };
    let mut answered = false;
    let response = modal.show(ctx, |ui| {
        ui.set_width(width.min(ui.ctx().content_rect().width() - 40.0));
        let before = commands.len();
        match asked {
            Asked::Tracks(tracks) => ask_tracks(ui, tracks, commands),
            Asked::Stations(stations) => ask_stations(ui, stations, commands),
            Asked::Columns(columns) => columns::ui(ui, columns, commands),
            Asked::Files(files) => ask_files(ui, files, commands),
            Asked::Toml(toml) => ask_toml(ui, toml, commands),
        }
        ui.add_space(8.0);
        buttons(ui, asked, commands);
        answered = commands.len() > before;
    });
    if !answered && response.should_close() {
        commands.push(DialogCommand::CancelAsked.into());
    }
}

fn buttons(ui: &mut egui::Ui, asked: &Asked, commands: &mut Commands) {
    ui.horizontal(|ui| {
        if ui.button("Cancel").clicked() {
            commands.push(DialogCommand::CancelAsked.into());
        }
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let yes = match asked {
                Asked::Files(files) => match files.targets.get(files.target) {
                    Some((_, name)) => format!("Use for {name}"),
                    None => "Use".to_owned(),
                },
                Asked::Toml(_) => "Write".to_owned(),
                _ => "Open".to_owned(),
            };
            let yes = ui.add_enabled(asked.is_answered(), egui::Button::new(yes));
            if yes.clicked() {
                commands.push(DialogCommand::AnswerAsked(AskedAnswer::AsChosen).into());
            }
            if let Asked::Files(files) = asked
                && !files.folders.is_empty()
                && ui.button("Open as a deployment of its own").clicked()
            {
                commands.push(DialogCommand::AnswerAsked(AskedAnswer::OwnDeployment).into());
            }
        });
    });
}

fn ask_tracks(ui: &mut egui::Ui, asked: &AskedTracks, commands: &mut Commands) {
    ui.heading("Choose the file with the tracks");
    ui.label(format!(
        "{} has several. Choose one, or all parts of a split recording.",
        asked.folder
    ));
    ui.add_space(6.0);
    let mut edited = asked.clone();
    let size = ui.ctx().content_rect().height() - 260.0;
    egui::ScrollArea::vertical().max_height(size.max(80.0)).show(ui, |ui| {
        for (file, chosen) in asked.files.iter().zip(&mut edited.chosen) {
            ui.checkbox(chosen, file);
        }
    });
    if edited != *asked {
        commands.push(DialogCommand::EditAsked(Asked::Tracks(edited)).into());
    }
}

fn ask_stations(ui: &mut egui::Ui, asked: &AskedStations, commands: &mut Commands) {
    let (what, why) = match asked.are {
        StationsAre::Topics => {
            ("topic", format!("The messages of {} do not name their station.", asked.place))
        }
        StationsAre::Files => {
            ("file", format!("The files of {} hold one station each.", asked.place))
        }
    };
    ui.heading(format!("Assign a {what} to each station"));
    ui.label(why);
    ui.add_space(6.0);
    let mut edited = asked.clone();
    let in_words = |index: usize| match asked.choices.get(index) {
        Some((name, more)) if more.is_empty() => name.clone(),
        Some((name, more)) => format!("{name}  ({more})"),
        None => String::new(),
    };
    egui::Grid::new("stations asked").num_columns(2).spacing([10.0, 6.0]).show(ui, |ui| {
        for (station, chosen) in edited.stations.iter_mut().enumerate() {
            let name = format!("Station {}", station + 1);
            ui.label(&name);
            let combo = egui::ComboBox::from_id_salt(&name)
                .width(WIDTH - 90.0)
                .truncate()
                .selected_text(in_words(*chosen))
                .show_ui(ui, |ui| {
                    for index in 0..asked.choices.len() {
                        ui.selectable_value(chosen, index, in_words(index));
                    }
                });
            let label = format!("The {what} of station {}", station + 1);
            combo
                .response
                .widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, &label));
            ui.end_row();
        }
    });
    choose_number(ui, &mut edited.stations, asked.choices.len());
    if !Asked::Stations(edited.clone()).is_answered() {
        trouble(ui, &format!("Each station needs a {what} of its own."));
    }
    if edited != *asked {
        commands.push(DialogCommand::EditAsked(Asked::Stations(edited)).into());
    }
}

fn ask_files(ui: &mut egui::Ui, asked: &AskedFiles, commands: &mut Commands) {
    ui.heading("Use these files?");
    let mut names: Vec<String> = Vec::new();
    let short = |path: &std::path::Path| {
        path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
    };
    names.extend(asked.extras.rig.iter().map(|path| format!("Rig: {}", short(path))));
    names.extend(asked.extras.gcp.iter().map(|path| format!("Control points: {}", short(path))));
    names.extend(asked.extras.gnss.iter().map(|path| format!("GNSS: {}", short(path))));
    for name in &names {
        ui.add(egui::Label::new(name).truncate());
    }
    ui.add_space(6.0);
    let mut edited = asked.clone();
    if asked.targets.len() > 1 {
        ui.label("Use with");
        for (index, (_, name)) in asked.targets.iter().enumerate() {
            ui.radio_value(&mut edited.target, index, name);
        }
    }
    if let Some((_, name)) = asked.targets.get(asked.target) {
        let replaces =
            if asked.extras.rig.is_some() { "The rig replaces the present one; " } else { "" };
        let text = format!("{replaces}{name} is read again with them. Undo reverts it.");
        ui.label(RichText::new(text).weak());
    }
    if edited != *asked {
        commands.push(DialogCommand::EditAsked(Asked::Files(Box::new(edited))).into());
    }
}

fn ask_toml(ui: &mut egui::Ui, asked: &AskedToml, _commands: &mut Commands) {
    ui.heading("Change deployment.toml?");
    ui.label(asked.path.display().to_string());
    ui.add_space(4.0);
    for change in &asked.said {
        ui.label(format!("• {change}"));
    }
    if asked.said.is_empty() {
        ui.label("No change: the file has all of this already.");
    }
    ui.label(RichText::new("Comments and all other entries stay.").weak());
    if !asked.stays.is_empty() {
        let text = "Files outside this folder stay in the session.";
        ui.label(RichText::new(text).weak());
    }
    ui.collapsing("Preview of the whole file", |ui| {
        let size = ui.ctx().content_rect().height() - 340.0;
        egui::ScrollArea::vertical().max_height(size.max(80.0)).show(ui, |ui| {
            ui.add(egui::Label::new(theme::code(&asked.after)).wrap());
        });
    });
}
