//! Rows of the legend, and descriptions of the hidden parts of the scene.

use egui::Color32;

use super::SceneContent;
use super::estimates::TRUTH_COLOUR;
use crate::app::model::{
    Added, Colouring, Command, JudgingCommand, OpenDeployment, SceneCommand, Visibility,
};
use crate::app::prepared::control_points::set_letter;
use crate::app::state::State;
use crate::app::theme;
use resect_core::analysis::Analysis;
use resect_core::calibration::inter_prism::observability::Hold;
use resect_core::deployment::ControlPointSet;
use resect_core::network::Prism;
use resect_core::pipeline::SampleFate;
use resect_tools::palette;

/// A row of the legend, or one of several in a line.
pub struct LegendRow {
    pub swatch: Swatch,
    pub text: String,
    /// Accessible name, which describes the row without colour and position.
    pub name: String,
    pub shown: bool,
    /// Command of a click; `None` if nothing can be hidden.
    pub click: Option<Command>,
}

#[derive(Clone, Copy)]
pub enum Swatch {
    Colour(Color32),
    /// A colour with an outline of the second colour.
    Outlined(Color32, Color32),
    None,
}

/// Rows on one subject.
pub struct Group {
    pub title: &'static str,
    /// True if the rows share one line.
    pub chips: bool,
    pub rows: Vec<LegendRow>,
}

/// Returns all groups: the meaning of the scene's colours, and the switches.
pub fn groups(
    open: &OpenDeployment,
    analysis: &Analysis,
    state: &State,
    content: &SceneContent,
    faint: Color32,
) -> Vec<Group> {
    let visibility = &state.scene.visibility;
    if let Some(truth) = &open.deployment.ground_truth {
        let mut rows = vec![LegendRow {
            swatch: Swatch::Colour(theme::rgb(TRUTH_COLOUR)),
            text: "ground truth".to_owned(),
            name: format!("Ground truth {}", truth.name),
            shown: true,
            click: None,
        }];
        rows.extend(of_estimates(open, visibility, content));
        return vec![Group { title: "", chips: false, rows }];
    }
    let by_station = matches!(state.scene.colouring, Colouring::Fate | Colouring::Station);
    let followed = &analysis.offer.followed;
    let stations = (0..followed.len()).map(|station| LegendRow {
        swatch: Swatch::Colour(theme::rgb(palette::station(station))),
        text: (station + 1).to_string(),
        name: format!("Show station {}", station + 1),
        shown: visibility.stations[station],
        click: shows(visibility.with_station_toggled(station)),
    });
    let prisms = Prism::count(followed);
    let tracks = (0..prisms).map(|prism| LegendRow {
        swatch: Swatch::Colour(if by_station {
            theme::rgb(palette::station(prism))
        } else {
            faint
        }),
        text: (prism + 1).to_string(),
        name: format!("Show the track of prism {}", prism + 1),
        shown: visibility.tracks && visibility.prisms[prism],
        click: shows(visibility.with_prism_toggled(prism, prisms)),
    });
    let mut groups = vec![
        Group { title: "stations", chips: true, rows: stations.collect() },
        Group { title: "tracks", chips: true, rows: tracks.collect() },
        Group { title: "", chips: false, rows: of_colours(analysis, state, content) },
        Group { title: "readings", chips: false, rows: of_fates(analysis, state, faint) },
    ];
    groups.push(Group { title: "", chips: false, rows: of_estimates(open, visibility, content) });
    groups.push(Group { title: "", chips: false, rows: of_runs_beside(open, state, faint) });
    let others = of_what_is_known(analysis, visibility, faint);
    if !open.deployment.control_points.is_empty() {
        let mut toggled = *visibility;
        toggled.control_points ^= true;
        let mut rows = vec![LegendRow {
            swatch: Swatch::Colour(faint),
            text: "control points".to_owned(),
            name: "Show control points".to_owned(),
            shown: visibility.control_points,
            click: shows(toggled),
        }];
        rows.extend(of_sets(open, visibility));
        if has_residuals(open, analysis) {
            rows.push(LegendRow {
                swatch: Swatch::Colour(faint),
                text: "arrows: station − mean".to_owned(),
                name: "Show residuals at control points".to_owned(),
                shown: visibility.control_points && visibility.residuals,
                click: shows(Visibility {
                    control_points: true,
                    residuals: !(visibility.control_points && visibility.residuals),
                    ..*visibility
                }),
            });
        }
        groups.push(Group { title: "", chips: false, rows });
    }
    groups.push(Group { title: "", chips: false, rows: others });
    groups.retain(|group| !group.rows.is_empty());
    groups
}

