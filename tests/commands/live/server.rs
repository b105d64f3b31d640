//! A scripted server of Foxglove's protocol: its messages, and its disconnections.

use std::collections::BTreeMap;
use std::net::{TcpListener, TcpStream};
use std::thread::JoinHandle;

use resect_live::bonn::BonnProtocol;
use resect_live::event::Sent;
use serde_json::{Value, json};
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::HeaderValue;
use tungstenite::{Message, WebSocket, accept_hdr};

/// A step of the server's script.
#[derive(Clone, Debug)]
pub enum Step {
    /// Sends a message of the channel, with its subscription id.
    Send(Sent),
    Text(String),
    Binary(Vec<u8>),
    /// Drops the connection without closing it, and waits for the next.
    BreakOff,
}

/// A server on the loopback interface.
pub struct Server {
    pub url: String,
    thread: JoinHandle<()>,
}

impl Server {
    /// Executes the steps; at the end it waits until the client leaves.
    pub fn start(subprotocol: Option<&'static str>, steps: Vec<Step>) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let url = format!("ws://{}", listener.local_addr().expect("bound"));
        let thread = std::thread::spawn(move || serve(&listener, subprotocol, steps));
        Self { url, thread }
    }

    /// Waits until all steps are done.
    pub fn join(self) {
        self.thread.join().expect("the server does not panic");
    }
}

/// Returns the advertisement of the one channel.
pub fn advertisement() -> String {
    let channel = BonnProtocol::channel();
    json!({ "op": "advertise", "channels": [{
        "id": channel.id,
        "topic": channel.topic,
        "encoding": channel.encoding,
        "schemaName": channel.message_type,
        "schema": String::from_utf8(channel.schema).expect("text"),
        "schemaEncoding": channel.schema_encoding,
    }]})
    .to_string()
}

fn serve(listener: &TcpListener, subprotocol: Option<&'static str>, steps: Vec<Step>) {
    let mut connection = Connection::accept(listener, subprotocol);
    for step in steps {
        match step {
            Step::Send(sent) => connection.send(&sent),
            Step::Text(text) => connection.write(Message::Text(text.into())),
            Step::Binary(bytes) => connection.write(Message::Binary(bytes.into())),
            Step::BreakOff => {
                connection.flush();
                drop(connection);
                connection = Connection::accept(listener, subprotocol);
            }
        }
    }
    connection.flush();
    // Until the client has closed the connection.
    while connection.socket.read().is_ok() {}
}

struct Connection {
    socket: WebSocket<TcpStream>,
    /// Subscription ids by channel.
    subscriptions: BTreeMap<u64, u32>,
}

impl Connection {
    #[allow(clippy::result_large_err, reason = "that is the crate's callback")]
    fn accept(listener: &TcpListener, subprotocol: Option<&'static str>) -> Self {
        loop {
            let (stream, _) = listener.accept().expect("somebody connects");
            let mut is_asked = false;
            let choose =
                |request: &Request, mut response: Response| -> Result<Response, ErrorResponse> {
                    is_asked = request.headers().contains_key("Sec-WebSocket-Protocol");
                    if let (Some(name), true) = (subprotocol, is_asked) {
                        let name = HeaderValue::from_static(name);
                        response.headers_mut().insert("Sec-WebSocket-Protocol", name);
                    }
                    Ok(response)
                };
            // A client that rejects the answer connects again.
            let Ok(mut socket) = accept_hdr(stream, choose) else { continue };
            let mut connection = match subprotocol {
                None if is_asked => continue,
                None => return Self { socket, subscriptions: BTreeMap::new() },
                Some(_) => {
                    let info = json!({ "op": "serverInfo", "name": "test", "capabilities": [] });
                    let greeted = socket.send(Message::Text(info.to_string().into()));
                    let greeted =
                        greeted.and_then(|()| socket.send(Message::Text(advertisement().into())));
                    if greeted.is_err() {
                        continue;
                    }
                    Self { socket, subscriptions: BTreeMap::new() }
                }
            };
            if connection.hear_subscriptions() {
                return connection;
            }
        }
    }

    fn hear_subscriptions(&mut self) -> bool {
        let Ok(Message::Text(text)) = self.socket.read() else { return false };
        let asked: Value = serde_json::from_str(&text).expect("JSON");
        assert_eq!(asked["op"], "subscribe");
        for one in asked["subscriptions"].as_array().expect("a list") {
            let [channel, id] = ["channelId", "id"].map(|key| one[key].as_u64().expect("a number"));
            self.subscriptions.insert(channel, id as u32);
        }
        true
    }

    fn send(&mut self, sent: &Sent) {
        let subscription = self.subscriptions[&sent.channel].to_le_bytes();
        let frame = [&[1][..], &subscription, &sent.sent_ns.to_le_bytes(), &sent.payload].concat();
        self.write(Message::Binary(frame.into()));
    }

    fn write(&mut self, message: Message) {
        // The client may have left.
        _ = self.socket.write(message);
    }

    fn flush(&mut self) {
        _ = self.socket.flush();
    }
}
