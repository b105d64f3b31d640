//! Mapping of the columns of a table, with the first rows as text and as interpreted.

use egui::RichText;

use super::station_count::choose_number;
use super::trouble::trouble;
use crate::app::model::{Asked, AskedColumns, Commands, DialogCommand, LEAST_FILES, TableHead};
use crate::app::panels::number;
use crate::app::theme;
use resect_core::deployment::{AzimuthSense, ColumnMapping, RawRecord};
use resect_core::deployment::{TableAngle, TableLength, TimeFormat, VerticalAngle};
use resect_core::network::USUAL_STATIONS;

/// Number of visible rows.
const ROWS: usize = 8;

pub fn ui(ui: &mut egui::Ui, asked: &AskedColumns, commands: &mut Commands) {
    ui.heading("Assign the columns");
    ui.label(format!("The header of {} is not recognised.", asked.file));
    ui.add_space(6.0);
    let mut edited = asked.clone();
    let header = &asked.preview.header;
    ui.columns_const(|[left, right]| {
        names(left, header, &mut edited, asked.head.as_ref());
        meanings(right, &mut edited);
    });
    ui.add_space(6.0);
    let height = (ui.ctx().content_rect().height() - 480.0).clamp(90.0, 240.0);
    egui::ScrollArea::both().max_height(height).auto_shrink([false, true]).show(ui, |ui| {
        preview(ui, asked);
    });
    ui.add_space(4.0);
    // This line is always present, so that the rows below do not move during typing.
    match asked.complaint() {
        Some(complaint) => trouble(ui, &complaint),
        None => {
            ui.label(RichText::new("The first rows read.").weak());
        }
    }
    let changed = edited.mapping != asked.mapping
        || edited.azimuth != asked.azimuth
        || edited.ranges_include_prism_constant != asked.ranges_include_prism_constant
        || edited.files != asked.files;
    if changed {
        commands.push(DialogCommand::EditAsked(Asked::Columns(Box::new(edited))).into());
    }
}

/// Lets the user assign columns by their names.
fn names(
    ui: &mut egui::Ui,
    header: &[String],
    edited: &mut AskedColumns,
    head: Option<&TableHead>,
) {
    let mut cartesian = edited.mapping.x.is_some();
    ui.horizontal(|ui| {
        ui.radio_value(&mut cartesian, false, "range and angles");
        ui.radio_value(&mut cartesian, true, "x, y, z")
            .on_hover_text("Coordinates in each station's own frame, z up");
    });
    if cartesian != edited.mapping.x.is_some() {
        let ColumnMapping { range, azimuth, vertical, x, y, z, .. } = &mut edited.mapping;
        let none = || Some(String::new());
        if cartesian {
            (*range, *azimuth, *vertical) = (None, None, None);
            (*x, *y, *z) = (none(), none(), none());
        } else {
            (*x, *y, *z) = (None, None, None);
            (*range, *azimuth, *vertical) = (none(), none(), none());
        }
    }
    egui::Grid::new("names").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        let mapping = &mut edited.mapping;
        let mut time = Some(mapping.time.clone()).filter(|name| !name.is_empty());
        column(ui, "Time", header, &mut time, false);
        mapping.time = time.unwrap_or_default();
        if cartesian {
            column(ui, "x", header, &mut mapping.x, false);
            column(ui, "y", header, &mut mapping.y, false);
            column(ui, "z", header, &mut mapping.z, false);
        } else {
            column(ui, "Range", header, &mut mapping.range, false);
            column(ui, "Azimuth", header, &mut mapping.azimuth, false);
            column(ui, "Vertical angle", header, &mut mapping.vertical, false);
        }
        column(ui, "Status", header, &mut mapping.status, true);
        column(ui, "Station", header, &mut mapping.station, true);
        stations_files(ui, edited, head);
    });
}

/// Asks for the file of each station, if no column names the station and each has a separate file.
fn stations_files(ui: &mut egui::Ui, edited: &mut AskedColumns, head: Option<&TableHead>) {
    if edited.mapping.station.is_some() {
        edited.files = None;
        return;
    }
    let Some(head) = head else { return };
    if head.alike.len() < LEAST_FILES {
        ui.label("");
        ui.label(RichText::new("No other file here has this header.").weak());
        ui.end_row();
        return;
    }
    let mut files =
        edited.files.take().unwrap_or_else(|| (0..head.alike.len().min(USUAL_STATIONS)).collect());
    for (station, file) in files.iter_mut().enumerate() {
        let name = format!("File of station {}", station + 1);
        ui.label(&name);
        choice(ui, &name, &head.alike[*file], |ui| {
            for (index, alike) in head.alike.iter().enumerate() {
                ui.selectable_value(file, index, alike);
            }
        });
        ui.end_row();
    }
    ui.label("");
    choose_number(ui, &mut files, head.alike.len());
    ui.end_row();
    edited.files = Some(files);
}

fn column(
    ui: &mut egui::Ui,
    name: &str,
    header: &[String],
    chosen: &mut Option<String>,
    optional: bool,
) {
    const NONE: &str = "– none –";
    ui.label(name);
    let shown = chosen.clone().filter(|name| !name.is_empty());
    let shown = shown.as_deref().unwrap_or(NONE);
    choice(ui, &format!("Column of {}", name.to_lowercase()), shown, |ui| {
        if optional {
            ui.selectable_value(chosen, None, NONE);
        }
        for own in header {
            ui.selectable_value(chosen, Some(own.clone()), own);
        }
    });
    ui.end_row();
}

