//! Numbers of a plan: target, stations, rig, instruments, ground.

use std::ops::RangeInclusive;

use egui::RichText;

use crate::app::model::planning::manoeuvre_name;
use crate::app::model::{Commands, PlanCommand};
use crate::app::panels::{fewer_or_more, heading, number, scrolled};
use crate::app::state::State;
use crate::app::theme;
use resect_core::network::MOST_STATIONS;
use resect_tools::palette;
use resect_tools::planning::{Piece, Plan};
use resect_tools::simulation::Preset;

/// A number of a plan: name, unit, bounds, and its change per point of dragging.
struct Field {
    name: &'static str,
    unit: &'static str,
    range: RangeInclusive<f64>,
    speed: f64,
    hint: &'static str,
}

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        from_where(ui, state, commands);
        let mut plan = state.planning.plan.clone();
        let mut changed = "";
        let mut note =
            |ui: &mut egui::Ui, words: &'static str, of: &mut dyn FnMut(&mut egui::Ui) -> bool| {
                if of(ui) {
                    changed = words;
                }
            };
        note(ui, "the target of the plan", &mut |ui| target(ui, &mut plan));
        note(ui, "stations of the plan", &mut |ui| stations(ui, &mut plan));
        note(ui, "prisms of the plan", &mut |ui| rig(ui, &mut plan));
        note(ui, "instruments of the plan", &mut |ui| instrument(ui, &mut plan));
        note(ui, "ground of the plan", &mut |ui| ground(ui, &mut plan));
        note(ui, "manoeuvres of the plan", &mut |ui| manoeuvres(ui, &mut plan));
        if !changed.is_empty() {
            commands.push(PlanCommand::Set(plan.into(), changed).into());
        }
    });
}

/// Opens and saves plans.
fn from_where(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut send = |command: PlanCommand| commands.push(command.into());
    ui.horizontal_wrapped(|ui| {
        let name = match &state.planning.path {
            Some(path) => path.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            None => state.planning.plan.name.clone(),
        };
        ui.strong(name);
    });
    ui.horizontal_wrapped(|ui| {
        if ui.button("Open…").on_hover_text("A plan file (TOML) of `resect plan`").clicked() {
            send(PlanCommand::OpenDialog);
        }
        if ui.button("Save…").clicked() {
            send(PlanCommand::SaveDialog);
        }
        let driven = state.analysed().is_some();
        let button = ui.add_enabled(driven, egui::Button::new("As driven"));
        let button = button
            .on_hover_text("Stations, track, rig and noise of the deployment shown")
            .on_disabled_hover_text("No deployment is open");
        if button.clicked() {
            send(PlanCommand::FromDeployment);
        }
        ui.menu_button("Preset…", |ui| {
            for preset in Preset::ALL {
                if ui.button(preset.name()).clicked() {
                    send(PlanCommand::FromPreset(preset));
                }
            }
        });
    });
}

fn field(ui: &mut egui::Ui, field: &Field, value: &mut f64) -> bool {
    let Field { name, unit, range, speed, hint } = field;
    let before = *value;
    ui.horizontal(|ui| {
        let label = ui.label(*name);
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            let shown =
                number::field(ui, (name, unit), value, range.clone(), |ui, value, parse| {
                    let drag = egui::DragValue::new(value).speed(*speed).range(range.clone());
                    ui.add(drag.suffix(format!(" {unit}")).max_decimals(3).custom_parser(parse))
                });
            let shown = shown.labelled_by(label.id);
            if !hint.is_empty() {
                shown.on_hover_text(*hint);
            }
        });
    });
    *value != before
}

fn target(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    let target = Field {
        name: "target at the far end",
        unit: "mm",
        range: 0.01..=1e4,
        speed: 0.05,
        hint: "Largest acceptable RMS error of a calibrated station's prism positions at the far end of the track",
    };
    field(ui, &target, &mut plan.target_mm)
}

