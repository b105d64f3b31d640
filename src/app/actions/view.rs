//! Actions for display.

use egui::Key;

use super::{Action, Menu};
use crate::app::model::channel_plots::{APART, Horizontal};
use crate::app::model::time_scale::tells_time_of_day;
use crate::app::model::{
    AngleUnit, ChannelPlots, Colouring, Command, LayoutPreset, LengthUnit, Pane, Ruler,
    SceneCommand, SceneOptions, TimeCommand, TimeUnit, Units, ViewPreset, Visibility,
    WorkspaceCommand,
};
use crate::app::prepared::channels::Channel;
use crate::app::state::State;
use resect_core::pipeline::SampleFate;

fn view(section: &'static str, name: &str, command: impl Into<Command>) -> Action {
    Action::new(Menu::View, section, name, command)
}

pub fn actions(state: &State) -> Vec<Action> {
    let mut actions = camera(state);
    actions.extend(hiding(state));
    actions.extend(Colouring::ALL.into_iter().map(|colouring| {
        let name = format!("Colour by {}", colouring.title().to_lowercase());
        view("Colours", &name, SceneCommand::Colour(colouring))
            .one_of(state.scene.colouring == colouring)
    }));
    let pane = |pane: Pane| view("Panes", pane.title(), WorkspaceCommand::ShowPane(pane));
    actions.extend(Pane::ALL.map(pane));
    actions.extend(channels(state));
    actions.extend(layouts());
    actions.extend(colours_of_the_window(state));
    actions.extend(units(state));
    actions
}

/// The camera and the ruler.
fn camera(state: &State) -> Vec<Action> {
    let measuring = state.scene.ruler.active;
    let picked = state.active().and_then(|open| open.timeline.picked);
    let ruler = Ruler { active: !measuring, ends: Vec::new() };
    let following = SceneOptions { follow: !state.scene.options.follow, ..state.scene.options };
    let mut actions = vec![
        view("Scene", "Fit", SceneCommand::Look(ViewPreset::Fit))
            .hint("Shows everything that is not hidden; brings back a lost view")
            .key(Key::F),
        view("Scene", "3D", SceneCommand::Look(ViewPreset::Slanted))
            .hint("Oblique view from above")
            .key(Key::D),
        view("Scene", "Top", SceneCommand::Look(ViewPreset::Top)).key(Key::T),
        view("Scene", "Front", SceneCommand::Look(ViewPreset::Front)).key(Key::R),
        view("Scene", "Side", SceneCommand::Look(ViewPreset::Side)).key(Key::S),
        view(
            "Scene",
            "Go to the picked reading",
            picked.map_or(TimeCommand::Unpick, TimeCommand::PickInPlot),
        )
        .hint("Moves the camera to it, as a double-click does")
        .key(Key::G)
        .possible(picked.is_some()),
        view("Scene", "Follow the rig", SceneCommand::SetOptions(following))
            .hint(
                "The camera follows the prisms at the time cursor until it is moved or Fit is used",
            )
            .key(Key::C)
            .on(state.scene.options.follow),
        view("Scene", "Ruler", SceneCommand::Measure(ruler))
            .hint("Measure between two points of the scene")
            .key(Key::M)
            .on(measuring),
    ];
    for station in 0..state.stations() {
        let name = format!("From station {}", station + 1);
        let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4];
        let look = SceneCommand::Look(ViewPreset::Station(station));
        let action = view("Scene", &name, look);
        actions.push(match keys.get(station) {
            Some(key) => action.key(*key),
            None => action,
        });
    }
    actions
}

fn layouts() -> Vec<Action> {
    let keys = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];
    let layout = |(preset, key): (LayoutPreset, Key)| {
        let name = format!("Layout: {}", preset.title());
        view("Layout", &name, WorkspaceCommand::UseLayout(preset)).hint(preset.hint()).ctrl(key)
    };
    let mut actions: Vec<Action> = LayoutPreset::ALL.into_iter().zip(keys).map(layout).collect();
    actions.push(
        view("Layout", "Reset layout", WorkspaceCommand::ResetLayout)
            .hint("All panes back to their initial places")
            .ctrl(Key::Num0),
    );
    actions
}

fn colours_of_the_window(state: &State) -> Vec<Action> {
    use egui::ThemePreference::{Dark, Light, System};
    let themes = [("Theme: as the system", System), ("Theme: dark", Dark), ("Theme: light", Light)];
    let mut actions = Vec::from(themes.map(|(name, theme)| {
        view("Theme", name, WorkspaceCommand::UseTheme(theme))
            .one_of(state.workspace.theme == theme)
    }));
    actions.push(
        view(
            "In the sun",
            "Readable in the sun",
            WorkspaceCommand::ReadInTheSun(!state.workspace.in_the_sun),
        )
        .hint("Large type and full contrast, in either theme")
        .on(state.workspace.in_the_sun),
    );
    let asks = state.workspace.asks_before_closing;
    actions.push(
        view("Closing", "Ask before closing", WorkspaceCommand::AskBeforeClosing(!asks))
            .hint("Asks before a window with an unsaved session closes")
            .on(asks),
    );
    actions
}

