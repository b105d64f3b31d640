//! A row of differences between two results.

use egui::RichText;

use crate::app::panels::number_cell;
use crate::app::theme;
use crate::app::words;
use resect_core::deployment::Severity;
use resect_report::difference::Deviation;

/// Width of a number in σ (figures).
pub const IN_SIGMA: usize = 6;
/// Stations beside each other; the next ones have a table below, since the pane is narrow.
pub const BESIDE: usize = 2;
/// Beyond this many σ, a choice changes the result too much.
pub const NOTABLE_SIGMAS: f64 = 3.0;

/// Shows one quantity of each station but the first, each number also in σ.
pub fn difference_row(
    ui: &mut egui::Ui,
    name: &str,
    deviations: impl IntoIterator<Item = Deviation>,
    show: impl Fn(f64) -> String,
) {
    let (notable, _) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
    let label = words::explain_text(ui.label(name), name);
    if name.starts_with("distance") {
        label.on_hover_text("Distance between the two positions of the station");
    }
    for Deviation { value, sigmas } in deviations {
        number_cell(ui, show(value), 8);
        let text = sigmas.map_or("–".to_owned(), |sigmas| format!("{sigmas:.1}"));
        let text = RichText::new(text);
        let large = sigmas.is_some_and(|sigmas| sigmas > NOTABLE_SIGMAS);
        number_cell(ui, if large { text.color(notable).strong() } else { text }, IN_SIGMA);
    }
    ui.end_row();
}
