//! What a file that hovers over the window would do.

use eframe::egui::{self, Align2, Color32, FontId};

pub fn ui(ui: &egui::Ui) {
    if ui.input(|i| i.raw.hovered_files.is_empty()) {
        return;
    }
    let ctx = ui.ctx();
    let painter = ctx
        .layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop hint")));
    let rect = ctx.content_rect();
    painter.rect_filled(rect, 0.0, Color32::from_black_alpha(170));
    painter.text(
        rect.center(),
        Align2::CENTER_CENTER,
        "Drop a deployment's folder, a ROS 1 bag or a polar CSV to open it",
        FontId::proportional(20.0),
        Color32::WHITE,
    );
}
