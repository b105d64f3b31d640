//! Questions of the window: the roles of files, topics and columns, and the purpose of files.

use egui::Vec2;
use std::path::Path;

use egui::Theme;
use egui::accesskit::Role;
use egui_kittest::kittest::Queryable;
use resect::app::{Asked, DeploymentCommand, Pane, ResectWindow, SessionCommand, Units};
use resect_core::deployment::{ColumnMapping, OneOrMany, Overrides};
use resect_io::error::{Question, Topic};
use resect_io::simulation_files::write_folder;
use resect_io::source::Source;
use resect_tools::simulation::{Preset, simulate};

use crate::common::sample_folder;
use crate::harness::{LARGE, Part, SMALL, Window, click, send, settle, shown, snapshot_of, window};

fn ask(harness: &mut Window, question: Question, source: Source) {
    let window: &mut ResectWindow = harness.state_mut();
    window.state.ask_of_data(question, source);
    settle(harness);
}

fn asked(harness: &Window) -> &Asked {
    harness.state().state.asked().expect("something is asked")
}

/// Selects an entry of a combo box.
fn choose(harness: &mut Window, name: &str, choice: &str) {
    harness.get_by_role_and_label(Role::ComboBox, name).click();
    harness.run_steps(3);
    harness.get_by_role_and_label(Role::Button, choice).click();
    settle(harness);
}

fn corrections(harness: &Window) -> Overrides {
    shown(harness).source.as_ref().expect("a source").extras.corrections.clone()
}

fn copy(name: &str, to: &Path) {
    std::fs::copy(sample_folder("warthog").join(name), to).expect("copied");
}

/// Copies a file without its last line, so that the two are different recordings.
fn copy_without_end(name: &str, to: &Path) {
    let text = std::fs::read_to_string(sample_folder("warthog").join(name)).expect("read");
    let end = text.trim_end().rfind('\n').expect("lines");
    std::fs::write(to, &text[..end]).expect("written");
}

#[test]
fn two_recordings_in_a_folder_are_a_question() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("drive");
    write_folder(&simulate(Preset::UnevenGround, 1), &path).expect("written");
    copy("inter_prism.csv", &path.join("zz another.csv"));
    let mut harness = window(LARGE, Theme::Dark);
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    assert!(harness.state().state.toasts.errors().next().is_none());
    harness.get_by_label("Choose the file with the tracks");
    // Without a selection nothing is opened.
    click(&mut harness, "Open");
    assert!(matches!(asked(&harness), Asked::Tracks(_)));
    click(&mut harness, "zz another.csv");
    click(&mut harness, "Open");
    assert!(harness.state().state.asked().is_none());
    assert_eq!(corrections(&harness).tracks, Some(OneOrMany::One("zz another.csv".into())));
    // The answer is stored: reading again asks nothing.
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
    assert!(harness.state().state.asked().is_none());
}

#[test]
fn a_session_waits_for_the_answer_to_what_its_data_leaves_open() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::create_dir(folder.path().join("drive")).expect("created");
    copy("inter_prism.csv", &folder.path().join("drive/a.csv"));
    copy_without_end("inter_prism.csv", &folder.path().join("drive/b.csv"));
    let session = folder.path().join("a.resect.toml");
    let text = "resect_session = 1\n[[deployment]]\npath = \"drive\"\n\
                [[deployment]]\nsample = \"hd2-tunnel\"\n";
    std::fs::write(&session, text).expect("written");
    for answered in [true, false] {
        let mut harness = window(LARGE, Theme::Dark);
        send(&mut harness, DeploymentCommand::OpenPaths(vec![session.clone()]));
        assert!(matches!(asked(&harness), Asked::Tracks(_)));
        assert!(harness.state().state.session.missing.is_empty());
        assert_eq!(harness.state().state.session().deployments.len(), 2, "it stays in the session");
        if answered {
            click(&mut harness, "b.csv");
            click(&mut harness, "Open");
            let open = &harness.state().state.deployments.open;
            assert_eq!((open.len(), harness.state().state.session.missing.len()), (2, 0));
            let tracks =
                open[0].source.as_ref().and_then(|it| it.extras.corrections.tracks.clone());
            assert_eq!(tracks, Some(OneOrMany::One("b.csv".into())));
        } else {
            harness.key_press(egui::Key::Escape);
            settle(&mut harness);
            assert_eq!(harness.state().state.deployments.open.len(), 1, "the others are opened");
            assert_eq!(harness.state().state.session.missing.len(), 1);
            send(&mut harness, SessionCommand::RetryMissing);
            assert!(matches!(asked(&harness), Asked::Tracks(_)));
        }
    }
}

