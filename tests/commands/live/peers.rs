//! The same with the server of `foxglove-sdk` from PyPI, as on robots.

use std::io::{BufRead, BufReader};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use resect_core::analysis::Settings;
use resect_core::progress::Progress;
use resect_io::source::{Extras, Source};
use resect_live::{Feed, Session, Wanted};

use super::stream::wait_until;
use crate::common::{analyse, answer, field_data, sample_folder};

/// Returns a drive and its rig: the field data if available, otherwise a sample.
fn drive() -> [PathBuf; 2] {
    let bag = field_data("2022-07-11-2-bags").map(|bags| bags.join("2022-07-11-2.bag"));
    match (bag, field_data("2022-07-11-2")) {
        (Some(bag), Some(rig)) => [bag, rig],
        _ => [sample_folder("warthog"), sample_folder("warthog")],
    }
}

#[test]
#[ignore = "needs foxglove-sdk: tests/run --peers"]
fn the_server_of_robots_at_twenty_times_the_speed_started_again_twice() {
    let [drive, rig] = drive();
    let script = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/peers/serve_live.py");
    let folder = tempfile::tempdir().expect("a folder");
    // The served messages come from our own recording of a replay, so that both kinds of drives are served in the same form.
    let source = folder.path().join("served.mcap");
    let extras = || Extras { rig: Some(rig.clone()), ..Extras::default() };
    let feed = Feed::Replay { source: Source::at(&drive).with(extras()).into(), speed: 1e9 };
    let wanted = |feed, record: &PathBuf| Wanted {
        feed,
        deployment: None,
        extras: extras(),
        instruments: None,
        settings: Settings::default(),
        record: Some(record.clone()),
        target_m: 2e-3,
        calculates: true,
    };
    let replay = Session::start(&wanted(feed, &source)).expect("it begins");
    while !replay.has_ended() {
        std::thread::sleep(std::time::Duration::from_millis(20));
    }
    replay.stop().expect("it ran");

    let mut server = Command::new("python3")
        .arg(script)
        .arg(&source)
        .args(["--speed", "20"])
        .stdout(Stdio::piped())
        .spawn()
        .expect("python starts");
    let mut said = BufReader::new(server.stdout.take().expect("piped")).lines();
    let url = said.next().expect("a line").expect("text");
    let file = folder.path().join("live.mcap");
    let session = Session::start(&wanted(Feed::Url(url), &file)).expect("it begins");
    // The server prints "over" once everything is sent, and waits for the client to leave.
    let over = said.next().expect("a line").expect("text");
    assert_eq!(over, "over");
    // Messages in transit take no longer.
    std::thread::sleep(std::time::Duration::from_secs(2));
    wait_until(&session, |view| view.connections >= 3);
    let finished = session.stop().expect("it ran");
    _ = server.kill();
    _ = server.wait();
    let view = &finished.view;
    eprintln!(
        "{} messages, {} late, {} repeated, {} connections",
        view.messages, view.late, view.repeated, view.connections
    );
    assert!(view.connections >= 3 && view.late > 0 && view.repeated > 0, "{view:?}");
    let live = finished.deployment.expect("readings");
    let offline = Source::at(&file).with(extras()).open(&Progress::default()).expect("it opens");
    assert_eq!(live.tracks, offline.tracks);
    let [live, offline] = [&live, &offline].map(|deployment| {
        let analysis = analyse(deployment, &Settings::default());
        let calibration = &answer(&analysis).calibration;
        (
            calibration.station1_from_station.clone(),
            calibration.covariance.clone(),
            calibration.verdict,
        )
    });
    assert_eq!(live, offline);
}
