//! Plots of the distance errors.

pub mod chart;
pub mod histogram;
mod prepared;
pub mod prior_search;
pub mod residuals;

pub use prepared::PreparedPlots;

use eframe::egui;

use crate::analysis::{Analysis, Answer};
use crate::app::open_deployment::OpenDeployment;
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::deployment::pair_label;
use crate::palette;

/// The answer to plot, if there is one.
fn answer(state: &State) -> Option<(&OpenDeployment, &Analysis, &Answer)> {
    let (open, analysis) = state.analysed()?;
    Some((open, analysis, analysis.answer.as_deref().ok()?))
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
