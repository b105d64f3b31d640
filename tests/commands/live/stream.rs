//! A live deployment equals its recording, despite any faults of the network.

use resect_io::findings::kinds;
use std::collections::BTreeSet;
use std::path::Path;
use std::time::Duration;

use resect_core::analysis::{Answer, Settings};
use resect_core::deployment::Deployment;
use resect_core::progress::Progress;
use resect_io::growing::Growing;
use resect_io::open::open;
use resect_io::sample::Sample;
use resect_io::source::{Extras, Source};
use resect_live::event::{Event, Sent};
use resect_live::recorder::Recorder;
use resect_live::{Engine, Feed, Finished, Session, View, Wanted, bonn, replay};

use super::server::{Server, Step};
use crate::common::{analyse, answer, sample_folder};

pub fn wanted(feed: Feed, record: Option<&Path>) -> Wanted {
    Wanted {
        feed,
        deployment: Some(sample_folder("hd2-tunnel")),
        extras: Extras::default(),
        instruments: None,
        settings: Settings::default(),
        record: record.map(Path::to_owned),
        target_m: 2e-3,
        calculates: true,
    }
}

/// Polls a live deployment until a condition is true.
pub fn wait_until(session: &Session, is: impl Fn(&View) -> bool) {
    while !is(&session.view()) {
        assert!(!session.has_ended(), "it ended before: {:?}", session.view());
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Returns the messages of a sample: some lost, some repeated, neighbours exchanged, a few delayed by many.
fn disturbed() -> Vec<Sent> {
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    let mut sent: Vec<Sent> = replay::messages(&sample, &[0.01; 3].into()).collect();
    let mut index = 0;
    sent.retain(|_| {
        index += 1;
        index % 17 != 0
    });
    let repeated: Vec<(usize, Sent)> =
        (0..sent.len()).step_by(11).map(|k| (k + 5, sent[k].clone())).collect();
    for pair in sent.chunks_exact_mut(2).step_by(3) {
        pair.swap(0, 1);
    }
    for k in (40..sent.len()).step_by(101) {
        let late = sent.remove(k - 30);
        sent.insert(k, late);
    }
    for (place, one) in repeated.into_iter().rev() {
        sent.insert(place.min(sent.len()), one);
    }
    sent
}

/// Returns the stamps of messages by station.
fn stamps(sent: &[Sent]) -> BTreeSet<Vec<u8>> {
    // Stamp, then station, by their offsets in the message.
    sent.iter().map(|one| [&one.payload[4..12], &one.payload[28..29]].concat()).collect()
}

#[track_caller]
fn assert_same_answer(live: &Deployment, recording: &Deployment) {
    assert_eq!(live.tracks, recording.tracks);
    assert_eq!(live.rig, recording.rig);
    let settings = Settings::default();
    let [live, offline] = [live, recording].map(|deployment| {
        let analysis = analyse(deployment, &settings);
        let Answer { calibration, .. } = answer(&analysis);
        assert_eq!(calibration.method.name(), "joint");
        let published = calibration.published.as_ref().expect("beside it");
        (
            calibration.station1_from_station.clone(),
            calibration.covariance.clone(),
            calibration.verdict,
            published.station1_from_station.clone(),
        )
    });
    assert_eq!(live, offline);
}

fn opened(recording: &Path) -> Deployment {
    let extras = Extras { rig: Some(sample_folder("hd2-tunnel")), ..Extras::default() };
    Source::at(recording).with(extras).open(&Progress::default()).expect("it opens")
}

#[test]
fn a_stream_that_breaks_off_twice_gives_what_its_recording_gives_exactly() {
    let sent = disturbed();
    let mut steps = Vec::new();
    let third = sent.len() / 3;
    for (part, begin) in [0, third, 2 * third].into_iter().enumerate() {
        if part > 0 {
            steps.push(Step::BreakOff);
        }
        // A restarted server repeats its last messages.
        let end = if part == 2 { sent.len() } else { begin + third };
        steps.extend(sent[begin.saturating_sub(50)..end].iter().cloned().map(Step::Send));
    }
    let count = steps.iter().filter(|step| matches!(step, Step::Send(_))).count() as u64;
    let server = Server::start(Some("foxglove.websocket.v1"), steps);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("drive.mcap");
    let session =
        Session::start(&wanted(Feed::Url(server.url.clone()), Some(&file))).expect("it begins");
    wait_until(&session, |view| view.messages == count);
    let view = session.view();
    assert_eq!(view.connections, 3);
    assert!(view.late > 0 && view.repeated > 100, "{view:?}");
    let Finished { deployment, recorded, view, .. } = session.stop().expect("it ran");
    server.join();
    let recorded = recorded.expect("it was asked for").expect("written");
    assert_eq!((recorded.messages, view.messages), (count, count));
    let live = deployment.expect("readings");
    let readings: usize = live.tracks.iter().map(|track| track.measurements.len()).sum();
    assert_eq!(readings, stamps(&sent).len());
    let offline = opened(&file);
    let damage = offline.findings.iter().find(|f| f.context.as_deref() == Some("drive.mcap"));
    assert_eq!(damage, None);
    assert_same_answer(&live, &offline);
}

#[test]
fn a_replay_is_the_deployment_again() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("replay.mcap");
    let feed = Feed::Replay { source: Source::sample(Sample::Hd2Tunnel).into(), speed: 1e6 };
    let session = Session::start(&Wanted { deployment: None, ..wanted(feed, Some(&file)) });
    let session = session.expect("it begins");
    while !session.has_ended() {
        std::thread::sleep(Duration::from_millis(20));
    }
    let finished = session.stop().expect("it ran");
    let live = finished.deployment.expect("readings");
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    assert_eq!(live.tracks, sample.tracks);
    assert_same_answer(&live, &sample);
    assert_same_answer(&live, &opened(&file));
    assert!(finished.view.warnings.is_empty(), "{:?}", finished.view.warnings);
}

/// Returns an engine that has received and recorded some of the sample's messages.
fn recording_engine(file: &Path, messages: usize) -> Engine {
    let folder = sample_folder("hd2-tunnel");
    let growing = Growing::around("live", Some(&folder), &Extras::default(), &Progress::default());
    let recorder = Recorder::create(file).expect("a new file");
    let mut engine = Engine::new(growing.expect("a folder"), Some(1.0), Some(recorder), 2e-3);
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    engine.take(Event::Connected("test".to_owned()), 0.0);
    engine.take(Event::Channel(bonn::BonnProtocol::channel()), 0.0);
    for sent in replay::messages(&sample, &[0.01; 3].into()).take(messages) {
        engine.take(Event::Message(sent), 0.0);
    }
    engine
}

#[test]
fn a_recording_that_nobody_ended_holds_all_up_to_the_last_flush() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("killed.mcap");
    let mut engine = recording_engine(&file, 600);
    engine.flush();
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    for sent in replay::messages(&sample, &[0.01; 3].into()).skip(600).take(50) {
        engine.take(Event::Message(sent), 0.0);
    }
    // As after a killed process: its buffers are never written.
    let killed = std::fs::read(&file).expect("there");
    std::fs::write(folder.path().join("copy.mcap"), &killed).expect("written");
    let deployment = open(&folder.path().join("copy.mcap")).expect("what is there opens");
    let readings: usize = deployment.tracks.iter().map(|track| track.measurements.len()).sum();
    assert_eq!(readings, 600);
    assert!(
        deployment
            .findings
            .iter()
            .any(|f| matches!(f.kind, kinds::BAG_DAMAGED | kinds::BAG_INCOMPLETE)),
        "it is said"
    );
    // Cut anywhere, the file keeps the chunks before the cut.
    let cut = &killed[..killed.len() - 100];
    std::fs::write(folder.path().join("cut.mcap"), cut).expect("written");
    assert!(open(&folder.path().join("cut.mcap")).is_ok());
}

#[test]
fn a_recording_is_never_written_over() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("there.mcap");
    std::fs::write(&file, "precious").expect("written");
    let feed = Feed::Url("ws://127.0.0.1:9".to_owned());
    let error = Session::start(&wanted(feed, Some(&file))).err().expect("refused").to_string();
    assert!(error.contains("already exists") && error.contains("; "), "{error}");
    assert_eq!(std::fs::read(&file).expect("there"), b"precious");
}
