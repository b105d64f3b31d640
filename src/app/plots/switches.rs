//! Switches of pairs and stations above a plot; in a picture, the names of those that are shown.

use crate::app::model::{Commands, SceneCommand};
use crate::app::state::State;
use crate::app::theme;
use resect_core::network::{Number, Pair};
use resect_tools::palette;

/// Shows the pairs as a line of switches above a plot; this legend covers no data.
pub fn pair_switches(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut visibility = state.scene.visibility;
    let dark = ui.visuals().dark_mode;
    for (pair, on) in visibility.pairs.iter_mut().enumerate().take(state.pairs()) {
        if state.workspace.picturing {
            if *on {
                ui.label(pair_name(pair, dark));
            }
            continue;
        }
        ui.checkbox(on, pair_name(pair, dark))
            .on_hover_text("Show or hide this pair of prisms, in all plots");
    }
    if visibility != state.scene.visibility {
        commands.push(SceneCommand::Show(visibility).into());
    }
}

/// Panes narrower than this show only the station's number (points).
pub const NARROW: f32 = 520.0;

/// Shows the stations in their colours, with switches that also apply to the scene.
pub fn station_switches(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut visibility = state.scene.visibility;
    let (dark, narrow) = (ui.visuals().dark_mode, ui.available_width() < NARROW);
    for (station, on) in visibility.stations.iter_mut().enumerate().take(state.stations()) {
        let name = format!("station {}", station + 1);
        let text = if narrow { (station + 1).to_string() } else { name.clone() };
        let colour = theme::readable(palette::station(station), dark);
        let text = egui::RichText::new(text).color(colour).strong();
        if state.workspace.picturing {
            if *on {
                ui.label(text);
            }
            continue;
        }
        let switch = ui.checkbox(on, text);
        let role = egui::accesskit::Role::CheckBox;
        switch.widget_info(|| egui::WidgetInfo::selected(role, true, *on, &name));
        switch.on_hover_text(format!("Show or hide {name}, in the scene too"));
    }
    if visibility != state.scene.visibility {
        commands.push(SceneCommand::Show(visibility).into());
    }
}

/// "1–2" in the pair's colour.
pub fn pair_name(pair: usize, dark: bool) -> egui::RichText {
    egui::RichText::new(Pair::at(pair).to_string())
        .color(theme::readable(palette::pair(pair), dark))
        .strong()
}
