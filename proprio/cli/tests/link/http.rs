//! A monitor over a line in memory, and a client of its page.

use std::io::{Read, Write};
use std::net::{IpAddr, Ipv4Addr, SocketAddr, TcpStream};
use std::time::Duration;

use proprio_link::Link;
use proprio_monitor::{Monitor, Options, Token};
use proprio_session::LoadedTable;
use serde_json::Value;
use tempfile::TempDir;
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use super::line::{Line, PATIENCE};

/// Address that a page announces for its stream.
pub const STREAM: SocketAddr = SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 8765);

/// The monitor, and its folders.
pub struct Page {
    pub monitor: Monitor,
    pub folder: TempDir,
    /// Where the monitor is announced to the user's programs.
    pub runtime_folder: TempDir,
}

/// Answer of a server.
#[derive(Debug)]
pub struct Answer {
    pub status: u16,
    pub head: String,
    pub body: Vec<u8>,
}

impl Answer {
    pub fn text(&self) -> String {
        String::from_utf8_lossy(&self.body).into_owned()
    }

    /// The line of JSON in front of rows.
    pub fn about(&self) -> Value {
        let line = self.body.split(|byte| *byte == b'\n').next().expect("there is a first line");
        serde_json::from_slice(line).unwrap_or_else(|error| panic!("{error}: {}", self.text()))
    }
}

impl Answer {
    /// One column of its rows, as bits.
    pub fn column(&self, columns: &Value, name: &str) -> Vec<u32> {
        let rows = self.about()["rows"].as_u64().expect("a number") as usize;
        let place = columns.as_array().and_then(|names| names.iter().position(|column| column == name));
        let begin = self.body.iter().position(|byte| *byte == b'\n').expect("a line") + 1;
        let floats = &self.body[begin + 8 * rows..][place.expect("a column") * 4 * rows..][..4 * rows];
        floats.as_chunks().0.iter().map(|bytes| u32::from_le_bytes(*bytes)).collect()
    }
}

impl Page {
    /// Of a board on this line.
    pub fn of(line: &Line, token: Option<Token>) -> Self {
        Self::with_table(line, token, None)
    }

    pub fn with_table(line: &Line, token: Option<Token>, table: Option<LoadedTable>) -> Self {
        let live = Link::start_waiting(Box::new(line.clone()), None).expect("memory opens");
        let folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let runtime_folder = tempfile::tempdir().expect("there is room for a temporary folder");
        let options = Options {
            port: 0,
            table,
            folder: folder.path().to_owned(),
            token,
            session: None,
            runtime_folder: Some(runtime_folder.path().to_owned()),
            stream: Some(STREAM),
            help: ToString::to_string,
            finding_text: ToString::to_string,
        };
        Self { monitor: Monitor::start(Some(live), options).expect("a free port"), folder, runtime_folder }
    }

    pub fn port(&self) -> u16 {
        self.monitor.address().port()
    }

    pub fn host(&self) -> String {
        format!("127.0.0.1:{}", self.port())
    }

    pub fn origin(&self) -> String {
        format!("http://{}", self.host())
    }

    /// Sends a request as it is written here.
    pub fn request(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &str) -> Answer {
        let mut stream = TcpStream::connect(self.monitor.address()).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let headers: Vec<String> = headers.iter().map(|(name, value)| format!("{name}: {value}\r\n")).collect();
        let headers = headers.concat();
        let length = body.len();
        let request =
            format!("{method} {path} HTTP/1.1\r\n{headers}Content-Length: {length}\r\nConnection: close\r\n\r\n{body}");
        stream.write_all(request.as_bytes()).expect("it listens");
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer).expect("it answers");
        let end = answer.windows(4).position(|bytes| bytes == b"\r\n\r\n").expect("the head has an end");
        let head = String::from_utf8_lossy(&answer[..end]).into_owned();
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        Answer { status, head, body: answer[end + 4..].to_vec() }
    }

    pub fn get(&self, path: &str) -> Answer {
        self.request("GET", path, &[("Host", &self.host())], "")
    }

    /// A POST with the headers of the page itself.
    pub fn post(&self, path: &str, body: &str) -> Answer {
        let (host, origin) = (self.host(), self.origin());
        self.request("POST", path, &[("Host", &host), ("Origin", &origin), ("Content-Type", "application/json")], body)
    }

    /// The WebSocket, from a page of this origin; or the status with which it is refused.
    pub fn socket(&self, origin: Option<&str>) -> Result<Socket, u16> {
        self.socket_at("/feed", origin, "")
    }

    /// The WebSocket at a path, with a token.
    pub fn socket_at(&self, path: &str, origin: Option<&str>, token: &str) -> Result<Socket, u16> {
        let stream = TcpStream::connect(self.monitor.address()).expect("it listens");
        stream.set_read_timeout(Some(PATIENCE)).expect("a timeout");
        let mut request = format!("ws://{}{path}", self.host()).into_client_request().expect("an address");
        if let Some(origin) = origin {
            request.headers_mut().insert("Origin", origin.parse().expect("a header's value"));
        }
        request.headers_mut().insert("Authorization", format!("Bearer {token}").parse().expect("a header's value"));
        match tungstenite::client(request, stream) {
            Ok((socket, _)) => Ok(Socket(socket)),
            Err(tungstenite::HandshakeError::Failure(tungstenite::Error::Http(refused))) => {
                Err(refused.status().as_u16())
            }
            Err(other) => panic!("{other}"),
        }
    }

    /// Waits for a status that satisfies `is_so`.
    pub fn wait_for_status(&self, is_so: impl Fn(&Value) -> bool) -> Value {
        let end = std::time::Instant::now() + PATIENCE;
        loop {
            let status = serde_json::from_slice(&self.get("/status").body).unwrap_or_default();
            if is_so(&status) {
                return status;
            }
            assert!(std::time::Instant::now() < end, "{status}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }
}

/// A page's feed.
pub struct Socket(WebSocket<TcpStream>);

impl Socket {
    /// The next message of this type; batches of rows are confirmed as a page does.
    pub fn next(&mut self, kind: &str) -> Value {
        loop {
            let message = self.read();
            if let Some(sent_us) = message["sent_us"].as_u64() {
                self.send(&format!(r#"{{"taken_us":{sent_us}}}"#));
            }
            if message["type"] == kind {
                return message;
            }
        }
    }

    /// The next message of this type; nothing is confirmed.
    pub fn unconfirmed(&mut self, kind: &str) -> Value {
        loop {
            let message = self.read();
            if message["type"] == kind {
                return message;
            }
        }
    }

    fn read(&mut self) -> Value {
        loop {
            if let Message::Text(text) = self.0.read().expect("the feed is open") {
                return serde_json::from_str(&text).expect("it is JSON");
            }
        }
    }

    /// The description of the arm, once the board has sent its number of segments.
    pub fn arm(&mut self) -> Value {
        loop {
            let arm = self.next("arm");
            if arm["segments"] != 0 {
                return arm;
            }
        }
    }

    pub fn send(&mut self, text: &str) {
        self.0.send(Message::from(text)).expect("it listens");
    }
}
