//! The numbers of the Pipeline pane, which the command palette finds by their names and focuses.

use super::{Action, Menu};
use crate::app::model::{AngleUnit, WorkspaceCommand};
use crate::app::state::State;
use resect_core::calibration::SIGMA_DISTANCES;
use resect_core::number_setting::NumberSetting;
use resect_core::pipeline::PIPELINE_NUMBERS;

pub fn actions(state: &State) -> Vec<Action> {
    let (settings, angle) = (state.settings(), state.workspace.units.angle);
    let pipeline = PIPELINE_NUMBERS.map(|setting| focus(setting, &settings.pipeline, angle));
    pipeline.into_iter().chain([focus(&SIGMA_DISTANCES, &settings.calibration, angle)]).collect()
}

fn focus<S: Copy + Default>(setting: &NumberSetting<S>, settings: &S, angle: AngleUnit) -> Action {
    let (unit, per) = angle.of_setting(setting.unit);
    let value = (setting.shown(settings) * per * 1e4).round() / 1e4;
    let name = format!("{}: {value} {unit}", setting.title);
    Action::new(Menu::Pipeline, "Numbers", name, WorkspaceCommand::FocusSetting(setting.key))
        .hint(setting.meaning)
        .also(setting.key)
}
