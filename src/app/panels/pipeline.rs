//! The four modules of the pipeline as in the paper's figure (solid frame required, dotted optional), and the
//! calibration they feed.

use std::ops::RangeInclusive;

use egui::{Shape, Stroke};

use super::scrolled;
use crate::app::model::{AngleUnit, Commands, DeploymentCommand, SettingFocus, WorkspaceCommand};
use crate::app::state::State;
use crate::app::words;
use resect_core::analysis::{Analysis, Settings};
use resect_core::calibration::{
    Alignment, CalibrationSettings, Evidence, Method, Offer, PriorMethod, SIGMA_DISTANCES,
};
use resect_core::deployment::Deployment;
use resect_core::network::Prism;
use resect_core::number_setting::NumberSetting;
use resect_core::pipeline::{
    Interpolation, Interval, PipelineSettings, RATE, SampleFate, TAU_A, TAU_E, TAU_L, TAU_R, TAU_S,
};
use resect_report::glossary;
use resect_report::glossary::Term;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let mut settings = *state.settings();
        let counts =
            state.analysed().map(|(open, analysis)| Counts::of(&open.deployment, analysis));
        let default = settings == Settings::default();
        if ui
            .add_enabled(!default, egui::Button::new("Reset to the defaults"))
            .on_hover_text("The paper's values for the pipeline, and the joint estimate")
            .on_disabled_hover_text("These are the defaults: the paper's values for the pipeline, and the joint estimate")
            .clicked()
        {
            settings = Settings::default();
        }
        let sliders = Sliders {
            angle: state.workspace.units.angle,
            focused: state.workspace.focused_setting,
        };
        modules(ui, &mut settings, counts.as_ref(), sliders);
        let offer = state.analysed().map(|(_, analysis)| &analysis.offer);
        let missing = missing_evidence(state.active().map(|open| &*open.deployment), offer);
        calibration(ui, &mut settings.calibration, sliders, (offer, missing));
        if let Some(focused) = sliders.focused {
            commands.push(WorkspaceCommand::SettingFocused(focused).into());
        }
        if settings != *state.settings() {
            commands.push(DeploymentCommand::Set(settings).into());
        }
    });
}

/// Unit of angles in the sliders, and the number that gets the focus.
#[derive(Clone, Copy)]
struct Sliders {
    angle: AngleUnit,
    focused: Option<SettingFocus>,
}

/// Counts before and after each module.
struct Counts {
    /// Raw readings except those excluded by the user.
    raw: usize,
    left_out: usize,
    filtered: usize,
    split: usize,
    kept: usize,
    kept_seconds: f64,
    triplets: usize,
}

impl Counts {
    fn of(deployment: &Deployment, analysis: &Analysis) -> Self {
        let out = &analysis.pipeline;
        let stations = out.fates.len();
        let rejected: usize = SampleFate::ALL
            .into_iter()
            .filter(|fate| matches!(fate, SampleFate::Rejected(_)))
            .map(|fate| (0..stations).map(|station| out.count(station, fate)).sum::<usize>())
            .sum();
        let all: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
        let left_out = (0..stations).map(|station| out.count(station, SampleFate::LeftOut)).sum();
        let raw = all - left_out;
        Self {
            raw,
            left_out,
            filtered: raw - rejected,
            split: out.intervals.len(),
            kept: out.kept_intervals.len(),
            kept_seconds: out.kept_intervals.iter().map(Interval::length_s).sum(),
            triplets: out.triplets.len(),
        }
    }
}

fn modules(ui: &mut egui::Ui, settings: &mut Settings, counts: Option<&Counts>, sliders: Sliders) {
    outlier_filter(ui, &mut settings.pipeline, counts, sliders);
    intervals(ui, &mut settings.pipeline, counts, sliders);
    interpolation(ui, &mut settings.pipeline, counts, sliders);
    ui.checkbox(&mut settings.pipeline.all_readings, "Joint estimate: all readings").on_hover_text(
        "The joint estimate takes all readings and finds outliers itself. Otherwise it takes those of the kept intervals",
    );
}

