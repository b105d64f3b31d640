//! The result to plot, or a sentence in its place.

use crate::app::model::OpenDeployment;
use crate::app::state::State;
use resect_core::analysis::{Analysis, Answer};

/// Shows a faint sentence in an empty pane, with normal word spacing in a narrow one.
pub fn in_the_middle(ui: &mut egui::Ui, text: &str) {
    let height = ui.available_height();
    ui.vertical_centered(|ui| {
        ui.add_space(0.4 * height);
        ui.weak(text);
    });
    ui.allocate_space(ui.available_size());
}

/// Returns the result to plot; `None` if there is none.
pub fn answer(state: &State) -> Option<(&OpenDeployment, &Analysis, &Answer)> {
    let (open, analysis) = state.analysed()?;
    Some((open, analysis, analysis.answer.as_deref().ok()?))
}

/// Returns the result whose distance errors are plotted; without one, shows the reason and returns `None`.
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
        Some((_, analysis, _)) if analysis.offer.followed.len() == 1 => {
            Some("No distance errors: they need two stations.")
        }
        Some(_) => Some("No distance errors: the inter-prism distances are not known."),
        None => Some("No result to plot."),
    };
    let Some(why) = why else { return answer };
    in_the_middle(ui, why);
    None
}