fn stations(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    heading(ui, "Stations");
    let mut changed = false;
    let dark = ui.visuals().dark_mode;
    egui::Grid::new("stations of the plan").num_columns(4).spacing([6.0, 3.0]).show(ui, |ui| {
        axes(ui);
        for (station, place_m) in plan.stations_m.iter_mut().enumerate() {
            let colour = theme::readable(palette::station(station), dark);
            ui.label(RichText::new((station + 1).to_string()).color(colour).strong());
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                let name = format!("{name} of station {}", station + 1);
                changed |= cell(ui, &name, &mut place_m[axis], -2e4..=2e4);
            }
            ui.end_row();
        }
    });
    if let Some(count) = fewer_or_more(ui, "station", plan.stations_m.len(), 2..=MOST_STATIONS) {
        plan.set_stations(count);
        changed = true;
    }
    changed
}

/// Header of the three fields of a position.
fn axes(ui: &mut egui::Ui) {
    ui.label("");
    for axis in ["x", "y", "z"] {
        ui.weak(axis);
    }
    ui.end_row();
}

fn rig(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    heading(ui, "Prisms on the vehicle");
    let mut changed = false;
    egui::Grid::new("prisms of the plan").num_columns(4).spacing([6.0, 3.0]).show(ui, |ui| {
        axes(ui);
        for (prism, place_m) in plan.rig.prisms_m.iter_mut().enumerate() {
            ui.label((prism + 1).to_string())
                .on_hover_text("x ahead, y left, z up from the ground under the vehicle");
            for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
                let name = format!("{name} of prism {}", prism + 1);
                changed |= cell(ui, &name, &mut place_m[axis], -50.0..=50.0);
            }
            ui.end_row();
        }
    });
    if let Some(count) = fewer_or_more(ui, "prism", plan.rig.prisms_m.len(), 1..=MOST_STATIONS) {
        plan.set_prisms(count);
        changed = true;
    }
    let sigma = Field {
        name: "σ of their distances",
        unit: "mm",
        range: 0.0..=1e3,
        speed: 0.02,
        hint: "Standard deviation of the measured distances between the prisms",
    };
    let mut sigma_mm = 1e3 * plan.rig.inter_prism_sigma_m;
    if field(ui, &sigma, &mut sigma_mm) {
        plan.rig.inter_prism_sigma_m = 1e-3 * sigma_mm;
        changed = true;
    }
    changed
}

fn cell(ui: &mut egui::Ui, name: &str, value_m: &mut f64, range: RangeInclusive<f64>) -> bool {
    let before = *value_m;
    let shown = number::field(ui, (name, "m"), value_m, range.clone(), |ui, value, parse| {
        let drag = egui::DragValue::new(value).speed(0.05).range(range).suffix(" m");
        ui.add(drag.max_decimals(2).min_decimals(2).custom_parser(parse))
    });
    shown.widget_info(|| egui::WidgetInfo::labeled(egui::accesskit::Role::SpinButton, true, name));
    *value_m != before
}

fn instrument(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    heading(ui, "Instruments");
    let one = &mut plan.instrument;
    let mut changed = false;
    for (name, unit, range, speed, hint, value) in [
        (
            "σ of ranges",
            "mm",
            0.01..=1e3,
            0.02,
            "Noise of a range to a moving prism",
            &mut one.range_mm,
        ),
        ("and by distance", "ppm", 0.0..=1e3, 0.05, "", &mut one.range_ppm),
        (
            "σ of angles",
            "″",
            0.01..=3600.0,
            0.02,
            "Noise of a direction and of a zenith angle",
            &mut one.angle_arcsec,
        ),
        ("readings a second", "Hz", 0.5..=50.0, 0.05, "Of each station", &mut one.rate_hz),
        (
            "jitter of stamps",
            "ms",
            0.0..=100.0,
            0.05,
            "Random error of each time stamp",
            &mut one.stamp_jitter_ms,
        ),
    ] {
        changed |= field(ui, &Field { name, unit, range, speed, hint }, value);
    }
    changed
}