fn units(state: &State) -> Vec<Action> {
    let now = state.workspace.units;
    let action = |section, name: String, units: Units| {
        view(section, &name, WorkspaceCommand::SetUnits(units)).also("units").one_of(now == units)
    };
    let mut actions: Vec<Action> = Vec::new();
    actions.extend(LengthUnit::ALL.into_iter().map(|length| {
        let name = format!("Lengths in {}", length.name());
        action("Lengths", name, Units { length, ..now })
    }));
    actions.extend(AngleUnit::ALL.into_iter().map(|angle| {
        let name = format!("Angles in {}", angle.name());
        action("Angles", name, Units { angle, ..now })
    }));
    let tells = state.active().is_none_or(|open| tells_time_of_day(open.start_s()));
    actions.extend(TimeUnit::ALL.into_iter().map(|time| {
        let name = format!("Times in {}", time.name());
        let action = action("Times", name, Units { time, ..now });
        match time {
            TimeUnit::Utc if !tells => {
                action.hint("The stamps of this deployment contain no time of day").possible(false)
            }
            TimeUnit::Utc => action.hint("Time of day from the stations' stamps"),
            _ => action.hint("Since the first measurement"),
        }
    }));
    actions
}

/// The plotted channels, and the channel on the horizontal axis.
fn channels(state: &State) -> Vec<Action> {
    let plots = &state.time.plots;
    let action = |section, name: String, to: ChannelPlots| {
        let on = *plots == to;
        Action::new(Menu::View, section, name, TimeCommand::Plot(to)).on(on)
    };
    let mut actions: Vec<Action> = (Channel::ALL.into_iter())
        .map(|channel| {
            let name = format!("Plot the {}", channel.name());
            let action = action("Channels", name, plots.toggled(channel));
            action.on(plots.shows(channel)).hint(channel.describe().hint)
        })
        .collect();
    let fates = ChannelPlots { fates: !plots.fates, ..plots.clone() };
    actions.push(
        action("Channels", "Fates of readings in the plots".to_owned(), fates)
            .on(plots.fates)
            .hint("Rejected readings have crosses, in the colours of the scene"),
    );
    let over_time = ChannelPlots { against: None, ..plots.clone() };
    actions.push(action("Channels against", "Plot against time".to_owned(), over_time));
    actions.extend(Channel::ALL.into_iter().map(|other| {
        let name = format!("Plot against the {}", other.name());
        let against = Horizontal::own(other);
        let to = ChannelPlots { against: Some(against), ..plots.clone() };
        let possible = plots.goes_against(against);
        let hint = if possible { other.describe().hint } else { APART };
        action("Channels against", name, to).hint(hint).possible(possible)
    }));
    actions
}

/// Visibility in the scene, the legend, and the scale of errors.
fn hiding(state: &State) -> Vec<Action> {
    let shown = |name: &str, on: bool, visibility: Visibility| {
        Action::new(Menu::View, "Shown in the scene", name, SceneCommand::Show(visibility)).on(on)
    };
    let (now, scene) = (&state.scene.visibility, state.scene.options);
    let mut actions = vec![
        shown("Everything in the scene", false, now.with_the_whole_scene())
            .hint("Shows everything that the legend or a switch has hidden")
            .possible(*now != now.with_the_whole_scene()),
    ];
    for one in 0..state.stations() {
        let name = format!("Station {} in the scene", one + 1);
        actions.push(shown(&name, now.stations[one], now.with_station_toggled(one)));
    }
    for one in 0..state.prisms() {
        let name = format!("Track of prism {}", one + 1);
        let on = now.tracks && now.prisms[one];
        actions.push(shown(&name, on, now.with_prism_toggled(one, state.prisms())));
    }
    for (place, fate) in SampleFate::ALL.into_iter().enumerate() {
        let name = format!("Readings: {}", fate.label());
        actions.push(shown(&name, now.shows_fate(place), now.with_fate_toggled(place)));
    }
    let set = |section, name: &str, options| {
        Action::new(Menu::View, section, name, SceneCommand::SetOptions(options))
    };
    let legend = |name: &str, open: Option<bool>| {
        set("Legend", name, SceneOptions { legend_open: open, ..scene })
            .one_of(scene.legend_open == open)
    };
    actions.extend([
        legend("Legend: open where there is room", None),
        legend("Legend: open", Some(true)),
        legend("Legend: folded", Some(false)),
    ]);
    actions.extend(SceneOptions::ERROR_SCALES.into_iter().map(|scale| {
        let options = SceneOptions { ellipsoid_scale: scale, ..scene };
        set("Ellipsoids", &format!("Ellipsoids ×{scale}"), options)
            .one_of(scene.ellipsoid_scale == scale)
    }));
    let scales = SceneOptions::ERROR_SCALES.map(Some);
    actions.extend([None].into_iter().chain(scales).map(|scale| {
        let options = SceneOptions { residual_scale: scale, ..scene };
        let name = scale.map_or("to fit the view".to_owned(), |scale| format!("×{scale}"));
        set("Residual arrows", &format!("Residual arrows {name}"), options)
            .one_of(scene.residual_scale == scale)
    }));
    actions.extend(SceneOptions::HEIGHT_SCALES.into_iter().map(|scale| {
        let options = SceneOptions { height_scale: scale, ..scene };
        set("Heights", &format!("Heights ×{scale}"), options).one_of(scene.height_scale == scale)
    }));
    actions.extend(SceneOptions::TRAILS_S.into_iter().map(|trail_s| {
        let options = SceneOptions { trail_s, ..scene };
        // The row of the menu shows the last word, so number and unit must be one.
        let length = SceneOptions::trail_in_words(trail_s).replace(' ', "\u{a0}");
        set("Trail", &format!("Trail: {length}"), options)
            .hint("Length of the trail behind each prism at the time cursor")
            .one_of(scene.trail_s == trail_s)
    }));
    actions
}
