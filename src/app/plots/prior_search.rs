//! The paper's search of the prior: what each speed limit τ_v led to, which runs agreed, which was chosen.

use eframe::egui;
use egui_plot::{AxisHints, HoverPosition, Line, MarkerShape, Plot, PlotPoint, PlotPoints, Points};

use super::answer;
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::calibration::inter_prism::{PriorSearch, SearchRun};
use crate::calibration::{Method, PriorMethod};
use crate::palette;

/// The two steps.
const STEPS: [&str; 2] = ["step 1", "step 2"];

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some((_, _, answer)) = answer(state) else {
        ui.centered_and_justified(|ui| ui.weak("No result to plot."));
        return;
    };
    let search = answer.calibration.inter_prism().and_then(|d| d.prior_search.as_ref());
    let Some(search) = search else {
        offer(ui, state, answer.calibration.method, commands);
        return;
    };
    if state.is_stale() {
        ui.multiply_opacity(0.45);
    }
    ui.horizontal(|ui| {
        ui.add_space(6.0);
        ui.add(egui::Label::new(egui::RichText::new(caption(search)).small()).truncate());
    });
    let id = state.active().map(|open| (open.id, open.analysis_run));
    Plot::new(("prior search", id))
        .x_axis_label("speed limit τ_v (m/s)")
        .custom_y_axes(vec![
            AxisHints::new_y()
                .label("error (mm, log)")
                .formatter(|mark, _| decade(mark.value))
                .label_spacing(10.0..=22.0),
        ])
        // Lines at 1, 10, 100 mm and halfway between.
        .y_grid_spacer(egui_plot::uniform_grid_spacer(|_| [0.5, 1.0, 2.0]))
        .legend(egui_plot::Legend::default().position(egui_plot::Corner::RightTop))
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
                let colour = theme::rgb(palette::SERIES[step]);
                let name = |what: &str| format!("{}: {what}", STEPS[step]);
                let median = |run: &SearchRun| run.metric_m;
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
                        .width(1.4)
                        .allow_band(false),
                );
                for (counts, shape) in [(true, MarkerShape::Circle), (false, MarkerShape::Cross)] {
                    let some: Vec<SearchRun> =
                        runs.iter().filter(|run| run.counts() == counts).copied().collect();
                    plot_ui.points(
                        Points::new("", series(&some, median))
                            .color(colour)
                            .shape(shape)
                            .radius(3.5),
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

/// 1, 3, 10, 30, … for the powers of ten and halfway between.
fn decade(log10: f64) -> String {
    let value = 10_f64.powf(log10);
    let round = if log10.fract() == 0.0 { value } else { 3.0 * 10_f64.powf(log10.floor()) };
    if round < 1.0 { format!("{round:.1}") } else { format!("{round:.0}") }
}

/// "step 1: best at τ_v 0.41 m/s, 9 of 12 runs agree with others …".
fn caption(search: &PriorSearch) -> String {
    let step = |index: usize| {
        let runs = &search.steps[index];
        let agreeing = runs.iter().filter(|run| run.counts()).count();
        let best = search.best[index].map_or("no run had enough triplets".to_owned(), |best| {
            let run = &runs[best];
            format!("chose τ_v {:.2} m/s, {:.2} mm", run.tau_v_m_per_s, run.metric_m * 1e3)
        });
        format!("{}: {best}, {agreeing} of {} runs count", STEPS[index], runs.len())
    };
    let rule =
        "dots count (at least three others agree within 5 cm, 0.5°), crosses do not; ring: chosen";
    format!("{}  ·  {}  ·  {rule}", step(0), step(1))
}

/// The search runs only where it is asked for.
fn offer(ui: &mut egui::Ui, state: &State, method: Method, commands: &mut Commands) {
    ui.vertical_centered(|ui| {
        ui.add_space(ui.available_height() * 0.3);
        if method != Method::InterPrism {
            ui.weak("The prior is searched for method D only.");
            return;
        }
        ui.label("The prior came in closed form, without a search.");
        if ui.button("Search as published").clicked() {
            let mut settings = *state.settings();
            settings.calibration.prior = PriorMethod::Search;
            commands.push(Command::Set(settings));
        }
    });
}
