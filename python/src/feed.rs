//! The feed of a running monitor, over its WebSocket.

use std::io::ErrorKind;
use std::net::TcpStream;
use std::time::Duration;

use pyo3::prelude::*;
use tungstenite::client::IntoClientRequest;
use tungstenite::http::HeaderValue;
use tungstenite::http::header::ORIGIN;
use tungstenite::{Error, Message, WebSocket};

use crate::error::with_help;

/// Longest time between two checks for Ctrl-C.
const CHECK_PERIOD: Duration = Duration::from_millis(100);

/// An open feed.
#[pyclass]
pub struct Feed(WebSocket<TcpStream>);

#[pymethods]
impl Feed {
    /// Connects to the monitor at `host`, such as `127.0.0.1:8642`.
    #[new]
    fn new(py: Python<'_>, host: &str) -> PyResult<Self> {
        py.detach(|| connect(host)).map(Self).map_err(|error| {
            let text = format!("{host}: no monitor answers: {error}");
            with_help(
                py,
                &text,
                "start one with `proprio monitor` or `proprio demo`, and give the address that it prints",
            )
        })
    }

    /// The next message, as JSON; `None` at the end of the monitor.
    fn next(&mut self, py: Python<'_>) -> PyResult<Option<String>> {
        loop {
            match py.detach(|| self.0.read()) {
                Ok(Message::Text(text)) => return Ok(Some(text.to_string())),
                Ok(Message::Close(_)) => return Ok(None),
                Ok(_) => {}
                Err(Error::Io(error)) if matches!(error.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) => {
                    py.check_signals()?;
                }
                // The monitor has ended, by itself or at once.
                Err(_) => return Ok(None),
            }
        }
    }

    /// Closes the feed.
    fn close(&mut self) {
        // The monitor may have ended.
        let _ = self.0.close(None).and_then(|()| self.0.flush());
    }
}

fn connect(host: &str) -> Result<WebSocket<TcpStream>, String> {
    let text = |error: &dyn std::fmt::Display| error.to_string();
    let mut request = format!("ws://{host}/feed").into_client_request().map_err(|error| text(&error))?;
    // The monitor answers pages of its own alone.
    let origin = HeaderValue::from_str(&format!("http://{host}")).map_err(|error| text(&error))?;
    request.headers_mut().insert(ORIGIN, origin);
    let stream = TcpStream::connect(host).map_err(|error| text(&error))?;
    let (socket, _) = tungstenite::client(request, stream).map_err(|error| text(&error))?;
    socket.get_ref().set_read_timeout(Some(CHECK_PERIOD)).map_err(|error| text(&error))?;
    Ok(socket)
}
