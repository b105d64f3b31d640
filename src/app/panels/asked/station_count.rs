//! The number of stations in a question about topics or files.

use crate::app::panels::fewer_or_more;
use resect_core::network::MOST_STATIONS;

/// Lets the user choose the number of stations, each of which has one of the choices.
pub fn choose_number(ui: &mut egui::Ui, chosen: &mut Vec<usize>, choices: usize) {
    let most = choices.min(MOST_STATIONS);
    if let Some(count) = fewer_or_more(ui, "station", chosen.len(), 1..=most) {
        let unused = (0..choices).find(|choice| !chosen.contains(choice)).unwrap_or(0);
        chosen.resize(count, unused);
    }
}
