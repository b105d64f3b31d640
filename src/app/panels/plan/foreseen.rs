//! Prediction for a plan: verdict, σ of the transforms, weak directions, and the best improvements.

use egui::RichText;
use egui_plot::{Line, Plot, PlotPoints};

use crate::app::model::estimates::Shown;
use crate::app::model::units::unbroken;
use crate::app::model::{Commands, PlanCommand, Units};
use crate::app::panels::result::badge;
use crate::app::panels::{finding, heading, observability, scrolled};
use crate::app::plots::{axis_below, bare_axis, close_marks, round_marks, still};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::deployment::Severity;
use resect_report::glossary;
use resect_tools::palette;
use resect_tools::planning::{Held, Prediction};

/// Height of the plot of σ along the track (points).
const PLOT: f32 = 110.0;
/// Room beside it (points).
const ASIDE: f32 = 14.0;
/// Greatest number of improvements offered.
const MOST_OFFERED: usize = 8;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let planning = &state.planning;
    scrolled(ui, |ui| {
        let Some(foreseen) = planning.foreseen.newest.as_deref() else {
            ui.weak("Predicting…");
            return;
        };
        let foreseen = match foreseen {
            Ok(foreseen) => foreseen,
            Err(why) => {
                ui.heading("No prediction");
                ui.add(egui::Label::new(why.to_string()).wrap());
                return;
            }
        };
        if !planning.is_foreseen() {
            ui.multiply_opacity(0.6);
        }
        head(ui, foreseen, planning.plan.target_mm);
        for one in &foreseen.findings {
            finding(ui, state, one, commands);
        }
        improvements(ui, state, commands);
        if let Some(held) = &foreseen.held {
            heading(ui, "Predicted σ");
            table(ui, held, state.workspace.units);
        }
        along(ui, foreseen, state.workspace.units);
        locks(ui, foreseen, state.workspace.units);
        if let Some(observed) = &foreseen.observability {
            observability::ui(ui, observed);
        }
    });
}

/// Shows the predicted verdict, and σ at the far end.
fn head(ui: &mut egui::Ui, foreseen: &Prediction, target_mm: f64) {
    ui.horizontal_wrapped(|ui| {
        let line = match &foreseen.held {
            Some(held) => {
                let sigma_mm = 1e3 * held.far_end.sigma_m;
                let target = if sigma_mm > target_mm { "misses" } else { "meets" };
                format!("{sigma_mm:.1} mm at the far end {target} the {target_mm:.1} mm target")
            }
            None => "a direction stays unobservable".to_owned(),
        };
        let text = RichText::new(unbroken(&line)).size(15.0).strong();
        let misses = foreseen.held.as_ref().is_none_or(|held| 1e3 * held.far_end.sigma_m > target_mm);
        let (notable, _) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
        ui.label(if misses { text.color(notable) } else { text }).on_hover_text(
            "RMS error of a calibrated station's prism positions at the worst place of the track. It comes from the \
             joint estimate's information, with priors and instrument errors",
        );
    });
    let minutes = foreseen.duration_s / 60.0;
    let length_m = foreseen.length_m;
    ui.horizontal_wrapped(|ui| {
        ui.label("predicted verdict:");
        words::explain(badge(ui, foreseen.verdict, 11.0), &glossary::VERDICT);
        ui.weak(format!("{minutes:.1} minutes · {length_m:.0} m"));
    });
}

/// Shows σ of (x, y, z, yaw) of stations 2, 3, …, with the main source of each.
fn table(ui: &mut egui::Ui, held: &Held, units: Units) {
    let mut rows = Vec::new();
    for (slot, sigma) in held.sigma.iter().skip(1).enumerate() {
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            rows.push((slot, 4 * slot + axis, name, 1e3 * sigma.translation_m[axis], "mm"));
        }
        let per = units.angle.small_per_radian();
        rows.push((slot, 4 * slot + 3, "yaw", sigma.yaw_rad * per, units.angle.small_name()));
    }
    egui::Grid::new("predicted σ").num_columns(3).spacing([10.0, 3.0]).striped(true).show(
        ui,
        |ui| {
            for (slot, place, name, sigma, unit) in rows {
                let label = ui.label(format!("{name} of T1{}", slot + 2));
                if let Some(entry) = [&glossary::T12, &glossary::T13].get(slot)
                    && place % 4 == 0
                {
                    words::explain(label, entry);
                }
                let shown = Shown::new(sigma, Some(sigma), unit, 3);
                ui.monospace(format!("± {}", shown.sigma_in_words()));
                let dominant = &held.dominant[place];
                let share = 100.0 * (dominant.sigma / dominant.total_sigma).powi(2);
                ui.small(format!("{share:.0} % {}", dominant.name))
                    .on_hover_text("Largest source of the variance");
                ui.end_row();
            }
        },
    );
}

