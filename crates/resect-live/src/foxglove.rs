//! The WebSocket protocol of Foxglove (`foxglove.websocket.v1`, `foxglove.sdk.v1`), reduced to the needs of a listener.
//!
//! From the specification in foxglove/ws-protocol (docs/spec.md): the server describes itself and its channels as JSON. A
//! subscriber receives binary messages: the byte 1, the subscription (u32), the time of sending (u64, ns), and the payload.

use std::collections::BTreeMap;

use serde::Deserialize;
use serde_json::json;

use super::event::{Channel, Event, LeftOut, Sent};
use resect_io::format::bag::messages::Kind;
use resect_io::format::bag::stream::LARGEST_MESSAGE_BYTES;

/// Subprotocols that the client requests; they do not differ in anything that is read here.
pub const SUBPROTOCOLS: [&str; 2] = ["foxglove.sdk.v1", "foxglove.websocket.v1"];
/// First byte of a binary message with the data of a channel.
const MESSAGE_DATA: u8 = 1;
/// Lowest level of a server's status that is reported.
const WARNING_LEVEL: u8 = 1;

#[derive(Deserialize)]
#[serde(tag = "op", rename_all = "camelCase")]
enum FromServer {
    ServerInfo {
        name: String,
    },
    Status {
        level: u8,
        message: String,
    },
    Advertise {
        channels: Vec<Advertised>,
    },
    #[serde(rename_all = "camelCase")]
    Unadvertise {
        channel_ids: Vec<u64>,
    },
    #[serde(other)]
    Other,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Advertised {
    id: u64,
    topic: String,
    encoding: String,
    /// Channels without a schema have none of the three; some servers write null.
    schema_name: Option<String>,
    schema: Option<String>,
    schema_encoding: Option<String>,
}

/// State of one connection: its subscriptions.
#[derive(Debug, Default)]
pub struct FoxgloveProtocol {
    /// Channels by subscription.
    channels: BTreeMap<u32, u64>,
    next: u32,
}

impl FoxgloveProtocol {
    /// Returns the events in a text of the server, and the reply.
    pub fn text(&mut self, text: &str) -> (Vec<Event>, Option<String>) {
        let nothing = |event| (vec![event], None);
        match serde_json::from_str(text) {
            Err(error) => {
                let first = format!("a text that is not Foxglove's protocol ({error})");
                nothing(Event::LeftOut { what: LeftOut::Frame, count: 1, first })
            }
            Ok(FromServer::ServerInfo { name }) => nothing(Event::Connected(name)),
            Ok(FromServer::Status { level, message }) if level >= WARNING_LEVEL => {
                let first = format!("the server says: {message}");
                nothing(Event::LeftOut { what: LeftOut::Warned, count: 1, first })
            }
            Ok(FromServer::Advertise { channels }) => self.subscribe(channels),
            Ok(FromServer::Unadvertise { channel_ids }) => {
                self.channels.retain(|_, channel| !channel_ids.contains(channel));
                (Vec::new(), None)
            }
            Ok(FromServer::Status { .. } | FromServer::Other) => (Vec::new(), None),
        }
    }

    /// Subscribes to the channels whose messages are read.
    fn subscribe(&mut self, channels: Vec<Advertised>) -> (Vec<Event>, Option<String>) {
        let mut events = Vec::new();
        let mut asked = Vec::new();
        for channel in channels {
            let message_type = channel.schema_name.unwrap_or_default();
            let is_wanted = Kind::of_type(&message_type).is_some_and(|kind| !kind.is_pose());
            if !is_wanted || self.channels.values().any(|known| *known == channel.id) {
                continue;
            }
            let schema_encoding = match channel.encoding.as_str() {
                "cdr" => "ros2msg",
                "ros1" => "ros1msg",
                "json" => "jsonschema",
                other => {
                    let topic = channel.topic;
                    let first = format!(
                        "{topic} ({message_type}) is in encoding `{other}`; cdr, ros1 and json are read"
                    );
                    events.push(Event::LeftOut { what: LeftOut::Encoding, count: 1, first });
                    continue;
                }
            };
            self.next += 1;
            self.channels.insert(self.next, channel.id);
            asked.push(json!({ "id": self.next, "channelId": channel.id }));
            events.push(Event::Channel(Channel {
                id: channel.id,
                topic: channel.topic,
                message_type,
                encoding: channel.encoding,
                schema: channel.schema.unwrap_or_default().into_bytes(),
                schema_encoding: channel
                    .schema_encoding
                    .unwrap_or_else(|| schema_encoding.to_owned()),
            }));
        }
        let ask = json!({ "op": "subscribe", "subscriptions": asked });
        (events, (!asked.is_empty()).then(|| ask.to_string()))
    }

