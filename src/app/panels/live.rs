//! The live deployment in large type, for reading at arm's length in sunlight. It shows if the data suffice, the state of the stations,
//! warnings, and what to drive next. Without a live deployment, it shows the form that starts one.

mod form;

use egui::{Color32, RichText, Vec2};

use super::scrolled;
use crate::app::model::Commands;
use crate::app::model::live::{LiveCommand, LiveForm};
use crate::app::model::units::unbroken;
use crate::app::plots::live_sigma;
use crate::app::state::State;
use crate::app::theme;
use resect_core::calibration::Verdict;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::deployment::Severity;
use resect_live::status::StationStatus;
use resect_live::{Link, View};
use resect_tools::palette;

const LARGE: f32 = 34.0;
const MIDDLE: f32 = 18.0;
/// Least height of the plot of σ, and of the content below it (points).
const CURVE: f32 = 190.0;
const BELOW: f32 = 150.0;
/// Size of a station's lamp, and least width of the text beside it (points).
const LAMP: f32 = 16.0;
const STATION: f32 = 90.0;

pub fn ui(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    scrolled(ui, |ui| {
        let live = &state.live;
        match (&live.view, live.is_running()) {
            (Some(view), true) => running(ui, state, view, commands),
            (Some(view), false) if !live.is_changing => {
                form::ui(ui, state, commands);
                ui.separator();
                ui.strong("Last run");
                told(ui, view);
            }
            _ => form::ui(ui, state, commands),
        }
    });
}

fn running(ui: &mut egui::Ui, state: &State, view: &View, commands: &mut Commands) {
    told(ui, view);
    ui.add_space(6.0);
    ui.horizontal_wrapped(|ui| {
        let mut target_mm = state.live.form.target_mm;
        ui.label("Target");
        if form::target(ui, &mut target_mm).changed() {
            let form = LiveForm { target_mm, ..state.live.form.clone() };
            commands.push(LiveCommand::Edit(form).into());
        }
        if ui.button(RichText::new("Stop").size(MIDDLE)).clicked() {
            commands.push(LiveCommand::Stop.into());
        }
    });
    below(ui, view);
}

/// Shows the messages, the most important first.
fn told(ui: &mut egui::Ui, view: &View) {
    headline(ui, view);
    let sentence = RichText::new(unbroken(&view.sentence)).size(MIDDLE);
    ui.add(egui::Label::new(sentence).wrap());
    ui.add_space(4.0);
    for warning in &view.warnings {
        let (colour, sign) = theme::severity(Severity::Problem, ui.visuals().dark_mode);
        let line = RichText::new(format!("{sign} {}", warning.finding)).size(MIDDLE).color(colour);
        ui.add(egui::Label::new(line).wrap());
    }
    ui.add_space(6.0);
    stations(ui, view);
    ui.add_space(6.0);
    live_sigma::legend(ui, view);
    live_sigma::ui(ui, view, CURVE.max(ui.clip_rect().bottom() - ui.cursor().top() - BELOW));
}

/// Shows if the data suffice, or the verdict that keeps them from it, and σ.
fn headline(ui: &mut egui::Ui, view: &View) {
    let dark = ui.visuals().dark_mode;
    ui.horizontal_wrapped(|ui| {
        let Some(judged) = view.shown() else {
            ui.label(RichText::new("no result yet").size(LARGE));
            return;
        };
        let (word, verdict) = match judged.verdict {
            Verdict::Good if view.enough => ("enough", Verdict::Good),
            // A good answer whose σ is too large.
            Verdict::Good => ("not yet", Verdict::Weak),
            verdict => (verdict.name(), verdict),
        };
        let [fill, ink] = palette::verdict(verdict).map(theme::rgb);
        egui::Frame::new().fill(fill).inner_margin(Vec2::new(10.0, 2.0)).corner_radius(4.0).show(
            ui,
            |ui| {
                ui.label(RichText::new(word.to_uppercase()).size(LARGE).strong().color(ink));
            },
        );
        match judged.far_end {
            Some(far_end) => {
                let sigma = format!("± {:.1} mm", far_end.sigma_m * 1e3);
                ui.label(RichText::new(sigma).size(LARGE).strong());
                ui.label(
                    RichText::new(format!("target\u{a0}{:.1}\u{a0}mm", view.target_m * 1e3))
                        .size(MIDDLE),
                );
            }
            None => {
                let open = RichText::new("not determined yet").size(LARGE);
                ui.label(open.color(theme::readable(palette::hold(Hold::Free), dark)));
            }
        }
    });
}

