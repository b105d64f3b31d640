//! Which colour is what in the scene, with counts of the fates.

use eframe::egui::{self, Align2, Color32, FontId, Mesh, Pos2, Rect, Shape, Vec2};

use super::colouring::Scale;
use super::{SceneContent, labels};
use crate::analysis::Analysis;
use crate::app::model::{Colouring, Visibility};
use crate::app::state::State;
use crate::app::theme;
use crate::calibration::inter_prism::observability::Hold;
use crate::palette;
use crate::pipeline::SampleFate;

const ROW: f32 = 17.0;
/// Size of the bar of a continuous scale, and how many pieces it is painted in.
const BAR: Vec2 = Vec2::new(150.0, 10.0);
const BAR_PIECES: usize = 32;
/// Height of the bar with its title and numbers.
const SCALE_HEIGHT: f32 = 46.0;

/// Paints the legend in the corner, over what the scene shows; gives the place it takes.
pub fn paint(ui: &egui::Ui, rect: Rect, state: &State, content: &SceneContent) -> Option<Rect> {
    let (_, analysis) = state.analysed()?;
    let dark = ui.visuals().dark_mode;
    let coloured = state.visibility.raw || state.visibility.tracks;
    let scale = content.colours.scale.as_ref().filter(|_| coloured);
    let mut entries = Vec::new();
    if coloured {
        entries = of_points(analysis, state, content);
    }
    entries.extend(of_stations(analysis, &state.visibility, content, theme::faint(dark)));
    if entries.is_empty() && scale.is_none() {
        return None;
    }
    let painter = ui.painter_at(rect);
    let font = FontId::proportional(11.5);
    let text_colour = ui.visuals().text_color();
    let galleys: Vec<_> = entries
        .into_iter()
        .map(|(colour, text)| (colour, painter.layout_no_wrap(text, font.clone(), text_colour)))
        .collect();
    let text_width = galleys.iter().map(|(_, g)| g.size().x).fold(0.0, f32::max);
    let bar_width = if scale.is_some() { BAR.x + 2.0 } else { 0.0 };
    let scale_height = if scale.is_some() { SCALE_HEIGHT } else { 0.0 };
    let size = Vec2::new(
        (text_width + 34.0).max(bar_width + 28.0),
        scale_height + galleys.len() as f32 * ROW + 10.0,
    );
    let frame = Rect::from_min_size(rect.left_top() + Vec2::splat(8.0), size);
    labels::ground(&painter, frame, dark);
    if let Some(scale) = scale {
        paint_scale(&painter, frame.left_top() + Vec2::new(14.0, 6.0), scale, text_colour);
    }
    for (index, (colour, galley)) in galleys.into_iter().enumerate() {
        let down = scale_height + 5.0 + (index as f32 + 0.5) * ROW;
        let middle = frame.left_top() + Vec2::new(14.0, down);
        painter.circle_filled(middle, 4.0, colour);
        let place = Align2::LEFT_CENTER.anchor_size(middle + Vec2::new(11.0, 0.0), galley.size());
        painter.galley(place.min, galley, text_colour);
    }
    Some(frame)
}

/// The title, the bar, and numbers at its ends and in its middle.
fn paint_scale(painter: &egui::Painter, at: Pos2, scale: &Scale, text_colour: Color32) {
    let font = FontId::proportional(11.5);
    painter.text(at, Align2::LEFT_TOP, scale.title, font.clone(), text_colour);
    let bar = Rect::from_min_size(at + Vec2::new(0.0, 17.0), BAR);
    let mut mesh = Mesh::default();
    for piece in 0..=BAR_PIECES {
        let share = piece as f32 / BAR_PIECES as f32;
        let x = bar.left() + share * bar.width();
        let colour = theme::rgb(palette::continuous(share));
        let first = 2 * piece as u32;
        mesh.colored_vertex(Pos2::new(x, bar.top()), colour);
        mesh.colored_vertex(Pos2::new(x, bar.bottom()), colour);
        if piece < BAR_PIECES {
            mesh.add_triangle(first, first + 1, first + 2);
            mesh.add_triangle(first + 1, first + 2, first + 3);
        }
    }
    painter.add(Shape::mesh(mesh));
    let more = if scale.exceeded { "≥ " } else { "" };
    for (share, align, more) in
        [(0.0, Align2::LEFT_TOP, ""), (0.5, Align2::CENTER_TOP, ""), (1.0, Align2::RIGHT_TOP, more)]
    {
        let value = scale.low + f64::from(share) * (scale.high - scale.low);
        let at = Pos2::new(bar.left() + share * bar.width(), bar.bottom() + 2.0);
        painter.text(at, align, format!("{more}{}", number(value)), font.clone(), text_colour);
    }
}