/// Returns the command that sets this visibility.
fn shows(visibility: Visibility) -> Option<Command> {
    Some(Command::Scene(SceneCommand::Show(visibility)))
}

/// Returns the rows of the visible stations' readings by fate.
fn of_fates(analysis: &Analysis, state: &State, faint: Color32) -> Vec<LegendRow> {
    let visibility = &state.scene.visibility;
    let row = |(place, fate): (usize, SampleFate)| {
        let count = count(analysis, visibility, fate);
        let coloured = state.scene.colouring == Colouring::Fate;
        (count > 0).then(|| LegendRow {
            swatch: Swatch::Colour(if coloured { theme::rgb(palette::fate(fate)) } else { faint }),
            text: format!("{}  {count}", fate.label()),
            name: format!("Show readings: {}", fate.label()),
            shown: visibility.shows_fate(place),
            click: shows(visibility.with_fate_toggled(place)),
        })
    };
    SampleFate::ALL.into_iter().enumerate().filter_map(row).collect()
}

fn count(analysis: &Analysis, visibility: &Visibility, fate: SampleFate) -> usize {
    let stations = 0..analysis.pipeline.fates.len();
    let shown = stations.filter(|station| visibility.stations[*station]);
    shown.map(|station| analysis.pipeline.count(station, fate)).sum()
}

/// Returns the key of the colouring, which hides nothing.
fn of_colours(analysis: &Analysis, state: &State, content: &SceneContent) -> Vec<LegendRow> {
    let key = |colour: palette::Rgb, text: &str| LegendRow {
        swatch: Swatch::Colour(theme::rgb(colour)),
        text: text.to_owned(),
        name: text.to_owned(),
        shown: true,
        click: None,
    };
    let mut rows = Vec::new();
    match state.scene.colouring {
        Colouring::Interval => rows.extend(
            of_intervals(analysis.pipeline.kept_intervals.len())
                .into_iter()
                .map(|(colour, text)| key(colour, &text)),
        ),
        Colouring::Residual if content.colours.scale.is_none() => {
            rows.push(key(palette::NO_VALUE, "no known distances"));
        }
        Colouring::Residual | Colouring::Speed | Colouring::Time => rows.push(LegendRow {
            swatch: Swatch::None,
            ..key(palette::NO_VALUE, "colours: scale below")
        }),
        Colouring::Fate | Colouring::Station => {}
    }
    if content.colours.some_without_value && state.scene.visibility.raw {
        rows.push(key(
            palette::NO_VALUE,
            match state.scene.colouring {
                Colouring::Interval => "in no kept interval",
                _ => "no triplet within 0.5 s",
            },
        ));
    }
    rows
}

/// Returns the key of the intervals, whose colours repeat: "intervals 1, 8, 15".
fn of_intervals(count: usize) -> Vec<(palette::Rgb, String)> {
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
            (palette::INTERVALS[first], format!("{word} {some}{more}"))
        })
        .collect()
}

/// Returns the letter of each set of control points, if there are several.
fn of_sets(open: &OpenDeployment, visibility: &Visibility) -> Vec<LegendRow> {
    let sets = &open.deployment.control_points;
    let row = |(number, set): (usize, &ControlPointSet)| {
        let (letter, count) = (set_letter(number), set.points.len());
        let text = format!("{letter}  {}  {count}", set.file);
        LegendRow { swatch: Swatch::None, name: text.clone(), text, shown: true, click: None }
    };
    let named = sets.len() > 1 && visibility.control_points;
    sets.iter().enumerate().filter(|_| named).map(row).collect()
}

