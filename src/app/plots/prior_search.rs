//! The paper's search of the prior: result of each speed limit τ_v, agreement of the runs, and the chosen run.

use egui_plot::{AxisHints, HoverPosition, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points};

use super::{GRID, LABELS, answer, in_the_middle, log_axis, round_marks};
use crate::app::model::{Commands, DeploymentCommand};
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::calibration::PriorMethod;
use resect_core::calibration::inter_prism::{PriorSearch, SearchRun};
use resect_tools::palette;

/// Names of the two steps of the search.
const STEPS: [&str; 2] = ["step 1", "step 2"];

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((_, _, answer)) = answer(state) else {
        in_the_middle(ui, "No result to plot.");
        return;
    };
    let search = answer.calibration.inter_prism().and_then(|d| d.prior_search.as_ref());
    let Some(search) = search else {
        let searches = answer.calibration.inter_prism().is_some();
        offer(ui, state, searches, commands);
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    caption(ui, search);
    let id = state.active().map(|open| (open.id, open.analysis_run));
    Plot::new(("prior search", id))
        .grid_spacing(GRID)
        .custom_x_axes(vec![
            AxisHints::new_x().label("speed limit τ_v (m/s)").label_spacing(LABELS),
        ])
        .x_grid_spacer(round_marks)
        .custom_y_axes(vec![
            AxisHints::new_y()
                .label("error (mm, log)")
                .formatter(|mark, _| log_axis::number(mark.value))
                .label_spacing(10.0..=22.0),
        ])
        .y_grid_spacer(log_axis::decades)
        .label_formatter(|position| match position {
            HoverPosition::NearDataPoint { plot_name, position, .. } => Some(format!(
                "{plot_name}\nτ_v {:.2} m/s\n{:.2} mm",
                position.x,
                10_f64.powf(position.y)
            )),
            HoverPosition::Elsewhere { .. } => None,
        })
        .show(ui, |plot_ui| {
            for (step, runs) in search.steps.iter().enumerate() {
                let colour = theme::rgb(palette::STEPS[step]);
                let name = |what: &str| format!("{}: {what}", STEPS[step]);
                let median = |run: &SearchRun| run.metric_m;
                // If both steps agree, the first is visible as a wider line about the second.
                let width = if step == 0 { 3.2 } else { 1.2 };
                plot_ui.line(
                    Line::new(name("cost (rms, triplets below τ_v)"), series(runs, |r| r.rms_m))
                        .color(colour.gamma_multiply(0.6))
                        .width(1.2)
                        .style(egui_plot::LineStyle::dashed_loose())
                        .allow_band(false),
                );
                plot_ui.line(
                    Line::new(name("metric (median, all triplets)"), series(runs, median))
                        .color(colour)
                        .width(width)
                        .allow_band(false),
                );
                for (counts, shape) in [(true, MarkerShape::Circle), (false, MarkerShape::Cross)] {
                    let some: Vec<SearchRun> =
                        runs.iter().filter(|run| run.counts() == counts).cloned().collect();
                    plot_ui.points(
                        Points::new("", series(&some, median))
                            .color(colour)
                            .shape(shape)
                            .radius(2.5 + width),
                    );
                }
                if let Some(best) = search.best[step] {
                    plot_ui.points(
                        Points::new("", series(&runs[best..=best], median))
                            .color(colour)
                            .filled(false)
                            .shape(MarkerShape::Circle)
                            .radius(8.0),
                    );
                }
            }
        });
}

fn series(runs: &[SearchRun], value_m: impl Fn(&SearchRun) -> f64) -> PlotPoints<'static> {
    let log_mm = |metres: f64| (metres * 1e3).max(1e-3).log10();
    let points = runs.iter().map(|run| PlotPoint::new(run.tau_v_m_per_s, log_mm(value_m(run))));
    PlotPoints::Owned(points.collect())
}

/// Shows the choice of each step, in its colour, and the legend.
fn caption(ui: &mut egui::Ui, search: &PriorSearch) {
    let dark = ui.visuals().dark_mode;
    let margin = egui::Margin::symmetric(6, 0);
    let framed = egui::Frame::new().inner_margin(margin);
    let texts = |ui: &mut egui::Ui| {
        for (index, runs) in search.steps.iter().enumerate() {
            let counted = runs.iter().filter(|run| run.counts()).count();
            let best = search.best[index].map_or("no run had enough triplets".to_owned(), |best| {
                let run = &runs[best];
                format!("chose τ_v {:.2} m/s, {:.2} mm", run.tau_v_m_per_s, run.metric_m * 1e3)
            });
            let text = format!("{}: {best}, {counted} of {} runs count", STEPS[index], runs.len());
            let colour = theme::readable(palette::STEPS[index], dark);
            ui.label(egui::RichText::new(text).small().color(colour)).on_hover_text(
                "A run counts if at least three others converge within 5 cm and 0.5° of it",
            );
        }
        let key = "solid: median of all triplets · dashed: cost (rms) of those below τ_v · cross: does not count · ring: chosen";
        words::explain_text(ui.small(key), key);
    };
    framed.show(ui, |ui| ui.horizontal_wrapped(texts));
}

/// Explains that the search runs only on request, and offers it.
fn offer(ui: &mut egui::Ui, state: &State, searches: bool, commands: &mut Commands) {
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() * 0.3);
        if !searches {
            ui.weak("No prior search: only method D and the joint estimate (inter-prism distances) have one.");
            return;
        }
        ui.label("The prior was computed in closed form, without a search.");
        if ui.button("Search as published").clicked() {
            let mut settings = *state.settings();
            settings.calibration.prior = PriorMethod::Search;
            commands.push(DeploymentCommand::Set(settings).into());
        }
    });
}
