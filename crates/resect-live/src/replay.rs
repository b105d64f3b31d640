//! Replays a deployment as a live source, at the speed of the drive or faster: for training, and for tests.

use resect_core::network::PerStation;
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use super::bonn;
use super::event::{Event, Sent};
use resect_core::deployment::{Deployment, Measurement, Track};
use resect_io::format::bag::messages::{Coords, encode_coords};

/// Shift of the stamps of deployments whose clocks begin at zero (s), because ROS treats a stamp of zero as missing.
const LATER_S: f64 = 1_000_000.0;
/// Poll interval of the stop flag (s).
const NAP_S: f64 = 0.1;

/// A reading of a station that waits to be sent.
struct Queued<'a> {
    station: usize,
    measurement: &'a Measurement,
    own_clock_s: Option<f64>,
}

/// Returns the readings of `track` that are not left out.
fn readings(station: usize, track: &Track) -> impl Iterator<Item = Queued<'_>> {
    let used = track.measurements.iter().enumerate().filter(|(k, _)| !track.is_left_out(*k));
    used.map(move |(k, measurement)| {
        let own_clock_s = track.own_clock_s.get(k).copied().filter(|own_s| own_s.is_finite());
        Queued { station, measurement, own_clock_s }
    })
}

/// Returns the messages of a deployment in the order of their stamps; readers add `added_m` to the ranges of each station (m).
pub fn messages(deployment: &Deployment, added_m: &PerStation<f64>) -> impl Iterator<Item = Sent> {
    let later_s =
        if deployment.start_s().is_some_and(|start_s| start_s < 1.0) { LATER_S } else { 0.0 };
    let mut queued: Vec<Queued<'_>> = Vec::new();
    for (station, track) in deployment.tracks.iter().enumerate() {
        queued.extend(readings(station, track));
    }
    queued.sort_by(|a, b| a.measurement.time_s.total_cmp(&b.measurement.time_s));
    queued.into_iter().map(move |Queued { station, measurement, own_clock_s }| {
        let track = &deployment.tracks[station];
        let stamp_s = measurement.time_s + later_s;
        let payload = encode_coords(&Coords {
            stamp_s: Some(stamp_s),
            own_clock_s: own_clock_s.map(|own_s| own_s + later_s),
            station: station as u8 + 1,
            status: 0,
            azimuth_rad: measurement.azimuth_rad,
            zenith_rad: measurement.zenith_rad,
            range_m: measurement.range_m + (track.prism_constant_m - added_m[station]),
        });
        let channel = bonn::BonnProtocol::channel().id;
        Sent { channel, sent_ns: (stamp_s * 1e9) as u64, received_s: stamp_s, payload }
    })
}

/// Sends all messages at `speed` times the speed of the drive, until the end or until it is stopped.
pub fn run(
    deployment: &Deployment,
    added_m: &PerStation<f64>,
    speed: f64,
    stop: &AtomicBool,
    into: &SyncSender<Event>,
) {
    let begin = [
        Event::Connected(format!("replay of {}", deployment.name)),
        Event::Channel(bonn::BonnProtocol::channel()),
    ];
    if begin.into_iter().any(|event| into.send(event).is_err()) {
        return;
    }
    let started = Instant::now();
    let mut first_s = None;
    for sent in messages(deployment, added_m) {
        let due_s = (sent.received_s - *first_s.get_or_insert(sent.received_s)) / speed;
        loop {
            if stop.load(Relaxed) {
                return;
            }
            let wait_s = due_s - started.elapsed().as_secs_f64();
            if wait_s <= 0.0 {
                break;
            }
            std::thread::sleep(Duration::from_secs_f64(wait_s.min(NAP_S)));
        }
        if into.send(Event::Message(sent)).is_err() {
            return;
        }
    }
    // The receiver may have gone, which is no error.
    _ = into.send(Event::Ended);
}
