//! The live stream for Foxglove, and its clients.

use std::net::TcpStream;
use std::time::Instant;

use proprio_foxglove::FoxgloveServer;
use proprio_link::Link;
use serde_json::{Value, json};
use telemetry::{Command, Estimate, Message as BoardMessage, SegmentEstimate};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use super::line::{Line, PATIENCE, sample};

/// A link to a board, and its stream.
struct Stream {
    line: Line,
    server: FoxgloveServer,
    link: Link,
    tick: u32,
}

impl Stream {
    fn new() -> Self {
        let line = Line::new();
        let (link, _) = Link::start(Box::new(line.clone()), None).expect("memory opens");
        let server = FoxgloveServer::start(link.subscribe(), 0, None).expect("a free port");
        Self { line, server, link, tick: 0 }
    }

    /// Sends a sample and its estimate, of which the last segment is not known.
    fn tick(&mut self) {
        let end = |i: i32| SegmentEstimate { theta: 0, end: [0, (i + 1) << 22] };
        let segments = (0..6).map(|i| (i < 5).then(|| end(i))).collect();
        let estimate = Estimate { tick: self.tick, segments };
        let mut board = self.line.board();
        board.send(&BoardMessage::Sample(sample(self.tick)));
        board.send(&BoardMessage::Estimate(estimate));
        drop(board);
        self.tick += 1;
    }

    fn client(&self) -> Client {
        self.connect("foxglove.sdk.v1", None).expect("it is answered")
    }

    /// A client of this version of the protocol, from a page of this origin; or the status with which it is refused.
    fn connect(&self, subprotocol: &str, origin: Option<&str>) -> Result<Client, u16> {
        let tcp = TcpStream::connect(self.server.address()).expect("it listens");
        tcp.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let mut request = format!("ws://{}", self.server.address()).into_client_request().expect("an address");
        let mut header = |name, value: &str| request.headers_mut().insert(name, value.parse().expect("a value"));
        header("Sec-WebSocket-Protocol", subprotocol);
        if let Some(origin) = origin {
            header("Origin", origin);
        }
        match tungstenite::client(request, tcp) {
            Ok((socket, _)) => Ok(Client::greeted(socket)),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(refused))) => {
                Err(refused.status().as_u16())
            }
            Err(other) => panic!("{other}"),
        }
    }
}

/// A client, and the channels that were advertised to it.
struct Client {
    socket: WebSocket<TcpStream>,
    channels: Vec<Value>,
}

impl Client {
    fn greeted(socket: WebSocket<TcpStream>) -> Self {
        let mut client = Self { socket, channels: Vec::new() };
        assert_eq!(client.json()["op"], "serverInfo");
        let advertised = client.json();
        assert_eq!(advertised["op"], "advertise");
        client.channels.extend_from_slice(advertised["channels"].as_array().expect("a list"));
        client
    }

    /// The next text.
    fn json(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.socket.read().expect("it is open") {
                return serde_json::from_str(&text).expect("it is JSON");
            }
        }
    }

    fn send(&mut self, message: &Value) {
        self.socket.send(Message::from(message.to_string())).expect("it is open");
    }

    fn subscribe(&mut self, topic: &str, id: u32) {
        let channel = self.channels.iter().find(|channel| channel["topic"] == topic).expect("it is advertised");
        let channel = channel["id"].clone();
        self.send(&json!({"op": "subscribe", "subscriptions": [{"id": id, "channelId": channel}]}));
    }

    /// Number of the subscription and data of the next message.
    fn data(&mut self) -> (u32, Vec<u8>) {
        loop {
            if let Message::Binary(bytes) = self.socket.read().expect("it is open") {
                assert_eq!(bytes[0], 1);
                let id = u32::from_le_bytes(bytes[1..5].try_into().expect("four bytes"));
                return (id, bytes[13..].to_vec());
            }
        }
    }
}

/// The tick of a `proprio_msgs/msg/Sample`, behind its header.
fn tick_of(sample: &[u8]) -> u32 {
    u32::from_le_bytes(sample[28..32].try_into().expect("four bytes"))
}

#[test]
fn every_channel_is_advertised_at_once_with_its_schema() {
    let topics: Vec<String> = Stream::new()
        .client()
        .channels
        .iter()
        .map(|channel| {
            assert_eq!((&channel["encoding"], &channel["schemaEncoding"]), (&json!("cdr"), &json!("ros2msg")));
            assert!(channel["schema"].as_str().is_some_and(|schema| !schema.is_empty()), "{channel}");
            channel["topic"].as_str().expect("a text").to_owned()
        })
        .collect();
    let expected = [
        "/proprio/samples",
        "/joint_states",
        "/proprio/shape",
        "/diagnostics",
        "/proprio/uncertainty",
        "/proprio/contact",
        "/tf",
        "/proprio/arm",
    ];
    assert_eq!(topics, expected);
}

