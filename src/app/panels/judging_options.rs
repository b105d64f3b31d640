//! Options for the comparison of other systems' trajectories with the ground truth: for all, or for each.

use egui::{Role, WidgetInfo};
use nalgebra::Vector3;

use super::number;
use crate::app::model::{Added, Commands, JudgingCommand};
use crate::app::theme;
use resect_core::deployment::Severity;
use resect_tools::estimates::conventions::{Convention, WORDS};
use resect_tools::estimates::{Body, Options, TrajectoryAlignment};

/// Greatest lever arm (m), and greatest time offset (s), which allows clocks that start in 1970.
const LONGEST_LEVER_M: f64 = 100.0;
const LARGEST_OFFSET_S: f64 = 4e9;

/// Shows and edits the options of all trajectories, or of the selected one.
pub fn ui(ui: &mut egui::Ui, added: &[Added], commands: &mut Commands) {
    let colour = chosen(ui, added);
    let is_chosen = |one: &Added| colour.is_none_or(|colour| one.colour == colour);
    let mut after = added.to_vec();
    let mut some: Vec<&mut Options> =
        after.iter_mut().filter(|one| is_chosen(one)).map(|one| &mut one.options).collect();
    alignment(ui, &mut some);
    body(ui, &mut some);
    clock(ui, &mut some);
    convention(ui, &mut some);
    if after != added {
        commands.push(JudgingCommand::Set(after).into());
    }
}

/// Returns the colour of the trajectory whose options are shown; `None` for all of them.
fn chosen(ui: &mut egui::Ui, added: &[Added]) -> Option<usize> {
    let id = ui.scope_id().with("judged how");
    let chosen: Option<usize> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut chosen = chosen.filter(|colour| added.iter().any(|one| one.colour == *colour));
    if added.len() < 2 {
        return None;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("evaluate");
        let mut choice = |ui: &mut egui::Ui, of: Option<usize>, text: String, name: String| {
            let label = ui.selectable_value(&mut chosen, of, text);
            label
                .widget_info(|| WidgetInfo::selected(Role::RadioButton, true, chosen == of, &name));
            label.on_hover_text(name);
        };
        choice(ui, None, "all".to_owned(), "Options of all trajectories".to_owned());
        for one in added {
            let name = &one.estimate.name;
            choice(ui, Some(one.colour), name.clone(), format!("Options of {name} only"));
        }
        ui.label(if chosen.is_none() { "with the same options:" } else { "with its own options:" });
    });
    ui.data_mut(|data| data.insert_temp(id, chosen));
    chosen
}

/// Returns the common value; `None` if the values differ.
fn common<T: PartialEq>(some: &[&mut Options], of: impl Fn(&Options) -> T) -> Option<T> {
    let (first, others) = some.split_first()?;
    let first = of(first);
    others.iter().all(|one| of(one) == first).then_some(first)
}

fn set_all(some: &mut [&mut Options], set: impl Fn(&mut Options)) {
    some.iter_mut().for_each(|one| set(one));
}

fn alignment(ui: &mut egui::Ui, some: &mut [&mut Options]) {
    ui.horizontal_wrapped(|ui| {
        ui.label("aligned by");
        for (alignment, hint) in [
            (TrajectoryAlignment::Rigid, "As evo with alignment"),
            (
                TrajectoryAlignment::Similarity,
                "For a monocular camera, as evo with scale correction",
            ),
            (TrajectoryAlignment::None, "The trajectory is in the frame of station 1"),
        ] {
            let is_it = common(some, |one| one.alignment) == Some(alignment);
            if ui.radio(is_it, alignment.in_words()).on_hover_text(hint).clicked() {
                set_all(some, |one| one.alignment = alignment);
            }
        }
    });
}