/// Shows a lamp per station, with the details of its state.
fn stations(ui: &mut egui::Ui, view: &View) {
    let (available, gap) = (ui.available_width(), ui.spacing().item_spacing.x);
    let fitting = (((available + gap) / (STATION + gap)) as usize).max(1);
    let all: Vec<(usize, &StationStatus)> = view.stations.iter().enumerate().collect();
    // Rows of equal length, so that the last one is not a single station.
    let rows = all.len().div_ceil(fitting).max(1);
    let in_row = all.len().div_ceil(rows).max(1);
    let width = ((available + gap) / in_row as f32 - gap).max(STATION);
    for row in all.chunks(in_row) {
        ui.horizontal_top(|ui| {
            for (station, status) in row {
                ui.vertical(|ui| {
                    ui.set_width(width);
                    of_station(ui, *station, status, view.link == Link::Ended);
                });
            }
        });
    }
}

fn of_station(ui: &mut egui::Ui, station: usize, status: &StationStatus, has_ended: bool) {
    let dark = ui.visuals().dark_mode;
    let (lamp, words) = match (status.locked, status.age_s) {
        _ if has_ended => (theme::faint(dark), "ended".to_owned()),
        (true, _) => (theme::rgb(palette::verdict(Verdict::Good)[0]), "locked".to_owned()),
        (false, Some(age_s)) => {
            (theme::rgb(palette::hold(Hold::Free)), format!("lost {age_s:.0} s ago"))
        }
        (false, None) => (theme::faint(dark), "no reading yet".to_owned()),
    };
    ui.horizontal(|ui| {
        let (place, _) = ui.allocate_exact_size(Vec2::splat(LAMP), egui::Sense::hover());
        ui.painter().circle_filled(place.center(), LAMP / 2.0, lamp);
        let name = RichText::new(format!("{}", station + 1)).size(MIDDLE).strong();
        ui.label(name.color(theme::readable(palette::station(station), dark)));
        ui.label(RichText::new(words).size(MIDDLE));
    });
    let mut line = |name: &str, value: Option<String>| {
        if let Some(value) = value {
            ui.label(unbroken(&format!("{name} {value}")));
        }
    };
    line("rate", status.rate_hz.map(|rate| format!("{rate:.1} Hz")));
    line(
        "last reading",
        status.age_s.filter(|_| !has_ended).map(|age_s| format!("{age_s:.1} s ago")),
    );
    line("latency", status.latency_s.map(|late_s| format!("{:.0} ms", late_s * 1e3)));
    let late = status.late_s.map(|[late_s, sigma_s]| {
        let side = if late_s < 0.0 { "early" } else { "late" };
        format!("{side} by {:.1} ± {:.1} ms", late_s.abs() * 1e3, sigma_s * 1e3)
    });
    line("clock", late);
    line(
        "lost its prism",
        match status.lock_losses {
            0 => None,
            1 => Some("once".to_owned()),
            count => Some(format!("{count} times")),
        },
    );
}

/// Shows source, recording, and data left out.
fn below(ui: &mut egui::Ui, view: &View) {
    let faint: Color32 = ui.visuals().weak_text_color();
    let mut line =
        |words: String| ui.add(egui::Label::new(RichText::new(words).color(faint)).wrap());
    match &view.link {
        Link::Connecting => line("connecting…".to_owned()),
        Link::Connected(name) => line(format!("connected to {name}")),
        Link::Lost { why, .. } => line(format!("not connected: {why}")),
        Link::Ended => line("the replay is over".to_owned()),
    };
    line(format!(
        "{} readings in {:.0} s; {} repeated, {} late, {} impossible",
        view.readings(),
        view.driven_s,
        view.repeated,
        view.late,
        view.dropped
    ));
    for left in &view.left_out {
        line(format!("left out: {} ({})", left.count, left.first));
    }
    if let Some(recorded) = &view.recorded {
        line(format!("recorded {} messages to {}", recorded.messages, recorded.path.display()));
    }
    if let Some(age_s) = view.answer_age_s.filter(|age_s| *age_s >= 10.0) {
        line(format!("the result is from the readings {age_s:.0} s ago"));
    }
}
