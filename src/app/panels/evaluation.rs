//! Evaluation of other systems' trajectories against the ground truth of the deployment: ranking, significance, and spans in which one of
//! them is wrong.

use egui::RichText;

use super::{extrinsics, finding, heading, judging_options, scrolled};
use crate::app::model::{
    AngleUnit, Commands, JudgingCommand, OpenDeployment, TimeCommand, TimeScale, Units,
};
use crate::app::short;
use crate::app::state::State;
use crate::app::theme;
use crate::app::words;
use resect_core::calibration::Verdict;
use resect_core::deployment::Finding;
use resect_core::network::Prism;
use resect_io::findings::kinds;
use resect_io::gnss_solution::SolutionChoice;
use resect_io::source::Place;
use resect_report::estimates::{
    ADD_A_TRUTH, Angles, EMPTY, PairTable, VERDICTS_IN_WORDS, agreed, contradiction, rows,
    trajectory_in_words, verdict_sentence, verdicts,
};
use resect_tools::estimates::odd::{OddOne, OddSpan};
use resect_tools::estimates::ranking::PairComparison;
use resect_tools::estimates::{
    EstimatedTrajectory, EstimatesJudgement, GroundTruth, Judged, TruthReason, Unjudged,
};
use resect_tools::palette;

/// Width of a digit in the table, and greatest width of a heading that is wider than its numbers (points).
const LETTER: f32 = 7.2;
const WIDEST_HEADING: f32 = 120.0;
/// Least and greatest width of a row's label (points).
const LEAST_LABEL: f32 = 96.0;
const WIDEST_LABEL: f32 = 260.0;
/// Greatest width of a sentence (points).
const SENTENCE: f32 = 620.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let Some(open) = state.active() else {
        ui.weak("Nothing open.");
        return;
    };
    scrolled(ui, |ui| {
        // Sentences have a limited width; tables may be wider, and scroll sideways on their own.
        ui.scope(|ui| {
            ui.set_max_width(ui.available_width().min(SENTENCE));
            verdict(ui, state, open);
            truth(ui, open, commands);
            added(ui, open, commands);
            if open.judging.added.is_empty() {
                return;
            }
            judging_options::ui(ui, &open.judging.added, commands);
            if open.judging.judgement.is_running() {
                ui.horizontal(|ui| {
                    ui.spinner();
                    ui.label("evaluating");
                });
            }
            let Some(judgement) = open.judging.judgement.newest.as_deref() else {
                if GroundTruth::needs_answer(&open.deployment)
                    && let Some(Err(why)) = open.analysis.as_ref().map(|analysis| &analysis.answer)
                {
                    ui.label(format!("No ground truth: {why}"));
                }
                return;
            };
            if state.is_stale() {
                ui.multiply_opacity(0.45);
            }
            doubt(ui, open);
            for one in &judgement.judged {
                for said in one.estimate.findings.iter().chain(&one.fit.findings) {
                    finding(ui, state, said, commands);
                }
            }
            ranking(ui, state, judgement, commands);
            odd(ui, state, open, judgement, commands);
            table(ui, open, judgement, angles(state.workspace.units));
            extrinsics::ui(ui, open, commands);
        });
    });
}

/// States the verdict on all trajectories in one sentence.
fn verdict(ui: &mut egui::Ui, state: &State, open: &OpenDeployment) {
    let Some(judgement) = open.judging.judgement.newest.as_deref() else { return };
    let angles = angles(state.workspace.units);
    let Some(sentence) = verdict_sentence(judgement, angles) else { return };
    let is_decided = judgement.comparisons.iter().any(PairComparison::is_significant);
    let verdict = if is_decided { Verdict::Good } else { Verdict::Weak };
    let [ground, ink] = palette::verdict(verdict).map(theme::rgb);
    let text = match judgement.judged.len() {
        1 => RichText::new(sentence),
        _ => RichText::new(format!(" {sentence} ")).color(ink).background_color(ground),
    };
    let text = text.strong();
    ui.add(egui::Label::new(text).wrap()).on_hover_text(VERDICTS_IN_WORDS);
    ui.add_space(4.0);
}

