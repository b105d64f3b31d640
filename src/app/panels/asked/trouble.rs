//! The reason why a dialog cannot continue.

use egui::RichText;

use crate::app::theme;
use resect_core::deployment::Severity;

/// Shows the reason as a problem.
pub fn trouble(ui: &mut egui::Ui, text: &str) {
    let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
    ui.label(RichText::new(format!("{sign} {text}")).color(colour));
}
