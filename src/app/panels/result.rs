//! The answer: verdict first, then the transforms with their σ, the mirror, and the metrics.

use eframe::egui::{self, RichText};

use super::{correlations, finding, heading, minima, observability, scrolled};
use crate::analysis::{Analysis, Answer};
use crate::app::state::{Command, Commands, State};
use crate::app::theme;
use crate::calibration::inter_prism::InterPrismDetails;
use crate::calibration::static_gcp::StaticGcpDetails;
use crate::calibration::two_point::TwoPointDetails;
use crate::calibration::{Calibration, Details, Mirror, ResolvedBy, Targets};
use crate::deployment::{Deployment, Finding, Severity, pair_label};
use crate::evaluation::{Evaluation, Spread};
use crate::export::text;
use crate::palette;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let Some((open, analysis)) = state.analysed() else {
            ui.weak("No result yet.");
            return;
        };
        if state.is_stale() {
            ui.multiply_opacity(0.45);
        }
        match &analysis.answer {
            Ok(answer) => show(ui, &open.deployment, analysis, answer, commands),
            Err(error) => {
                ui.heading("No result");
                finding(ui, &Finding::problem(error.to_string()));
            }
        }
    });
}

fn show(
    ui: &mut egui::Ui,
    deployment: &Deployment,
    analysis: &Analysis,
    answer: &Answer,
    commands: &mut Commands,
) {
    let calibration = &answer.calibration;
    verdict(ui, calibration);
    reasons(ui, &calibration.findings);
    heading(ui, "Transforms into station 1");
    transforms(ui, calibration);
    ui.horizontal(|ui| {
        if ui.button("Copy as text").clicked() {
            commands.push(Command::Copy(text::calibration(deployment, analysis, answer)));
        }
        for station in 1..3 {
            if ui.button(format!("Copy T1{} 4×4", station + 1)).clicked() {
                commands.push(Command::Copy(text::matrix(calibration, station)));
            }
        }
    });
    ui.collapsing("4×4 matrices", |ui| {
        for station in 1..3 {
            ui.label(format!("T1{}", station + 1));
            egui::ScrollArea::horizontal().id_salt(station).show(ui, |ui| {
                ui.add(
                    egui::Label::new(
                        RichText::new(text::matrix(calibration, station).trim_end())
                            .monospace()
                            .size(11.0),
                    )
                    .extend(),
                );
            });
        }
    });
    match &calibration.details {
        Details::TwoPoint(details) => two_point(ui, details),
        Details::StaticGcp(details) => static_gcp(ui, details),
        Details::DynamicGcp(_) => {}
        Details::InterPrism(details) => {
            mirror(ui, details);
            minima::ui(ui, details);
            observability::ui(ui, &details.observability);
        }
    }
    if let Some(correlation) = calibration.correlation() {
        correlations::ui(ui, &correlation);
    }
    metrics(ui, &answer.evaluation, analysis.offer.targets);
}

/// All that limits the answer, and the first notes; the others on request, so that the numbers stay in sight.
fn reasons(ui: &mut egui::Ui, findings: &[Finding]) {
    const NOTES_IN_SIGHT: usize = 4;
    let (notes, doubts): (Vec<_>, Vec<_>) =
        findings.iter().partition(|finding| finding.severity == Severity::Note);
    doubts.into_iter().for_each(|one| finding(ui, one));
    let (shown, folded) = notes.split_at(notes.len().min(NOTES_IN_SIGHT));
    shown.iter().for_each(|one| finding(ui, one));
    if !folded.is_empty() {
        ui.collapsing(format!("what else was found ({})", folded.len()), |ui| {
            folded.iter().for_each(|one| finding(ui, one));
        });
    }
}

fn verdict(ui: &mut egui::Ui, calibration: &Calibration) {
    let [fill, ink] = palette::verdict(calibration.verdict).map(theme::rgb);
    ui.horizontal(|ui| {
        egui::Frame::new()
            .fill(fill)
            .corner_radius(4.0)
            .inner_margin(egui::Margin::symmetric(10, 4))
            .show(ui, |ui| {
                let word = calibration.verdict.name().to_uppercase();
                ui.label(RichText::new(word).color(ink).strong().size(15.0));
            });
        ui.label(format!("{}  {}", calibration.method.letter(), calibration.method.title()));
    });
}

/// One column for each transform: value ± σ.
fn transforms(ui: &mut egui::Ui, calibration: &Calibration) {
    let sigma_text =
        |sigma: Option<f64>, digits: usize| format!("± {}", text::sigma_text(sigma, digits));
    egui::Grid::new("transforms").num_columns(5).spacing([7.0, 3.0]).striped(true).show(ui, |ui| {
        ui.label("");
        for station in 1..3 {
            ui.strong(format!("T1{}", station + 1));
            ui.weak("± mm");
        }
        ui.end_row();
        for (axis, name) in ["x (m)", "y (m)", "z (m)"].into_iter().enumerate() {
            ui.label(name);
            for station in 1..3 {
                let value = calibration.station1_from_station[station].translation_m[axis];
                let sigma = calibration.sigma.map(|s| s[station - 1].translation_m[axis]);
                ui.monospace(format!("{value:>9.4}"));
                ui.monospace(sigma_text(sigma, 1));
            }
            ui.end_row();
        }
        ui.label("yaw (rad)");
        for station in 1..3 {
            let value = calibration.station1_from_station[station].yaw_rad();
            let sigma = calibration.sigma.map(|s| s[station - 1].yaw_rad);
            ui.monospace(format!("{value:>9.5}"));
            ui.monospace(sigma_text(sigma, 3)).on_hover_text("mrad");
        }
        ui.end_row();
        ui.label("yaw (deg)");
        for station in 1..3 {
            let value = calibration.station1_from_station[station].yaw_rad().to_degrees();
            ui.monospace(format!("{value:>9.4}"));
            ui.label("");
        }
        ui.end_row();
    });
    ui.small("± one standard deviation: mm for lengths, mrad for the yaw");
}