/// Names a ground truth that is a trajectory, with the reason of its choice, and offers to exchange it with the only other one.
fn truth(ui: &mut egui::Ui, open: &OpenDeployment, commands: &mut Commands) {
    let Some(truth) = &open.deployment.ground_truth else { return };
    let judging = &open.judging;
    if judging.truth_reason == Some(TruthReason::Alone) && judging.added.is_empty() {
        ui.horizontal_wrapped(|ui| {
            ui.strong(&truth.name).on_hover_text(truth.path.display().to_string());
            ui.label(trajectory_in_words(truth));
        });
        ui.label(ADD_A_TRUTH);
        ui.add_space(4.0);
        return;
    }
    ui.horizontal_wrapped(|ui| {
        ui.label("ground truth:");
        ui.strong(&truth.name).on_hover_text(truth.path.display().to_string());
        let kind = if truth.has_orientations() { "poses" } else { "positions" };
        let reason = judging.truth_reason.map_or("", TruthReason::in_words);
        let reason = if reason.is_empty() { String::new() } else { format!(", {reason}") };
        ui.weak(format!("{} {kind}{reason}", truth.poses.len()));
        if let [only] = &judging.added[..] {
            let button = ui.small_button("exchange");
            let hint = format!("Use {} as the ground truth, and evaluate this one", only.full_name);
            if button.on_hover_text(hint).clicked() {
                commands.push(JudgingCommand::UseAsGroundTruth(only.colour).into());
            }
        }
    });
    truth_file(ui, open, truth, commands);
}

/// Shows and edits the options of the file that is the ground truth.
fn truth_file(
    ui: &mut egui::Ui,
    open: &OpenDeployment,
    truth: &EstimatedTrajectory,
    commands: &mut Commands,
) {
    let Some(Place::GroundTruth(file)) = open.source.as_ref().map(|source| &source.place) else {
        return;
    };
    let mut after = file.clone();
    let name = "ground truth's convention is";
    if let Some(convention) = judging_options::convention_field(ui, name, Some(file.convention)) {
        after.convention = convention;
    }
    let is_gnss = |finding: &Finding| finding.kind == kinds::GNSS_SOLUTIONS_LEFT_OUT;
    if truth.findings.iter().any(is_gnss) || file.solutions != SolutionChoice::Best {
        ui.horizontal_wrapped(|ui| {
            ui.label("its solutions are");
            for (choice, name, hint) in [
                (SolutionChoice::Best, "the best", "The most accurate kind of the file"),
                (SolutionChoice::Float, "fixed and float", "Each with its σ"),
                (SolutionChoice::All, "all", "Each with its σ"),
            ] {
                ui.radio_value(&mut after.solutions, choice, name).on_hover_text(hint);
            }
        });
    }
    if after != *file {
        commands.push(JudgingCommand::ReadGroundTruth(after).into());
    }
}

/// Lists the added trajectories, and offers to add more.
fn added(ui: &mut egui::Ui, open: &OpenDeployment, commands: &mut Commands) {
    let judging = &open.judging;
    if judging.added.is_empty() {
        let followed = open.analysis.as_ref().map(|analysis| &analysis.offer.followed);
        let truth = match followed.map(Prism::count) {
            _ if judging.truth_reason == Some(TruthReason::Alone) => {
                "The ground truth is chosen by names, missing orientations or stated σ, and can be exchanged."
            }
            _ if open.deployment.ground_truth.is_some() => "They are evaluated against this one.",
            Some(2) => {
                "Two prisms have no orientation, so this deployment has no trajectory that could be the ground truth; `resect \
                 evaluate --truth-station` compares with the prism of one station."
            }
            _ => {
                "This deployment's own trajectory is the ground truth, with its σ at each instant."
            }
        };
        ui.label(format!(
            "Drop trajectories of SLAM or odometry here (TUM, EuRoC, KITTI with times.txt, CSV with a header), or add a bag with \
             Odometry or PoseStamped. {truth}"
        ));
        ui.add_space(4.0);
    }
    for (index, one) in judging.added.iter().enumerate() {
        let estimate = &one.estimate;
        ui.horizontal_wrapped(|ui| {
            let colour = theme::readable(palette::estimate(one.colour), ui.visuals().dark_mode);
            ui.label(RichText::new(&estimate.name).color(colour).strong())
                .on_hover_text(estimate.path.display().to_string());
            ui.weak(format!("{} poses", estimate.poses.len()));
            // The only other trajectory has its button beside the ground truth.
            if open.deployment.ground_truth.is_none() || judging.added.len() > 1 {
                let name = format!("Use {} as the ground truth", estimate.name);
                let hint = match open.deployment.ground_truth {
                    Some(_) => format!("{name}, and evaluate the present one"),
                    None => format!(
                        "{name}: opens it beside this deployment, and compares the others with it"
                    ),
                };
                let button = ui.small_button("ground truth").on_hover_text(hint);
                button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
                if button.clicked() {
                    commands.push(JudgingCommand::UseAsGroundTruth(one.colour).into());
                }
            }
            let name = format!("Remove {}", estimate.name);
            let button = ui.small_button("×").on_hover_text(&name);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if button.clicked() {
                let mut others = judging.added.clone();
                others.remove(index);
                commands.push(JudgingCommand::Set(others).into());
            }
        });
    }
    if ui.button("Add a trajectory…").clicked() {
        commands.push(JudgingCommand::AddDialog.into());
    }
}

