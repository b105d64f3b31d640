//! Observability of the drive: a bar for each direction, from the least observable to the best, and what to drive next.

use egui::{Color32, Rect, RichText, Sense, Vec2};

use crate::app::theme;
use crate::app::words;
use resect_core::calibration::inter_prism::drive_shape::{DriveShape, PlanView};
use resect_core::calibration::inter_prism::observability::{Direction, Hold, Observability};
use resect_report::glossary;
use resect_report::text::sigma_text;
use resect_tools::palette;

const BAR: Vec2 = Vec2::new(84.0, 12.0);
/// Left end of a bar: the information that noise alone gives to an unobservable direction.
const LEAST: f64 = 1e-7;
const SIGMA_WIDTH: f32 = 62.0;

/// Shows the section, open at first if a direction is unobservable or weak.
pub fn ui(ui: &mut egui::Ui, observed: &Observability) {
    let doubtful = observed.count(Hold::Held) < 8;
    let header = egui::CollapsingHeader::new("Observability").id_salt(("observability", doubtful));
    let shown = header.default_open(doubtful).show(ui, |ui| {
        ui.label(drive_in_words(&observed.drive));
        for direction in &observed.directions {
            row(ui, direction);
        }
        ui.small(
            "Bars: information of the distances about each motion of the stations, relative to the largest, on a log \
             scale from 1e-7 to 1. Beside them: σ along each at the track. The least certain motion is a combination of them.",
        );
        let lead = if doubtful { "Drive next" } else { "To improve the first direction" };
        ui.add(egui::Label::new(format!("{lead}: {}.", observed.advice)).wrap());
    });
    words::explain(shown.header_response, &glossary::OBSERVABILITY);
}

fn row(ui: &mut egui::Ui, direction: &Direction) {
    let dark = ui.visuals().dark_mode;
    let colour = theme::rgb(palette::hold(direction.hold));
    ui.horizontal_top(|ui| {
        let (place, response) = ui.allocate_exact_size(BAR + Vec2::new(0.0, 4.0), Sense::hover());
        response.on_hover_text(format!("{:.1e} of the largest eigenvalue", direction.relative));
        paint_bar(
            ui,
            Rect::from_center_size(place.center(), BAR),
            direction.relative,
            colour,
            dark,
        );
        let sigma = match direction.sigma_m {
            Some(_) => format!("{} mm", sigma_text(direction.sigma_m, 1)),
            None => "–".to_owned(),
        };
        let (place, _) = ui.allocate_exact_size(Vec2::new(SIGMA_WIDTH, 16.0), Sense::hover());
        let font = egui::TextStyle::Monospace.resolve(ui.style());
        let ink = ui.visuals().text_color();
        ui.painter().text(place.right_center(), egui::Align2::RIGHT_CENTER, sigma, font, ink);
        let words = match direction.hold {
            Hold::Held => RichText::new(direction.short()),
            hold => RichText::new(&direction.words)
                .color(theme::readable(palette::hold(hold), dark))
                .strong(),
        };
        let whole = format!("{}: {}", direction.hold.name(), direction.words);
        ui.add(egui::Label::new(words).wrap()).on_hover_text(whole);
    });
}

fn paint_bar(ui: &egui::Ui, place: Rect, relative: f64, colour: Color32, dark: bool) {
    let share = 1.0 - relative.max(LEAST).log10() / LEAST.log10();
    // A bar of zero length is still visible.
    let filled = Vec2::new((share as f32 * place.width()).max(2.0), place.height());
    let ground = theme::faint(dark).gamma_multiply(0.25);
    ui.painter().rect_filled(place, 2.0, ground);
    ui.painter().rect_filled(Rect::from_min_size(place.min, filled), 2.0, colour);
}

fn drive_in_words(drive: &DriveShape) -> String {
    let plan = match drive.plan {
        PlanView::Standing => "The vehicle hardly moved".to_owned(),
        PlanView::StraightLine { length_m, .. } => {
            format!("The drive is one straight line of {length_m:.0} m")
        }
        PlanView::Circle { radius_m, .. } => {
            format!("The drive is one circle of radius {radius_m:.1} m")
        }
        PlanView::TwoLegs { .. } => {
            "The drive is an L, two straight legs with one corner".to_owned()
        }
        PlanView::Winding => "The drive winds".to_owned(),
    };
    let ground = match (drive.is_flat(), drive.is_floor()) {
        (true, true) => {
            format!(", on a flat floor (heights vary by {:.0} mm).", drive.relief_m * 1e3)
        }
        (true, false) => ", without pitch and roll.".to_owned(),
        (false, _) => {
            format!(", and the rig pitches and rolls by {:.1}°.", drive.tilt_rad.to_degrees())
        }
    };
    plan + &ground
}
