//! Plots of the distance errors.

pub mod histogram;
pub mod residuals;

use crate::analysis::{Analysis, Answer};
use crate::app::state::State;

/// The answer to plot, if there is one.
fn answer(state: &State) -> Option<(&Analysis, &Answer)> {
    let analysis = state.analysis.as_deref()?;
    Some((analysis, analysis.answer.as_deref().ok()?))
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
