//! Preview of what happens to the files that are dragged over the window.

use std::path::{Path, PathBuf};

use egui::{Align2, Color32, FontId};

use crate::app::model::{Commands, DialogCommand};
use crate::app::state::State;
use resect_io::what_is::Sorted;

pub fn ui(ui: &egui::Ui, state: &State, commands: &mut Commands) {
    let paths: Vec<PathBuf> = ui.input(|input| {
        input.raw.hovered_files.iter().filter_map(|file| file.path.clone()).collect()
    });
    if ui.input(|input| input.raw.hovered_files.is_empty()) {
        return;
    }
    let ctx = ui.ctx();
    let painter = ctx
        .layer_painter(egui::LayerId::new(egui::Order::Foreground, egui::Id::unique("drop hint")));
    let rect = ctx.content_rect();
    painter.rect_filled(rect, 0.0, Color32::from_black_alpha(190));
    let active = state.active().and_then(|open| state.name_of(open.id));
    let has_truth = state.active().is_some_and(|open| !open.placeholder);
    let hovering = &state.dialogs.hovering;
    let text = match &hovering.sorted {
        // Some systems report the paths only at the drop.
        _ if paths.is_empty() => GENERAL.to_owned(),
        Some(sorted) if hovering.paths == paths => in_words(sorted, active.as_deref(), has_truth),
        _ => format!("{}…", names(&paths)),
    };
    if !paths.is_empty() && hovering.paths != paths {
        commands.push(DialogCommand::HoverPaths(paths).into());
    }
    let galley = painter.layout(
        text,
        FontId::proportional(18.0),
        Color32::WHITE,
        (rect.width() - 80.0).max(200.0),
    );
    let place = Align2::CENTER_CENTER.anchor_size(rect.center(), galley.size());
    // A label, because screen readers do not read painted text.
    egui::Area::new(egui::Id::unique("drop hint's text"))
        .order(egui::Order::Foreground)
        .interactable(false)
        .fixed_pos(place.min)
        .show(ctx, |ui| ui.add(egui::Label::new(galley).selectable(false)));
}

const GENERAL: &str = "Drop a deployment's folder, a bag or a polar CSV to open it;\n\
    control points, a rig, GNSS or settings to use them with the open deployment;\n\
    trajectories of other systems (TUM, EuRoC, KITTI, CSV) to evaluate them against it, or against their ground truth among them;\n\
    a session to continue it";

fn name(path: impl AsRef<Path>) -> String {
    let path = path.as_ref();
    path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned()
}

fn names(paths: &[PathBuf]) -> String {
    paths.iter().map(name).collect::<Vec<_>>().join(", ")
}

/// Lists the actions, one per line. `active`: name of the open deployment; `has_truth` is false if that is only the sample.
fn in_words(sorted: &Sorted, active: Option<&str>, has_truth: bool) -> String {
    let mut lines = Vec::new();
    for path in &sorted.deployments {
        lines.push(format!("Open {}", name(path)));
    }
    let whose = match (sorted.deployments.is_empty(), active) {
        (false, _) => "it".to_owned(),
        (true, Some(active)) => active.to_owned(),
        (true, None) => "a deployment (open its tracks first)".to_owned(),
    };
    let extras = &sorted.extras;
    if !extras.gcp.is_empty() {
        lines.push(format!("Add the control points {} to {whose}", names(&extras.gcp)));
    }
    if let Some(rig) = &extras.rig {
        lines.push(format!("Use the rig {} for {whose}", name(rig)));
    }
    if !extras.gnss.is_empty() {
        lines.push(format!("Use the GNSS solutions {} for {whose}", names(&extras.gnss)));
    }
    let estimates = &sorted.estimates;
    if sorted.deployments.is_empty() && !has_truth && estimates.len() > 1 {
        lines.push(format!("Evaluate {} against their ground truth among them", names(estimates)));
    } else if !estimates.is_empty() {
        lines.push(format!("Evaluate {} against {whose}", names(estimates)));
    }
    for path in &sorted.settings {
        lines.push(format!("Use the settings of {}", name(path)));
    }
    for path in &sorted.sessions {
        lines.push(format!("Continue the session {}", name(path)));
    }
    for why in &sorted.unknown {
        lines.push(format!("Not usable: {why}"));
    }
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_io::source::Extras;

    #[test]
    fn each_file_has_its_line() {
        let extras = Extras {
            rig: Some("/d/rig.csv".into()),
            gcp: vec!["/d/a.txt".into(), "/d/b.txt".into()],
            ..Extras::default()
        };
        let mut sorted = Sorted { extras, ..Sorted::default() };
        assert_eq!(
            in_words(&sorted, Some("day 1"), true),
            "Add the control points a.txt, b.txt to day 1\nUse the rig rig.csv for day 1"
        );
        sorted.deployments.push("/d/day 2".into());
        sorted.unknown.push("notes.txt: not recognised".to_owned());
        assert_eq!(
            in_words(&sorted, Some("day 1"), true),
            "Open day 2\nAdd the control points a.txt, b.txt to it\nUse the rig rig.csv for it\n\
             Not usable: notes.txt: not recognised"
        );
        let estimates = vec!["/d/slam.tum".into(), "/d/truth.tum".into()];
        let sorted = Sorted { estimates, ..Sorted::default() };
        for (has_truth, expected) in [
            (false, "Evaluate slam.tum, truth.tum against their ground truth among them"),
            (true, "Evaluate slam.tum, truth.tum against day 1"),
        ] {
            assert_eq!(in_words(&sorted, Some("day 1"), has_truth), expected);
        }
    }
}
