//! The stream of the robotic total station network of Bonn: JSON with the latest reading of each instrument, sent repeatedly.
//!
//! From `rts-api/rtsapi/routers/measurement.py` and `dtos.py` of Engineering-Geodesy-Bonn/rts-network:
//! `/ws/measurements/stream` sends a list of `{controller_timestamp, sensor_timestamp, geocom_return_code, rpc_return_code,
//! distance, horizontal_angle, vertical_angle, rts_job_id, rts_id, …}` about every millisecond. `controller_timestamp` is
//! the arrival of the answer at the instrument's computer (Unix s). `sensor_timestamp` is the instrument's own clock (s
//! since it was switched on, or already converted to the computer's clock). Angles are in radians; the range contains the
//! prism constant that is set on the instrument. This module follows that source code; it was not tested with a real stream.

use resect_core::network::PerStation;
use std::collections::{BTreeMap, VecDeque};

use serde::Deserialize;

use super::event::{Channel, Event, LeftOut, Sent};
use resect_core::statistics::median;
use resect_io::format::bag::messages::{
    Coords, THEODOLITE_DEFINITION, THEODOLITE_TYPE, encode_coords,
};

/// End of the path of such a stream.
pub const PATH: &str = "/ws/measurements/stream";
const CHANNEL: u64 = 1;
/// Difference between own clock and arrival (s) below which the two clocks are the same.
const NEAR_S: f64 = 60.0;
/// Number of readings from which the offset of the instrument's clock is estimated.
const COMPARED: usize = 200;
/// Largest number of instruments; further ones are ignored.
const MOST_INSTRUMENTS: usize = 64;

#[derive(Deserialize)]
struct Reading {
    controller_timestamp: f64,
    sensor_timestamp: f64,
    geocom_return_code: i64,
    rpc_return_code: i64,
    distance: f64,
    horizontal_angle: f64,
    vertical_angle: f64,
    rts_job_id: String,
    rts_id: Option<String>,
}

/// State of one connection: the last reading of each instrument.
#[derive(Debug)]
pub struct BonnProtocol {
    /// Instruments of stations 1, 2, 3.
    stations: Option<PerStation<String>>,
    /// Corrections that the reader of a message adds to the ranges of each station (m).
    added_m: PerStation<f64>,
    instruments: BTreeMap<String, Instrument>,
    /// Number of repeats that were not reported yet.
    repeats: u64,
}

#[derive(Debug, Default)]
struct Instrument {
    last: Option<[f64; 2]>,
    /// Arrival minus own clock of the last readings (s).
    behind_s: VecDeque<f64>,
}

impl BonnProtocol {
    pub fn new(stations: Option<PerStation<String>>, added_m: PerStation<f64>) -> Self {
        Self { stations, added_m, instruments: BTreeMap::new(), repeats: 0 }
    }

    /// Returns the channel of all readings.
    pub fn channel() -> Channel {
        Channel {
            id: CHANNEL,
            topic: "/theodolite_master/theodolite_data".to_owned(),
            message_type: THEODOLITE_TYPE.replacen('/', "/msg/", 1),
            encoding: "cdr".to_owned(),
            schema: THEODOLITE_DEFINITION.as_bytes().to_vec(),
            schema_encoding: "ros2msg".to_owned(),
        }
    }

    /// Returns true if a text comes from such a stream.
    pub fn is_list(text: &str) -> bool {
        text.trim_start().starts_with('[')
    }

    /// Returns the events in a text of the server.
    pub fn text(&mut self, text: &str, received_s: f64) -> Vec<Event> {
        let readings: Vec<Reading> = match serde_json::from_str(text) {
            Ok(readings) => readings,
            Err(error) => {
                let first = format!("a text that is not a list of measurements ({error})");
                return vec![Event::LeftOut { what: LeftOut::Frame, count: 1, first }];
            }
        };
        let mut events: Vec<Event> =
            readings.iter().filter_map(|reading| self.reading(reading, received_s)).collect();
        if !events.is_empty() && self.repeats > 0 {
            let (what, first) =
                (LeftOut::Repeat, "the stream repeats the latest reading".to_owned());
            events.push(Event::LeftOut { what, count: std::mem::take(&mut self.repeats), first });
        }
        events
    }