/// Warns if the ground truth itself is not good, because the results are then no better.
fn doubt(ui: &mut egui::Ui, open: &OpenDeployment) {
    let answer = open.analysis.as_ref().and_then(|analysis| analysis.answer.as_ref().ok());
    let verdict = answer.map(|answer| answer.calibration.verdict);
    if let Some(verdict) = verdict.filter(|verdict| *verdict != Verdict::Good) {
        let [ground, ink] = palette::verdict(verdict).map(theme::rgb);
        let word = format!(" {} ", verdict.name());
        ui.label(RichText::new(word).color(ink).background_color(ground).strong());
        let line = format!(
            "The ground truth is {}, so these results are no more reliable. The Result pane gives the reasons.",
            verdict.name()
        );
        ui.add(egui::Label::new(line).wrap());
    }
}

/// Shows the verdicts on each compared pair, and the trajectories that could not be evaluated.
fn ranking(
    ui: &mut egui::Ui,
    state: &State,
    judgement: &EstimatesJudgement,
    commands: &mut Commands,
) {
    ui.add_space(4.0);
    for table in verdicts(judgement, angles(state.workspace.units)) {
        pair(ui, &table);
    }
    for both in &judgement.agreements {
        ui.add(egui::Label::new(agreed(judgement, both)).wrap());
    }
    // Each deficiency of the ground truth is reported once.
    let mut said: Vec<&Unjudged> = judgement.unjudged.iter().map(|(_, why)| why).collect();
    said.dedup();
    said.into_iter().for_each(|why| finding(ui, state, &why.finding(), commands));
    if judgement.judged.is_empty() && judgement.unjudged.len() > 1 {
        ui.label(
            "If one of these trajectories is the ground truth, press “ground truth” beside it.",
        );
    }
}

/// Shows a row for each kind of error of a pair. Evidence is shown on hover.
fn pair(ui: &mut egui::Ui, table: &PairTable) {
    let grid = egui::Grid::new(("verdicts", table.estimates)).striped(true).spacing([10.0, 3.0]);
    egui::ScrollArea::horizontal().id_salt(("verdicts", table.estimates)).show(ui, |ui| {
        grid.show(ui, |ui| {
            ui.label("");
            for name in &table.names {
                column_heading(ui, RichText::new(name).small(), name, WIDEST_HEADING);
            }
            ui.small("verdict").on_hover_text(VERDICTS_IN_WORDS);
            ui.end_row();
            for row in &table.rows {
                words::explain_text(ui.small(&row.label), &row.label);
                for cell in &row.cells {
                    ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                        let text = RichText::new(cell).small().family(egui::FontFamily::Monospace);
                        let label = ui.label(text);
                        if cell == EMPTY {
                            label.on_hover_text(&row.reason);
                        }
                    });
                }
                // The factor and the evidence are shown on hover, so that the verdict fits a narrow pane.
                let short = row.verdict.split_once(": ").map_or(&*row.verdict, |(short, _)| short);
                let text = RichText::new(short).small();
                let text = if row.better.is_some() { text.strong() } else { text.weak() };
                ui.label(text).on_hover_text(&row.reason);
                ui.end_row();
            }
        })
    });
    ui.add_space(4.0);
}

