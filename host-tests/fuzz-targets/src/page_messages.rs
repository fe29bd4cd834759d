//! Messages of the live page: HTTP requests with JSON, and the WebSocket of the feed.
//!
//! The first byte of an input selects a path with the rest as its body, query or message, and its lowest bits leave out
//! the headers that give access; or the rest is all that a client sends.

use std::path::PathBuf;
use std::sync::OnceLock;

use proprio_monitor::{Options, Token, serve_stream};
use serde_json::Value;
use tokio::io::{AsyncReadExt, AsyncWriteExt};
use tokio::runtime::Runtime;

/// Port in the header Host; nothing listens on it.
const PORT: u16 = 8000;

/// Paths of requests with a body in JSON. From [`FIRST_OF_BOARD`] on they need the token.
const PATHS: [&str; 6] = ["/record", "/mark", "/unlock", "/control", "/tare", "/table"];
const FIRST_OF_BOARD: usize = 2;

/// Room for what a client sends and receives at once.
const BUFFER: usize = 1 << 16;

/// Serves a connection of the page.
///
/// # Panics
/// Where an answer is not HTTP, has no content security policy or is an internal error; where a request is accepted without
/// its origin or its token; where a body that is not JSON is accepted; and where the feed does not answer its end.
pub fn page_messages(bytes: &[u8]) {
    let Some((first, rest)) = bytes.split_first() else { return };
    let (has_origin, has_token) = (first & 1 == 0, first & 2 == 0);
    let access = Access { has_origin, has_token };
    match usize::from(first >> 2) % 9 {
        path @ 0..6 => check_request(path, rest, access),
        6 => check_feed(rest, access),
        7 => check_session(rest),
        _ => drop(Answer::of(&served(rest, true))),
    }
}

/// The headers that a request has.
#[derive(Clone, Copy)]
struct Access {
    has_origin: bool,
    has_token: bool,
}

impl Access {
    fn headers(self) -> String {
        let origin = if self.has_origin { format!("Origin: http://127.0.0.1:{PORT}\r\n") } else { String::new() };
        let token = if self.has_token { format!("Authorization: Bearer {}\r\n", token()) } else { String::new() };
        format!("Host: 127.0.0.1:{PORT}\r\n{origin}{token}")
    }
}

/// Status and head of an answer.
struct Answer {
    status: u16,
    head: String,
}

impl Answer {
    /// The first answer in what was received; `None` where the connection ended without one.
    fn of(received: &[u8]) -> Option<Self> {
        if received.is_empty() {
            return None;
        }
        let text = String::from_utf8_lossy(received);
        let (head, _) = text.split_once("\r\n\r\n").expect("the head of an answer ends");
        let status = head.strip_prefix("HTTP/1.").and_then(|rest| rest.get(2..5)?.parse().ok()).expect("a status");
        assert_ne!(status, 500, "{head}");
        Some(Self { status, head: head.to_owned() })
    }

    /// The answer to a request of which the head is right.
    fn of_router(received: &[u8]) -> Self {
        let answer = Self::of(received).expect("there is an answer");
        assert!(answer.head.contains("content-security-policy: default-src 'none'"), "{}", answer.head);
        answer
    }
}

fn check_request(path: usize, body: &[u8], access: Access) {
    let head = format!(
        "POST {} HTTP/1.1\r\n{}Content-Type: application/json\r\nContent-Length: {}\r\nConnection: close\r\n\r\n",
        PATHS[path],
        access.headers(),
        body.len()
    );
    let Answer { status, head } = Answer::of_router(&served(&[head.as_bytes(), body].concat(), false));
    match status {
        _ if !access.has_origin => assert_eq!(status, 403, "{head}"),
        _ if path >= FIRST_OF_BOARD && !access.has_token => assert_eq!(status, 401, "{head}"),
        200 if PATHS[path] == "/unlock" => {}
        200 | 409 => assert!(path < FIRST_OF_BOARD && is_object(body), "{head}"),
        400 | 422 => assert_ne!(PATHS[path], "/table", "{head}"),
        // There is no board.
        403 => assert!(is_object(body) || PATHS[path] == "/table", "{head}"),
        _ => panic!("{head}"),
    }
}

/// True for JSON that a request may have: an object, or the name of a variant.
fn is_object(body: &[u8]) -> bool {
    serde_json::from_slice::<Value>(body).is_ok()
}

/// Sends a message over the feed, and its end.
fn check_feed(message: &[u8], access: Access) {
    let head = format!(
        "GET /feed HTTP/1.1\r\n{}Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n\
         Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n",
        access.headers()
    );
    let frames = [frame(0x81, &message[..message.len().min(125)]), frame(0x88, &[])].concat();
    let received = served(&[head.as_bytes(), &frames].concat(), !access.has_origin);
    let Answer { status, head } = Answer::of_router(&received);
    assert_eq!(status, if access.has_origin { 101 } else { 403 }, "{head}");
    if access.has_origin && std::str::from_utf8(message).is_ok() && message.len() <= 125 {
        assert!(received.ends_with(&[0x88, 0]), "the end is answered");
    }
}

/// A frame of a WebSocket with an empty mask.
fn frame(opcode: u8, payload: &[u8]) -> Vec<u8> {
    [&[opcode, 0x80 | payload.len() as u8, 0, 0, 0, 0], payload].concat()
}

/// Opens a session, in a folder that has none.
fn check_session(query: &[u8]) {
    let is_plain = |byte: &u8| byte.is_ascii_alphanumeric() || b"=&%.-_+/".contains(byte);
    let query: String = query.iter().filter(|byte| is_plain(byte)).map(|byte| char::from(*byte)).collect();
    let access = Access { has_origin: false, has_token: false };
    let head = format!("GET /session?{query} HTTP/1.1\r\n{}Connection: close\r\n\r\n", access.headers());
    let Answer { status, head } = Answer::of_router(&served(head.as_bytes(), false));
    assert!(matches!(status, 400 | 404), "{head}");
}

/// The bytes that a client receives. A client that `leaves` ends what it sends.
fn served(bytes: &[u8], leaves: bool) -> Vec<u8> {
    static RUNTIME: OnceLock<Runtime> = OnceLock::new();
    let runtime = RUNTIME
        .get_or_init(|| tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime starts"));
    let options = Options {
        runtime_folder: None,
        stream: None,
        port: PORT,
        table: None,
        folder: PathBuf::from("/nowhere"),
        token: Some(token().clone()),
        session: None,
        help: ToString::to_string,
        finding_text: ToString::to_string,
    };
    let (mut client, server) = tokio::io::duplex(BUFFER);
    runtime.block_on(async {
        let exchange = async {
            // The server may have ended the connection already.
            let _ = client.write_all(bytes).await;
            if leaves {
                let _ = client.shutdown().await;
            }
            let mut received = Vec::new();
            let _ = client.read_to_end(&mut received).await;
            received
        };
        tokio::join!(serve_stream(options, server), exchange).1
    })
}

/// The token of every monitor.
fn token() -> &'static Token {
    static TOKEN: OnceLock<Token> = OnceLock::new();
    TOKEN.get_or_init(|| Token::new().expect("the system has random numbers"))
}
