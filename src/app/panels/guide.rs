//! The guide from data to a trusted result, step by step, with buttons for each step. [`steps`] has its texts.

#[cfg(test)]
mod advice_tests;
mod headless;
mod steps;

use egui::RichText;

use self::steps::{GuideStep, Part, STEPS};
use super::{finding, result, scrolled};
use crate::app::actions;
use crate::app::actions::{Action, Menu};
use crate::app::model::{Commands, WorkspaceCommand};
use crate::app::state::State;
use crate::app::{theme, words};
use resect_core::calibration::Verdict;
use resect_core::deployment::advice::{ADVICE, Advice};
use resect_core::deployment::{Finding, Severity, doubts};
use resect_report::glossary;

/// Greatest number of terms shown below the steps in a search.
const MOST_WORDS: usize = 6;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let query_id = ui.scope_id().with("query");
    let mut query: String = ui.data(|data| data.get_temp(query_id)).unwrap_or_default();
    egui::Frame::new().inner_margin(egui::Margin { bottom: 0, ..8.into() }).show(ui, |ui| {
        let field = egui::TextEdit::singleline(&mut query)
            .hint_text("Search the guide and the glossary")
            .desired_width(f32::INFINITY);
        if ui.add(field).accessible_name("Search the guide").changed() {
            ui.data_mut(|data| data.insert_temp(query_id, query.clone()));
        }
    });
    let all = actions::all(state);
    let mut guide = Guide { state, actions: &all, commands };
    scrolled(ui, |ui| {
        if query.trim().is_empty() {
            guide.steps(ui);
        } else {
            guide.found(ui, &query);
        }
    });
}

/// Data and commands of the steps.
struct Guide<'a> {
    state: &'a State,
    actions: &'a [Action],
    commands: &'a mut Commands,
}

impl<'a> Guide<'a> {
    fn steps(&mut self, ui: &mut egui::Ui) {
        let own_data = self.state.active().is_some_and(|open| !open.placeholder);
        // The step that is open at first: the user's present one.
        let first = usize::from(own_data);
        for (index, step) in STEPS.iter().enumerate() {
            let title = RichText::new(format!("{}  {}", index + 1, step.title)).strong();
            egui::CollapsingHeader::new(title)
                .id_salt(step.title)
                .default_open(index == first)
                .show(ui, |ui| {
                    for part in step.parts {
                        self.part(ui, part);
                    }
                });
        }
    }

    /// Shows the parts that contain all words of the query, with their buttons, and then the matching terms.
    fn found(&mut self, ui: &mut egui::Ui, query: &str) {
        let wanted: Vec<String> = query.split_whitespace().map(str::to_lowercase).collect();
        let has = |texts: &[&str]| {
            let text = texts.join(" ").to_lowercase();
            wanted.iter().all(|word| text.contains(word.as_str()))
        };
        let mut any = false;
        for step in &STEPS {
            let parts = found_in(step, &has);
            let advice: Vec<&Advice> = ADVICE
                .iter()
                .filter(|advice| {
                    step.parts.iter().any(|part| matches!(part, Part::Doubts))
                        && has(&[advice.title, advice.meaning, advice.step])
                })
                .collect();
            if parts.is_empty() && advice.is_empty() {
                continue;
            }
            any = true;
            ui.strong(step.title);
            parts.into_iter().for_each(|part| self.part(ui, part));
            advice.into_iter().for_each(|advice| show_advice(ui, advice, false));
        }
        let terms = glossary::matching(query);
        if !terms.is_empty() {
            ui.add_space(6.0);
            ui.strong("Glossary");
            for term in terms.iter().take(MOST_WORDS) {
                ui.add_space(4.0);
                words::entry(ui, term);
            }
        }
        if !any && terms.is_empty() {
            ui.weak("No match in the guide or the glossary. Ctrl+P searches the commands.");
        }
    }

    fn part(&mut self, ui: &mut egui::Ui, part: &Part) {
        match part {
            Part::Say(text) => {
                let label = ui.add(egui::Label::new(*text).wrap());
                words::explain_text(label, text);
            }
            Part::Do(names) => {
                ui.horizontal_wrapped(|ui| {
                    names.iter().for_each(|name| self.button(ui, *name));
                });
                ui.add_space(4.0);
            }
            Part::Open => self.what_is_open(ui),
            Part::Verdict => self.verdict(ui),
            Part::Doubts => self.doubts(ui),
            Part::Headless => self.headless(ui),
        }
    }

    /// Adds a button for a menu entry.
    fn button(&mut self, ui: &mut egui::Ui, (menu, name): (Menu, &str)) {
        let found = self.actions.iter().find(|action| action.menu == menu && action.name == name);
        let Some(action) = found else { return };
        let label =
            if action.section == "Panes" { format!("Show {name}") } else { name.to_owned() };
        let button = ui.add_enabled(action.command.is_some(), egui::Button::new(label));
        let button =
            if action.hint.is_empty() { button } else { button.on_hover_text(action.hint) };
        let why_not = match self.state.active() {
            None => "Open a deployment first",
            Some(_) => "Not available for the present data",
        };
        if button.on_disabled_hover_text(why_not).clicked() {
            self.commands.extend(action.command.clone());
        }
    }

    fn what_is_open(&self, ui: &mut egui::Ui) {
        let Some(open) = self.state.active() else {
            ui.weak("Nothing is open.");
            return;
        };
        let deployment = &open.deployment;
        let readings: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
        let rig = if deployment.rig.is_some() { "rig known" } else { "rig not known" };
        let points = match deployment.control_points.len() {
            0 => "no control points".to_owned(),
            1 => "1 file of control points".to_owned(),
            count => format!("{count} files of control points"),
        };
        let name = &deployment.name;
        ui.label(format!("Open now: {name}, {readings} readings, {rig}, {points}."));
    }