    fn reading(&mut self, reading: &Reading, received_s: f64) -> Option<Event> {
        let id = reading.rts_id.as_ref().unwrap_or(&reading.rts_job_id);
        if self.instruments.len() >= MOST_INSTRUMENTS && !self.instruments.contains_key(id) {
            return None;
        }
        let instrument = self.instruments.entry(id.clone()).or_default();
        let stamps = [reading.controller_timestamp, reading.sensor_timestamp];
        if instrument.last == Some(stamps) {
            self.repeats += 1;
            return None;
        }
        instrument.last = Some(stamps);
        let stamp_s = instrument.stamp_s(stamps);
        let stations = self.stations.as_ref();
        let Some(station) = stations.and_then(|all| all.iter().position(|own| own == id)) else {
            let ids: Vec<&str> = self.instruments.keys().map(String::as_str).collect();
            let first = format!(
                "instrument {id} is not assigned to a station; give the instruments of stations 1, 2, … (seen so far: \
                 {})",
                ids.join(",")
            );
            return Some(Event::LeftOut { what: LeftOut::NoStation, count: 1, first });
        };
        let codes = [reading.geocom_return_code, reading.rpc_return_code];
        let payload = encode_coords(&Coords {
            stamp_s: Some(stamp_s),
            own_clock_s: Some(reading.sensor_timestamp).filter(|own_s| *own_s > 0.0),
            station: station as u8 + 1,
            // Return codes have more values than a status; any code but 0 means that there is no reading.
            status: codes.iter().any(|code| *code != 0).into(),
            azimuth_rad: reading.horizontal_angle,
            zenith_rad: reading.vertical_angle,
            // The distance already contains the constant that the reader will add.
            range_m: reading.distance - self.added_m[station],
        });
        let sent_ns = (reading.controller_timestamp.max(0.0) * 1e9) as u64;
        Some(Event::Message(Sent { channel: CHANNEL, sent_ns, received_s, payload }))
    }
}

impl Instrument {
    /// Returns the time of a reading by the computer's clock (s): the instrument's clock plus its median offset over
    /// the last answers. A single arrival has an unknown, varying delay.
    fn stamp_s(&mut self, [arrived_s, own_s]: [f64; 2]) -> f64 {
        let behind_s = arrived_s - own_s;
        if behind_s.abs() < NEAR_S {
            return own_s;
        }
        self.behind_s.push_back(behind_s);
        if self.behind_s.len() > COMPARED {
            self.behind_s.pop_front();
        }
        own_s + median(self.behind_s.iter().copied()).unwrap_or(behind_s)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use resect_io::format::bag::messages::{Kind, Message, decode};
    use resect_io::format::bag::wire::Encoding;

    fn json(id: &str, arrived_s: f64, own_s: f64, code: i64) -> String {
        format!(
            r#"[{{"controller_timestamp":{arrived_s},"sensor_timestamp":{own_s},"response_length":87,
            "geocom_return_code":{code},"rpc_return_code":0,"distance":20.25,"horizontal_angle":0.5,"vertical_angle":1.55,
            "rts_job_id":"6a0e3f9c-0000-0000-0000-000000000000","rts_id":"{id}"}}]"#
        )
    }

    fn stations() -> Option<PerStation<String>> {
        Some(["a", "b", "c"].map(str::to_owned).into())
    }

    fn coords(event: &Event) -> Coords {
        let Event::Message(sent) = event else { panic!("{event:?}") };
        match decode(Kind::TheodoliteCoords, Encoding::Cdr, &sent.payload) {
            Ok(Message::Coords(coords)) => coords,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn what_is_repeated_is_taken_once_and_counted() {
        let mut protocol = BonnProtocol::new(stations(), [0.0, 0.25, 0.0].into());
        let first = protocol.text(&json("b", 1.7e9, 1.7e9 - 0.01, 0), 1.0);
        let told = coords(&first[0]);
        assert_eq!((told.station, told.status, told.range_m), (2, 0, 20.0));
        assert_eq!((told.azimuth_rad, told.zenith_rad), (0.5, 1.55));
        assert_eq!(told.stamp_s, Some(1.7e9 - 0.01));
        for _ in 0..400 {
            assert_eq!(protocol.text(&json("b", 1.7e9, 1.7e9 - 0.01, 0), 1.0), []);
        }
        let next = protocol.text(&json("b", 1.7e9 + 0.1, 1.7e9 + 0.09, 1284), 1.1);
        assert_eq!(coords(&next[0]).status, 1);
        assert!(matches!(next[1], Event::LeftOut { what: LeftOut::Repeat, count: 400, .. }));
    }

    #[test]
    fn answers_that_are_late_by_turns_do_not_shake_the_stamps() {
        let mut protocol = BonnProtocol::new(stations(), [0.0, 0.25, 0.0].into());
        let mut off_s = Vec::new();
        for k in 0..400 {
            let time_s = 1.7e9 + f64::from(k) * 0.1;
            let late_s = 0.004 + 0.004 * (f64::from(k) * 2.4).sin();
            let text = json("a", time_s + late_s, time_s - 1.7e9 + 4321.0, 0);
            let told = coords(&protocol.text(&text, time_s)[0]);
            off_s.push(told.stamp_s.expect("a stamp") - time_s);
        }
        // The mean delay remains.
        let last = &off_s[200..];
        assert!(last.iter().all(|off_s| (off_s - 0.004).abs() < 0.001), "{last:?}");
    }

    #[test]
    fn an_instrument_that_is_no_station_is_named() {
        let mut protocol = BonnProtocol::new(None, [0.0; 3].into());
        let said = protocol.text(&json("x", 1.7e9, 1.7e9, 0), 1.0);
        let Event::LeftOut { what: LeftOut::NoStation, first, .. } = &said[0] else {
            panic!("{said:?}")
        };
        assert!(first.contains("instrument x"), "{first}");
        for text in ["", "{}", "[{}]", "[1]", "[{\"distance\":1}]"] {
            let said = protocol.text(text, 1.0);
            assert!(matches!(said[0], Event::LeftOut { what: LeftOut::Frame, .. }), "{text}");
        }
    }
}