#[test]
fn a_question_can_be_left() {
    let folder = tempfile::tempdir().expect("a folder");
    // The picture contains its name.
    let drive = folder.path().join("drive");
    std::fs::create_dir(&drive).expect("created");
    copy("inter_prism.csv", &drive.join("a.csv"));
    copy_without_end("inter_prism.csv", &drive.join("b.csv"));
    let mut harness = window(SMALL, Theme::Light);
    let name = shown(&harness).deployment.name.clone();
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(&drive)));
    snapshot_of(&mut harness, Part::Middle(Vec2::new(640.0, 320.0)), "asked-tracks-light");
    harness.key_press(egui::Key::Escape);
    settle(&mut harness);
    assert!(harness.state().state.asked().is_none());
    assert_eq!(shown(&harness).deployment.name, name);
}

#[test]
fn topics_are_proposed_and_can_be_exchanged() {
    let topic = |name: &str, messages| Topic {
        name: name.to_owned(),
        message_type: "geometry_msgs/PointStamped".to_owned(),
        messages,
    };
    let topics = vec![topic("/rts10", 812), topic("/rts2", 790), topic("/rts1", 805)];
    let question = Question::Topics { file: "drive.bag".to_owned(), topics };
    let mut harness = window(SMALL, Theme::Dark);
    ask(&mut harness, question, Source::at(sample_folder("warthog")));
    let Asked::Stations(proposed) = asked(&harness) else { panic!("topics") };
    assert_eq!(proposed.stations, [2, 1, 0]);
    snapshot_of(&mut harness, Part::Middle(Vec2::new(640.0, 320.0)), "asked-topics-dark");
    choose(
        &mut harness,
        "The topic of station 1",
        "/rts2  (geometry_msgs/PointStamped, 790 messages)",
    );
    harness.get_by_label_contains("a topic of its own");
    choose(
        &mut harness,
        "The topic of station 2",
        "/rts1  (geometry_msgs/PointStamped, 805 messages)",
    );
    click(&mut harness, "Open");
    let expected = ["/rts2", "/rts1", "/rts10"].map(str::to_owned);
    assert_eq!(corrections(&harness).topics, Some(expected.into()));
}

/// The sample's tracks with an unknown header.
fn foreign(folder: &Path) -> std::path::PathBuf {
    let tracks = std::fs::read_to_string(sample_folder("warthog").join("inter_prism.csv"));
    let tracks = tracks.expect("readable");
    let (_, rows) = tracks.split_once('\n').expect("a header");
    let path = folder.join("foreign.csv");
    std::fs::write(&path, format!("aa,bb,cc,kk,ee\n{rows}")).expect("written");
    path
}

