//! Which colour is what in the scene, with counts of the fates.

use eframe::egui::{self, Align2, Color32, FontId, Rect, Vec2};

use super::SceneContent;
use crate::analysis::Analysis;
use crate::app::state::{State, Visibility};
use crate::app::theme;
use crate::calibration::inter_prism::observability::Hold;
use crate::palette;
use crate::pipeline::SampleFate;

/// Paints the legend in the corner, over what the scene shows.
pub fn paint(ui: &egui::Ui, rect: Rect, state: &State, content: &SceneContent) {
    let Some((_, analysis)) = state.analysed() else { return };
    let dark = ui.visuals().dark_mode;
    let mut entries = of_points(analysis, &state.visibility);
    entries.extend(of_stations(analysis, &state.visibility, content, theme::faint(dark)));
    if entries.is_empty() {
        return;
    }
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(11.5);
    let text_colour = ui.visuals().text_color();
    let galleys: Vec<_> = entries
        .into_iter()
        .map(|(colour, text)| (colour, painter.layout_no_wrap(text, font.clone(), text_colour)))
        .collect();
    let width = galleys.iter().map(|(_, g)| g.size().x).fold(0.0, f32::max);
    let row = 17.0;
    let frame = Rect::from_min_size(
        rect.left_top() + Vec2::splat(8.0),
        Vec2::new(width + 34.0, galleys.len() as f32 * row + 10.0),
    );
    painter.rect_filled(frame, 4.0, theme::scene_background(dark).gamma_multiply(0.85));
    for (index, (colour, galley)) in galleys.into_iter().enumerate() {
        let middle = frame.left_top() + Vec2::new(14.0, 5.0 + (index as f32 + 0.5) * row);
        painter.circle_filled(middle, 4.0, colour);
        let place = Align2::LEFT_CENTER.anchor_size(middle + Vec2::new(11.0, 0.0), galley.size());
        painter.galley(place.min, galley, text_colour);
    }
}

fn of_points(analysis: &Analysis, visibility: &Visibility) -> Vec<(Color32, String)> {
    let shown = || (0..3).filter(|station| visibility.stations[*station]);
    let mut entries = Vec::new();
    if visibility.tracks {
        entries.extend(shown().map(|station| {
            (theme::rgb(palette::STATIONS[station]), format!("prism {} track", station + 1))
        }));
    }
    if visibility.raw {
        for fate in SampleFate::ALL {
            let count: usize = shown().map(|station| analysis.pipeline.count(station, fate)).sum();
            if count > 0 {
                let name = format!("{}  {count}", fate.label());
                entries.push((theme::rgb(palette::fate(fate)), name));
            }
        }
    }
    entries
}

/// What is drawn at stations 2 and 3.
fn of_stations(
    analysis: &Analysis,
    visibility: &Visibility,
    content: &SceneContent,
    faint: Color32,
) -> Vec<(Color32, String)> {
    if !visibility.stations[1] && !visibility.stations[2] {
        return Vec::new();
    }
    let mut entries = Vec::new();
    if let Some(factor) = content.station_exaggeration {
        entries.push((faint, format!("stations: 95 % ellipsoid, ×{factor}")));
    }
    let observed = (analysis.answer.as_ref().ok())
        .and_then(|answer| answer.calibration.inter_prism())
        .map(|details| &details.observability);
    if let Some(observed) = observed.filter(|_| visibility.weak_directions) {
        for hold in [Hold::Free, Hold::Weak] {
            if observed.count(hold) > 0 {
                let name = format!("{} direction of a station", hold.name());
                entries.push((theme::rgb(palette::hold(hold)), name));
            }
        }
    }
    entries
}
