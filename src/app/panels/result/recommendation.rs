//! The recommendation: the answer to use, the reason, and the next step.

use egui::{Label, RichText};

use crate::app::model::Units;
use crate::app::model::units::unbroken;
use crate::app::words;
use resect_core::calibration::{Calibration, recommend};
use resect_core::deployment::Deployment;

/// Shows the recommendation, a sentence on each line.
pub fn ui(ui: &mut egui::Ui, calibration: &Calibration, deployment: &Deployment, units: Units) {
    let recommendation = recommend(calibration, deployment);
    let [conclusion, reason, next_step] = recommendation.sentences(|angle| units.told(angle));
    ui.add(Label::new(RichText::new(&conclusion).strong()).wrap());
    for sentence in [reason, next_step] {
        let label = ui.add(Label::new(unbroken(&sentence)).wrap());
        words::explain_text(label, &sentence);
    }
}