/// Shows the counts below a module; a dash until there are any.
fn counted(ui: &mut egui::Ui, counts: Option<&Counts>, text: impl FnOnce(&Counts) -> String) {
    ui.small(counts.map_or_else(|| "–".to_owned(), text));
}

fn outlier_filter(
    ui: &mut egui::Ui,
    settings: &mut PipelineSettings,
    counts: Option<&Counts>,
    sliders: Sliders,
) {
    let mut on = settings.outlier_filter;
    module(ui, Some(&mut on), "1  Outlier filter", |ui, on| {
        ui.add_enabled_ui(on, |ui| {
            number_slider(ui, (&TAU_R, &glossary::TAU_R), settings, sliders);
            number_slider(ui, (&TAU_A, &glossary::TAU_A), settings, sliders);
            number_slider(ui, (&TAU_E, &glossary::TAU_E), settings, sliders);
        });
        counted(ui, counts, |c| match c.left_out {
            0 => format!("{} → {} readings", c.raw, c.filtered),
            left_out => {
                format!("{} → {} readings ({left_out} left out by hand)", c.raw, c.filtered)
            }
        });
    });
    settings.outlier_filter = on;
}

fn intervals(
    ui: &mut egui::Ui,
    settings: &mut PipelineSettings,
    counts: Option<&Counts>,
    sliders: Sliders,
) {
    module(ui, None, "2  Interval split", |ui, _| {
        number_slider(ui, (&TAU_S, &glossary::TAU_S), settings, sliders);
        counted(ui, counts, |c| format!("{} readings → {} intervals", c.filtered, c.split));
    });
    let mut on = settings.interval_filter;
    module(ui, Some(&mut on), "3  Interval filter", |ui, on| {
        ui.add_enabled_ui(on, |ui| {
            number_slider(ui, (&TAU_L, &glossary::TAU_L), settings, sliders);
        });
        // The sum of an empty list is -0.
        counted(ui, counts, |c| {
            format!("{} → {} intervals ({:.0} s)", c.split, c.kept, c.kept_seconds + 0.0)
        });
    });
    settings.interval_filter = on;
}

fn interpolation(
    ui: &mut egui::Ui,
    settings: &mut PipelineSettings,
    counts: Option<&Counts>,
    sliders: Sliders,
) {
    module(ui, None, "4  Interpolation", |ui, _| {
        ui.horizontal_wrapped(|ui| {
            for choice in Interpolation::ALL {
                let hint = match choice {
                    Interpolation::Linear => "Straight lines between readings, as published",
                    Interpolation::Gp => {
                        "Gaussian process, squared-exponential kernel, noise learned: for smooth driving"
                    }
                    Interpolation::Wnoa => {
                        "Gaussian process, white noise on acceleration: also for stops and turns"
                    }
                };
                ui.radio_value(&mut settings.interpolation, choice, choice.title()).on_hover_text(hint);
            }
        });
        number_slider(ui, (&RATE, &glossary::TRIPLET), settings, sliders);
        counted(ui, counts, |c| format!("{} intervals → {} triplets", c.kept, c.triplets));
    });
}

