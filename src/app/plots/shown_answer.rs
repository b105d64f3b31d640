//! The answer that is plotted, or a sentence in its place.

use crate::app::model::OpenDeployment;
use crate::app::state::State;
use resect_core::analysis::{Analysis, Answer};

/// Shows a faint sentence where there is nothing else to show; its lines are not stretched, however narrow the pane is.
pub fn in_the_middle(ui: &mut egui::Ui, text: &str) {
    let height = ui.available_height();
    ui.vertical_centered(|ui| {
        ui.add_space(0.4 * height);
        ui.weak(text);
    });
    ui.allocate_space(ui.available_size());
}

/// The answer to plot, if there is one.
pub fn answer(state: &State) -> Option<(&OpenDeployment, &Analysis, &Answer)> {
    let (open, analysis) = state.analysed()?;
    Some((open, analysis, analysis.answer.as_deref().ok()?))
}

/// The answer whose errors of distances are to be plotted; where there is none, or there are no such errors, it says so.
pub fn answer_with_errors<'a>(
    ui: &mut egui::Ui,
    state: &'a State,
) -> Option<(&'a OpenDeployment, &'a Analysis, &'a Answer)> {
    let answer = answer(state);
    let has_errors = |answer: &Answer| {
        answer.evaluation.distance_errors_mm.iter().any(|errors| !errors.is_empty())
    };
    let why = match &answer {
        Some((.., answer)) if has_errors(answer) => None,
        Some((_, analysis, _)) if analysis.triplets().is_empty() => Some("No triplets to plot."),
        Some(_) => Some("The inter-prism distances are not known: there are no errors of them."),
        None => Some("No result to plot."),
    };
    let Some(why) = why else { return answer };
    in_the_middle(ui, why);
    None
}
