//! Files of the rig and of control points.

use egui::RichText;

use super::{ShownCorrections, name};
use crate::app::model::{Commands, DeploymentCommand};
use crate::app::state::corrections::without_control_points;
use resect_io::source::Extras;

impl ShownCorrections<'_> {
    pub(super) fn files(&self, ui: &mut egui::Ui, changed: &mut Extras, commands: &mut Commands) {
        let corrections = &self.extras.corrections;
        let own_rig = self.extras.rig.is_some() || corrections.rig.is_some();
        if name(ui, "Rig", own_rig.then(|| "the file beside the tracks".to_owned())) {
            (changed.rig, changed.corrections.rig) = (None, None);
        }
        let file_name = |path: &std::path::Path| {
            path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
        };
        let choose = "Choose a rig file…";
        ui.horizontal_wrapped(|ui| {
            if let Some(path) = &self.extras.rig {
                ui.label(RichText::new(file_name(path)).small())
                    .on_hover_text(path.display().to_string());
            }
            if ui
                .button(choose)
                .on_hover_text("Distances, or the readings of the prisms from one station")
                .clicked()
            {
                commands.push(DeploymentCommand::ChooseRigDialog.into());
            }
        });
        let own_points = !self.extras.gcp.is_empty()
            || self.extras.gcp_instead
            || corrections.control_points.is_some();
        if name(ui, "Control points", own_points.then(|| "the files beside the tracks".to_owned()))
        {
            (changed.gcp, changed.gcp_instead) = (Vec::new(), false);
            changed.corrections.control_points = None;
        }
        for set in &self.deployment().control_points {
            ui.horizontal(|ui| {
                let cross = ui.add(egui::Button::new("×").small().frame(false));
                let short = file_name(std::path::Path::new(&set.file));
                let label = format!("Do not use {short}");
                cross.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &label));
                if cross.on_hover_text(&label).clicked() {
                    *changed = without_control_points(self.extras, self.deployment(), &set.file);
                }
                let text = format!("{short}: {} points", set.points.len());
                ui.add(egui::Label::new(RichText::new(text).small()).truncate())
                    .on_hover_text(&set.file);
            });
        }
        if ui.button("Add control points…").clicked() {
            commands.push(DeploymentCommand::AddControlPointsDialog.into());
        }
    }
}