/// Shows the methods, enabling those that the data allow, and the options of the chosen one.
fn calibration(
    ui: &mut egui::Ui,
    settings: &mut CalibrationSettings,
    sliders: Sliders,
    (offer, missing): (Option<&Offer>, MissingEvidence),
) {
    module(ui, None, "Calibration", |ui, _| {
        let default = Method::default();
        let mut method = settings.method.unwrap_or_default();
        for choice in Method::ALL {
            let lack = offer.and_then(|offer| offer.lack(choice));
            ui.add_enabled_ui(lack.is_none(), |ui| {
                let radio = ui.radio_value(&mut method, choice, choice.label());
                let radio = words::explain(radio, words::of_method(choice));
                radio.on_disabled_hover_text(format!("Needs {}", lack.unwrap_or_default()));
            });
        }
        // The default method is stored as no choice.
        if method != settings.method.unwrap_or_default() {
            settings.method = (method != default).then_some(method);
        }
        match method {
            Method::TwoPoint => {}
            // With one prism there are no distances.
            Method::Joint if offer.is_some_and(|offer| Prism::is_one(&offer.followed)) => {}
            Method::StaticGcp | Method::DynamicGcp => {
                ui.horizontal(|ui| {
                    words::explain(ui.label("alignment"), &glossary::LEVEL);
                    ui.radio_value(&mut settings.alignment, Alignment::Level, "level")
                        .on_hover_text("Translation and yaw: the stations are levelled");
                    ui.radio_value(&mut settings.alignment, Alignment::Rigid, "rigid")
                        .on_hover_text("Roll and pitch as well");
                });
            }
            Method::InterPrism | Method::Joint => {
                ui.horizontal(|ui| {
                    words::explain(ui.label("prior"), &glossary::PRIOR);
                    ui.radio_value(&mut settings.prior, PriorMethod::ClosedForm, "closed form")
                        .on_hover_text("Lifted linear least squares: needs no initial guess");
                    ui.radio_value(&mut settings.prior, PriorMethod::Search, "search").on_hover_text(
                        "The paper's two-step search over the speed limit τ_v; see Prior search",
                    );
                });
                let distances = (&SIGMA_DISTANCES, &glossary::SIGMA_DISTANCES);
                number_slider(ui, distances, settings, sliders).on_hover_text(
                    "σ of the given inter-prism distances; it increases every σ of the result",
                );
            }
        }
        if method == Method::Joint {
            evidence(ui, &mut settings.evidence, missing);
        }
    });
}

