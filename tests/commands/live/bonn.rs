//! The stream of Bonn's network, which repeats the latest readings and names instruments.

use resect_live::kinds;
use std::time::Duration;

use resect_io::sample::Sample;
use resect_io::source::Extras;
use resect_live::{Feed, Session, Wanted};
use serde_json::json;

use super::server::{Server, Step};
use super::stream::{wait_until, wanted};
use crate::common::sample_folder;

const INSTRUMENTS: [&str; 3] = ["7a11", "0b22", "c333"];

/// Returns the latest readings of all instruments as they grow, each message three times.
fn steps(readings: usize) -> Vec<Step> {
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    let mut steps = Vec::new();
    for k in 0..readings {
        let latest: Vec<_> = (0..3)
            .map(|station| {
                let m = sample.tracks[station].measurements[k];
                json!({
                    "controller_timestamp": m.time_s + 0.01, "sensor_timestamp": m.time_s, "response_length": 87,
                    "geocom_return_code": 0, "rpc_return_code": 0, "distance": m.range_m + 0.01,
                    "horizontal_angle": m.azimuth_rad, "vertical_angle": m.zenith_rad,
                    "rts_job_id": "j", "rts_id": INSTRUMENTS[station],
                })
            })
            .collect();
        let text = json!(latest).to_string();
        steps.extend([Step::Text(text.clone()), Step::Text(text.clone()), Step::Text(text)]);
    }
    steps
}

#[test]
fn repeated_readings_are_taken_once_with_the_stations_that_are_named() {
    let server = Server::start(None, steps(40));
    let mut wanted = wanted(Feed::Url(format!("{}/ws/measurements/stream", server.url)), None);
    wanted.instruments = Some(INSTRUMENTS.map(str::to_owned).into());
    let session = Session::start(&wanted).expect("it begins");
    wait_until(&session, |view| view.readings() == 120);
    let view = session.view();
    let repeats: Vec<_> = view.left_out.iter().filter(|left| left.what == "repeats").collect();
    // The last readings wait for the next one.
    assert!((230..=240).contains(&repeats[0].count), "{repeats:?}");
    let live = session.stop().expect("it ran").deployment.expect("readings");
    server.join();
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    for (track, expected) in live.tracks.iter().zip(&sample.tracks) {
        assert_eq!(track.measurements.len(), 40);
        for (found, expected) in track.measurements.iter().zip(&expected.measurements) {
            assert!((found.time_s - expected.time_s).abs() < 1e-6);
            let apart_m = track.polar(found).range_m - (expected.range_m + 0.01);
            assert!(apart_m.abs() < 1e-9, "{apart_m}");
        }
    }
}

#[test]
fn instruments_that_nobody_names_are_asked_for() {
    let server = Server::start(None, steps(5));
    // Matched by content, not by path.
    let wanted = Wanted {
        deployment: None,
        extras: Extras { rig: Some(sample_folder("hd2-tunnel")), ..Extras::default() },
        ..wanted(Feed::Url(server.url.clone()), None)
    };
    let session = Session::start(&wanted).expect("it begins");
    wait_until(&session, |view| {
        view.warnings.iter().any(|w| w.finding.kind == kinds::LIVE_NO_STATION)
    });
    let view = session.view();
    assert!(view.warnings.iter().any(|w| w.finding.to_string().contains("7a11")), "{view:?}");
    assert_eq!(view.readings(), 0);
    std::thread::sleep(Duration::from_millis(10));
    assert!(session.stop().expect("it ran").deployment.is_err());
    server.join();
}
