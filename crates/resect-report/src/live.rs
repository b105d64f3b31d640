//! State of a live deployment at an instant: a line of JSON for a robot, a line of text for people.

use std::fmt::Write;

use serde_json::{Map, Value, json};

use crate::json::{SCHEMA, finding};
use resect_core::network::Station;
use resect_live::judged::Judged;
use resect_live::status::StationStatus;
use resect_live::{Link, View};

/// Returns one object, printed once a second: a contract with scripts. Times in s, lengths in m, angles in rad, unless
/// the name says otherwise; unknown values are null.
///
/// | field | content |
/// |---|---|
/// | `time_s` | present time by the source's clock (s since 1970) |
/// | `driven_s` | time since the first reading, by the stamps |
/// | `link` | `connecting`, `connected`, `lost`, `ended`; `why` if it is lost |
/// | `stations` | for each: `locked`, `readings`, `rate_hz`, `age_s` of the last reading, `latency_ms`, `lock_losses`, `correction_ms`, `late_ms` (clock offset against station 1: `value`, `sigma`) |
/// | `verdict`, `method`, `far_end_mm`, `transforms` | of the newest answer: `far_end_mm` is the largest σ on the track |
/// | `answer_age_s` | driven time since the newest reading in the answer |
/// | `target_mm`, `enough`, `advice` | target, true if the drive is long enough for it, and the advice in one sentence |
/// | `moves` | manoeuvres from the vehicle's position, the largest gain per second first: `text`, `after_mm` at the far end, `takes_s`, `waypoints_m` in the frame of station 1 |
/// | `warnings` | `name`, `station` (1 to 3, or null), `since_s`, `text` |
/// | `messages`, `readings`, `repeated`, `late`, `dropped`, `left_out` | counts; `left_out` by kind, with the first of each |
/// | `recorded` | `file` and `messages` of the recording |
pub fn json(view: &View) -> Value {
    let (link, why) = match &view.link {
        Link::Connecting => ("connecting", None),
        Link::Connected(_) => ("connected", None),
        Link::Lost { why, .. } => ("lost", Some(why)),
        Link::Ended => ("ended", None),
    };
    let source = match &view.link {
        Link::Connected(name) => Some(name),
        _ => None,
    };
    let left_out: Map<String, Value> = view
        .left_out
        .iter()
        .map(|left| (left.what.to_owned(), json!({ "count": left.count, "first": left.first })))
        .collect();
    let warnings: Vec<Value> = view
        .warnings
        .iter()
        .map(|warning| {
            let mut object = finding(&warning.finding);
            object["since_s"] = warning.since_s.into();
            object
        })
        .collect();
    let shown = view.shown();
    let stations: Vec<Value> = view
        .stations
        .iter()
        .enumerate()
        .map(|(station, status)| of_station(station, status))
        .collect();
    json!({
        "schema": SCHEMA,
        "time_s": view.now_s,
        "driven_s": view.driven_s,
        "link": link,
        "why": why,
        "source": source,
        "connections": view.connections,
        "stations": stations,
        "verdict": shown.map(|judged| judged.verdict),
        "verdict_in_words": shown.map(|judged| &judged.verdict_in_words),
        "method": shown.map(|judged| judged.method.name()),
        "far_end_mm": shown.and_then(|judged| judged.far_end).map(|far| far.sigma_m * 1e3),
        "transforms": shown.map(|judged| {
            let others = judged.station1_from_station.numbers().skip(1);
            others.map(|station| transform(judged, station)).collect::<Vec<_>>()
        }),
        "inter_prism_mm": shown.and_then(|judged| judged.inter_prism_mm),
        "answer_age_s": view.answer_age_s,
        "target_mm": view.target_m * 1e3,
        "enough": view.enough,
        "advice": view.sentence,
        "moves": view.moves.iter().map(|one| json!({
            "text": one.sentence,
            "after_mm": one.after_m * 1e3,
            "takes_s": one.takes_s,
            "waypoints_m": one.waypoints_m.iter().map(|at| [at.x, at.y]).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "warnings": warnings,
        "messages": view.messages,
        "readings": view.readings(),
        "repeated": view.repeated,
        "late": view.late,
        "dropped": view.dropped,
        "left_out": left_out,
        "recorded": view.recorded.as_ref().map(|recorded| json!({
            "file": recorded.path.display().to_string(),
            "messages": recorded.messages,
        })),
    })
}

fn of_station(station: usize, status: &StationStatus) -> Value {
    json!({
        "station": station + 1,
        "locked": status.locked,
        "readings": status.readings,
        "without_reading": status.without_reading,
        "rate_hz": status.rate_hz,
        "age_s": status.age_s,
        "latency_ms": status.latency_s.map(|late_s| late_s * 1e3),
        "lock_losses": status.lock_losses,
        "correction_ms": status.correction_s.map(|offset_s| offset_s * 1e3),
        "late_ms": status.late_s.map(|[late_s, sigma_s]| {
            json!({ "value": late_s * 1e3, "sigma": sigma_s * 1e3 })
        }),
    })
}

fn transform(judged: &Judged, station: Station) -> Value {
    let transform = &judged.station1_from_station[station];
    let sigma = judged.sigma.as_ref().map(|sigma| sigma[station]);
    json!({
        "from": station.number(),
        "to": 1,
        "translation_m": transform.translation_m.as_slice(),
        "yaw_rad": transform.yaw_rad(),
        "sigma": sigma.map(|sigma| json!({
            "translation_m": sigma.translation_m.as_slice(),
            "yaw_rad": sigma.yaw_rad,
        })),
    })
}

/// Returns one line of text: duration of the drive, stations, verdict and advice.
pub fn line(view: &View) -> String {
    let mut line = format!("{:>5.0} s ", view.driven_s);
    for status in &view.stations {
        let word = match (status.locked, status.age_s) {
            (true, _) => status.rate_hz.map_or("locked".to_owned(), |rate| format!("{rate:.1} Hz")),
            (false, Some(age_s)) => format!("lost {age_s:.0} s"),
            (false, None) => "no reading".to_owned(),
        };
        _ = write!(line, " | {word:>10}");
    }
    let verdict = view.shown().map_or("–", |judged| judged.verdict.name());
    _ = write!(line, " | {verdict:>10} | {}", view.sentence);
    if let Some(age_s) = view.answer_age_s.filter(|age_s| *age_s >= 10.0) {
        _ = write!(line, " (answer {age_s:.0} s old)");
    }
    line
}

/// Returns the state of the connection in words.
pub fn link(view: &View) -> String {
    match &view.link {
        Link::Connecting => "connecting".to_owned(),
        Link::Connected(name) => format!("connected to {name}"),
        Link::Lost { why, again_in_s } => {
            format!("no connection: {why}; next attempt in {again_in_s:.2} s")
        }
        Link::Ended => "the replay has ended".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_known_is_null_and_never_zero() {
        let value = json(&View { target_m: 2e-3, ..View::default() });
        for name in ["time_s", "verdict", "far_end_mm", "transforms", "answer_age_s", "recorded"] {
            assert!(value[name].is_null(), "{name}: {value}");
        }
        assert_eq!((&value["target_mm"], &value["enough"]), (&json!(2.0), &json!(false)));
        assert_eq!(value["stations"][2]["rate_hz"], Value::Null);
        assert!(!value.to_string().contains('\n'));
    }
}
