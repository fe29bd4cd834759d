//! Bodies of requests, limited in length and in the time that their parts take.

use std::io;
use std::time::Duration;

use axum::body::{Body, Bytes, HttpBody};
use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt;

use super::access::Refused;

/// Longest time for the head of a request, and for each part of its body.
pub(super) const PART_TIMEOUT: Duration = Duration::from_secs(10);

/// Largest session that is received, MB: four hours of recording.
pub(super) const SESSION_MB: u64 = 2000;

/// Largest body of another request, MB.
pub(super) const REQUEST_MB: u64 = 1;

/// Passes the parts of a body to `take`, up to a length in MB.
pub(super) async fn read(
    mut body: Body,
    most_mb: u64,
    mut take: impl FnMut(&Bytes) -> io::Result<()>,
) -> Result<(), Response> {
    let failed = |error: &dyn std::fmt::Display| (StatusCode::CONFLICT, error.to_string()).into_response();
    let refused = |refused: Refused| refused.into_response();
    let most = most_mb * 1_000_000;
    if HttpBody::size_hint(&body).lower() > most {
        return Err(refused(Refused::Long(most_mb)));
    }
    let mut length = 0;
    loop {
        let part = tokio::time::timeout(PART_TIMEOUT, body.frame()).await;
        let Some(part) = part.map_err(|_| refused(Refused::Slow(PART_TIMEOUT.as_secs())))? else { return Ok(()) };
        let bytes = part.map_err(|error| failed(&error))?.into_data().unwrap_or_default();
        length += bytes.len() as u64;
        if length > most {
            return Err(refused(Refused::Long(most_mb)));
        }
        take(&bytes).map_err(|error| failed(&error))?;
    }
}

#[cfg(test)]
mod tests {
    use axum::body::Body;
    use axum::http::StatusCode;

    use super::read;

    fn status_of(body: Body) -> Option<StatusCode> {
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().expect("a runtime starts");
        runtime.block_on(read(body, 1, |_| Ok(()))).err().map(|response| response.status())
    }

    #[test]
    fn a_body_over_the_limit_is_refused_also_when_its_length_is_not_told() {
        assert_eq!(status_of(Body::from(vec![0; 1_000_000])), None);
        assert_eq!(status_of(Body::from(vec![0; 1_000_001])), Some(StatusCode::PAYLOAD_TOO_LARGE));
        let untold = http_body_util::BodyExt::map_frame(Body::from(vec![0; 1_000_001]), |frame| frame);
        assert_eq!(status_of(Body::new(untold)), Some(StatusCode::PAYLOAD_TOO_LARGE));
    }
}
