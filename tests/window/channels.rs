//! The channels pane.

use std::path::Path;

use egui::{Key, Modifiers, Theme};
use egui_kittest::kittest::Queryable;
use resect::app::{
    Channel, ChannelPlots, Horizontal, LengthUnit, Pane, SceneCommand, TimeCommand, Units,
    WorkspaceCommand,
};

use crate::harness::{
    LARGE, Part, SMALL, Window, click, press, send, settle, shown, snapshot_of,
    type_and_enter_at_once, window,
};

fn plot(harness: &mut Window, channel: Channel, against: Option<Channel>) {
    let against = against.map(Horizontal::own);
    send(harness, TimeCommand::Plot(ChannelPlots { against, ..ChannelPlots::of(&[channel]) }));
}

#[test]
fn every_channel_is_plotted_over_time_and_against_others() {
    let mut harness = window(LARGE, Theme::Dark);
    for channel in Channel::ALL {
        plot(&mut harness, channel, None);
        // No file of the sample contains the stations' own clocks.
        if channel == Channel::OwnClock {
            harness.get_by_label("No station clocks in these files.");
            continue;
        }
        harness.get_by_label(&format!("{} over time", channel.name()));
        for other in Channel::ALL.into_iter().filter(|other| *other != Channel::OwnClock) {
            if channel.goes_with(other) {
                plot(&mut harness, channel, Some(other));
                harness.get_by_label(&format!("{} against {}", channel.name(), other.name()));
            }
        }
    }
}

#[test]
fn channels_are_drawn_with_their_units() {
    let mut harness = window(LARGE, Theme::Dark);
    plot(&mut harness, Channel::Range, None);
    let sources = shown(&harness).sources();
    assert!((0..3).all(|station| Channel::Range.series(sources, station).is_some()));
    harness.get_all_by_label_contains("values; at the cursor").next().expect("a station");
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "channels-dark");
    let units = Units { length: LengthUnit::Millimetre, ..Units::default() };
    send(&mut harness, WorkspaceCommand::SetUnits(units));
    assert!(harness.get_all_by_label_contains(" mm").count() >= 3);
    let mut harness = window(SMALL, Theme::Light);
    plot(&mut harness, Channel::Y, Some(Channel::X));
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "channels-small-light");
}

#[test]
fn channels_are_chosen_in_the_menu_and_plotted_against_those_that_they_go_with() {
    let mut harness = window(LARGE, Theme::Dark);
    plot(&mut harness, Channel::DistanceError, Some(Channel::Speed));
    harness.get_by_label("distance error against prism speed");
    click(&mut harness, "Show…");
    click(&mut harness, "range");
    press(&mut harness, Modifiers::NONE, Key::Escape);
    let plots = harness.state().state.time.plots.clone();
    let both = [Channel::Range, Channel::DistanceError];
    let against = Some(Horizontal::own(Channel::Speed));
    assert_eq!(plots, ChannelPlots { against, ..ChannelPlots::of(&both) });
}

#[test]
fn two_channels_share_a_plot_by_its_menu_or_by_dragging_it() {
    let mut harness = window(LARGE, Theme::Dark);
    let apart = ChannelPlots::of(&[Channel::Range, Channel::Speed]);
    send(&mut harness, TimeCommand::Plot(apart.clone()));
    click(&mut harness, "Axes of prism speed");
    click(&mut harness, "Join with range");
    harness.get_by_label("range and prism speed over time");
    // Each channel has its axis, and names it.
    harness.get_by_label_contains("× prism speed (right)");
    let joined = harness.state().state.time.plots.clone();
    assert_eq!(joined.shown.len(), 1);
    click(&mut harness, "Axes of range and prism speed");
    click(&mut harness, "prism speed: own plot");
    assert_eq!(harness.state().state.time.plots, apart);
    let [from, to] = ["Axes of prism speed", "range over time"]
        .map(|name| harness.get_by_label(name).rect().center());
    harness.hover_at(from);
    harness.run_steps(1);
    harness.drag_at(from);
    harness.run_steps(1);
    for share in [0.3, 0.6, 1.0] {
        harness.hover_at(from + share * (to - from));
        harness.run_steps(1);
    }
    harness.drop_at(to);
    settle(&mut harness);
    assert_eq!(harness.state().state.time.plots, joined);
    snapshot_of(&mut harness, Part::Pane(Pane::Channels), "channels-shared-dark");
}

