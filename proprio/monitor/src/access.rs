//! Access control: only pages of this program may send requests, and only with the token may they drive the board.
//!
//! Any page in a browser can reach a server on this machine. A foreign name that resolves to 127.0.0.1 is detected by the
//! header Host, a script of another page by Origin, which browsers send with every POST and WebSocket and no script can set.

use std::fmt;

use axum::http::header::{AUTHORIZATION, HOST, ORIGIN};
use axum::http::{HeaderMap, StatusCode};

/// Reasons to refuse a request.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub(super) enum Refused {
    #[error("this server is http://127.0.0.1:{0} and http://localhost:{0}, and answers to no other name")]
    Host(u16),
    #[error("the request does not come from this server's page")]
    Origin,
    #[error("the page may not drive the board: start with --allow-control")]
    ReadOnly,
    #[error("the token is missing or wrong: open the address that `proprio monitor` has printed")]
    Token,
    #[error("the request did not arrive whole within {0} s")]
    Slow(u64),
    #[error("the request is longer than {0} MB; put a long session into the folder of this monitor instead")]
    Long(u64),
}

impl Refused {
    pub fn status(self) -> StatusCode {
        match self {
            Self::Host(_) | Self::Origin | Self::ReadOnly => StatusCode::FORBIDDEN,
            Self::Token => StatusCode::UNAUTHORIZED,
            Self::Slow(_) => StatusCode::REQUEST_TIMEOUT,
            Self::Long(_) => StatusCode::PAYLOAD_TOO_LARGE,
        }
    }
}

/// The host name of the request, if it is one of the server's.
pub(super) fn check_host(headers: &HeaderMap, port: u16) -> Result<&str, Refused> {
    let mut hosts = headers.get_all(HOST).iter();
    let host = hosts.next().and_then(|host| host.to_str().ok()).ok_or(Refused::Host(port))?;
    let is_ours = [format!("127.0.0.1:{port}"), format!("localhost:{port}")].iter().any(|ours| ours == host);
    if is_ours && hosts.next().is_none() { Ok(host) } else { Err(Refused::Host(port)) }
}

/// Checks that the request comes from a page of this server.
pub(super) fn check_origin(headers: &HeaderMap, port: u16) -> Result<(), Refused> {
    let host = check_host(headers, port)?;
    let origin = headers.get(ORIGIN).and_then(|origin| origin.to_str().ok());
    if origin == Some(&format!("http://{host}")) { Ok(()) } else { Err(Refused::Origin) }
}

/// Token that permits a page to drive the board.
#[derive(Clone, PartialEq, Eq)]
pub struct Token(String);

impl Token {
    /// A random token.
    ///
    /// # Errors
    /// [`std::io::Error`] where the system has no random numbers.
    pub fn new() -> Result<Self, std::io::Error> {
        let mut bytes = [0; 16];
        getrandom::fill(&mut bytes)?;
        Ok(Self(format!("{:032x}", u128::from_be_bytes(bytes))))
    }

    /// Checks that the request has the token. The comparison takes the same time for every token.
    pub(super) fn check(&self, headers: &HeaderMap) -> Result<(), Refused> {
        let given = headers.get(AUTHORIZATION).and_then(|given| given.as_bytes().strip_prefix(b"Bearer "));
        let given = given.filter(|given| given.len() == self.0.len()).ok_or(Refused::Token)?;
        let differs = given.iter().zip(self.0.as_bytes()).fold(0, |differs, (a, b)| differs | (a ^ b));
        if differs == 0 { Ok(()) } else { Err(Refused::Token) }
    }
}

impl fmt::Display for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

/// Without the token itself, so that it is not logged.
impl fmt::Debug for Token {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Token")
    }
}
