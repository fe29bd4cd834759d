//! The page of a running monitor, as a browser requests it.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::tools::Running;

/// The page of a running monitor.
pub struct Page {
    /// Address and port.
    host: String,
    /// Its token; empty where the page controls nothing.
    token: String,
    _monitor: Running,
}

impl Page {
    /// The page of a command, at the address that it prints.
    pub fn of(command: &mut Command) -> Self {
        let mut monitor = Running(command.stdout(Stdio::piped()).spawn().expect("the tool starts"));
        let mut address = String::new();
        BufReader::new(monitor.0.stdout.take().expect("a pipe"))
            .read_line(&mut address)
            .expect("it prints its address");
        let (host, token) = address.trim().trim_start_matches("http://").split_once('/').expect("an address");
        let token = token.trim_start_matches("#token=").to_owned();
        Self { host: host.to_owned(), token, _monitor: monitor }
    }

    /// The same page, whose requests have another token.
    pub fn with_token(self, token: &str) -> Self {
        Self { token: token.to_owned(), ..self }
    }

    /// Sends a request; returns the status and the body.
    pub fn request(&self, method: &str, path: &str) -> (u16, String) {
        let Self { host, token, .. } = self;
        let mut stream = TcpStream::connect(host).expect("the monitor listens");
        let head = format!(
            "{method} {path} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nAuthorization: Bearer {token}\r\n\
             Content-Length: 0\r\nConnection: close\r\n\r\n"
        );
        stream.write_all(head.as_bytes()).expect("the monitor reads");
        let mut answer = String::new();
        stream.read_to_string(&mut answer).expect("the monitor answers in UTF-8");
        let (head, body) = answer.split_once("\r\n\r\n").expect("a head and a body");
        let status = head.split(' ').nth(1).and_then(|status| status.parse().ok()).expect("a status");
        (status, body.to_owned())
    }

    /// The page's status, once the board answers and `is_as_wanted`.
    pub fn wait_for_status(&self, is_as_wanted: impl Fn(&Value) -> bool) -> Value {
        let end = Instant::now() + Duration::from_mins(1);
        loop {
            let (_, body) = self.request("GET", "/status");
            let status = body.split_once('{').and_then(|(_, rest)| {
                let json = format!("{{{}", rest.rsplit_once('}')?.0);
                serde_json::from_str::<Value>(&(json + "}")).ok()
            });
            if let Some(status) = status.filter(|status| status["answers"] == true && is_as_wanted(status)) {
                return status;
            }
            assert!(Instant::now() < end, "{body}");
            std::thread::sleep(Duration::from_millis(200));
        }
    }
}
