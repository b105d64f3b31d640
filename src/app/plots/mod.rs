//! Plots of the distance errors.

pub mod histogram;
pub mod residuals;

use eframe::egui;

use crate::analysis::{Analysis, Answer};
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::deployment::pair_label;
use crate::palette;

/// The answer to plot, if there is one.
fn answer(state: &State) -> Option<(&Analysis, &Answer)> {
    let analysis = state.analysis.as_deref()?;
    Some((analysis, analysis.answer.as_deref().ok()?))
}

/// The legend as a line of switches above a plot, where it covers no data.
fn pair_switches(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut visibility = state.visibility;
    let dark = ui.visuals().dark_mode;
    for (pair, on) in visibility.pairs.iter_mut().enumerate() {
        ui.checkbox(on, pair_name(pair, dark)).on_hover_text("Show or hide this pair of prisms");
    }
    if visibility != state.visibility {
        commands.push(Command::Show(visibility));
    }
}

/// "1–2" in the pair's colour.
fn pair_name(pair: usize, dark: bool) -> egui::RichText {
    egui::RichText::new(pair_label(pair))
        .color(theme::readable(palette::PAIRS[pair], dark))
        .strong()
}

/// Half the range that shows nearly all errors (mm): outliers must not squeeze the rest into a line.
fn half_range_mm(answer: &Answer) -> f64 {
    let mut sizes: Vec<f64> =
        answer.evaluation.distance_errors_mm.iter().flatten().map(|e| e.abs()).collect();
    if sizes.is_empty() {
        return 1.0;
    }
    let index = (sizes.len() as f64 * 0.985) as usize;
    let index = index.min(sizes.len() - 1);
    (*sizes.select_nth_unstable_by(index, f64::total_cmp).1 * 1.15).max(0.5)
}