    /// Returns the event in a binary frame; `None` if a listener ignores it.
    pub fn binary(&self, frame: &[u8], received_s: f64) -> Option<Event> {
        let left_out = |what, first: String| Some(Event::LeftOut { what, count: 1, first });
        let Some((&op, rest)) = frame.split_first() else {
            return left_out(LeftOut::Frame, "an empty binary frame".to_owned());
        };
        if op != MESSAGE_DATA {
            return None;
        }
        let parts = rest.split_first_chunk::<4>().and_then(|(subscription, rest)| {
            let (sent, payload) = rest.split_first_chunk::<8>()?;
            Some((u32::from_le_bytes(*subscription), u64::from_le_bytes(*sent), payload))
        });
        let Some((subscription, sent_ns, payload)) = parts else {
            let first = format!("a message of {} bytes, which is cut off", frame.len());
            return left_out(LeftOut::Frame, first);
        };
        // Messages of a cancelled subscription may still arrive.
        let channel = *self.channels.get(&subscription)?;
        if payload.len() > LARGEST_MESSAGE_BYTES {
            let bytes = payload.len();
            let first =
                format!("a message of {bytes} bytes (the limit is {LARGEST_MESSAGE_BYTES})");
            return left_out(LeftOut::TooLong, first);
        }
        // Without a time of sending, the time of reception replaces it.
        let sent_ns = if sent_ns == 0 { (received_s * 1e9) as u64 } else { sent_ns };
        Some(Event::Message(Sent { channel, sent_ns, received_s, payload: payload.to_vec() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn advertised(encoding: &str, name: &str) -> String {
        json!({ "op": "advertise", "channels": [
            { "id": 7, "topic": "/t", "encoding": encoding, "schemaName": name, "schema": "S" },
            { "id": 8, "topic": "/i", "encoding": "cdr", "schemaName": "sensor_msgs/msg/Imu", "schema": "" },
        ]})
        .to_string()
    }

    const THEODOLITE: &str = "theodolite_node_msgs/msg/TheodoliteCoordsStamped";

    #[test]
    fn it_subscribes_to_what_is_read_and_to_nothing_else() {
        let mut protocol = FoxgloveProtocol::default();
        let (events, ask) = protocol.text(&advertised("cdr", THEODOLITE));
        let [Event::Channel(channel)] = &events[..] else { panic!("{events:?}") };
        assert_eq!((channel.id, channel.topic.as_str()), (7, "/t"));
        assert_eq!(channel.schema_encoding, "ros2msg");
        let ask = ask.expect("it asks");
        assert_eq!(ask, r#"{"op":"subscribe","subscriptions":[{"channelId":7,"id":1}]}"#);
        // A repeated advertisement makes no second subscription.
        assert_eq!(protocol.text(&advertised("cdr", THEODOLITE)), (Vec::new(), None));
    }

    #[test]
    fn schemas_that_are_missing_or_null_cost_no_other_channel() {
        let channels = json!([
            { "id": 1, "topic": "/json", "encoding": "json", "schemaName": null, "schema": null },
            { "id": 2, "topic": "/bare", "encoding": "cdr" },
            { "id": 7, "topic": "/t", "encoding": "json", "schemaName": THEODOLITE, "schema": null },
        ]);
        let text = json!({ "op": "advertise", "channels": channels }).to_string();
        let (events, ask) = FoxgloveProtocol::default().text(&text);
        let [Event::Channel(channel)] = &events[..] else { panic!("{events:?}") };
        assert_eq!((channel.id, channel.schema_encoding.as_str()), (7, "jsonschema"));
        assert!(ask.is_some_and(|ask| ask.contains(r#""channelId":7"#)));
    }

    #[test]
    fn messages_come_with_their_channel_and_time() {
        let mut protocol = FoxgloveProtocol::default();
        protocol.text(&advertised("cdr", THEODOLITE));
        let frame = |payload: &[u8]| {
            [&[1, 1, 0, 0, 0][..], &5_000_000_000_u64.to_le_bytes(), payload].concat()
        };
        let sent = protocol.binary(&frame(&[9, 9]), 6.0);
        let expected =
            Sent { channel: 7, sent_ns: 5_000_000_000, received_s: 6.0, payload: vec![9, 9] };
        assert_eq!(sent, Some(Event::Message(expected)));
        // The server's clock, and an unknown subscription.
        assert_eq!(protocol.binary(&[2, 0, 0, 0, 0, 0, 0, 0, 0], 6.0), None);
        assert_eq!(protocol.binary(&[&[1, 9, 0, 0, 0][..], &[0; 9]].concat(), 6.0), None);
        let left_out = |frame: &[u8]| match protocol.binary(frame, 6.0) {
            Some(Event::LeftOut { what, first, .. }) => (what, first),
            other => panic!("{other:?}"),
        };
        assert_eq!(left_out(&[]).0, LeftOut::Frame);
        for length in 1..13 {
            assert_eq!(left_out(&frame(&[])[..length]).0, LeftOut::Frame, "{length}");
        }
        assert_eq!(left_out(&frame(&vec![0; LARGEST_MESSAGE_BYTES + 1])).0, LeftOut::TooLong);
    }

    #[test]
    fn what_cannot_be_read_is_said_in_one_line() {
        let mut protocol = FoxgloveProtocol::default();
        let mut said = |text: &str| match &protocol.text(text).0[..] {
            [Event::LeftOut { what, first, .. }] => (*what, first.clone()),
            other => panic!("{other:?}"),
        };
        for text in
            ["", "{", "[]", "5", r#"{"op":"advertise"}"#, r#"{"op":"advertise","channels":[{}]}"#]
        {
            let (what, line) = said(text);
            assert_eq!(what, LeftOut::Frame, "{text}");
            assert!(!line.contains('\n'), "{line}");
        }
        let (what, line) = said(&advertised("protobuf", THEODOLITE));
        assert_eq!(what, LeftOut::Encoding);
        assert!(line.contains("/t") && line.contains("`protobuf`"), "{line}");
        let (what, line) = said(r#"{"op":"status","level":2,"message":"buffer is full"}"#);
        assert_eq!((what, line.contains("buffer is full")), (LeftOut::Warned, true));
        assert_eq!(protocol.text(r#"{"op":"connectionGraphUpdate","x":1}"#), (Vec::new(), None));
    }
}