/// Reason why the data lacks each group of measurements, in the order of [`Evidence::NAMES`]; `None` if the data has it.
type MissingEvidence = [Option<&'static str>; Evidence::NAMES.len()];

fn missing_evidence(deployment: Option<&Deployment>, offer: Option<&Offer>) -> MissingEvidence {
    let Some(deployment) = deployment else { return MissingEvidence::default() };
    let control_points =
        deployment.control_points.is_empty().then_some("The deployment has no control points");
    let rig = if offer.is_some_and(|offer| Prism::is_one(&offer.followed)) {
        Some("One prism has no inter-prism distances")
    } else {
        deployment.rig.is_none().then_some("The inter-prism distances are unknown")
    };
    [None, control_points, rig]
}

/// Shows a switch for each group of measurements. The last of drive and control points cannot be switched off.
fn evidence(ui: &mut egui::Ui, evidence: &mut Evidence, missing: MissingEvidence) {
    const GROUPS: [(&str, &str); Evidence::NAMES.len()] = [
        ("drive", "Readings of the prisms while the vehicle drives"),
        ("control points", "Readings of static points by all stations"),
        ("rig distances", "Inter-prism distances as measured on the vehicle"),
    ];
    // The rig alone determines no transform.
    let determining = evidence.switches().map(|on| *on).into_iter().zip(missing).take(2);
    let is_single = determining.filter(|(on, missing)| *on && missing.is_none()).count() == 1;
    ui.horizontal_wrapped(|ui| {
        ui.label("evidence").on_hover_text("Measurements that the joint estimate uses");
        let groups = GROUPS.into_iter().zip(evidence.switches()).zip(missing);
        for (index, (((name, meaning), on), missing)) in groups.enumerate() {
            let is_last = *on && is_single && index < 2;
            let lock = missing.or(is_last.then_some("The drive or the control points stay on"));
            let is_enabled = lock.is_none();
            let switch = ui.add_enabled(is_enabled, egui::Checkbox::new(on, name));
            let (role, label) = (egui::Role::CheckBox, format!("evidence: {name}"));
            switch.widget_info(|| egui::WidgetInfo::selected(role, is_enabled, *on, &label));
            switch.on_hover_text(meaning).on_disabled_hover_text(lock.unwrap_or_default());
        }
    });
}

/// Draws a frame with a title: dotted and with a switch if the module is optional.
fn module(
    ui: &mut egui::Ui,
    switch: Option<&mut bool>,
    title: &str,
    add: impl FnOnce(&mut egui::Ui, bool),
) {
    let optional = switch.is_some();
    let frame = egui::Frame::new().inner_margin(egui::Margin::symmetric(8, 6));
    let inner = frame.show(ui, |ui| {
        ui.set_width(ui.available_width());
        let on = match switch {
            Some(on) => {
                let text = egui::RichText::new(title).strong();
                words::explain_text(ui.checkbox(on, text), title);
                *on
            }
            None => {
                words::explain_text(ui.strong(title), title);
                true
            }
        };
        add(ui, on);
    });
    let rect = inner.response.rect.shrink(0.5);
    let stroke = Stroke::new(
        1.0,
        ui.visuals()
            .widgets
            .noninteractive
            .bg_stroke
            .color
            .lerp_to_gamma(ui.visuals().text_color(), 0.25),
    );
    if optional {
        let corners = [
            rect.left_top(),
            rect.right_top(),
            rect.right_bottom(),
            rect.left_bottom(),
            rect.left_top(),
        ];
        ui.painter().extend(Shape::dashed_line(&corners, stroke, 2.0, 3.0));
    } else {
        ui.painter().rect_stroke(rect, 2.0, stroke, egui::StrokeKind::Middle);
    }
}

/// A slider for a number of the settings; angular rates are in the user's unit.
fn number_slider<S: Copy + Default>(
    ui: &mut egui::Ui,
    (setting, term): (&NumberSetting<S>, &'static Term),
    settings: &mut S,
    sliders: Sliders,
) -> egui::Response {
    let (unit, per) = sliders.angle.of_setting(setting.unit);
    let before = setting.shown(settings) * per;
    let mut value = before;
    let [least, most] = setting.slider;
    let unit = format!(" {unit}");
    let default = setting.default_shown() * per;
    if sliders.focused == Some(SettingFocus::Field(setting.key)) {
        ui.memory_mut(|memory| memory.move_focus(egui::FocusDirection::Next));
    }
    let response = threshold(ui, (setting.label, term), &mut value, least..=most, &unit, default);
    if value != before {
        let shown = value / per;
        // Rounds off the noise of the unit conversion.
        let shown = if per == 1.0 { shown } else { (shown * 1e6).round() / 1e6 };
        *(setting.field)(settings) = shown / setting.per_stored;
    }
    if sliders.focused == Some(SettingFocus::Handle(setting.key)) {
        response.request_focus();
        response.scroll_to_me(None);
    }
    response
}

/// A slider with unit and typed entry; a right click restores the paper's value.
fn threshold(
    ui: &mut egui::Ui,
    (name, term): (&str, &'static Term),
    value: &mut f64,
    range: RangeInclusive<f64>,
    unit: &str,
    paper: f64,
) -> egui::Response {
    ui.horizontal(|ui| {
        let name_size = egui::vec2(76.0, ui.spacing().interact_size.y);
        let left = egui::Layout::left_to_right(egui::Align::Center);
        let label = ui.allocate_ui_with_layout(name_size, left, |ui| {
            ui.set_min_width(name_size.x);
            words::explain(ui.label(name), term)
        });
        ui.spacing_mut().slider_width = (ui.available_width() - 84.0).max(40.0);
        let field =
            super::number::field(ui, (name, unit), value, range.clone(), |ui, value, parse| {
                let slider = egui::Slider::new(value, range)
                    .logarithmic(true)
                    .smallest_positive(0.05)
                    .max_decimals(2)
                    .custom_formatter(super::number::shown)
                    .clamping(egui::SliderClamping::Edits)
                    .custom_parser(parse)
                    .suffix(unit);
                ui.add(slider)
            });
        let response = field.labelled_by(label.inner.id);
        if response.secondary_clicked() {
            *value = paper;
        }
        words::mark(&response, &[term]);
        response.on_hover_text(format!(
            "Paper: {}{unit} (right click). Drag, or click the number to type.",
            (paper * 1e4).round() / 1e4
        ))
    })
    .inner
}
