//! The board's line through a running monitor, for a program of its user.

use std::collections::VecDeque;
use std::io;
use std::net::{SocketAddr, TcpStream};
use std::time::Duration;

use proprio_link::{ReceivedBytes, Relay, Relayed};
use proprio_session::HostNs;
use telemetry::Command;
use tungstenite::client::IntoClientRequest;
use tungstenite::http::header::{AUTHORIZATION, HeaderName, InvalidHeaderValue, ORIGIN};
use tungstenite::{Error, HandshakeError, Message, WebSocket};

use super::line_message::{LineMessage, LineRequest, split_bytes};
use super::running::{RunningMonitor, RunningMonitorError};

/// Longest wait for the begin, and for each of its parts: a history has up to 256 MB.
const BEGIN_TIMEOUT: Duration = Duration::from_secs(10);

/// Longest wait of a read: requests are sent between two reads.
const WAIT: Duration = Duration::from_millis(5);

/// Longest wait of a write, which a monitor that works takes at once.
const WRITE_TIMEOUT: Duration = Duration::from_secs(2);

/// A connection to the monitor that has a line. Its drop ends it.
pub struct LineClient {
    address: SocketAddr,
    socket: WebSocket<TcpStream>,
    waiting: VecDeque<Relayed>,
}

/// A line that a monitor has.
pub struct MonitoredLine {
    /// The connection.
    pub client: LineClient,
    /// Name of the line, where it is open.
    pub name: Option<String>,
    /// The bytes from the last start of the board's estimator until the begin of the connection, where they are asked for and all
    /// known.
    pub history: Option<Vec<ReceivedBytes>>,
}

impl RunningMonitor {
    /// Connects to the board's line; `with_history`: from the last start of the board's estimator on.
    ///
    /// # Errors
    /// [`RunningMonitorError`].
    pub fn line(&self, with_history: bool) -> Result<MonitoredLine, RunningMonitorError> {
        let address = self.address();
        let socket = self.connect(with_history).map_err(|error| match error {
            Error::Http(refused) => {
                let reason = String::from_utf8_lossy(refused.body().as_deref().unwrap_or_default()).into_owned();
                RunningMonitorError::Refused { address, reason }
            }
            Error::Io(source) => RunningMonitorError::NoAnswer { address, source },
            other => RunningMonitorError::NoAnswer { address, source: io::Error::other(other) },
        })?;
        let mut client = LineClient { address, socket, waiting: VecDeque::new() };
        let begin = client.begin().map_err(|source| RunningMonitorError::NoAnswer { address, source });
        let (name, history) = begin?;
        Ok(MonitoredLine { client, name, history })
    }

    fn connect(&self, with_history: bool) -> Result<WebSocket<TcpStream>, Error> {
        let address = self.address();
        let mut request = format!("ws://{address}/board/line?history={with_history}").into_client_request()?;
        let mut add = |name: HeaderName, value: String| -> Result<(), InvalidHeaderValue> {
            request.headers_mut().insert(name, value.parse()?);
            Ok(())
        };
        add(ORIGIN, format!("http://{address}")).map_err(tungstenite::http::Error::from)?;
        add(AUTHORIZATION, format!("Bearer {}", self.token)).map_err(tungstenite::http::Error::from)?;
        let tcp = TcpStream::connect(address)?;
        tcp.set_nodelay(true)?;
        tcp.set_read_timeout(Some(BEGIN_TIMEOUT))?;
        tcp.set_write_timeout(Some(WRITE_TIMEOUT))?;
        match tungstenite::client(request, tcp) {
            Ok((socket, _)) => Ok(socket),
            Err(HandshakeError::Failure(error)) => Err(error),
            Err(HandshakeError::Interrupted(_)) => Err(Error::Io(io::ErrorKind::TimedOut.into())),
        }
    }
}

/// The line's name, and its history.
type Begin = (Option<String>, Option<Vec<ReceivedBytes>>);

impl LineClient {
    /// Reads the begin of the connection.
    fn begin(&mut self) -> io::Result<Begin> {
        let (mut name, mut history) = Begin::default();
        loop {
            let message = match self.socket.read() {
                Err(Error::Io(error)) if is_pause(error.kind()) => return Err(io::ErrorKind::TimedOut.into()),
                read => read.map_err(|_| self.ended())?,
            };
            match message {
                Message::Binary(bytes) => history.get_or_insert_default().extend(received(&bytes)?),
                Message::Text(text) => match serde_json::from_str(&text)? {
                    LineMessage::Begin { line, has_history } => (name, history) = (line, has_history.then(Vec::new)),
                    LineMessage::Live => break,
                    _ => return Err(io::ErrorKind::InvalidData.into()),
                },
                _ => {}
            }
        }
        self.socket.get_ref().set_read_timeout(Some(WAIT))?;
        Ok((name, history))
    }

    /// The error of a connection that has ended.
    fn ended(&self) -> io::Error {
        io::Error::other(format!(
            "the monitor at http://{}, through which the board was reached, has ended",
            self.address
        ))
    }
}

/// True where a read has ended without data: at the end of its time, or by Ctrl-C.
fn is_pause(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted)
}

fn received(bytes: &[u8]) -> io::Result<Vec<ReceivedBytes>> {
    split_bytes(bytes).ok_or_else(|| io::ErrorKind::InvalidData.into())
}

fn relayed(message: LineMessage) -> Option<Relayed> {
    Some(match message {
        LineMessage::Opened(name) => Relayed::Opened(name),
        LineMessage::Lost(reason) => Relayed::Lost(reason),
        LineMessage::Ended(reason) => Relayed::Ended(reason),
        LineMessage::SetPoints { at_ns, requested } => Relayed::SetPoints(HostNs(at_ns), requested),
        LineMessage::Dropped(events) => Relayed::Dropped(events),
        LineMessage::Answer { id, error } => Relayed::Answer(id, error.map_or(Ok(()), Err)),
        LineMessage::Begin { .. } | LineMessage::Live => return None,
    })
}

impl Relay for LineClient {
    fn next(&mut self) -> io::Result<Option<Relayed>> {
        if let Some(relayed) = self.waiting.pop_front() {
            return Ok(Some(relayed));
        }
        match self.socket.read() {
            Ok(Message::Binary(bytes)) => {
                self.waiting.extend(received(&bytes)?.into_iter().map(|(at, bytes)| Relayed::Bytes(at, bytes)));
                Ok(self.waiting.pop_front())
            }
            Ok(Message::Text(text)) => Ok(relayed(serde_json::from_str(&text)?)),
            Ok(Message::Close(_)) => Err(self.ended()),
            Ok(_) => Ok(None),
            Err(Error::Io(error)) if is_pause(error.kind()) => Ok(None),
            Err(_) => Err(self.ended()),
        }
    }

    fn request(&mut self, id: u32, command: &Command) -> io::Result<()> {
        let request = serde_json::to_string(&LineRequest { id, command: command.clone() })?;
        self.socket.send(Message::Text(request.into())).map_err(|_| self.ended())
    }
}
