//! σ at the far end of the track during the drive, compared with the target.

use egui::{Color32, RichText};
use egui_plot::{AxisHints, HLine, Line, Plot, PlotPoints};

use super::{GRID, log_axis};
use crate::app::theme;
use resect_core::calibration::Verdict;
use resect_live::View;
use resect_live::coach::Curve;
use resect_tools::palette;

const MM: f64 = 1e3;
/// Limit of the curve as a multiple of the target. The first results may be wrong by metres; without the limit, the target would be hard to
/// see.
const MOST_TARGETS: f64 = 300.0;
/// Least range: this duration (s), and half the target to ten times the target.
const SHORTEST_S: f64 = 30.0;

/// Plots σ of the result with the user's settings over that with the paper's, and the target as a line.
pub fn ui(ui: &mut egui::Ui, view: &View, height: f32) {
    let dark = ui.visuals().dark_mode;
    let firsts = view.curves.iter().filter_map(|curve| Some(curve.points.first()?.time_s));
    let from_s = firsts.min_by(f64::total_cmp).unwrap_or(0.0);
    let target_mm = view.target_m * MM;
    let points = |curve: &Curve| -> PlotPoints<'static> {
        let shown = curve.points.iter().map(|point| {
            let sigma_mm = (point.sigma_m * MM).min(target_mm * MOST_TARGETS);
            [point.time_s - from_s, sigma_mm.log10()]
        });
        shown.collect()
    };
    let y_axis = AxisHints::new_y()
        .label("σ at the far end (mm)")
        .formatter(|mark, _| log_axis::number(mark.value));
    let x_axis = AxisHints::new_x()
        .label("time since the first result")
        .formatter(|mark, _| format!("{:.0} s", mark.value));
    let plot = Plot::new("sigma over the drive")
        .height(height)
        // The grid is fainter than the curve.
        .grid_spacing(GRID)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .show_x(false)
        .show_y(false)
        .include_x(0.0)
        .include_x(SHORTEST_S)
        .include_y((target_mm / 2.0).log10())
        .include_y((target_mm * 10.0).log10())
        .y_grid_spacer(log_axis::many_decades)
        .custom_y_axes(vec![y_axis])
        .custom_x_axes(vec![x_axis]);
    plot.show(ui, |plot| {
        plot.hline(HLine::new("target", target_mm.log10()).color(aim(dark)).width(2.0));
        let published = Line::new("the paper's answer", points(&view.curves[0]));
        plot.line(published.color(theme::faint(dark)).width(1.5));
        plot.line(Line::new("answer", points(&view.curves[1])).color(ink(dark)).width(3.0));
    });
}

/// Shows the legend of the lines.
pub fn legend(ui: &mut egui::Ui, view: &View) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        let line = |ui: &mut egui::Ui, colour: Color32, words: &str| {
            ui.label(RichText::new("—").color(colour).strong());
            ui.label(words);
        };
        line(ui, ink(dark), "σ at the far end of the track");
        line(ui, theme::faint(dark), "with the paper's settings");
        line(ui, aim(dark), &format!("target {:.1} mm", view.target_m * MM));
    });
}

fn ink(dark: bool) -> Color32 {
    theme::rgb(theme::cursor(dark))
}

fn aim(dark: bool) -> Color32 {
    theme::readable(palette::verdict(Verdict::Good)[0], dark)
}