#[test]
fn columns_are_named_with_the_first_rows_in_sight() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = foreign(folder.path());
    for (size, theme, name) in [
        (LARGE, Theme::Dark, "asked-columns-dark"),
        (SMALL, Theme::Light, "asked-columns-small-light"),
    ] {
        let mut harness = window(size, theme);
        send(&mut harness, DeploymentCommand::OpenSource(Source::at(&path)));
        let Asked::Columns(columns) = asked(&harness) else { panic!("columns") };
        assert_eq!(columns.preview.header.len(), 5);
        // Not all columns can be guessed: the table cannot be opened yet.
        assert!(!asked(&harness).is_answered());
        click(&mut harness, "Open");
        assert!(harness.state().state.asked().is_some());
        choose(&mut harness, "Column of time", "aa");
        choose(&mut harness, "Column of station", "bb");
        choose(&mut harness, "Column of range", "cc");
        choose(&mut harness, "Column of azimuth", "kk");
        snapshot_of(
            &mut harness,
            Part::Middle(Vec2::new(1100.0, 640.0)),
            &format!("{name}-unread"),
        );
        choose(&mut harness, "Column of vertical angle", "ee");
        harness.get_by_label("The first rows read.");
        snapshot_of(&mut harness, Part::Middle(Vec2::new(1100.0, 640.0)), name);
        click(&mut harness, "is in the ranges already");
        click(&mut harness, "Open");
        let own = corrections(&harness);
        assert_eq!(own.ranges_include_prism_constant, Some(true));
        let expected = ColumnMapping {
            time: "aa".to_owned(),
            station: Some("bb".to_owned()),
            range: Some("cc".to_owned()),
            azimuth: Some("kk".to_owned()),
            vertical: Some("ee".to_owned()),
            ..ColumnMapping::default()
        };
        assert_eq!(own.columns, Some(expected));
        let opened = &shown(&harness).deployment;
        assert_eq!(opened.name, "foreign");
        assert!(opened.tracks.iter().all(|track| track.measurements.len() > 900));
        assert!(opened.tracks.iter().all(|track| track.prism_constant_m == 0.0));
    }
}

#[test]
fn a_folder_with_only_a_rig_asks_what_it_is_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let rig = folder.path().join("rig");
    std::fs::create_dir(&rig).expect("made");
    std::fs::write(rig.join("calibration_results.csv"), "0.9 1.0 1.1\n").expect("written");
    let mut harness = window(SMALL, Theme::Dark);
    let before = shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m;
    let name = shown(&harness).deployment.name.clone();
    send(&mut harness, DeploymentCommand::OpenPaths(vec![rig.clone()]));
    snapshot_of(&mut harness, Part::Middle(Vec2::new(640.0, 320.0)), "asked-files-dark");
    assert_eq!(shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m, before);
    click(&mut harness, "Cancel");
    assert_eq!(shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m, before);
    send(&mut harness, DeploymentCommand::OpenPaths(vec![rig.clone()]));
    click(&mut harness, &format!("Use for {name}"));
    let now = shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m;
    assert_eq!(now, [0.9, 1.0, 1.1].into());
    assert_eq!(
        harness.state().state.deployments.undo.undo_name(Units::default()),
        "Undo rig as read → rig"
    );
    send(&mut harness, DeploymentCommand::Undo);
    assert_eq!(shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m, before);
    // As a deployment it has no tracks, which an error reports.
    send(&mut harness, DeploymentCommand::OpenPaths(vec![rig]));
    click(&mut harness, "Open as a deployment of its own");
    assert_eq!(harness.state().state.deployments.open.len(), 1);
    let (text, _) = harness.state().state.toasts.errors().next().expect("said");
    assert!(text.contains("no tracks of the stations"), "{text}");
}

#[test]
fn a_recording_without_a_rig_ends_in_a_calibration() {
    let folder = tempfile::tempdir().expect("a folder");
    copy("inter_prism.csv", &folder.path().join("tracks.csv"));
    let mut harness = window(LARGE, Theme::Dark);
    let known = shown(&harness).deployment.rig.clone().expect("a rig").inter_prism_m;
    send(&mut harness, DeploymentCommand::OpenSource(Source::at(folder.path().join("tracks.csv"))));
    assert!(harness.state().state.analysed().expect("open").1.answer.is_err());
    snapshot_of(&mut harness, Part::Pane(Pane::Result), "no-rig-dark");
    for (pair, distance_m) in ["1–2", "1–3", "2–3"].iter().zip(&known) {
        let name = format!("Distance of prisms {pair}");
        harness.get_by_role_and_label(Role::SpinButton, &name).focus();
        harness.run_steps(2);
        crate::harness::type_and_enter_at_once(&mut harness, &format!("{distance_m}"));
    }
    let (open, analysis) = harness.state().state.analysed().expect("open");
    assert_eq!(open.deployment.rig.as_ref().expect("given").inter_prism_m, known);
    assert!(analysis.answer.is_ok());
}
