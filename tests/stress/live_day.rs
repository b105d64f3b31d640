//! Memory of a live deployment after a day.

use std::path::Path;

use resect_core::progress::Progress;
use resect_io::format::bag::messages::{Coords, encode_coords};
use resect_io::growing::Growing;
use resect_io::source::Extras;
use resect_live::event::{Event, LeftOut, Sent};
use resect_live::recorder::Recorder;
use resect_live::{Engine, bonn};

use crate::{ALLOCATED, process};

const DAY_S: u32 = 86_400;
const START_S: f64 = 1_760_000_000.0;

fn sent(station: u8, stamp_s: f64) -> Event {
    let payload = encode_coords(&Coords {
        stamp_s: Some(stamp_s),
        own_clock_s: Some(stamp_s + 0.3),
        station,
        status: 0,
        azimuth_rad: 0.1,
        zenith_rad: 1.5,
        range_m: 30.0 + (stamp_s * 0.1).sin(),
    });
    let sent_ns = ((stamp_s + 0.01) * 1e9) as u64;
    let channel = bonn::BonnProtocol::channel().id;
    Event::Message(Sent { channel, sent_ns, received_s: stamp_s + 0.02, payload })
}

/// At 2.5 readings a second, as with the authors' instruments. A reading has 40 bytes with its own clock, in a list with up to twice the
/// capacity. Each second of the recording has an index of the same size. At ten readings a second a reading needs 85 bytes.
#[test]
fn a_day_takes_less_than_200_bytes_a_reading_and_nothing_else_grows() {
    process::alone(
        "live_day::a_day_takes_less_than_200_bytes_a_reading_and_nothing_else_grows",
        measure,
    );
}

fn measure(folder: &Path) {
    let growing = Growing::around("live", None, &Extras::default(), &Progress::default());
    let recorder = Recorder::create(&folder.join("day.mcap")).expect("a new file");
    let mut engine = Engine::new(growing.expect("nothing is read"), None, Some(recorder), 2e-3);
    engine.take(Event::Connected("robot".to_owned()), 0.0);
    engine.take(Event::Channel(bonn::BonnProtocol::channel()), 0.0);
    let before = ALLOCATED.current_usage();
    ALLOCATED.reset_peak_usage();
    let mut readings = 0;
    for second in 0..DAY_S {
        let at_s = f64::from(second);
        for step in 0..if second % 2 == 0 { 3 } else { 2 } {
            let stamp_s = START_S + at_s + 0.3 * f64::from(step);
            for station in 1..=3 {
                engine.take(sent(station, stamp_s + f64::from(station) * 1e-3), at_s);
                readings += 1;
            }
        }
        // Repeated, garbled and truncated messages are counted and not stored.
        engine.take(sent(1, START_S + at_s + 1e-3), at_s);
        engine.take(
            Event::LeftOut { what: LeftOut::Frame, count: 1, first: format!("{second}") },
            at_s,
        );
        if second % 3600 == 1800 {
            engine.take(Event::Lost { why: "broken off".to_owned(), again_in_s: 1.0 }, at_s);
            engine.take(Event::Connected("robot".to_owned()), at_s);
            engine.take(Event::Channel(bonn::BonnProtocol::channel()), at_s);
        }
        engine.flush();
        if second % 60 == 59 {
            engine.view(at_s);
        }
    }
    let view = engine.view(f64::from(DAY_S));
    assert_eq!(view.readings(), readings);
    assert_eq!(view.repeated, DAY_S as usize);
    let took = ALLOCATED.peak_usage() - before;
    let each = took as f64 / readings as f64;
    eprintln!("{each:.1} bytes for each of {readings} readings, {} MB", took / 1_000_000);
    assert!(each < 200.0, "{each:.1} bytes a reading");
    // Half a day more of repeats alone needs no memory.
    let before = ALLOCATED.current_usage();
    for second in 0..DAY_S / 2 {
        engine.take(sent(2, START_S + f64::from(second) + 2e-3), f64::from(DAY_S + second));
        if second % 60 == 59 {
            engine.view(f64::from(DAY_S + second));
        }
    }
    let more = ALLOCATED.current_usage().saturating_sub(before);
    eprintln!("{more} bytes more");
    assert!(more < 2_000_000, "{more} bytes");
}
