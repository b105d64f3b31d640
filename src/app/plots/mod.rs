//! Plots: over time ([`residuals`], [`rates`], [`intervals`], [`clocks`], [`channels`], [`way`], all through [`time_plot`]), and others.
//!
//! What no frame should compute is in [`PreparedPlots`] and [`RawReadings`], made by the worker; of long series a frame
//! draws what its [`pyramid`] says.

mod channel_units;
pub mod channels;
pub mod chart;
pub mod clocks;
mod estimate_errors;
pub mod histogram;
pub mod intervals;
pub mod live_sigma;
mod log_axis;
mod marks;
mod navigation;
pub mod plan_map;
pub mod prior_search;
pub mod quads;
pub mod rates;
pub mod residuals;
mod strips;
mod threshold;
mod time_plot;
mod times;
pub mod way;

use egui_plot::{GridInput, GridMark};

pub use strips::{axis_below, bare_axis};
pub use time_plot::still;

use crate::app::model::{Command, Commands, OpenDeployment};
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::{Analysis, Answer};
use resect_core::deployment::pair_label;
use resect_core::palette;

/// Shows a faint sentence where there is nothing else to show; its lines are not stretched, however narrow the pane is.
pub fn in_the_middle(ui: &mut egui::Ui, text: &str) {
    let height = ui.available_height();
    ui.vertical_centered(|ui| {
        ui.add_space(0.4 * height);
        ui.weak(text);
    });
    ui.allocate_space(ui.available_size());
}

/// The answer to plot, if there is one.
fn answer(state: &State) -> Option<(&OpenDeployment, &Analysis, &Answer)> {
    let (open, analysis) = state.analysed()?;
    Some((open, analysis, analysis.answer.as_deref().ok()?))
}

/// The answer whose errors of distances are to be plotted; where there is none, or there are no such errors, it says so.
fn answer_with_errors<'a>(
    ui: &mut egui::Ui,
    state: &'a State,
) -> Option<(&'a OpenDeployment, &'a Analysis, &'a Answer)> {
    let answer = answer(state);
    let has_errors = |answer: &Answer| {
        answer.evaluation.distance_errors_mm.iter().any(|errors| !errors.is_empty())
    };
    let why = match &answer {
        Some((.., answer)) if has_errors(answer) => None,
        Some((_, analysis, _)) if analysis.triplets().is_empty() => Some("No triplets to plot."),
        Some(_) => Some("The inter-prism distances are not known: there are no errors of them."),
        None => Some("No result to plot."),
    };
    let Some(why) = why else { return answer };
    in_the_middle(ui, why);
    None
}

/// The legend as a line of switches above a plot, where it covers no data.
fn pair_switches(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut visibility = state.visibility;
    let dark = ui.visuals().dark_mode;
    for (pair, on) in visibility.pairs.iter_mut().enumerate() {
        ui.checkbox(on, pair_name(pair, dark))
            .on_hover_text("Show or hide this pair of prisms, in all plots");
    }
    if visibility != state.visibility {
        commands.push(Command::Show(visibility));
    }
}

/// Panes narrower than this have room for a station's number only (points).
const NARROW: f32 = 520.0;

/// Stations in their colours, shown or hidden here and in the scene.
fn station_switches(ui: &mut egui::Ui, state: &State, commands: &mut Commands) {
    let mut visibility = state.visibility;
    let (dark, narrow) = (ui.visuals().dark_mode, ui.available_width() < NARROW);
    for (station, on) in visibility.stations.iter_mut().enumerate() {
        let name = format!("station {}", station + 1);
        let text = if narrow { (station + 1).to_string() } else { name.clone() };
        let colour = theme::readable(palette::STATIONS[station], dark);
        let switch = ui.checkbox(on, egui::RichText::new(text).color(colour).strong());
        let role = egui::accesskit::Role::CheckBox;
        switch.widget_info(|| egui::WidgetInfo::selected(role, true, *on, &name));
        switch.on_hover_text(format!("Show or hide {name}, in the scene too"));
    }
    if visibility != state.visibility {
        commands.push(Command::Show(visibility));
    }
}

/// "1–2" in the pair's colour.
fn pair_name(pair: usize, dark: bool) -> egui::RichText {
    egui::RichText::new(pair_label(pair))
        .color(theme::readable(palette::PAIRS[pair], dark))
        .strong()
}

/// Grid lines as near as this are not seen, and as far apart as this in full ink (points): what is plotted stands out of its grid.
const GRID: std::ops::RangeInclusive<f32> = 8.0..=900.0;

/// Numbers along x appear from the first of these distances (points), in full from the second.
const LABELS: std::ops::RangeInclusive<f32> = 20.0..=34.0;