/// Plots the predicted σ of the vehicle's position along the drive.
fn along(ui: &mut egui::Ui, foreseen: &Prediction, units: Units) {
    heading(ui, "σ of the vehicle along the track");
    ui.small("At each instant, with the noise of its readings. σ at the far end is from the calibration alone.");
    let mut pieces: Vec<Vec<[f64; 2]>> = vec![Vec::new()];
    for at in &foreseen.way {
        match at.position_sigma_m {
            Some(sigma_m) => {
                let piece = pieces.last_mut().expect("never empty");
                piece.push([at.time_s, 1e3 * sigma_m]);
            }
            None if pieces.last().is_some_and(|piece| !piece.is_empty()) => pieces.push(Vec::new()),
            None => {}
        }
    }
    let most_mm = pieces.iter().flatten().map(|at| at[1]).fold(0.0, f64::max);
    if most_mm == 0.0 {
        ui.weak("No motion is known: see the findings.");
        return;
    }
    let plot = still(Plot::new("σ along the planned way"))
        .height(PLOT)
        // Half of the last number extends beyond the plot.
        .width(ui.available_width() - ASIDE)
        .x_grid_spacer(round_marks)
        .y_grid_spacer(close_marks)
        .custom_x_axes(vec![axis_below("time (s)")])
        .custom_y_axes(vec![bare_axis().label(RichText::new("σ position (mm)").small())])
        .label_formatter(|_| None);
    let shown = plot.show(ui, |plot_ui| {
        plot_ui.set_plot_bounds_x(0.0..=foreseen.duration_s);
        plot_ui.set_plot_bounds_y(0.0..=1.1 * most_mm);
        for piece in pieces {
            let line = Line::new("", PlotPoints::from(piece)).width(1.6);
            plot_ui.line(line.color(theme::rgb(palette::METRICS[0])));
        }
    });
    let role = egui::accesskit::Role::Canvas;
    let name = "σ of the position along the planned track";
    shown.response.widget_info(|| egui::WidgetInfo::labeled(role, true, name));
    let rotations = foreseen.way.iter().filter_map(|at| at.rotation_sigma_rad);
    let (sum, count) = rotations.fold((0.0, 0), |(sum, count), sigma| (sum + sigma, count + 1));
    if count > 0 {
        let mean = units.angle.small_per_radian() * sum / f64::from(count);
        ui.small(format!("rotation: {mean:.2} {} on average", units.angle.small_name()));
    }
}

/// Shows the range, the greatest rates, and the number of accepted readings of each station.
fn locks(ui: &mut egui::Ui, foreseen: &Prediction, units: Units) {
    heading(ui, "Prism tracking");
    let rate = |deg_per_s: f64| {
        format!("{:.2} {}", deg_per_s * units.angle.rate_per_deg_per_s(), units.angle.rate_name())
    };
    let grid = egui::Grid::new("locks").num_columns(6).spacing([10.0, 3.0]).striped(true);
    grid.show(ui, |ui| {
        for title in ["", "range", "fastest", "azimuth", "zenith", "kept"] {
            ui.small(title);
        }
        ui.end_row();
        for (station, lock) in foreseen.locks.iter().enumerate() {
            let dark = ui.visuals().dark_mode;
            let colour = theme::readable(palette::station(station), dark);
            ui.label(RichText::new((station + 1).to_string()).color(colour).strong());
            let [near, far] = lock.range_m;
            for cell in [
                format!("{near:.0}–{far:.0} m"),
                format!("{:.1} m/s", lock.fastest_range_m_per_s),
                rate(lock.fastest_azimuth_deg_per_s),
                rate(lock.fastest_zenith_deg_per_s),
                format!("{} of {}", foreseen.kept[station], foreseen.readings[station]),
            ] {
                ui.small(cell);
            }
            ui.end_row();
        }
    });
}

/// Lists the tested changes, best first, with a button to apply each.
fn improvements(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    heading(ui, "Largest improvements");
    let better = &state.planning.better;
    let of_this = better.is_of((state.planning.version, 0));
    match better.newest.as_deref().filter(|_| of_this) {
        None => {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.weak("trying manoeuvres, prisms and stations");
            });
        }
        Some(Err(why)) => {
            ui.weak(why.to_string());
        }
        Some(Ok(found)) if found.is_empty() => {
            ui.weak("No change that was tried improves it by 2 % or more.");
        }
        Some(Ok(found)) => {
            for one in found.iter().take(MOST_OFFERED) {
                ui.horizontal_top(|ui| {
                    let name = format!("Take: {}", one.sentence);
                    let button = ui.small_button("Take");
                    button.widget_info(|| {
                        egui::WidgetInfo::labeled(egui::accesskit::Role::Button, true, &name)
                    });
                    if button.on_hover_text("Apply it to the plan; Undo reverts it").clicked() {
                        let plan = Box::new(one.plan.clone());
                        let set = PlanCommand::Set(plan, "an improvement taken");
                        commands.push(set.into());
                    }
                    ui.add(egui::Label::new(unbroken(&one.sentence)).wrap());
                });
            }
        }
    }
}
