//! Computing time of a live deployment during a day, by a simulated clock.

use std::sync::Arc;

use resect_core::progress::Progress;
use resect_io::format::bag::messages::{Coords, encode_coords};
use resect_io::growing::Growing;
use resect_io::source::Extras;
use resect_live::event::{Event, Sent};
use resect_live::judged::{NoAnswer, Outcome};
use resect_live::{Engine, bonn};

const DAY_S: u32 = 86_400;
const START_S: f64 = 1_760_000_000.0;

/// A simulated worker: its time for each reading (s), the end of its current task, and its work so far.
struct Worker {
    for_each_s: f64,
    until_s: Option<f64>,
    worked_s: f64,
    answers: usize,
}

impl Worker {
    fn new(for_each_s: f64) -> Self {
        Self { for_each_s, until_s: None, worked_s: 0.0, answers: 0 }
    }

    fn begin(&mut self, readings: usize, now_s: f64) {
        assert!(self.until_s.is_none(), "it is asked for one answer at a time");
        let takes_s = self.for_each_s * readings as f64;
        self.until_s = Some(now_s + takes_s);
        self.worked_s += takes_s;
        self.answers += 1;
    }

    fn has_finished(&mut self, now_s: f64) -> bool {
        self.until_s.take_if(|until_s| *until_s <= now_s).is_some()
    }
}

fn sent(station: u8, stamp_s: f64) -> Event {
    let payload = encode_coords(&Coords {
        stamp_s: Some(stamp_s),
        own_clock_s: None,
        station,
        status: 0,
        azimuth_rad: 0.1,
        zenith_rad: 1.5,
        range_m: 30.0 + (stamp_s * 0.1).sin(),
    });
    let sent_ns = (stamp_s * 1e9) as u64;
    let channel = bonn::BonnProtocol::channel().id;
    Event::Message(Sent { channel, sent_ns, received_s: stamp_s, payload })
}

/// However long calibrations take in the end, each worker rests as long as it has worked.
#[test]
fn nobody_works_for_more_than_half_of_a_day() {
    let growing = Growing::around("live", None, &Extras::default(), &Progress::default());
    let mut engine = Engine::new(growing.expect("nothing is read"), None, None, 2e-3);
    engine.take(Event::Connected("robot".to_owned()), 0.0);
    engine.take(Event::Channel(bonn::BonnProtocol::channel()), 0.0);
    // A slow laptop: minutes for a calibration in the evening.
    let [mut first, mut second, mut next] = [1e-3, 2e-3, 3e-3].map(Worker::new);
    let mut readings = 0;
    for second_of_day in 0..DAY_S {
        let now_s = f64::from(second_of_day);
        for station in 1..=3 {
            engine.take(sent(station, START_S + now_s + 0.1 * f64::from(station)), now_s);
            readings += 1;
        }
        for (worker, is_first) in [(&mut first, true), (&mut second, false)] {
            if worker.has_finished(now_s) {
                let judged = Err(NoAnswer { why: "nothing moves".to_owned(), drive: None });
                engine.judged(Outcome { is_first, judged, lately_off_m: None }, now_s);
                if !is_first && engine.begins_to_advise(now_s) {
                    next.begin(readings, now_s);
                }
            }
        }
        if next.has_finished(now_s) {
            engine.advised(Vec::new(), now_s);
        }
        if let Some(due) = engine.due(true, now_s) {
            let due_of = Arc::new(due.deployment);
            let count = due_of.tracks.iter().map(|track| track.measurements.len()).sum();
            assert_eq!(count, readings, "it is of all that came");
            if due.first {
                first.begin(count, now_s);
            }
            if due.second {
                second.begin(count, now_s);
            }
        }
    }
    for (name, worker) in [("first", first), ("second", second), ("next", next)] {
        let share = worker.worked_s / f64::from(DAY_S);
        eprintln!("{name}: {} answers, {share:.2} of the day", worker.answers);
        // The last calculation exceeds the day; a tick is a second.
        assert!(share < 0.51 && worker.answers < 3000, "{name}: {share} {}", worker.answers);
        // There is no excessive waiting either.
        assert!(share > 0.3 && worker.answers > 300, "{name}: {share} {}", worker.answers);
    }
}