fn mirror(ui: &mut egui::Ui, details: &InterPrismDetails) {
    let Mirror { twin, cost_ratio, resolved_by } = &details.mirror;
    heading(ui, "Mirror twin");
    let (Some(twin), Some(ratio)) = (twin, cost_ratio) else {
        ui.label("No second minimum: pitch and roll rule it out.");
        return;
    };
    let by = match resolved_by {
        ResolvedBy::Rig => "by the rig's heights",
        ResolvedBy::ControlPoints => "by control points",
        ResolvedBy::Cost => "by cost",
        ResolvedBy::Nothing => "by nothing",
    };
    egui::Grid::new("mirror").num_columns(3).spacing([10.0, 2.0]).show(ui, |ui| {
        ui.label("");
        ui.label("answer");
        ui.label("twin");
        ui.end_row();
        for station in 1..3 {
            ui.label(format!("z of T1{} (m)", station + 1));
            for basin in [&details.basin, twin] {
                ui.monospace(format!(
                    "{:>8.4}",
                    basin.station1_from_station[station].translation_m.z
                ));
            }
            ui.end_row();
        }
        ui.label("RMS error (mm)");
        for basin in [&details.basin, twin] {
            ui.monospace(format!("{:>8.2}", basin.mean_square_m2.sqrt() * 1e3));
        }
        ui.end_row();
        ui.label("cost ratio");
        ui.monospace(format!("{:>8.2}", 1.0));
        ui.monospace(format!("{ratio:>8.2}"));
        ui.end_row();
    });
    ui.label(format!("Told apart {by}."));
}

/// Every pair of known points, and what the stations make of the points it leaves out.
fn two_point(ui: &mut egui::Ui, details: &TwoPointDetails) {
    heading(ui, "Pairs of known points");
    let widest =
        |values: &[f64]| values.last().map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3));
    egui::Grid::new("pairs").num_columns(4).spacing([10.0, 2.0]).striped(true).show(ui, |ui| {
        for (name, hint) in [
            ("points", "Markers of the two points"),
            ("apart (m)", "Known distance between them"),
            (
                "left out (mm)",
                "Largest distance between what the stations make of a point left out",
            ),
            (
                "known (mm)",
                "Largest distance of a point left out to its known position, mean of the stations",
            ),
        ] {
            ui.label(name).on_hover_text(hint);
        }
        ui.end_row();
        for (index, pair) in details.pairs.iter().enumerate() {
            let name = format!("{}–{}", pair.markers[0], pair.markers[1]);
            let chosen = index == details.chosen;
            let cell = |text: String| {
                let text = RichText::new(text).monospace();
                if chosen { text.strong() } else { text }
            };
            ui.label(cell(name));
            ui.label(cell(format!("{:.1}", pair.baseline_m)));
            ui.label(cell(widest(&pair.left_out_m)));
            let known =
                pair.largest_from_known_m().map_or("–".to_owned(), |m| format!("{:.1}", m * 1e3));
            ui.label(cell(known));
            ui.end_row();
        }
    });
    ui.small("Bold: the pair that the answer comes from.");
}

fn static_gcp(ui: &mut egui::Ui, details: &StaticGcpDetails) {
    if let Some(world) = &details.world_from_station1 {
        heading(ui, "Station 1 in the points' frame");
        let t = world.translation_m;
        ui.monospace(format!("{:.4}  {:.4}  {:.4} m", t.x, t.y, t.z));
        ui.monospace(format!("yaw {:.6} rad", world.yaw_rad()));
    }
}

fn metrics(ui: &mut egui::Ui, evaluation: &Evaluation, targets: Targets) {
    heading(ui, "Metrics (mm)");
    egui::Grid::new("metrics").num_columns(4).spacing([10.0, 3.0]).striped(true).show(ui, |ui| {
        ui.label("");
        ui.label("median");
        ui.label("IQR");
        ui.label("n");
        ui.end_row();
        let row = |ui: &mut egui::Ui, name: RichText, spread: &Spread| {
            ui.label(name);
            ui.monospace(format!("{:>7.2}", spread.median));
            ui.monospace(format!("{:>7.2}", spread.iqr));
            ui.monospace(spread.n.to_string());
            ui.end_row();
        };
        // Of one prism, what the distances compare are the stations' versions of it.
        let (all, each) = match targets {
            Targets::OnePrism => ("Same prism", "stations"),
            _ => ("Inter-prism", "prisms"),
        };
        if let Some(spread) = &evaluation.inter_prism_mm {
            row(ui, RichText::new(all).strong(), spread);
        }
        for (pair, spread) in evaluation.inter_prism_by_pair_mm.iter().enumerate() {
            if let Some(spread) = spread {
                row(ui, RichText::new(format!("   {each} {}", pair_label(pair))), spread);
            }
        }
        for metric in &evaluation.control_points_mm {
            row(ui, RichText::new(&metric.file), &metric.spread);
        }
    });
    if evaluation.control_points_mm.is_empty() {
        ui.weak("No control points: no control-point metric.");
    }
}
