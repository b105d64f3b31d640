//! Faults of a stream: each is reported in one line, and none ends the program.

use resect_live::kinds;
use std::io::Write;
use std::net::TcpListener;

use resect_io::sample::Sample;
use resect_live::event::Sent;
use resect_live::{Feed, Link, Session, View, replay};
use serde_json::json;

use super::server::{Server, Step};
use super::stream::{wait_until, wanted};

fn messages(count: usize) -> Vec<Step> {
    let sample = Sample::Hd2Tunnel.open().expect("built in");
    replay::messages(&sample, &[0.01; 3].into()).take(count).map(Step::Send).collect()
}

fn session(url: &str) -> Session {
    Session::start(&wanted(Feed::Url(url.to_owned()), None)).expect("it begins")
}

fn count(view: &View, what: &str) -> u64 {
    view.left_out.iter().filter(|left| left.what == what).map(|left| left.count).sum()
}

fn why(view: &View) -> Option<&str> {
    match &view.link {
        Link::Lost { why, .. } => Some(why),
        _ => None,
    }
}

#[test]
fn garbage_between_messages_is_counted_and_costs_nothing_else() {
    let mut steps = messages(90);
    let Step::Send(good) = steps[0].clone() else { panic!("a message") };
    let cut = Sent { payload: good.payload[..30].to_vec(), ..good.clone() };
    let long = Sent { payload: vec![0; 70_000], ..good };
    let other_encoding = json!({ "op": "advertise", "channels": [{
        "id": 9, "topic": "/other", "encoding": "protobuf",
        "schemaName": "theodolite_node_msgs/msg/TheodoliteCoordsStamped", "schema": "",
    }]});
    let garbage = [
        Step::Text("{\"op\":".to_owned()),
        Step::Text("\u{1b}[2J".to_owned()),
        Step::Text(other_encoding.to_string()),
        Step::Text("{\"op\":\"status\",\"level\":2,\"message\":\"two\\nlines\"}".to_owned()),
        Step::Text("{\"op\":\"somethingNew\",\"x\":[1,2]}".to_owned()),
        Step::Binary(Vec::new()),
        Step::Binary(vec![1, 1, 0]),
        Step::Binary(vec![7; 20]),
        Step::Send(cut),
        Step::Send(long),
    ];
    for (place, one) in garbage.into_iter().enumerate() {
        steps.insert(5 * place, one);
    }
    let server = Server::start(Some("foxglove.sdk.v1"), steps);
    let session = session(&server.url);
    wait_until(&session, |view| view.readings() == 90);
    let view = session.view();
    for (what, expected) in
        [("frames", 4), ("encodings", 1), ("server_warnings", 1), ("malformed", 1), ("too_long", 1)]
    {
        assert_eq!(count(&view, what), expected, "{what}: {:?}", view.left_out);
    }
    assert!(view.left_out.iter().all(|left| !left.first.contains(['\n', '\u{1b}'])), "{view:?}");
    assert_eq!(view.connections, 1);
    session.stop().expect("it ran").deployment.expect("readings");
    server.join();
}

#[test]
fn a_frame_that_is_too_long_ends_the_connection_and_not_the_session() {
    let mut steps = messages(30);
    steps.push(Step::Binary(vec![1; 17 << 20]));
    steps.push(Step::BreakOff);
    steps.extend(messages(60));
    let server = Server::start(Some("foxglove.sdk.v1"), steps);
    let session = session(&server.url);
    wait_until(&session, |view| view.readings() == 60);
    assert_eq!(session.view().connections, 2);
    session.stop().expect("it ran");
    server.join();
}

#[test]
fn whoever_is_no_source_is_told_apart() {
    // A port without a listener.
    let closed = {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        listener.local_addr().expect("bound")
    };
    let nobody = session(&format!("ws://{closed}"));
    wait_until(&nobody, |view| why(view).is_some_and(|why| why.contains("no server answers")));
    let view = nobody.view();
    assert!(view.warnings.iter().any(|w| w.finding.kind == kinds::LIVE_NO_CONNECTION), "{view:?}");
    assert!(nobody.stop().expect("it ran").deployment.is_err(), "nothing was read");

    // A web server, and a server with another answer.
    for (answer, expected) in [
        ("HTTP/1.1 404 Not Found\r\nContent-Length: 0\r\n\r\n", "HTTP 404"),
        ("HTTP/1.1 200 OK\r\nContent-Length: 0\r\n\r\n", "HTTP 200"),
        ("SSH-2.0-OpenSSH_9.2\r\n", "does not speak the WebSocket protocol"),
    ] {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let url = format!("ws://{}", listener.local_addr().expect("bound"));
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                let mut stream = stream.expect("somebody connects");
                let mut asked = [0; 1024];
                _ = std::io::Read::read(&mut stream, &mut asked);
                _ = stream.write_all(answer.as_bytes());
            }
        });
        let session = session(&url);
        wait_until(&session, |view| why(view).is_some_and(|why| why.contains(expected)));
        session.stop().expect("it ran");
    }

    // A WebSocket with another protocol.
    let chat = Server::start(None, vec![Step::Text("{\"hello\":1}".to_owned())]);
    let session = session(&chat.url);
    wait_until(&session, |view| why(view).is_some_and(|why| why.contains("uses neither")));
    session.stop().expect("it ran");
}
