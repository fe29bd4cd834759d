//! The table from the live page onto a board that has none.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::Stdio;
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::tools::{Running, folder, proprio, table};

/// The page of a running monitor.
struct Page {
    /// Address and port.
    host: String,
    token: String,
}

impl Page {
    /// Sends a request; returns the status and the body.
    fn request(&self, method: &str, path: &str) -> (u16, String) {
        let Self { host, token } = self;
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
    fn wait_for_status(&self, is_as_wanted: impl Fn(&Value) -> bool) -> Value {
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

#[test]
fn the_page_offers_its_table_to_a_board_without_one_and_stores_it() {
    let folder = folder("table of the page");
    let arguments = ["monitor", "--virtual", "--firmware", "firmware", "--flash", "empty.bin", "--table", &table()];
    let arguments = [&arguments[..], &["--listen", "0", "--allow-control"]].concat();
    let mut monitor = Running(proprio(&folder, &arguments).stdout(Stdio::piped()).spawn().expect("the tool starts"));
    let mut address = String::new();
    BufReader::new(monitor.0.stdout.take().expect("a pipe")).read_line(&mut address).expect("it prints its address");
    let (host, token) = address.trim().trim_start_matches("http://").split_once("/#token=").expect("with a token");
    let page = Page { host: host.to_owned(), token: token.to_owned() };

    let before = page.wait_for_status(|status| status["board"].is_object());
    assert_eq!((&before["offers_table"], &before["board"]["table"]), (&Value::Bool(true), &Value::Null));

    let (status, text) = page.request("POST", "/table");
    assert!(status == 200 && text.contains("of arm planar-6"), "{status}: {text}");
    let after = page.wait_for_status(|status| status["board"]["table"].is_string());
    assert_eq!((&after["offers_table"], &after["board"]["arm"]), (&Value::Bool(false), &"planar-6".into()));

    let without = Page { token: "0".to_owned(), ..page };
    assert_eq!(without.request("POST", "/table").0, 401, "nothing is stored without the token");
}
