//! The way to a source over the network: by its address, with whatever protocol answers there, and again when it breaks off.

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

/// Where `foxglove_bridge` listens unless told otherwise.
const USUAL_PORT: u16 = 8765;
/// A list of all channels of a robot with their definitions is not as large.
const LARGEST_FRAME_BYTES: usize = 16 << 20;
/// How long it is waited for an answer to a connection, and for any sign of life later.
const ANSWER: Duration = Duration::from_secs(5);
const SILENCE: Duration = Duration::from_secs(15);
const PING_EVERY: Duration = Duration::from_secs(5);
/// How often it is looked whether anyone still wants more.
const NAP: Duration = Duration::from_millis(100);
/// Waits between attempts: from the first on twice as long each time.
const FIRST_WAIT_S: f64 = 0.25;
const LONGEST_WAIT_S: f64 = 8.0;

/// An address that cannot be one of a source.
#[derive(Debug, thiserror::Error)]
#[error("{0}: {1}")]
pub struct AddressError(String, &'static str);

/// The address that is meant: `host`, `host:port`, or a whole `ws://…`.
pub fn address(text: &str) -> Result<Uri, AddressError> {
    let wrong = |why| AddressError(printable(text), why);
    let text_trimmed = text.trim();
    let whole = match text_trimmed.split_once("://") {
        None => format!("ws://{text_trimmed}"),
        Some(("ws", _)) => text_trimmed.to_owned(),
        Some(("wss", _)) => {
            return Err(wrong(
                "encrypted streams are not read; give the ws:// address, over a tunnel if need be",
            ));
        }
        Some(_) => {
            return Err(wrong(
                "not the address of a stream; it begins with ws://, as ws://robot:8765",
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

/// What is said over a connection.
enum Protocol {
    Foxglove(foxglove::Protocol),
    Bonn(bonn::Protocol),
    /// Not known before the first text.
    Unknown,
}

/// What is known of a source beforehand.
pub struct Expected {
    pub address: Uri,
    /// The instruments that are stations 1, 2, 3, where messages name instruments.
    pub stations: Option<[String; 3]>,
    /// What is added to the ranges of each station by whoever reads them (m).
    pub added_m: [f64; 3],
}

/// Connects, and again whenever it breaks off, until nobody wants more.
pub fn run(expected: &Expected, stop: &AtomicBool, into: &SyncSender<Event>) {
    let mut wait_s = FIRST_WAIT_S;
    let mut without_subprotocol = expected.address.path().ends_with(bonn::PATH);
    while !stop.load(Relaxed) {
        let mut heard = false;
        let why = match listen(expected, without_subprotocol, stop, into, &mut heard) {
            // Nobody listens any more.
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

/// Why a connection came to its end.
enum Broken {
    NoSubprotocol,
    Because(String),
}

impl From<String> for Broken {
    fn from(why: String) -> Self {
        Self::Because(why)
    }
}

/// Listens until the connection breaks off; `Ok` where nobody wants more.
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
        false => Protocol::Foxglove(foxglove::Protocol::default()),
        true => Protocol::Unknown,
    };
    let (mut alive, mut pinged) = (Instant::now(), Instant::now());
    while !stop.load(Relaxed) {
        let message = match socket.read() {
            Ok(message) => message,
            Err(Error::Io(error)) if is_nothing_yet(&error) => {
                if alive.elapsed() > SILENCE {
                    return Err(format!("{} s without a sign of life", SILENCE.as_secs()).into());
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
    // Whether the other side hears it or not, this is the end of it.
    _ = socket.close(None);
    _ = socket.flush();
    Ok(())
}

/// Gathers the events of a message, and returns the answer to it.
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
            return Err(format!("the server ended it{reason}").into());
        }
        Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
    }
    Ok(None)
}

/// What speaks without a subprotocol, by the first thing that it says.
fn recognise(expected: &Expected, text: &str, events: &mut Vec<Event>) -> Result<Protocol, Broken> {
    if bonn::Protocol::is_list(text) {
        let host = expected.address.host().unwrap_or_default();
        events.push(Event::Connected(format!("total station network at {host}")));
        events.push(Event::Channel(bonn::Protocol::channel()));
        let stations = expected.stations.clone();
        return Ok(Protocol::Bonn(bonn::Protocol::new(stations, expected.added_m)));
    }
    if text.contains("\"serverInfo\"") {
        return Ok(Protocol::Foxglove(foxglove::Protocol::default()));
    }
    Err("a WebSocket is there, but it speaks neither Foxglove's protocol nor that of rts-network; give the address of \
         foxglove_bridge"
        .to_owned()
        .into())
}

fn open(address: &Uri) -> Result<TcpStream, String> {
    let host = address.host().unwrap_or_default();
    let port = address.port_u16().unwrap_or(USUAL_PORT);
    let bare = host.trim_start_matches('[').trim_end_matches(']');
    let places = (bare, port).to_socket_addrs().map_err(|error| {
        format!("no computer is called {host} ({error}); look at its name, and at the network")
    })?;
    let mut why = "no address of it is known".to_owned();
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
        "nobody answers at {host}:{port} ({why}); start the server there, or give another address"
    ))
}

/// `None` where nobody wants more.
fn shake_hands(
    address: &Uri,
    stream: TcpStream,
    without_subprotocol: bool,
    stop: &AtomicBool,
) -> Result<Option<WebSocket<TcpStream>>, Broken> {
    let mut request = ClientRequestBuilder::new(address.clone());
    if !without_subprotocol {
        // In one header: servers read the first.
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
                let why = "somebody is there, but does not answer as a WebSocket; look at the port";
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
        Error::ConnectionClosed | Error::AlreadyClosed => "the server ended it".to_owned(),
        Error::Protocol(ProtocolError::ResetWithoutClosingHandshake) => {
            "the connection broke off".to_owned()
        }
        Error::Http(response) => format!(
            "a web server is there, but no stream (HTTP {}); give the address of foxglove_bridge",
            response.status()
        ),
        Error::Capacity(error) => {
            format!(
                "a frame that is too long ({error}; the limit is {} MiB)",
                LARGEST_FRAME_BYTES >> 20
            )
        }
        Error::Protocol(error) => {
            format!("what is there does not speak as a WebSocket ({error}); look at the address")
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
