//! Connection to a source over the network: by its address, with the protocol that answers there; reconnects after a break.

use resect_core::network::PerStation;
use std::net::{TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use tungstenite::client::{ClientRequestBuilder, IntoClientRequest, client_with_config};
use tungstenite::error::{ProtocolError, SubProtocolError};
use tungstenite::handshake::HandshakeError;
use tungstenite::http::Uri;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket};

use super::event::{Event, LeftOut};
use super::{bonn, foxglove};
use resect_core::deployment::printable::printable;

/// Default port of `foxglove_bridge`.
const USUAL_PORT: u16 = 8765;
/// Largest frame; a list of all channels of a robot with their definitions is smaller.
const LARGEST_FRAME_BYTES: usize = 16 << 20;
/// Timeouts of the answer to a connection, and of later silence.
const ANSWER: Duration = Duration::from_secs(5);
const SILENCE: Duration = Duration::from_secs(15);
const PING_EVERY: Duration = Duration::from_secs(5);
/// Poll interval of the stop flag.
const NAP: Duration = Duration::from_millis(100);
/// First and longest wait between attempts (s); each wait is twice the one before.
const FIRST_WAIT_S: f64 = 0.25;
const LONGEST_WAIT_S: f64 = 8.0;

/// An address that is invalid for a source.
#[derive(Debug, thiserror::Error)]
#[error("{0}: {1}")]
pub struct AddressError(String, &'static str);

/// Parses an address: `host`, `host:port`, or a complete `ws://…`.
pub fn address(text: &str) -> Result<Uri, AddressError> {
    let wrong = |why| AddressError(printable(text), why);
    let text_trimmed = text.trim();
    let whole = match text_trimmed.split_once("://") {
        None => format!("ws://{text_trimmed}"),
        Some(("ws", _)) => text_trimmed.to_owned(),
        Some(("wss", _)) => {
            return Err(wrong(
                "encrypted streams are not supported; give the ws:// address, through a tunnel if necessary",
            ));
        }
        Some(_) => {
            return Err(wrong(
                "not the address of a stream; it begins with ws://, for example ws://robot:8765",
            ));
        }
    };
    let not_one = "not the address of a stream; give it as ws://robot:8765";
    let uri: Uri = whole.parse().map_err(|_| wrong(not_one))?;
    match uri.host() {
        Some(host) if !host.is_empty() => Ok(uri),
        _ => Err(wrong(not_one)),
    }
}

/// Protocol of a connection.
enum Protocol {
    Foxglove(foxglove::FoxgloveProtocol),
    Bonn(bonn::BonnProtocol),
    /// Not recognised before the first text.
    Unknown,
}

/// Properties of a source that are known before the connection.
pub struct Expected {
    pub address: Uri,
    /// Instruments of stations 1, 2, …, if messages name instruments.
    pub stations: Option<PerStation<String>>,
    /// Corrections that the reader of a message adds to the ranges of each station (m).
    pub added_m: PerStation<f64>,
}

/// Connects, and reconnects after each break, until it is stopped.
pub fn run(expected: &Expected, stop: &AtomicBool, into: &SyncSender<Event>) {
    let mut wait_s = FIRST_WAIT_S;
    let mut without_subprotocol = expected.address.path().ends_with(bonn::PATH);
    while !stop.load(Relaxed) {
        let mut heard = false;
        let why = match listen(expected, without_subprotocol, stop, into, &mut heard) {
            // The receiver has gone.
            Ok(()) => return,
            Err(Broken::NoSubprotocol) => {
                without_subprotocol = true;
                continue;
            }
            Err(Broken::Because(why)) => why,
        };
        if heard {
            wait_s = FIRST_WAIT_S;
        }
        if into.send(Event::Lost { why: printable(&why), again_in_s: wait_s }).is_err() {
            return;
        }
        let until = Instant::now() + Duration::from_secs_f64(wait_s);
        while Instant::now() < until && !stop.load(Relaxed) {
            std::thread::sleep(NAP.min(until.saturating_duration_since(Instant::now())));
        }
        wait_s = (2.0 * wait_s).min(LONGEST_WAIT_S);
    }
}

/// Reason for the end of a connection.
enum Broken {
    NoSubprotocol,
    Because(String),
}

impl From<String> for Broken {
    fn from(why: String) -> Self {
        Self::Because(why)
    }
}

/// Listens until the connection breaks; `Ok` if it was stopped.
fn listen(
    expected: &Expected,
    without_subprotocol: bool,
    stop: &AtomicBool,
    into: &SyncSender<Event>,
    heard: &mut bool,
) -> Result<(), Broken> {
    let stream = open(&expected.address)?;
    let Some(mut socket) = shake_hands(&expected.address, stream, without_subprotocol, stop)?
    else {
        return Ok(());
    };
    let mut protocol = match without_subprotocol {
        false => Protocol::Foxglove(foxglove::FoxgloveProtocol::default()),
        true => Protocol::Unknown,
    };
    let (mut alive, mut pinged) = (Instant::now(), Instant::now());
    while !stop.load(Relaxed) {
        let message = match socket.read() {
            Ok(message) => message,
            Err(Error::Io(error)) if is_nothing_yet(&error) => {
                if alive.elapsed() > SILENCE {
                    return Err(format!("no sign of life for {} s", SILENCE.as_secs()).into());
                }
                if pinged.elapsed() > PING_EVERY {
                    pinged = Instant::now();
                    send(&mut socket, Message::Ping(Vec::new().into()))?;
                }
                continue;
            }
            Err(error) => return Err(in_words(&error).into()),
        };
        alive = Instant::now();
        let received_s =
            SystemTime::now().duration_since(UNIX_EPOCH).map_or(0.0, |t| t.as_secs_f64());
        let mut events = Vec::new();
        if let Some(answer) =
            take_message(&mut protocol, expected, message, received_s, &mut events)?
        {
            send(&mut socket, Message::Text(answer.into()))?;
        }
        for event in events {
            *heard |= matches!(event, Event::Connected(_));
            if into.send(event).is_err() {
                return Ok(());
            }
        }
    }
    // Errors are ignored, because the connection ends anyway.
    _ = socket.close(None);
    _ = socket.flush();
    Ok(())
}

/// Adds the events of a message, and returns the reply.
fn take_message(
    protocol: &mut Protocol,
    expected: &Expected,
    message: Message,
    received_s: f64,
    events: &mut Vec<Event>,
) -> Result<Option<String>, Broken> {
    match message {
        Message::Text(text) => {
            if matches!(protocol, Protocol::Unknown) {
                *protocol = recognise(expected, &text, events)?;
            }
            return Ok(match protocol {
                Protocol::Foxglove(protocol) => {
                    let (said, answer) = protocol.text(&text);
                    events.extend(said);
                    answer
                }
                Protocol::Bonn(protocol) => {
                    events.extend(protocol.text(&text, received_s));
                    None
                }
                Protocol::Unknown => None,
            });
        }
        Message::Binary(bytes) => match protocol {
            Protocol::Foxglove(protocol) => events.extend(protocol.binary(&bytes, received_s)),
            _ => {
                let first = format!("a binary frame of {} bytes, where text is sent", bytes.len());
                events.push(Event::LeftOut { what: LeftOut::Frame, count: 1, first });
            }
        },
        Message::Close(frame) => {
            let reason = frame.map_or(String::new(), |frame| frame.reason.to_string());
            let reason = if reason.is_empty() { reason } else { format!(" ({reason})") };
            return Err(format!("the server closed the connection{reason}").into());
        }
        Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
    }
    Ok(None)
}

/// Recognises the protocol of a server without a subprotocol, by its first text.
fn recognise(expected: &Expected, text: &str, events: &mut Vec<Event>) -> Result<Protocol, Broken> {
    if bonn::BonnProtocol::is_list(text) {
        let host = expected.address.host().unwrap_or_default();
        events.push(Event::Connected(format!("total station network at {host}")));
        events.push(Event::Channel(bonn::BonnProtocol::channel()));
        let stations = expected.stations.clone();
        return Ok(Protocol::Bonn(bonn::BonnProtocol::new(stations, expected.added_m.clone())));
    }
    if text.contains("\"serverInfo\"") {
        return Ok(Protocol::Foxglove(foxglove::FoxgloveProtocol::default()));
    }
    Err("the server uses neither Foxglove's protocol nor that of rts-network; give the address of foxglove_bridge"
        .to_owned()
        .into())
}

fn open(address: &Uri) -> Result<TcpStream, String> {
    let host = address.host().unwrap_or_default();
    let port = address.port_u16().unwrap_or(USUAL_PORT);
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    let places = (bare, port).to_socket_addrs().map_err(|error| {
        format!("host {host} is not found ({error}); check its name and the network")
    })?;
    let mut why = "no known address".to_owned();
    for place in places {
        match TcpStream::connect_timeout(&place, ANSWER) {
            Ok(stream) => {
                let set =
                    stream.set_nodelay(true).and_then(|()| stream.set_read_timeout(Some(NAP)));
                let set = set.and_then(|()| stream.set_write_timeout(Some(ANSWER)));
                return set.map(|()| stream).map_err(|error| error.to_string());
            }
            Err(error) => why = error.to_string(),
        }
    }
    Err(format!(
        "no server answers at {host}:{port} ({why}); start the server, or give another address"
    ))
}

/// Performs the handshake; `None` if it was stopped.
fn shake_hands(
    address: &Uri,
    stream: TcpStream,
    without_subprotocol: bool,
    stop: &AtomicBool,
) -> Result<Option<WebSocket<TcpStream>>, Broken> {
    let mut request = ClientRequestBuilder::new(address.clone());
    if !without_subprotocol {
        // One header has all of them, because servers read the first header only.
        request = request.with_sub_protocol(foxglove::SUBPROTOCOLS.join(", "));
    }
    let request = request.into_client_request().map_err(|error| in_words(&error))?;
    let config = WebSocketConfig::default()
        .max_message_size(Some(LARGEST_FRAME_BYTES))
        .max_frame_size(Some(LARGEST_FRAME_BYTES));
    let begun = Instant::now();
    let mut shaken = client_with_config(request, stream, Some(config));
    loop {
        match shaken {
            Ok((socket, _)) => return Ok(Some(socket)),
            Err(HandshakeError::Interrupted(_)) if stop.load(Relaxed) => return Ok(None),
            Err(HandshakeError::Interrupted(middle)) if begun.elapsed() < ANSWER => {
                shaken = middle.handshake();
            }
            Err(HandshakeError::Interrupted(_)) => {
                let why = "the server does not answer as a WebSocket; check the port";
                return Err(why.to_owned().into());
            }
            Err(HandshakeError::Failure(Error::Protocol(
                ProtocolError::SecWebSocketSubProtocolError(SubProtocolError::NoSubProtocol),
            ))) => return Err(Broken::NoSubprotocol),
            Err(HandshakeError::Failure(error)) => return Err(in_words(&error).into()),
        }
    }
}

fn send(socket: &mut WebSocket<TcpStream>, message: Message) -> Result<(), String> {
    socket.send(message).map_err(|error| in_words(&error))
}

fn is_nothing_yet(error: &std::io::Error) -> bool {
    matches!(error.kind(), std::io::ErrorKind::WouldBlock | std::io::ErrorKind::TimedOut)
}

fn in_words(error: &Error) -> String {
    match error {
        Error::ConnectionClosed | Error::AlreadyClosed => {
            "the server closed the connection".to_owned()
        }
        Error::Protocol(ProtocolError::ResetWithoutClosingHandshake) => {
            "the connection was lost".to_owned()
        }
        Error::Http(response) => format!(
            "the web server has no stream (HTTP {}); give the address of foxglove_bridge",
            response.status()
        ),
        Error::Capacity(error) => {
            format!(
                "a frame that is too long ({error}; the limit is {} MiB)",
                LARGEST_FRAME_BYTES >> 20
            )
        }
        Error::Protocol(error) => {
            format!("the server does not speak the WebSocket protocol ({error}); check the address")
        }
        error => error.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_may_be_short_and_a_wrong_one_says_how_it_should_be() {
        for (text, host, port) in [
            ("robot", "robot", None),
            ("robot:8765", "robot", Some(8765)),
            ("ws://10.0.0.2:9090/x", "10.0.0.2", Some(9090)),
            (" ws://[::1]:8765 ", "[::1]", Some(8765)),
        ] {
            let uri = address(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            assert_eq!((uri.host(), uri.port_u16()), (Some(host), port), "{text}");
        }
        for text in
            ["", "ws://", "http://robot:8080", "wss://robot", "ws://a b", "file:///x", "ws://:8765"]
        {
            let said = address(text).expect_err(text).to_string();
            assert!(said.contains("; ") && said.contains("ws://"), "{text}: {said}");
        }
    }
}
