//! How trajectories of other systems are brought together with the ground truth: all of them alike, or each by itself.

use egui::{Role, WidgetInfo};
use nalgebra::Vector3;

use super::number;
use crate::app::model::{Added, Commands, JudgingCommand};
use crate::app::short;
use resect_core::estimates::{Alignment, Body, Options};

/// Lever arms on vehicles are shorter (m), and clocks that somebody knows are nearer than since 1970 (s).
const LONGEST_LEVER_M: f64 = 100.0;
const LARGEST_OFFSET_S: f64 = 4e9;

/// Shows what is asked of all, or of the one that the user chose, and lets it be changed.
pub fn ui(ui: &mut egui::Ui, added: &[Added], commands: &mut Commands) {
    let colour = chosen(ui, added);
    let is_chosen = |one: &Added| colour.is_none_or(|colour| one.colour == colour);
    let mut after = added.to_vec();
    let mut some: Vec<&mut Options> =
        after.iter_mut().filter(|one| is_chosen(one)).map(|one| &mut one.options).collect();
    alignment(ui, &mut some);
    body(ui, &mut some);
    clock(ui, &mut some);
    if after != added {
        commands.push(JudgingCommand::Set(after).into());
    }
}

/// The colour of the trajectory that what stands below is about; `None` is all of them.
fn chosen(ui: &mut egui::Ui, added: &[Added]) -> Option<usize> {
    let id = ui.scope_id().with("judged how");
    let chosen: Option<usize> = ui.data(|data| data.get_temp(id)).unwrap_or_default();
    let mut chosen = chosen.filter(|colour| added.iter().any(|one| one.colour == *colour));
    if added.len() < 2 {
        return None;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("how");
        let mut choice = |ui: &mut egui::Ui, of: Option<usize>, text: String, name: String| {
            let label = ui.selectable_value(&mut chosen, of, text);
            label
                .widget_info(|| WidgetInfo::selected(Role::RadioButton, true, chosen == of, &name));
            label.on_hover_text(name);
        };
        choice(ui, None, "all".to_owned(), "How all are judged".to_owned());
        for one in added {
            let name = &one.estimate.name;
            let text = short::of_trajectory(ui, name);
            choice(ui, Some(one.colour), text, format!("How {name} alone is judged"));
        }
        ui.label(if chosen.is_none() { "are judged:" } else { "is judged:" });
    });
    ui.data_mut(|data| data.insert_temp(id, chosen));
    chosen
}

/// What they have in common; `None` where they differ.
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
            (Alignment::Rigid, "As evo's --align"),
            (Alignment::Similarity, "For one camera alone, as evo's --correct_scale"),
            (Alignment::None, "The trajectory is in the frame of station 1"),
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
            (Body::Found, "found", "Lever arm and rotation against the vehicle are estimated"),
            (Body::Same, "the vehicle's frame", "As evo takes it to be"),
            (Body::Lever(given_m), "at", "The lever arm is known: where the body's origin is in the vehicle's frame, or the one prism in the body's"),
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
            (None, "found", "What has to be added to the times is estimated"),
            (
                Some(given_s),
                "off by",
                "What has to be added to the times is known; 0 s as evo takes it",
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

fn metres(ui: &mut egui::Ui, name: &str, value_m: &mut f64) -> egui::Response {
    let range = -LONGEST_LEVER_M..=LONGEST_LEVER_M;
    number::field(ui, (name, "m"), value_m, range.clone(), |ui, value, parse| {
        let field = egui::DragValue::new(value).speed(0.005).range(range).suffix(" m");
        ui.add(field.max_decimals(4).custom_parser(parse))
    })
}
