//! The pane of the channels.

use std::path::Path;

use egui::Theme;
use egui_kittest::kittest::Queryable;
use resect::app::{
    Channel, LengthUnit, Pane, Plotted, SceneCommand, TimeCommand, Units, WorkspaceCommand,
};

use crate::harness::{
    LARGE, Part, SMALL, Window, send, settle, shown, snapshot_of, type_and_enter_at_once, window,
};

fn plot(harness: &mut Window, channel: Channel, against: Option<Channel>) {
    send(harness, TimeCommand::Plot(Plotted { channel, against }));
}

#[test]
fn every_channel_is_plotted_over_time_and_against_others() {
    let mut harness = window(LARGE, Theme::Dark);
    for channel in Channel::ALL {
        plot(&mut harness, channel, None);
        // No file of the sample tells the stations' own clocks.
        if channel == Channel::OwnClock {
            harness.get_by_label("No file tells the stations' own clocks.");
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
    let (plots, index) = (&shown(&harness).plots, 0);
    assert!(Channel::Range.series(plots, index).is_some());
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
fn a_channel_is_chosen_in_the_menu_where_it_can_stand_against_the_other() {
    let mut harness = window(LARGE, Theme::Dark);
    plot(&mut harness, Channel::DistanceError, Some(Channel::Speed));
    // Ranges are of stations, speeds of the vehicle: they go together, errors of pairs and ranges do not.
    plot(&mut harness, Channel::Range, Some(Channel::Speed));
    harness.get_by_label("range against speed");
    harness.get_by_label("What is plotted").click();
    harness.run_steps(3);
    harness.get_by_label("distance error").click();
    settle(&mut harness);
    let plotted = harness.state().state.time.plotted;
    let expected = Plotted { channel: Channel::DistanceError, against: Some(Channel::Speed) };
    assert_eq!(plotted, expected);
    assert_eq!(plotted.with_channel(Channel::Range).against, Some(Channel::Speed));
    let errors = Plotted { channel: Channel::Range, against: Some(Channel::Height) };
    assert_eq!(errors.with_channel(Channel::DistanceError).against, None);
}

fn saved(harness: &mut Window, path: &Path) -> Vec<csv::StringRecord> {
    send(harness, TimeCommand::SaveChannelsDialog);
    type_and_enter_at_once(harness, &path.display().to_string());
    settle(harness);
    // It is written beside the window, whole or not at all.
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
    // Of what is hidden or out of sight nothing is written.
    let mut visibility = harness.state().state.scene.visibility;
    visibility.stations = [false, true, false];
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