    /// Returns the findings that limit the present result.
    fn present_doubts(&self) -> Vec<&'a Finding> {
        let answer =
            self.state.analysed().and_then(|(_, analysis)| analysis.answer.as_deref().ok());
        answer.map_or_else(Vec::new, |answer| doubts(&answer.calibration.findings))
    }

    fn verdict(&mut self, ui: &mut egui::Ui) {
        let answer = match self.state.analysed().map(|(_, analysis)| &analysis.answer) {
            Some(Ok(answer)) => answer,
            Some(Err(error)) => {
                finding(ui, self.state, &error.finding(), self.commands);
                return;
            }
            None => {
                ui.weak("No result yet.");
                return;
            }
        };
        let calibration = &answer.calibration;
        ui.horizontal_wrapped(|ui| {
            result::badge(ui, calibration.verdict, 12.0);
            let caveat = calibration.verdict.caveat(calibration.is_independently_checked());
            ui.label(caveat.trim_start_matches(", "));
        });
        for one in self.present_doubts() {
            finding(ui, self.state, one, self.commands);
        }
        if let Some(details) = calibration.inter_prism() {
            let lead = match calibration.verdict {
                Verdict::Good => "To improve the next drive",
                _ => "For the next drive",
            };
            let text = format!("{lead}: {}.", details.observability.advice);
            let label = ui.add(egui::Label::new(RichText::new(&text).strong()).wrap());
            words::explain_text(label, &text);
        }
        ui.add_space(4.0);
    }

    /// Shows all advice; advice about the present result comes first and is open.
    fn doubts(&self, ui: &mut egui::Ui) {
        let present = self.present_doubts();
        let is_present = |advice: &Advice| {
            present.iter().any(|finding| finding.kind.advice.as_ref() == Some(advice))
        };
        let (now, others): (Vec<&Advice>, Vec<&Advice>) =
            ADVICE.iter().partition(|advice| is_present(advice));
        ui.strong("Causes and remedies");
        now.into_iter().for_each(|advice| show_advice(ui, advice, true));
        for advice in others {
            ui.collapsing(advice.title, |ui| ui.add(egui::Label::new(advice.in_words()).wrap()));
        }
    }

    fn headless(&mut self, ui: &mut egui::Ui) {
        let open = self.state.active().and_then(|open| Some((open, open.source.as_ref()?)));
        let command = open
            .and_then(|(open, source)| headless::command(source, &open.settings))
            .unwrap_or_else(|| "resect calibrate FOLDER --json > calibration.json".to_owned());
        ui.add(egui::Label::new(theme::code(&command)).wrap());
        ui.horizontal_wrapped(|ui| {
            if ui.button("Copy the command").clicked() {
                self.commands.push(WorkspaceCommand::Copy(command).into());
            }
            let settings = self.state.settings();
            let button = ui
                .button("Copy the settings")
                .on_hover_text(format!("As TOML, to be saved as {}", headless::SETTINGS_FILE));
            if button.clicked()
                && let Ok(text) = toml::to_string(settings)
            {
                self.commands.push(WorkspaceCommand::Copy(text).into());
            }
        });
        if self.state.extras().is_some_and(|extras| !extras.corrections.is_empty()) {
            let (colour, _) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
            let text = "The command uses your corrections only after you write them to the folder:";
            ui.label(RichText::new(text).color(colour));
            self.button(ui, (Menu::Edit, "Write to deployment.toml…"));
        }
        ui.add_space(4.0);
    }
}

/// Returns the parts of a step that match, each with the buttons that follow it; all parts if the title matches.
fn found_in<'a>(step: &'a GuideStep, has: &impl Fn(&[&str]) -> bool) -> Vec<&'a Part> {
    let whole = has(&[step.title]);
    let mut found = Vec::new();
    let mut above = false;
    for part in step.parts {
        match part {
            Part::Say(text) => above = whole || has(&[step.title, text]),
            Part::Do(names) => {
                let names: Vec<&str> = names.iter().map(|(_, name)| *name).collect();
                above |= has(&names);
            }
            // These are shown with all kinds of doubts, or separately.
            Part::Doubts => continue,
            Part::Open | Part::Verdict | Part::Headless => {}
        }
        if whole || above {
            found.push(part);
        }
    }
    found
}

fn show_advice(ui: &mut egui::Ui, advice: &Advice, present: bool) {
    let title = RichText::new(advice.title);
    let (colour, sign) = theme::severity(Severity::Warning, ui.visuals().dark_mode);
    ui.add_space(2.0);
    if present {
        ui.label(RichText::new(format!("{sign} {}, here", advice.title)).color(colour));
    } else {
        ui.label(title.italics());
    }
    ui.indent(advice.title, |ui| ui.add(egui::Label::new(advice.in_words()).wrap()));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A menu entry with a changed name would silently lose its button.
    #[test]
    fn every_button_is_an_entry_of_a_menu() {
        let state = State::new(egui::Context::default());
        let actions = actions::all(&state);
        for step in &STEPS {
            for part in step.parts {
                let Part::Do(names) = part else { continue };
                for (menu, name) in *names {
                    let known = actions.iter().any(|a| a.menu == *menu && a.name == *name);
                    assert!(known, "{}: {menu:?} has no {name}", step.title);
                }
            }
        }
    }
}