/// Grid lines at 1, 2 or 5 times a power of ten, every one of which has room for its number, and four or five faint
/// ones between.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn round_marks(input: GridInput) -> Vec<GridMark> {
    marks_apart(&input, 40.0)
}

/// Marks along y, where a number is not wide.
#[expect(clippy::needless_pass_by_value, reason = "egui_plot hands it over")]
pub fn close_marks(input: GridInput) -> Vec<GridMark> {
    marks_apart(&input, 20.0)
}

/// Gives the next round number that is not above a positive one.
fn round_below(most: f64) -> f64 {
    let decade = 10_f64.powf(most.log10().floor());
    let digits = [5.0, 4.0, 3.0, 2.0].into_iter().find(|times| times * decade <= most);
    digits.unwrap_or(1.0) * decade
}

/// Two round marks on both sides of zero, for an axis so short that zero alone would be left, which is no scale.
fn marks_about_zero(input: &GridInput) -> Option<[GridMark; 2]> {
    let (low, high) = numbered(input);
    let most = high.min(-low);
    if most <= 0.0 {
        return None;
    }
    let value = round_below(most);
    // A number's height.
    let is_room = 2.0 * value > 12.0 * per_point(input);
    let mark = |value: f64| GridMark { value, step_size: 4.0 * value.abs() };
    is_room.then(|| [mark(-value), mark(value)])
}

/// Marks nearer than this to an end of their axis have no number: it would lie on that of the plot below or above (points).
const ENDS: f64 = 2.5;

/// What a point is worth: egui_plot's least step is eight points wide.
fn per_point(input: &GridInput) -> f64 {
    input.base_step_size / 8.0
}

/// The part of an axis whose marks have numbers.
fn numbered(input: &GridInput) -> (f64, f64) {
    let end = ENDS * per_point(input);
    (input.bounds.0 + end, input.bounds.1 - end)
}

/// Round marks, the strong ones at least so far apart (points).
fn marks_apart(input: &GridInput, points: f64) -> Vec<GridMark> {
    let least = points * per_point(input);
    let decade = 10_f64.powf(least.log10().floor());
    let (times, parts) = [(1.0, 5), (2.0, 4), (5.0, 5), (10.0, 5)]
        .into_iter()
        .find(|(times, _)| times * decade >= least)
        .unwrap_or((10.0, 5));
    let step = times * decade;
    let fine = step / f64::from(parts);
    let (low, high) = input.bounds;
    let (lowest, highest) = numbered(input);
    let strong = (highest / step).floor() - (lowest / step).ceil() + 1.0;
    if let Some(marks) = marks_about_zero(input).filter(|_| strong < 2.0) {
        return marks.to_vec();
    }
    if strong < 1.0 && low >= 0.0 && highest > 0.0 {
        // A single number, as high as there is a round one, is a scale from zero.
        let value = round_below(highest);
        return vec![GridMark { value, step_size: 4.0 * value }];
    }
    ((low / fine).ceil() as i64..=(high / fine).floor() as i64)
        .map(|index| {
            let value = index as f64 * fine;
            let whole = index.rem_euclid(i64::from(parts)) == 0;
            let has_number = whole && (lowest..=highest).contains(&value);
            // The size decides how strong the line is, and only strong ones have a number.
            GridMark { value, step_size: if has_number { step } else { fine } }
        })
        .collect()
}

/// From the least to the greatest, with some room about them.
fn with_room(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let [low, high] = values
        .filter(|value| value.is_finite())
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| [low.min(v), high.max(v)]);
    if low > high {
        return [0.0, 1.0];
    }
    let margin = (0.05 * (high - low)).max(1e-6 * high.abs().max(1.0));
    [low - margin, high + margin]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers of an axis from one bound to the other that is so high (points).
    fn numbers(bounds: (f64, f64), height: f64) -> Vec<f64> {
        let base_step_size = 8.0 * (bounds.1 - bounds.0) / height;
        let marks = close_marks(GridInput { bounds, base_step_size });
        let most = marks.iter().map(|mark| mark.step_size).fold(0.0, f64::max);
        marks.iter().filter(|mark| mark.step_size == most).map(|mark| mark.value).collect()
    }

    #[test]
    fn numbers_at_the_ends_of_an_axis_do_not_reach_into_the_next_plot() {
        assert_eq!(numbers((-6.1, 6.1), 130.0), [-4.0, -2.0, 0.0, 2.0, 4.0]);
        assert_eq!(numbers((-6.9, 6.9), 150.0), [-6.0, -4.0, -2.0, 0.0, 2.0, 4.0, 6.0]);
        // Where the only numbers would be at the ends, smaller ones stand about zero.
        assert_eq!(numbers((-5.1, 5.1), 30.0), [-4.0, 4.0]);
        // And an axis from zero that is lower than the distance of two has one.
        assert_eq!(numbers((0.0, 33.0), 22.0), [20.0]);
    }
}
