//! The time span that is used, and readings excluded by hand.

use super::{ShownCorrections, name};
use crate::app::state::corrections::{masked, with_span, within};
use resect_core::deployment::StatedPrismChange;
use resect_io::source::Extras;

impl ShownCorrections<'_> {
    pub(super) fn times(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let start_s = self.open.start_s();
        let in_words = |[from_s, to_s]: [f64; 2]| {
            format!("{:.1} to {:.1} s", from_s - start_s, to_s - start_s)
        };
        let own = self.extras.corrections.span_s;
        let read = self.deployment().as_read.span_s;
        let as_read = own.map(|_| read.map_or("all".to_owned(), in_words));
        if name(ui, "Times that are used", as_read) {
            changed.corrections.span_s = None;
        }
        ui.label(self.now.span_s.map_or("All".to_owned(), in_words));
        ui.horizontal_wrapped(|ui| {
            let selection = self.open.timeline.selection_s;
            let only = egui::Button::new("Use only the selection");
            let only = ui.add_enabled(selection.is_some(), only);
            let hint = "Drag in a plot over time to select";
            if only
                .on_hover_text("Readings at other times are not used")
                .on_disabled_hover_text(hint)
                .clicked()
            {
                *changed = with_span(self.extras, self.open, selection);
            }
            let all = ui.add_enabled(self.now.span_s.is_some(), egui::Button::new("Use all"));
            if all.on_disabled_hover_text("All are used").clicked() {
                *changed = with_span(self.extras, self.open, None);
            }
        });
    }

    /// Shows the changes of prisms, if there are any; the finding of one offers to add it.
    pub(super) fn prism_changes(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let now = self.now.prism_changes.as_deref().unwrap_or_default();
        let corrected = self.extras.corrections.prism_changes.as_ref();
        if now.is_empty() && corrected.is_none() {
            return;
        }
        let read = self.deployment().as_read.prism_changes.as_ref().map_or(0, Vec::len);
        if name(ui, "Changes of prisms", corrected.map(|_| read.to_string())) {
            changed.corrections.prism_changes = None;
        }
        let start_s = self.open.start_s();
        for StatedPrismChange { station, time_s, prism } in now {
            ui.label(format!(
                "Station {station} follows prism {prism} from {:.1} s",
                time_s - start_s
            ));
        }
        if ui.add_enabled(!now.is_empty(), egui::Button::new("Remove them")).clicked() {
            changed.corrections.prism_changes = Some(Vec::new());
        }
    }

    pub(super) fn masks(&self, ui: &mut egui::Ui, changed: &mut Extras) {
        let count = |masks: Option<&Vec<_>>| match masks.map_or(0, Vec::len) {
            0 => "none".to_owned(),
            1 => "1 reading".to_owned(),
            count => format!("{count} readings"),
        };
        let own = self.extras.corrections.masked.as_ref();
        let as_read = own.map(|_| count(self.deployment().as_read.masked.as_ref()));
        if name(ui, "Left out by hand", as_read) {
            changed.corrections.masked = None;
        }
        let now = self.now.masked.as_ref();
        ui.label(count(now)).on_hover_text("A reading is left out in the pane “Reading”, or by X");
        ui.horizontal_wrapped(|ui| {
            ui.label("Leave out the selection of");
            for station in 0..self.deployment().tracks.len() {
                let readings = self
                    .open
                    .timeline
                    .selection_s
                    .map_or_else(Vec::new, |span_s| within(self.deployment(), station, span_s));
                let button = egui::Button::new((station + 1).to_string());
                let button = ui.add_enabled(!readings.is_empty(), button);
                let label = format!("Leave out the selection of station {}", station + 1);
                button.widget_info(|| {
                    egui::WidgetInfo::labeled(egui::Role::Button, !readings.is_empty(), &label)
                });
                let hint = format!("{} readings of station {}", readings.len(), station + 1);
                let button = button.on_hover_text(hint);
                if button.on_disabled_hover_text("No reading of it is selected").clicked() {
                    *changed = masked(self.extras, self.deployment(), readings, true);
                }
            }
            let any = now.is_some_and(|masks| !masks.is_empty());
            if ui.add_enabled(any, egui::Button::new("Use all again")).clicked() {
                changed.corrections.masked = Some(Vec::new());
            }
        });
    }
}