#[test]
fn readings_have_the_marks_of_their_fates_in_plot_and_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    let plots = ChannelPlots {
        fates: true,
        against: Some(Horizontal { channel: Channel::DistanceError, index: Some(0) }),
        ..ChannelPlots::of(&[Channel::Range])
    };
    send(&mut harness, TimeCommand::Plot(plots));
    harness.get_by_label("range against distance error of prisms 1–2");
    assert!(harness.query_all_by_label_contains("× rejected").count() >= 2);
    let rows = saved(&mut harness, &folder.path().join("fates.csv"));
    assert_eq!(
        rows[0],
        vec!["series", "time_s", "distance_error_mm_prisms_1_2", "range_m", "fate"]
    );
    let analysis = harness.state().state.analysed().expect("an answer").1;
    for fate in resect_core::pipeline::SampleFate::ALL {
        let written = rows[1..].iter().filter(|row| &row[4] == fate.label()).count();
        let counted: usize = (0..3).map(|station| analysis.pipeline.count(station, fate)).sum();
        assert_eq!(written, counted, "{}", fate.label());
    }
}

#[test]
fn pitch_is_plotted_against_speed_and_saved_with_its_sigma() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    plot(&mut harness, Channel::Pitch, Some(Channel::VehicleSpeed));
    harness.get_by_label("pitch against speed");
    let rows = saved(&mut harness, &folder.path().join("pitch.csv"));
    assert_eq!(rows[0], vec!["series", "time_s", "vehicle_speed_m_per_s", "pitch_rad", "sigma"]);
    let way = shown(&harness).way.newest.clone().expect("made");
    assert_eq!(rows.len() - 1, way.instants.len());
    let pitch_rad = way.instants[0].attitude.expect("a rig").pitch_rad;
    assert_eq!(rows[1][3].parse(), Ok(pitch_rad.value));
    assert_eq!(rows[1][4].parse(), Ok(pitch_rad.sigma));
    // Several channels are written one below the other.
    send(&mut harness, TimeCommand::Plot(ChannelPlots::of(&[Channel::Roll, Channel::Range])));
    let rows = saved(&mut harness, &folder.path().join("two.csv"));
    assert_eq!(rows[0], vec!["series", "time_s", "channel", "value", "sigma"]);
    let count = |name: &str| rows[1..].iter().filter(|row| &row[2] == name).count();
    assert_eq!(count("roll_rad"), way.instants.len());
    let tracks = &shown(&harness).deployment.tracks;
    let readings = tracks.iter().map(|track| track.measurements.len()).sum::<usize>();
    assert_eq!(count("range_m"), readings);
    let has_sigma = |row: &csv::StringRecord| row[4].is_empty() == (&row[2] == "range_m");
    assert!(rows[1..].iter().all(has_sigma));
}

fn saved(harness: &mut Window, path: &Path) -> Vec<csv::StringRecord> {
    send(harness, TimeCommand::SaveChannelsDialog);
    type_and_enter_at_once(harness, &path.display().to_string());
    settle(harness);
    // A background thread writes the file atomically.
    for _ in 0..100 {
        if path.exists() {
            break;
        }
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    let mut table = csv::ReaderBuilder::new().has_headers(false).from_path(path).expect("written");
    table.records().map(|record| record.expect("a row")).collect()
}

#[test]
fn what_is_shown_is_written_as_a_table() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut harness = window(LARGE, Theme::Dark);
    plot(&mut harness, Channel::Range, None);
    let rows = saved(&mut harness, &folder.path().join("ranges.csv"));
    assert_eq!(rows[0], vec!["series", "time_s", "range_m"]);
    let deployment = shown(&harness).deployment.clone();
    let readings = deployment.tracks.iter().map(|track| track.measurements.len()).sum::<usize>();
    assert_eq!(rows.len() - 1, readings);
    let first = &deployment.tracks[0].measurements[0];
    assert_eq!(&rows[1][0], "station 1");
    assert_eq!(rows[1][2].parse(), Ok(first.range_m));
    let time_s: f64 = rows[1][1].parse().expect("a number");
    assert!((time_s - first.time_s).abs() < 1e-6);
    // Hidden series and times out of view are not written.
    let mut visibility = harness.state().state.scene.visibility;
    visibility.stations[..3].copy_from_slice(&[false, true, false]);
    send(&mut harness, SceneCommand::Show(visibility));
    let [from_s, to_s] = [100.0, 130.0].map(|t| shown(&harness).start_s() + t);
    send(&mut harness, TimeCommand::ShowTimes([from_s, to_s]));
    plot(&mut harness, Channel::Range, Some(Channel::Speed));
    let rows = saved(&mut harness, &folder.path().join("some.csv"));
    assert_eq!(rows[0], vec!["series", "time_s", "speed_m_per_s", "range_m"]);
    assert!((20..150).contains(&rows.len()), "{}", rows.len());
    for row in &rows[1..] {
        let time_s: f64 = row[1].parse().expect("a number");
        assert!(&row[0] == "station 2" && (from_s..=to_s).contains(&time_s), "{row:?}");
    }
    assert!(rows[1..].iter().any(|row| !row[2].is_empty()));
}
