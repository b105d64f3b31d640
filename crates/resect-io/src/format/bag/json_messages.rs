//! Messages that are encoded as JSON: those of ROS by their field names, and `foxglove.PoseInFrame`.
//!
//! MCAP files of Foxglove and of web tools contain them (mcap.dev, registry of encodings). A time is an object of `sec` with `nsec` or
//! `nanosec`, or text in ISO 8601.

use resect_core::deployment::FrameNames;
use serde_json::Value;

use super::messages::{
    Coords, Correction, Kind, Message, NavSatFix, Point, StampedPose, StampedTransform,
};
use super::wire::Malformed;
use crate::format::mapped_csv::calendar_s;

/// Decodes a message of a kind.
pub fn decode(kind: Kind, message: &[u8]) -> Result<Message, Malformed> {
    let value: Value = serde_json::from_slice(message).map_err(|_| Malformed::NotJson)?;
    let stamp_s = header_s(&value)?;
    Ok(match kind {
        Kind::TheodoliteCoords => Message::Coords(Coords {
            stamp_s,
            own_clock_s: time_s(&value["theodolite_time"])?,
            station: whole(&value, "theodolite_id")?,
            status: whole(&value, "status")?,
            azimuth_rad: number(&value, "azimuth")?,
            zenith_rad: number(&value, "elevation")?,
            range_m: number(&value, "distance")?,
        }),
        Kind::TimeCorrection => Message::Correction(Correction {
            stamp_s,
            station: whole(&value, "theodolite_id")?,
            offset_s: duration_s(&value["estimated_time_offset"])
                .ok_or(Malformed::Field("estimated_time_offset"))?,
        }),
        Kind::Point => Message::Point(Point { stamp_s, position_m: position_m(&value["point"])? }),
        Kind::LeicaPoint => Message::Point(Point { stamp_s, position_m: position_m(&value)? }),
        Kind::PoseStamped | Kind::Odometry => Message::Pose(pose(&value, stamp_s)?),
        Kind::NavSatFix => Message::Fix(nav_sat_fix(&value, stamp_s)?),
        Kind::Transforms => {
            let all = value["transforms"].as_array().ok_or(Malformed::Field("transforms"))?;
            Message::Transforms(all.iter().map(transform).collect::<Result<_, _>>()?)
        }
    })
}

/// Pose of PoseStamped and PoseInFrame, of messages with a covariance, or of a transform.
fn pose(value: &Value, stamp_s: Option<f64>) -> Result<StampedPose, Malformed> {
    let outer = if value["transform"].is_object() { &value["transform"] } else { &value["pose"] };
    let inner = if outer["pose"].is_object() { &outer["pose"] } else { outer };
    let named = |first: &str, second: &str| match inner[first].is_object() {
        true => inner[first].clone(),
        false => inner[second].clone(),
    };
    let rotation = named("orientation", "rotation");
    let part = |name: &'static str| number(&rotation, name);
    let orientation = match rotation.is_object() {
        true => [part("x")?, part("y")?, part("z")?, part("w")?],
        false => [0.0; 4],
    };
    let covariance = outer["covariance"].as_array().and_then(|elements| {
        let elements: Option<Vec<f64>> = elements.iter().map(Value::as_f64).collect();
        <[f64; 36]>::try_from(elements?).ok().map(Box::new)
    });
    let position_m = position_m(&named("position", "translation"))?;
    // Foxglove's own messages have the frame at the top.
    let name = |name: &Value| name.as_str().filter(|name| !name.is_empty()).map(str::to_owned);
    let parent = name(&value["header"]["frame_id"]).or_else(|| name(&value["frame_id"]));
    let child = name(&value["child_frame_id"]);
    let frames = parent.map(|parent| FrameNames { parent, child });
    Ok(StampedPose { stamp_s, position_m, orientation, covariance, frames })
}

/// Fix of ROS, or of Foxglove without a status. JSON has no NaN, so coordinates without a fix are null.
fn nav_sat_fix(value: &Value, stamp_s: Option<f64>) -> Result<NavSatFix, Malformed> {
    let coordinate = |name: &'static str| match &value[name] {
        Value::Null if !value["status"].is_null() => Ok(f64::NAN),
        _ => number(value, name),
    };
    let status = value["status"]["status"].as_i64().and_then(|status| i8::try_from(status).ok());
    let elements = value["position_covariance"].as_array();
    let elements: Option<Vec<f64>> =
        elements.and_then(|elements| elements.iter().map(Value::as_f64).collect());
    let covariance_m2 = elements.and_then(|elements| <[f64; 9]>::try_from(elements).ok());
    let covariance_type = match covariance_m2 {
        Some(_) => whole(value, "position_covariance_type")?,
        None => 0,
    };
    Ok(NavSatFix {
        stamp_s,
        status,
        degrees: [coordinate("latitude")?, coordinate("longitude")?],
        altitude_m: coordinate("altitude")?,
        covariance_m2: covariance_m2.unwrap_or_default(),
        covariance_type,
    })
}