fn choice(ui: &mut egui::Ui, name: &str, shown: &str, add: impl FnOnce(&mut egui::Ui)) {
    let combo = egui::ComboBox::from_id_salt(name)
        .width(210.0)
        .truncate()
        .selected_text(shown)
        .show_ui(ui, |ui| add(ui));
    combo.response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::ComboBox, true, name));
}

/// Lets the user choose units, signs and formats.
fn meanings(ui: &mut egui::Ui, edited: &mut AskedColumns) {
    let mapping = &mut edited.mapping;
    egui::Grid::new("meanings").num_columns(2).spacing([10.0, 4.0]).show(ui, |ui| {
        pick(ui, "Lengths in", &mut mapping.length_unit, &LENGTHS);
        if mapping.x.is_none() {
            pick(ui, "Angles in", &mut mapping.angle_unit, &ANGLES);
            pick(ui, "Vertical angle is", &mut mapping.vertical_angle, &VERTICALS);
        }
        let senses = AzimuthSense::ALL.map(|sense| (sense, sense.title()));
        pick(ui, "Azimuth turns", &mut edited.azimuth, &senses);
        pick(ui, "Time is", &mut mapping.time_format, &TIMES);
        if matches!(mapping.time_format, TimeFormat::Calendar | TimeFormat::TimeOfDay) {
            ui.label("Time zone if none is given");
            let (hours, range) = (&mut mapping.utc_offset_hours, -14.0..=14.0);
            let name = "Hours ahead of UTC";
            number::field(ui, (name, " h"), hours, range.clone(), |ui, hours, parse| {
                let field = egui::DragValue::new(hours).range(range).speed(0.25);
                ui.add(field.prefix("UTC ").suffix(" h").custom_parser(parse))
            })
            .accessible_name(name);
            ui.end_row();
        }
        ui.label("Prism constant");
        ui.checkbox(&mut edited.ranges_include_prism_constant, "is in the ranges already");
        ui.end_row();
    });
}

const LENGTHS: [(TableLength, &str); 4] = [
    (TableLength::Metres, "metres"),
    (TableLength::Millimetres, "millimetres"),
    (TableLength::Feet, "feet (international)"),
    (TableLength::UsSurveyFeet, "US survey feet"),
];

const ANGLES: [(TableAngle, &str); 4] = [
    (TableAngle::Radians, "radians"),
    (TableAngle::Degrees, "degrees"),
    (TableAngle::Gon, "gon"),
    (TableAngle::DegreesMinutesSeconds, "degrees, minutes, seconds"),
];

const VERTICALS: [(VerticalAngle, &str); 2] = [
    (VerticalAngle::Zenith, "zenith angle (0 straight up)"),
    (VerticalAngle::Elevation, "elevation (0 on the horizon)"),
];

const TIMES: [(TimeFormat, &str); 6] = [
    (TimeFormat::Seconds, "seconds"),
    (TimeFormat::Milliseconds, "milliseconds"),
    (TimeFormat::Microseconds, "microseconds"),
    (TimeFormat::Nanoseconds, "nanoseconds"),
    (TimeFormat::Calendar, "date and time of day"),
    (TimeFormat::TimeOfDay, "time of day"),
];

fn pick<T: Copy + PartialEq>(
    ui: &mut egui::Ui,
    name: &str,
    chosen: &mut T,
    choices: &[(T, &'static str)],
) {
    ui.label(name);
    let shown = choices.iter().find(|(value, _)| value == chosen).map_or("", |(_, text)| *text);
    choice(ui, name, shown, |ui| {
        for (value, text) in choices {
            ui.selectable_value(chosen, *value, *text);
        }
    });
    ui.end_row();
}

/// Shows each row as written, and as interpreted or with its error.
fn preview(ui: &mut egui::Ui, asked: &AskedColumns) {
    let start_s = asked.preview.read.iter().flatten().map(|row| row.measurement.time_s).next();
    let dark = ui.visuals().dark_mode;
    let spacing = [12.0, 2.0];
    egui::Grid::new("preview").striped(true).spacing(spacing).show(ui, |ui| {
        for name in &asked.preview.header {
            ui.label(RichText::new(name).small().strong());
        }
        ui.label(RichText::new("understood as").small().strong());
        ui.end_row();
        for (row, read) in asked.preview.rows.iter().zip(&asked.preview.read).take(ROWS) {
            for column in 0..asked.preview.header.len() {
                let text = row.get(column).map_or("", String::as_str);
                ui.label(theme::code(text));
            }
            match read {
                Ok(record) => {
                    let text = understood(record, start_s.unwrap_or(0.0));
                    ui.label(theme::code(&text));
                }
                Err(why) => {
                    let (colour, sign) =
                        theme::severity(resect_core::deployment::Severity::Problem, dark);
                    ui.label(RichText::new(format!("{sign} {why}")).small().color(colour));
                }
            }
            ui.end_row();
        }
    });
}

/// Formats a record, for example "station 1  +0.400 s  12.3450 m  azimuth 12.3400°  zenith angle 89.1000°".
fn understood(record: &RawRecord, start_s: f64) -> String {
    let m = &record.measurement;
    format!(
        "station {}  +{:.3} s  {:.4} m  azimuth {:.4}°  zenith angle {:.4}°",
        record.station,
        m.time_s - start_s,
        m.range_m,
        m.azimuth_rad.to_degrees(),
        m.zenith_rad.to_degrees()
    )
}