fn body(ui: &mut egui::Ui, some: &mut [&mut Options]) {
    ui.horizontal_wrapped(|ui| {
        ui.label("body is");
        let given_m = match common(some, |one| one.body) {
            Some(Body::Lever(lever_m)) => lever_m,
            _ => Vector3::zeros(),
        };
        for (body, name, hint) in [
            (Body::Found, "estimated", "Estimates lever arm and rotation relative to the vehicle"),
            (Body::Same, "the vehicle's frame", "As evo assumes"),
            (Body::Lever(given_m), "at", "Known lever arm: the body's origin in the vehicle's frame, or the single prism in the body's frame"),
        ] {
            let is_it = common(some, |one| one.body) == Some(body);
            if ui.radio(is_it, name).on_hover_text(hint).clicked() {
                set_all(some, |one| one.body = body);
            }
        }
        let Some(Body::Lever(mut lever_m)) = common(some, |one| one.body) else { return };
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let label = ui.label(name);
            metres(ui, name, &mut lever_m[axis]).labelled_by(label.id);
        }
        set_all(some, |one| one.body = Body::Lever(lever_m));
    });
}

fn clock(ui: &mut egui::Ui, some: &mut [&mut Options]) {
    ui.horizontal_wrapped(|ui| {
        ui.label("clock is");
        let given_s = common(some, |one| one.time_offset_s).flatten().unwrap_or_default();
        for (offset_s, name, hint) in [
            (None, "estimated", "Estimates the time offset, which is added to the times"),
            (
                Some(given_s),
                "off by",
                "Known time offset, which is added to the times; evo uses 0 s",
            ),
        ] {
            let is_it = common(some, |one| one.time_offset_s) == Some(offset_s);
            if ui.radio(is_it, name).on_hover_text(hint).clicked() {
                set_all(some, |one| one.time_offset_s = offset_s);
            }
        }
        let Some(Some(mut offset_s)) = common(some, |one| one.time_offset_s) else { return };
        let range = -LARGEST_OFFSET_S..=LARGEST_OFFSET_S;
        number::field(
            ui,
            ("time offset", "s"),
            &mut offset_s,
            range.clone(),
            |ui, value, parse| {
                let field = egui::DragValue::new(value).speed(0.001).range(range).suffix(" s");
                ui.add(field.max_decimals(4).custom_parser(parse))
            },
        )
        .on_hover_text("Added to the times");
        set_all(some, |one| one.time_offset_s = Some(offset_s));
    });
}

/// Edits the convention of the files, in the words of `evaluate --convention`. Text that is no convention stays, with the reason below.
fn convention(ui: &mut egui::Ui, some: &mut [&mut Options]) {
    let common = common(some, |one| one.convention);
    if let Some(convention) = convention_field(ui, "file's convention is", common) {
        set_all(some, |one| one.convention = convention);
    }
}

/// Shows the convention of a file, or of several with different ones (`None`), and returns one that was typed.
pub fn convention_field(
    ui: &mut egui::Ui,
    name: &str,
    convention: Option<Convention>,
) -> Option<Convention> {
    let id = ui.scope_id().with(("convention", name));
    let edited: Option<String> = ui.data(|data| data.get_temp(id));
    let is_edited = edited.is_some();
    let as_is = convention.map_or_else(String::new, |convention| convention.to_string());
    let mut text = edited.unwrap_or(as_is);
    let hint = if convention.is_some() { "xyzw" } else { "different ones" };
    let response = ui.horizontal_wrapped(|ui| {
        let label = ui.label(name);
        let field = egui::TextEdit::singleline(&mut text).desired_width(140.0).hint_text(hint);
        ui.add(field).labelled_by(label.id).on_hover_text(WORDS)
    });
    let response = response.inner;
    if response.changed() {
        ui.data_mut(|data| data.insert_temp(id, text.clone()));
    }
    if !is_edited || response.has_focus() {
        return None;
    }
    match text.parse::<Convention>() {
        Ok(convention) => {
            ui.data_mut(|data| data.remove::<String>(id));
            Some(convention)
        }
        Err(why) => {
            let (colour, _) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
            ui.colored_label(colour, why);
            None
        }
    }
}

fn metres(ui: &mut egui::Ui, name: &str, value_m: &mut f64) -> egui::Response {
    let range = -LONGEST_LEVER_M..=LONGEST_LEVER_M;
    number::field(ui, (name, "m"), value_m, range.clone(), |ui, value, parse| {
        let field = egui::DragValue::new(value).speed(0.005).range(range).suffix(" m");
        ui.add(field.max_decimals(4).custom_parser(parse))
    })
}