/// The value with three digits.
fn number(value: f64) -> String {
    let decimals = (2.0 - value.abs().max(1e-3).log10().floor()).clamp(0.0, 3.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn of_points(analysis: &Analysis, state: &State, content: &SceneContent) -> Vec<(Color32, String)> {
    let visibility = &state.visibility;
    let shown = || (0..3).filter(|station| visibility.stations[*station]);
    let of_stations = |what: &str, end: &str| {
        let entry = |station: usize| {
            let colour = theme::rgb(palette::STATIONS[station]);
            (colour, format!("{what} {}{end}", station + 1))
        };
        shown().map(entry).collect::<Vec<_>>()
    };
    let mut entries = Vec::new();
    match state.colouring {
        Colouring::Fate => {
            if visibility.tracks {
                entries = of_stations("prism", " track");
            }
            if visibility.raw {
                for fate in SampleFate::ALL {
                    let count: usize =
                        shown().map(|station| analysis.pipeline.count(station, fate)).sum();
                    if count > 0 {
                        let name = format!("{}  {count}", fate.label());
                        entries.push((theme::rgb(palette::fate(fate)), name));
                    }
                }
            }
        }
        Colouring::Station => entries = of_stations("station", ""),
        Colouring::Interval => entries = of_intervals(analysis.pipeline.kept_intervals.len()),
        Colouring::Residual if content.colours.scale.is_none() => {
            entries
                .push((theme::rgb(palette::NO_VALUE), "no distances to compare with".to_owned()));
        }
        Colouring::Speed | Colouring::Residual | Colouring::Time => {}
    }
    if content.colours.some_without_value && visibility.raw {
        let none = match state.colouring {
            Colouring::Interval => "in no interval that was kept",
            _ => "no triplet within 0.5 s",
        };
        entries.push((theme::rgb(palette::NO_VALUE), none.to_owned()));
    }
    entries
}

/// Colours repeat: "intervals 1, 8, 15".
fn of_intervals(count: usize) -> Vec<(Color32, String)> {
    let colours = palette::INTERVALS.len();
    (0..count.min(colours))
        .map(|first| {
            let own: Vec<String> = (first..count)
                .step_by(colours)
                .map(|interval| (interval + 1).to_string())
                .collect();
            let word = if own.len() > 1 { "intervals" } else { "interval" };
            let more = if own.len() > 3 { ", …" } else { "" };
            let some = own[..own.len().min(3)].join(", ");
            (theme::rgb(palette::INTERVALS[first]), format!("{word} {some}{more}"))
        })
        .collect()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intervals_that_share_a_colour_share_a_line() {
        let lines: Vec<String> = of_intervals(30).into_iter().map(|(_, text)| text).collect();
        assert_eq!(lines.len(), 7);
        assert_eq!(lines[0], "intervals 1, 8, 15, …");
        assert_eq!(lines[6], "intervals 7, 14, 21, …");
        assert_eq!(of_intervals(2)[1].1, "interval 2");
    }

    #[test]
    fn numbers_on_the_scale_are_short() {
        assert_eq!(
            [0.0, 0.65, 1.3, 7.5, 210.0, 420.0].map(number),
            ["0", "0.65", "1.3", "7.5", "210", "420"]
        );
    }
}