/// Returns rows for trajectories of other systems: the scale of their errors, and each with its outline colour.
fn of_estimates(
    open: &OpenDeployment,
    visibility: &Visibility,
    content: &SceneContent,
) -> Vec<LegendRow> {
    let judging = &open.judging;
    if judging.judgement.newest.is_none() {
        return Vec::new();
    }
    let shown = visibility.estimates;
    let text = match content.worst_m {
        Some(worst_m) => format!("trajectory errors ≤ {:.0} mm", 1e3 * worst_m),
        None => "trajectories".to_owned(),
    };
    let worst = theme::rgb(palette::continuous(1.0));
    let mut rows = vec![LegendRow {
        swatch: Swatch::Colour(worst),
        text,
        name: "Show trajectories of other systems".to_owned(),
        shown,
        click: shows(Visibility { estimates: !shown, ..*visibility }),
    }];
    let has_lines = |one: &Added| judging.judged().any(|(colour, _)| colour == one.colour);
    for (index, one) in judging.added.iter().enumerate().filter(|(_, one)| has_lines(one)) {
        let mut toggled = judging.added.clone();
        toggled[index].shown ^= true;
        rows.push(LegendRow {
            swatch: Swatch::Outlined(worst, theme::rgb(palette::estimate(one.colour))),
            text: one.estimate.name.clone(),
            name: format!("Show the trajectory {}", one.estimate.name),
            shown: shown && one.shown,
            // If none is visible, the switch of the group hides it.
            click: shown.then_some(Command::Judging(JudgingCommand::Set(toggled))),
        });
    }
    rows
}

/// Returns rows for the paths of other open runs, a colour each; the tooltip gives the reason for a run that is not drawn.
fn of_runs_beside(open: &OpenDeployment, state: &State, faint: Color32) -> Vec<LegendRow> {
    if state.deployments.open.len() < 2 {
        return Vec::new();
    }
    let visibility = &state.scene.visibility;
    let shown = visibility.runs_beside;
    let mut rows = vec![LegendRow {
        swatch: Swatch::Colour(faint),
        text: "other open runs".to_owned(),
        name: "Show other open runs in this one's frame".to_owned(),
        shown,
        click: shows(Visibility { runs_beside: !shown, ..*visibility }),
    }];
    let runs = open.beside.newest.as_deref().filter(|_| shown);
    for (number, run) in runs.into_iter().flatten().enumerate() {
        let (swatch, text) = match &run.way {
            Ok(_) => {
                let colour = theme::rgb(palette::run_beside(number));
                (Swatch::Colour(colour), run.name.clone())
            }
            Err(_) => (Swatch::None, format!("not drawn: {}", run.name)),
        };
        rows.push(LegendRow {
            swatch,
            text,
            name: run.in_words(&|angle| state.workspace.units.told(angle)),
            shown: true,
            click: None,
        });
    }
    rows
}

/// Returns true if the calibration has residuals at control points.
pub fn has_residuals(open: &OpenDeployment, analysis: &Analysis) -> bool {
    let answer = analysis.answer.as_ref().ok();
    !open.deployment.control_points.is_empty()
        && answer.is_some_and(|a| a.calibration.placing_control_points(&open.deployment).is_some())
}

/// Returns true if the calibration or the interpolation states standard deviations.
pub fn states_errors(analysis: &Analysis) -> bool {
    let answer = analysis.answer.as_ref().ok();
    analysis.triplets().sigma_m.is_some()
        || answer.is_some_and(|answer| answer.calibration.covariance.is_some())
}

