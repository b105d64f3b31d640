//! The recommendation: the answer to use, the reason, and the next step.

use egui::{Label, RichText};

use super::super::remedies_of;
use crate::app::model::Commands;
use crate::app::model::units::unbroken;
use crate::app::state::State;
use crate::app::words;
use resect_core::calibration::{Recommendation, RecommendationProof};
use resect_core::deployment::Finding;

/// Shows the recommendation, a sentence on each line, and the buttons of the finding that it states.
pub fn ui(
    ui: &mut egui::Ui,
    state: &State,
    recommendation: &Recommendation,
    commands: &mut Commands,
) {
    let units = state.workspace.units;
    let [conclusion, reason, next_step] = recommendation.sentences(|angle| units.told(angle));
    ui.add(Label::new(RichText::new(&conclusion).strong()).wrap());
    let stated = stated(recommendation);
    for (sentence, stated) in [(reason, stated), (next_step, None)] {
        let label = ui.add(Label::new(unbroken(&sentence)).wrap());
        let label = match stated {
            Some(finding) => label.on_hover_text(units.message(finding)),
            None => label,
        };
        words::explain_text(label, &sentence);
    }
    if let Some(finding) = stated {
        remedies_of(ui, state, finding, commands);
    }
}

/// Returns the finding that a recommendation states, which the list of findings below need not repeat.
pub fn stated(recommendation: &Recommendation) -> Option<&Finding> {
    match &recommendation.proof {
        RecommendationProof::Finding(finding) => Some(finding),
        RecommendationProof::LargestSigma { .. } | RecommendationProof::Unobservable(_) => None,
    }
}
