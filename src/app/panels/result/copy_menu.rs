//! Copies the transforms to the clipboard, in the formats of other programs.

use egui::{PopupCloseBehavior, containers::menu};

use crate::app::model::{Commands, ResultsCommand};
use resect_core::calibration::Verdict;
use resect_report::copy::{CopiedTransforms, CopyFormat};
use resect_report::summary::ResultSummary;

pub fn ui(ui: &mut egui::Ui, summary: &ResultSummary, commands: &mut Commands) {
    // Choosing the transforms must not close the menu, because the format is chosen next.
    let config = menu::MenuConfig::new().close_behavior(PopupCloseBehavior::CloseOnClickOutside);
    let id = ui.scope_id().with("transforms to copy");
    menu::MenuButton::new("Copy…").config(config).ui(ui, |ui| {
        let mut copied: CopiedTransforms = ui.data(|data| data.get_temp(id)).unwrap_or_default();
        ui.horizontal(|ui| {
            for choice in CopiedTransforms::choices(summary) {
                ui.selectable_value(&mut copied, choice, choice.title(summary));
            }
        });
        ui.data_mut(|data| data.insert_temp(id, copied));
        ui.separator();
        for format in CopyFormat::ALL {
            if ui.button(format.title()).clicked() {
                commands.push(ResultsCommand::CopyTransforms(format, copied).into());
                ui.close();
            }
        }
        if summary.verdict != Verdict::Good || !summary.independently_checked {
            ui.separator();
            ui.small(format!("The copy includes the verdict: {}.", summary.verdict_in_words()));
        }
    });
}