#[test]
fn a_client_gets_what_it_has_subscribed_to_until_it_unsubscribes() {
    let mut stream = Stream::new();
    let mut client = stream.client();
    client.subscribe("/proprio/samples", 70);
    client.subscribe("/joint_states", 71);
    let mut seen = [false; 2];
    let end = Instant::now() + PATIENCE;
    while seen != [true; 2] {
        stream.tick();
        let (id, _) = client.data();
        seen[(id - 70) as usize] = true;
        assert!(Instant::now() < end, "{seen:?}");
    }
    client.send(&json!({"op": "unsubscribe", "subscriptionIds": [71]}));
    // An unknown channel is reported, which shows that the request before it was done.
    client.send(&json!({"op": "subscribe", "subscriptions": [{"id": 72, "channelId": 99}]}));
    assert_eq!(client.json()["message"], "there is no channel 99");
    let last = stream.tick;
    stream.tick();
    loop {
        let (id, data) = client.data();
        if id == 70 && tick_of(&data) == last {
            break;
        }
    }
    stream.tick();
    assert_eq!(client.data().0, 70);
}

#[test]
fn segments_that_are_not_known_are_no_transforms_and_their_markers_are_removed() {
    let mut stream = Stream::new();
    let mut client = stream.client();
    client.subscribe("/tf", 0);
    client.subscribe("/proprio/arm", 1);
    let mut of_tick = |channel: u32| {
        let end = Instant::now() + PATIENCE;
        loop {
            // A picture of the arm comes with every fourth tick.
            (0..4).for_each(|_| stream.tick());
            let (id, data) = client.data();
            if id == channel {
                return data;
            }
            assert!(Instant::now() < end, "no message on channel {channel}");
        }
    };
    let count = |data: &[u8]| u32::from_le_bytes(data[4..8].try_into().expect("four bytes"));
    let transforms = of_tick(0);
    assert_eq!(count(&transforms), 5);
    let names = String::from_utf8_lossy(&transforms).into_owned();
    assert!(names.contains("segment5") && !names.contains("segment6"), "{names}");
    assert_eq!(count(&of_tick(1)), 12, "a line and an ellipse for each segment");
}

#[test]
fn a_slow_client_loses_the_oldest_messages_and_no_other_client_any() {
    let mut stream = Stream::new();
    let mut slow = stream.client();
    for (id, channel) in (0..).zip(["/proprio/samples", "/joint_states", "/proprio/shape", "/tf"]) {
        slow.subscribe(channel, id);
    }
    let mut fast = stream.client();
    fast.subscribe("/proprio/samples", 0);
    stream.tick();
    fast.data();
    // In 400 batches, more than the system's buffers and the slow client's queue have room for.
    let mut next = stream.tick;
    for _ in 0..400 {
        (0..200).for_each(|_| stream.tick());
        while next < stream.tick {
            assert_eq!(tick_of(&fast.data().1), next);
            next += 1;
        }
    }
    let warning = slow.json();
    assert!(warning["message"].as_str().is_some_and(|text| text.contains("too slow")), "{warning}");
    // The newest are there.
    loop {
        let (id, data) = slow.data();
        if id == 0 && tick_of(&data) + 1 == stream.tick {
            break;
        }
    }
}

#[test]
fn pages_of_other_sites_and_other_protocols_are_refused() {
    let stream = Stream::new();
    for subprotocol in ["foxglove.sdk.v1", "foxglove.websocket.v1", "foxglove.sdk.v1.1, foxglove.sdk.v1"] {
        for origin in [None, Some("file://"), Some("http://localhost:8080"), Some("https://app.foxglove.dev")] {
            assert!(stream.connect(subprotocol, origin).is_ok(), "{subprotocol} {origin:?}");
        }
    }
    assert_eq!(stream.connect("foxglove.sdk.v1", Some("https://example.com")).err(), Some(403));
    assert_eq!(stream.connect("foxglove.sdk.v1", Some("null")).err(), Some(403));
    assert_eq!(stream.connect("rosbridge", None).err(), Some(400));
}

#[test]
fn no_client_reaches_the_board() {
    let mut stream = Stream::new();
    stream.line.board().restart(1);
    stream.link.wait_until_connected().expect("the board answers");
    let mut client = stream.client();
    client.subscribe("/proprio/samples", 0);
    client
        .send(&json!({"op": "advertise", "channels": [{"id": 1, "topic": "/proprio/set_points", "encoding": "cdr"}]}));
    client.send(&json!({"op": "setParameters", "parameters": [{"name": "armed", "value": true}]}));
    client.socket.send(Message::binary(vec![1, 1, 0, 0, 0, 7])).expect("it is open");
    client.socket.send(Message::from("no JSON")).expect("it is open");
    let warning = client.json();
    assert!(warning["message"].as_str().is_some_and(|text| text.contains("not of this protocol")), "{warning}");
    stream.tick();
    client.data();
    assert!(stream.line.board().done.iter().all(|command| *command == Command::Ping));
}

#[test]
fn a_port_that_is_taken_is_named() {
    let stream = Stream::new();
    let port = stream.server.address().port();
    let error = FoxgloveServer::start(stream.link.subscribe(), port, None).expect_err("it is taken");
    assert!(error.to_string().starts_with(&format!("port {port} of 127.0.0.1 cannot be listened on: ")), "{error}");
}