fn transform(value: &Value) -> Result<StampedTransform, Malformed> {
    let frame = |name: &Value, field| match name.as_str() {
        Some(name) => Ok(name.trim_start_matches('/').to_owned()),
        None => Err(Malformed::Field(field)),
    };
    Ok(StampedTransform {
        parent: frame(&value["header"]["frame_id"], "frame_id")?,
        child: frame(&value["child_frame_id"], "child_frame_id")?,
        pose: pose(value, header_s(value)?)?,
    })
}

fn position_m(value: &Value) -> Result<[f64; 3], Malformed> {
    Ok([number(value, "x")?, number(value, "y")?, number(value, "z")?])
}

fn number(value: &Value, field: &'static str) -> Result<f64, Malformed> {
    value[field].as_f64().ok_or(Malformed::Field(field))
}

fn whole(value: &Value, field: &'static str) -> Result<u8, Malformed> {
    let number = value[field].as_u64().and_then(|number| u8::try_from(number).ok());
    number.ok_or(Malformed::Field(field))
}

/// Stamp of the header, or the `timestamp` of Foxglove's own messages (s); `None` if it is zero or missing, which means unset.
fn header_s(value: &Value) -> Result<Option<f64>, Malformed> {
    match value["header"]["stamp"].is_null() {
        true => time_s(&value["timestamp"]),
        false => time_s(&value["header"]["stamp"]),
    }
}

fn time_s(value: &Value) -> Result<Option<f64>, Malformed> {
    let time_s = match value {
        Value::Null => return Ok(None),
        Value::String(text) => calendar_s(text, 0.0).map_err(|_| Malformed::Field("stamp"))?,
        other => duration_s(other).ok_or(Malformed::Field("stamp"))?,
    };
    Ok((time_s != 0.0).then_some(time_s))
}

/// Seconds of `sec` with `nsec` or `nanosec`, with or without the `s` at the end that ROS 1 writes.
fn duration_s(value: &Value) -> Option<f64> {
    let first = |names: &[&str]| names.iter().find_map(|name| value[*name].as_f64());
    Some(first(&["sec", "secs"])? + 1e-9 * first(&["nsec", "nanosec", "nsecs"])?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn poses_of_both_families_and_readings_are_decoded() {
        let expected = StampedPose {
            stamp_s: Some(1_760_000_000.25),
            position_m: [1.0, 2.0, 3.0],
            orientation: [0.0, 0.0, 0.6, 0.8],
            covariance: None,
            frames: None,
        };
        let pose =
            r#"{"position":{"x":1,"y":2,"z":3},"orientation":{"x":0,"y":0,"z":0.6,"w":0.8}}"#;
        for text in [
            format!(
                r#"{{"timestamp":{{"sec":1760000000,"nsec":250000000}},"frame_id":"map","pose":{pose}}}"#
            ),
            format!(r#"{{"timestamp":"2025-10-09T08:53:20.25Z","pose":{pose}}}"#),
            format!(
                r#"{{"header":{{"stamp":{{"sec":1760000000,"nanosec":250000000}}}},"pose":{pose}}}"#
            ),
            format!(
                r#"{{"header":{{"stamp":{{"secs":1760000000,"nsecs":250000000}}}},"pose":{{"pose":{pose},"covariance":[]}}}}"#
            ),
        ] {
            let names_frame = text.contains("frame_id");
            let frames = names_frame.then(|| FrameNames { parent: "map".to_owned(), child: None });
            let expected = Message::Pose(StampedPose { frames, ..expected.clone() });
            assert_eq!(decode(Kind::PoseStamped, text.as_bytes()), Ok(expected), "{text}");
        }
        let reading = br#"{"header":{"stamp":{"sec":5,"nanosec":0}},"theodolite_time":{"sec":4,"nanosec":500000000},
            "theodolite_id":2,"status":0,"azimuth":0.1,"elevation":1.5,"distance":30.25}"#;
        let Ok(Message::Coords(coords)) = decode(Kind::TheodoliteCoords, reading) else { panic!() };
        assert_eq!((coords.stamp_s, coords.own_clock_s, coords.station), (Some(5.0), Some(4.5), 2));
        assert_eq!([coords.azimuth_rad, coords.zenith_rad, coords.range_m], [0.1, 1.5, 30.25]);
        let fix = br#"{"timestamp":{"sec":5,"nsec":0},"latitude":46.78,"longitude":-71.275,"altitude":95.25,
            "position_covariance":[1,0,0,0,1,0,0,0,4],"position_covariance_type":3}"#;
        let Ok(Message::Fix(fix)) = decode(Kind::NavSatFix, fix) else { panic!() };
        assert_eq!((fix.stamp_s, fix.status, fix.degrees), (Some(5.0), None, [46.78, -71.275]));
        assert_eq!((fix.covariance_m2[8], fix.covariance_type), (4.0, 3));
        for (text, why) in [
            (&b"{\"theodolite_id\": 1}"[..], Malformed::Field("status")),
            (b"{", Malformed::NotJson),
            (b"[1, 2]", Malformed::Field("theodolite_id")),
        ] {
            assert_eq!(decode(Kind::TheodoliteCoords, text), Err(why));
        }
    }
}