/// Lists the spans in which the estimate and the ground truth contradict each other; a click selects them.
fn odd(
    ui: &mut egui::Ui,
    state: &State,
    open: &OpenDeployment,
    judgement: &EstimatesJudgement,
    commands: &mut Commands,
) {
    let spans = judgement.judged.iter().flat_map(|one| one.odd.iter().map(move |span| (one, span)));
    let mut spans: Vec<(&Judged, &OddSpan)> = spans.collect();
    if spans.is_empty() {
        return;
    }
    spans.sort_by(|a, b| a.1.span_s[0].total_cmp(&b.1.span_s[0]));
    heading(ui, "Contradictions with the ground truth");
    let scale = TimeScale::new(state.workspace.units.time, open.start_s());
    for (one, span) in spans {
        ui.horizontal_wrapped(|ui| {
            let [from, to] = span.span_s.map(|time_s| scale.text(time_s - open.start_s(), 1));
            let button = ui.small_button(format!("{from} to {to}"));
            let name = format!("Look at {}, {from} to {to}", one.estimate.name);
            button.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &name));
            if button.on_hover_text("Show these times in the plots and the scene").clicked() {
                look_at(span, commands);
            }
            ui.strong(&one.estimate.name);
            ui.label(contradiction(span, angles(state.workspace.units)));
        });
    }
}

/// Selects a span. For wrong readings it shows the distance errors, which reveal them; otherwise the trajectory stays visible.
fn look_at(span: &OddSpan, commands: &mut Commands) {
    if matches!(span.odd_one, OddOne::Readings | OddOne::LeftOut) {
        commands.push(TimeCommand::LookAtTimes(span.span_s).into());
        return;
    }
    let [from_s, to_s] = span.span_s;
    let room_s = (0.5 * (to_s - from_s)).max(2.0);
    commands.push(TimeCommand::Select(Some(span.span_s)).into());
    commands.push(TimeCommand::ShowTimes([from_s - room_s, to_s + room_s]).into());
    commands.push(TimeCommand::MoveCursor(0.5 * (from_s + to_s)).into());
}

/// Shows a table of errors with one column per trajectory.
fn table(ui: &mut egui::Ui, open: &OpenDeployment, judgement: &EstimatesJudgement, angles: Angles) {
    if judgement.judged.is_empty() {
        return;
    }
    heading(ui, "Errors");
    let pane_width = ui.available_width();
    let grid = egui::Grid::new("errors of trajectories").striped(true).spacing([10.0, 3.0]);
    egui::ScrollArea::horizontal().show(ui, |ui| {
        grid.show(ui, |ui| {
            ui.label("");
            let rows = rows(judgement, angles);
            let widest = |column: usize| {
                rows.iter().map(|row| row.cells[column].chars().count()).max().unwrap_or(0)
            };
            let widths: Vec<usize> = (0..judgement.judged.len()).map(widest).collect();
            // Labels take the width that the numbers leave, so that the numbers are in sight.
            let numbers = widths.iter().map(|width| LETTER * *width as f32 + 10.0).sum::<f32>();
            let label_width = (pane_width - numbers).clamp(LEAST_LABEL, WIDEST_LABEL);
            for (one, width) in judgement.judged.iter().zip(&widths) {
                let colour = open.judging.of(&one.estimate).map_or(0, |added| added.colour);
                let colour = theme::readable(palette::estimate(colour), ui.visuals().dark_mode);
                let room = (LETTER * *width as f32).max(WIDEST_HEADING);
                let name = &one.estimate.name;
                column_heading(ui, RichText::new(name).color(colour).strong(), name, room);
            }
            ui.end_row();
            for row in &rows {
                let label = RichText::new(&row.label).small();
                let label = ui.scope(|ui| {
                    ui.set_max_width(label_width);
                    ui.add(egui::Label::new(label).wrap())
                });
                words::explain_text(label.inner, &row.label);
                for ((cell, why), width) in row.cells.iter().zip(&row.why_empty).zip(&widths) {
                    // Numbers are aligned at their ends.
                    let text = RichText::new(format!("{cell:>width$}"));
                    let label = ui.label(text.small().family(egui::FontFamily::Monospace));
                    if cell == EMPTY {
                        label.on_hover_text(why);
                    }
                }
                ui.end_row();
            }
        })
    });
}

/// Shows a name above the ends of its numbers. A wider name is broken, because any of its letters may distinguish it.
fn column_heading(ui: &mut egui::Ui, text: RichText, name: &str, room: f32) {
    let font = egui::TextStyle::Body.resolve(ui.style());
    if short::in_the_middle(ui, name, &font, room) != *name {
        ui.scope(|ui| {
            ui.set_max_width(room);
            ui.add(egui::Label::new(text).wrap());
        });
    } else {
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
            ui.label(text);
        });
    }
}

/// Shows small rotations in mrad instead of radians; other units are unchanged.
fn angles(units: Units) -> Angles {
    match units.angle {
        AngleUnit::Radian => Angles { per_radian: 1e3, unit: "mrad" },
        unit => Angles { per_radian: unit.per_radian(), unit: unit.name() },
    }
}
