//! Studies of the paper: options, progress, and the chart of the result.

use super::{MARGIN, finding, number, scrolled};
use crate::app::model::studies::{StudyKind, StudyOptions};
use crate::app::model::{Commands, ResultsCommand};
use crate::app::plots::{chart, in_the_middle};
use crate::app::state::State;
use crate::app::words;
use resect_core::calibration::Method;
use resect_report::box_chart;
use resect_tools::experiment::{Parameter, Sweep};

const OPTIONS_WIDTH: f32 = 256.0;
const NARROW_WIDTH: f32 = 600.0;
/// Least height of the picture in a narrow pane (points), limited to a share of the pane's height. Options that need more than the rest
/// scroll.
const LEAST_PICTURE: f32 = 300.0;
const MOST_PICTURE: f32 = 0.7;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    if state.workspace.picturing {
        picture(ui, state);
        return;
    }
    let whole = ui.available_rect_before_wrap();
    // In a narrow pane, the picture takes the whole width, and the options have the height of the last frame.
    let id = ui.scope_id().with("options");
    let drawn: f32 = ui.data(|data| data.get_temp(id)).unwrap_or(0.0);
    let (first, second) = if whole.width() < NARROW_WIDTH {
        let most = whole.height() - LEAST_PICTURE.min(MOST_PICTURE * whole.height());
        whole.split_top_bottom_at_y(whole.top() + drawn.min(most))
    } else {
        whole.split_left_right_at_x(whole.left() + OPTIONS_WIDTH)
    };
    let column = |rect| {
        egui::UiBuilder::new().max_rect(rect).layout(egui::Layout::top_down(egui::Align::Min))
    };
    ui.scope_builder(column(first), |ui| {
        scrolled(ui, |ui| {
            options(ui, state, commands);
            let height = ui.min_rect().height() + 2.0 * MARGIN;
            if (height - drawn).abs() > 0.5 {
                ui.data_mut(|data| data.insert_temp(id, height));
                ui.ctx().request_repaint();
            }
        });
    });
    ui.scope_builder(column(second), |ui| picture(ui, state));
}

fn options(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut options = state.results.studies.options;
    ui.horizontal_wrapped(|ui| {
        for kind in StudyKind::ALL {
            let radio = ui.radio_value(&mut options.kind, kind, kind.title());
            words::explain_text(radio, kind.title());
        }
    });
    run_or_cancel(ui, state, commands);
    ui.separator();
    ui.horizontal_wrapped(|ui| {
        ui.label("on");
        ui.radio_value(&mut options.all_open, false, "the active one");
        ui.radio_value(
            &mut options.all_open,
            true,
            format!("all open ({})", state.deployments.open.len()),
        )
        .on_hover_text("All use the settings of the active deployment");
    });
    if options.kind.is_sweep() {
        sweep(ui, &mut options.sweep);
    }
    if options.kind.has_reference() {
        reference(ui, &mut options);
    }
    if options.kind != StudyKind::Answers {
        splits(ui, &mut options);
    }
    if options != state.results.studies.options {
        commands.push(ResultsCommand::SetStudy(options).into());
    }
    if let Some(result) = &state.results.studies.result {
        ui.separator();
        for one in &result.study().findings {
            finding(ui, state, one, commands);
        }
    }
}

/// Shows the Run or Cancel button above the options, so that a small pane shows it too.
fn run_or_cancel(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let options = &state.results.studies.options;
    match &state.results.studies.running {
        Some((_, progress)) => {
            // In the line of Run, so that nothing moves under the pointer when the study ends.
            ui.horizontal(|ui| {
                if ui.button("Cancel").clicked() {
                    commands.push(ResultsCommand::CancelStudy.into());
                }
                ui.add(egui::ProgressBar::new(progress.share().unwrap_or(0.0)).show_percentage());
            });
        }
        None => {
            ui.horizontal(|ui| {
                let settings = &state.settings().pipeline;
                let is_sweep = options.kind.is_sweep();
                let wrong = is_sweep.then(|| options.sweep.check(settings).err()).flatten();
                let wrong = wrong.or_else(|| {
                    state.deployments.open.is_empty().then(|| "Nothing is open".to_owned())
                });
                let run = ui.add_enabled(wrong.is_none(), egui::Button::new("Run"));
                if let Some(wrong) = wrong {
                    run.on_disabled_hover_text(wrong);
                } else if run.clicked() {
                    commands.push(ResultsCommand::RunStudy.into());
                }
                let save = egui::Button::new("Save…");
                if ui
                    .add_enabled(state.results.studies.result.is_some(), save)
                    .on_hover_text("CSV, SVG and PNG into a folder")
                    .clicked()
                {
                    commands.push(ResultsCommand::SaveStudyDialog.into());
                }
            });
        }
    }
}

