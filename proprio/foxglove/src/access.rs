//! Access control: which pages of a browser may read the stream.
//!
//! Any page in a browser can reach a server on this machine. A foreign name that resolves to 127.0.0.1 is detected by the header
//! Host, a script of a foreign page by Origin, which browsers send with every WebSocket and no script can set. Programs send no
//! Origin, or one that no site can have, such as `file://` of desktop viewers; they cannot be kept out, and need not be.

use axum::http::HeaderMap;
use axum::http::header::{HOST, ORIGIN};

/// The site of Foxglove's viewer.
const FOXGLOVE: &str = "https://app.foxglove.dev";

/// Reasons to refuse a connection.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Refused {
    #[error("this server is 127.0.0.1 and localhost, and answers to no other name")]
    Host,
    #[error("pages of {FOXGLOVE} and of this machine may read this stream, and no other site's")]
    Origin,
}

/// Checks name and origin of a connection.
pub fn check(headers: &HeaderMap) -> Result<(), Refused> {
    let mut hosts = headers.get_all(HOST).iter();
    let host = hosts.next().and_then(|host| host.to_str().ok()).ok_or(Refused::Host)?;
    if !is_this_machine(host) || hosts.next().is_some() {
        return Err(Refused::Host);
    }
    let mut origins = headers.get_all(ORIGIN).iter();
    let Some(origin) = origins.next() else { return Ok(()) };
    let may_read = origin.to_str().is_ok_and(may_read) && origins.next().is_none();
    if may_read { Ok(()) } else { Err(Refused::Origin) }
}

/// True for Foxglove's site, pages of this machine, and programs.
fn may_read(origin: &str) -> bool {
    match origin.split_once("://") {
        Some(("http" | "https", host)) => origin == FOXGLOVE || is_this_machine(host),
        // A scheme that no site has.
        Some(_) => true,
        // `null` is a page in a frame or a file without an origin, of any site.
        None => false,
    }
}

/// True for the names of this machine, with any port: a tunnel has another one.
fn is_this_machine(host: &str) -> bool {
    let is_port = |text: &str| text.parse::<u16>().is_ok();
    ["127.0.0.1", "localhost"].iter().any(|name| match host.strip_prefix(name) {
        Some("") => true,
        Some(port) => port.strip_prefix(':').is_some_and(is_port),
        None => false,
    })
}

#[cfg(test)]
mod tests {
    use super::{HOST, HeaderMap, ORIGIN, Refused, check};

    fn checked(headers: &[(axum::http::HeaderName, &str)]) -> Result<(), Refused> {
        let mut map = HeaderMap::new();
        for (name, value) in headers {
            map.append(name, value.parse().expect("a header's value"));
        }
        check(&map)
    }

    #[test]
    fn programs_viewers_and_pages_of_this_machine_may_read() {
        for host in ["127.0.0.1:8765", "localhost:8765", "localhost:9000", "127.0.0.1"] {
            assert_eq!(checked(&[(HOST, host)]), Ok(()), "{host}");
        }
        let origins = [
            "file://",
            "foxglove://app",
            "https://app.foxglove.dev",
            "http://localhost:8080",
            "http://127.0.0.1",
            "https://localhost",
        ];
        for origin in origins {
            assert_eq!(checked(&[(HOST, "127.0.0.1:8765"), (ORIGIN, origin)]), Ok(()), "{origin}");
        }
    }

    #[test]
    fn pages_of_other_sites_may_not() {
        let origins = [
            "null",
            "https://example.com",
            "http://app.foxglove.dev",
            "https://app.foxglove.dev.example.com",
            "https://example.com/app.foxglove.dev",
            "http://localhost.example.com",
            "http://localhost:8080.example.com",
            "http://127.0.0.1.example.com:8765",
            "",
        ];
        for origin in origins {
            assert_eq!(checked(&[(HOST, "127.0.0.1:8765"), (ORIGIN, origin)]), Err(Refused::Origin), "{origin}");
        }
        let twice = [(HOST, "127.0.0.1:8765"), (ORIGIN, "file://"), (ORIGIN, "https://example.com")];
        assert_eq!(checked(&twice), Err(Refused::Origin));
    }

    #[test]
    fn other_names_are_not_answered() {
        for host in ["example.com", "example.com:8765", "localhost.example.com", "127.0.0.1.example.com", "127.0.0.12"]
        {
            assert_eq!(checked(&[(HOST, host)]), Err(Refused::Host), "{host}");
        }
        assert_eq!(checked(&[]), Err(Refused::Host));
        assert_eq!(checked(&[(HOST, "localhost:8765"), (HOST, "example.com")]), Err(Refused::Host));
    }
}