/// Returns the rows for the drawn uncertainties of the stations and of the tracks.
fn of_what_is_known(
    analysis: &Analysis,
    visibility: &Visibility,
    faint: Color32,
) -> Vec<LegendRow> {
    let calibration = analysis.answer.as_ref().ok().map(|answer| &answer.calibration);
    let mut rows = Vec::new();
    let mut push = |colour, text: &str, name: &str, shown, toggled| {
        let (text, name) = (text.to_owned(), name.to_owned());
        rows.push(LegendRow {
            swatch: Swatch::Colour(colour),
            text,
            name,
            shown,
            click: shows(toggled),
        });
    };
    if calibration.is_some_and(|calibration| calibration.covariance.is_some()) {
        let shown = visibility.station_ellipsoids;
        let toggled = Visibility { station_ellipsoids: !shown, ..*visibility };
        push(faint, "ellipsoids of stations, 95 %", "Show ellipsoids of stations", shown, toggled);
    }
    if analysis.triplets().sigma_m.is_some() {
        let shown = visibility.uncertainty;
        let toggled = Visibility { uncertainty: !shown, ..*visibility };
        push(faint, "ellipsoids of tracks, 2 σ", "Show ellipsoids of tracks", shown, toggled);
    }
    if calibration.is_some_and(|calibration| calibration.joint().is_some()) {
        let shown = visibility.tube;
        let toggled = Visibility { tube: !shown, ..*visibility };
        let colour = theme::rgb(palette::METRICS[0]);
        push(colour, "tube of the vehicle, 95 %", "Show the tube of the vehicle", shown, toggled);
    }
    let observed = calibration.and_then(|calibration| calibration.inter_prism());
    if let Some(observed) = observed.map(|details| &details.observability) {
        let shown = visibility.weak_directions;
        let toggled = Visibility { weak_directions: !shown, ..*visibility };
        for hold in [Hold::Free, Hold::Weak].into_iter().filter(|hold| observed.count(*hold) > 0) {
            let text = format!("{} direction of a station", hold.name());
            let name = format!("Show {} directions", hold.name());
            push(theme::rgb(palette::hold(hold)), &text, &name, shown, toggled);
        }
    }
    rows
}

/// Describes the hidden parts of the scene; absent data is not hidden.
pub fn hidden(open: &OpenDeployment, analysis: &Analysis, visibility: &Visibility) -> Vec<String> {
    let mut hidden = Vec::new();
    let numbers = |shown: &[bool], count: usize| {
        let numbers = (1..=count).zip(shown).filter(|(_, shown)| !**shown);
        numbers.map(|(number, _)| format!("{number}")).collect::<Vec<_>>()
    };
    let followed = &analysis.offer.followed;
    for (what, shown, count) in [
        ("station", &visibility.stations, followed.len()),
        ("track", &visibility.prisms, Prism::count(followed)),
    ] {
        let numbers = numbers(shown, count);
        if !numbers.is_empty() {
            let plural = if numbers.len() > 1 { "s" } else { "" };
            hidden.push(format!("{what}{plural} {}", numbers.join(", ")));
        }
    }
    if !visibility.raw {
        hidden.push("readings".to_owned());
    }
    if !visibility.tracks {
        hidden.push("tracks".to_owned());
    }
    for (place, fate) in SampleFate::ALL.into_iter().enumerate() {
        let count = count(analysis, visibility, fate);
        if visibility.raw && !visibility.fates[place] && count > 0 {
            hidden.push(format!("{count} readings ({})", fate.label()));
        }
    }
    let points = !open.deployment.control_points.is_empty();
    let stated = analysis.answer.as_ref().is_ok_and(|a| a.calibration.covariance.is_some());
    for (there, shown, what) in [
        (points, visibility.control_points, "control points"),
        (
            visibility.control_points && has_residuals(open, analysis),
            visibility.residuals,
            "residuals at control points",
        ),
        (analysis.answer.is_ok(), visibility.poses, "vehicle"),
        (open.judging.judgement.newest.is_some(), visibility.estimates, "trajectories"),
        (stated, visibility.station_ellipsoids, "ellipsoids of stations"),
        (analysis.triplets().sigma_m.is_some(), visibility.uncertainty, "ellipsoids of tracks"),
    ] {
        if there && !shown {
            hidden.push(what.to_owned());
        }
    }
    if visibility.estimates {
        let not_shown = open.judging.added.iter().filter(|one| !one.shown);
        hidden.extend(not_shown.map(|one| format!("trajectory {}", one.estimate.name)));
    }
    hidden
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
}