fn sweep(ui: &mut egui::Ui, sweep: &mut Sweep) {
    egui::ComboBox::from_id_salt("parameter")
        .selected_text(sweep.parameter.setting().title)
        .width(180.0)
        .show_ui(ui, |ui| {
            for parameter in Parameter::ALL {
                ui.selectable_value(&mut sweep.parameter, parameter, parameter.setting().title);
            }
        });
    let unit = format!(" {}", sweep.parameter.setting().unit);
    ui.horizontal_wrapped(|ui| {
        for (name, value) in [("from", &mut sweep.from), ("to", &mut sweep.to)] {
            let label = ui.label(name);
            number::field(ui, (name, &unit), value, StudyOptions::ENDS, |ui, value, parse| {
                let number = egui::DragValue::new(value).speed(0.05).range(StudyOptions::ENDS);
                let number = number.custom_parser(parse).custom_formatter(number::shown);
                ui.add(number.suffix(unit.as_str()))
            })
            .labelled_by(label.id);
        }
        let label = ui.label("in");
        let (steps, range) = (&mut sweep.steps, StudyOptions::STEPS);
        number::field(ui, ("in", "steps"), steps, range.clone(), |ui, steps, parse| {
            let steps = egui::DragValue::new(steps).range(range).suffix(" steps");
            ui.add(steps.custom_parser(parse))
        })
        .labelled_by(label.id);
    });
}

/// Shows the options of the random splits.
fn splits(ui: &mut egui::Ui, options: &mut StudyOptions) {
    ui.horizontal(|ui| {
        ui.checkbox(&mut options.split, "75 % splits,").on_hover_text(
            "Calibrates with a random 75 % of the data and evaluates on the rest, split in segments of 5 s",
        );
        ui.add_enabled_ui(options.split, |ui| {
            let (repeats, range) = (&mut options.splits.repeats, StudyOptions::REPEATS);
            number::field(ui, ("Repeats", "repeats"), repeats, range, |ui, repeats, parse| {
                let repeats =
                    egui::DragValue::new(repeats).range(StudyOptions::REPEATS).suffix(" repeats");
                ui.add(repeats.custom_parser(parse))
            })
            .on_hover_text("Repeats");
        });
    });
    if options.split {
        ui.horizontal(|ui| {
            let label = ui.label("seed");
            let seed = &mut options.splits.seed;
            number::field(ui, ("seed", ""), seed, StudyOptions::SEEDS, |ui, seed, parse| {
                let seed = egui::DragValue::new(seed).range(StudyOptions::SEEDS);
                ui.add(seed.custom_parser(parse))
            })
            .labelled_by(label.id);
        });
    }
}

fn reference(ui: &mut egui::Ui, options: &mut StudyOptions) {
    let name =
        |method: Option<Method>| method.map_or("B if possible (paper)".to_owned(), Method::label);
    ui.horizontal(|ui| {
        ui.label("evaluated with").on_hover_text("Transforms used to compute the errors");
        egui::ComboBox::from_id_salt("reference")
            .selected_text(name(options.reference))
            .width(140.0)
            .show_ui(ui, |ui| {
                for method in std::iter::once(None).chain(Method::ALL.map(Some)) {
                    ui.selectable_value(&mut options.reference, method, name(method));
                }
            });
    });
}

fn picture(ui: &mut egui::Ui, state: &State) {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), egui::Sense::hover());
    let Some(result) = &state.results.studies.result else {
        let text = "Choose a study and run it: box plots as in the paper appear here.";
        in_the_middle(&mut ui.new_child(egui::UiBuilder::new().max_rect(rect)), text);
        return;
    };
    let study = result.study();
    response.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Image, true, &study.title));
    let painter = ui.painter_at(rect);
    if state.results.studies.running.is_some() {
        ui.multiply_opacity(0.45);
    }
    // Findings of the study are among the options, with their advice.
    let size = [rect.width().max(200.0), rect.height().max(150.0)];
    let laid_out = box_chart::lay_out(study, &[], size);
    chart::paint(&painter, rect, &laid_out.drawing, ui.visuals().dark_mode);
    let at = response.hover_pos().map(|at| at - rect.min);
    if let Some(said) = at.and_then(|at| laid_out.said_at(study, at.into())) {
        response.on_hover_text_at_pointer(said);
    }
}