fn ground(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    heading(ui, "Ground and vehicle");
    let mut changed = false;
    let mut slope_deg = plan.ground.slope_rms_rad.to_degrees();
    let slope = Field {
        name: "slopes (rms)",
        unit: "°",
        range: 0.0..=28.0,
        speed: 0.02,
        hint: "Pitch and roll of the vehicle from the ground; they resolve the mirror ambiguity of heights",
    };
    if field(ui, &slope, &mut slope_deg) {
        plan.ground.slope_rms_rad = slope_deg.to_radians();
        changed = true;
    }
    for (name, unit, range, speed, hint, value) in [
        (
            "height of the ground",
            "m",
            -2e4..=2e4,
            0.02,
            "Its mean, in the frame of the stations",
            &mut plan.ground.height_m,
        ),
        (
            "speed",
            "m/s",
            0.01..=20.0,
            0.01,
            "Unless a waypoint sets its own",
            &mut plan.speed_m_per_s,
        ),
        (
            "tightest turn",
            "m",
            0.1..=100.0,
            0.02,
            "Radius of the vehicle's tightest turn",
            &mut plan.turn_radius_m,
        ),
    ] {
        changed |= field(ui, &Field { name, unit, range, speed, hint }, value);
    }
    for (index, ramp) in plan.ground.ramps.iter_mut().enumerate() {
        ui.label(format!("ramp {}", index + 1));
        ui.indent(("ramp", index), |ui| {
            let radius =
                Field { name: "radius", unit: "m", range: 0.5..=1000.0, speed: 0.02, hint: "" };
            changed |= field(ui, &radius, &mut ramp.radius_m);
            let highest = ramp.radius_m;
            let height = Field {
                name: "height",
                unit: "m",
                range: -highest..=highest,
                speed: 0.01,
                hint: "",
            };
            changed |= field(ui, &height, &mut ramp.height_m);
        });
    }
    changed
}

fn capitalised(name: &str) -> String {
    let (first, rest) = name.split_at(1);
    first.to_uppercase() + rest
}

/// Fields for the dimensions of figure-eights and loops; their places are moved in the map.
fn manoeuvres(ui: &mut egui::Ui, plan: &mut Plan) -> bool {
    let mut changed = false;
    let names: Vec<String> =
        (0..plan.way.len()).map(|piece| capitalised(&manoeuvre_name(plan, piece))).collect();
    for (index, piece) in plan.way.iter_mut().enumerate() {
        ui.push_id(("manoeuvre", index), |ui| match piece {
            Piece::Waypoints(_) => {}
            Piece::FigureEight(eight) => {
                heading(ui, &names[index]);
                let length = Field {
                    name: "length",
                    unit: "m",
                    range: 1.0..=1000.0,
                    speed: 0.05,
                    hint: "From tip to tip",
                };
                changed |= field(ui, &length, &mut eight.length_m);
                let mut times = f64::from(eight.times);
                let often = Field {
                    name: "how often",
                    unit: "×",
                    range: 1.0..=100.0,
                    speed: 0.05,
                    hint: "",
                };
                if field(ui, &often, &mut times) {
                    eight.times = times.round() as u32;
                    changed = true;
                }
            }
            Piece::Loop(one) => {
                heading(ui, &names[index]);
                let radius =
                    Field { name: "radius", unit: "m", range: 0.5..=1000.0, speed: 0.05, hint: "" };
                changed |= field(ui, &radius, &mut one.radius_m);
                let turns = Field {
                    name: "turns",
                    unit: "×",
                    range: 0.01..=100.0,
                    speed: 0.02,
                    hint: "How often around",
                };
                let side = one.turns.signum();
                let mut count = one.turns.abs();
                if field(ui, &turns, &mut count) {
                    one.turns = side * count;
                    changed = true;
                }
            }
        });
    }
    changed
}
