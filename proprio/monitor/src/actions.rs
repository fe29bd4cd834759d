//! What a page asks for, each an answer of its own.

use std::io::Write;
use std::sync::Arc;

use axum::Json;
use axum::body::{Body, Bytes};
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_TYPE, HeaderName};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use http_body_util::BodyExt;
use serde::Deserialize;
use telemetry::{Command, REGULATORS, SetPressures};

use super::access::Refused;
use super::server::Server;
use super::sessions::File;

const BYTES: [(HeaderName, &str); 1] = [(CONTENT_TYPE, "application/octet-stream")];

/// How long set-points stand without the page's next, ms. A page that is closed, or hidden and slowed by its browser, lets
/// the board vent.
const VALID_MS: u16 = 500;

type Answer<T> = Result<T, Response>;

/// Runs work that blocks on a thread of its own.
async fn run_blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Answer<T> {
    let done = tokio::task::spawn_blocking(work).await;
    done.map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "this is a fault of proprio").into_response())
}

pub(super) async fn history(State(server): State<Server>) -> Answer<impl IntoResponse> {
    #[derive(serde::Serialize)]
    struct Nothing {}
    let bytes = run_blocking(move || server.shared.history().to_bytes(&Nothing {})).await?;
    Ok((BYTES, bytes))
}

pub(super) async fn status(State(server): State<Server>) -> impl IntoResponse {
    ([(CONTENT_TYPE, "application/json")], server.shared.status().to_string())
}

pub(super) async fn list(State(server): State<Server>) -> Answer<Json<Vec<File>>> {
    run_blocking(move || Json(server.shared.sessions.list())).await
}

#[derive(Debug, Deserialize)]
pub(super) struct Part {
    name: String,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

pub(super) async fn session(State(server): State<Server>, Query(part): Query<Part>) -> Answer<impl IntoResponse> {
    let Some(path) = server.shared.sessions.path(&part.name) else {
        return Err((StatusCode::NOT_FOUND, format!("{}: there is no such session", part.name)).into_response());
    };
    let (from_s, to_s) = (part.from_s.unwrap_or(f64::NEG_INFINITY), part.to_s.unwrap_or(f64::INFINITY));
    let shared = Arc::clone(&server.shared);
    let rows = run_blocking(move || shared.sessions.rows(&path, from_s, to_s)).await?;
    Ok((BYTES, rows.map_err(|error| server.failure(&error))?))
}

#[derive(Debug, Deserialize)]
pub(super) struct Sent {
    name: String,
}

/// Takes a session that the browser sends, piece by piece.
pub(super) async fn send(State(server): State<Server>, Query(sent): Query<Sent>, mut body: Body) -> Answer<()> {
    let failed = |error: &dyn std::fmt::Display| (StatusCode::CONFLICT, error.to_string()).into_response();
    let suffix = std::path::Path::new(&sent.name).extension().unwrap_or_default().to_string_lossy().into_owned();
    let mut file = tempfile::Builder::new().suffix(&format!(".{suffix}")).tempfile().map_err(|error| failed(&error))?;
    while let Some(frame) = body.frame().await {
        let data: Bytes = frame.map_err(|error| failed(&error))?.into_data().unwrap_or_default();
        file.write_all(&data).map_err(|error| failed(&error))?;
    }
    server.shared.sessions.keep(&sent.name, file.into_temp_path());
    Ok(())
}

#[derive(Debug, Deserialize)]
pub(super) struct Record {
    on: bool,
}

pub(super) async fn record(State(server): State<Server>, Json(Record { on }): Json<Record>) -> Answer<Response> {
    let shared = Arc::clone(&server.shared);
    let done = run_blocking(move || {
        if on { shared.begin_recording().map(|()| shared.recording()) } else { shared.finish_recording() }
    });
    Ok(Json(done.await?.map_err(|error| server.failure(&error))?).into_response())
}

#[derive(Debug, Deserialize)]
pub(super) struct Mark {
    text: String,
}

pub(super) async fn mark(State(server): State<Server>, Json(Mark { text }): Json<Mark>) -> Answer<()> {
    let is_marked = server.shared.mark(text);
    is_marked.then_some(()).ok_or_else(|| (StatusCode::CONFLICT, "nothing is recorded: begin first").into_response())
}

/// What the page asks of the board.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Control {
    Arm,
    /// Vents, and disarms.
    Vent,
    SetPressures {
        kpa: [f64; REGULATORS],
    },
}

impl From<Control> for Command {
    fn from(control: Control) -> Self {
        match control {
            Control::Arm => Self::Arm,
            Control::Vent => Self::Disarm,
            Control::SetPressures { kpa } => {
                // A cast ends at 0 and at the largest number; the board refuses what is over its regulators' range.
                let pressures_pa = kpa.map(|kpa| (kpa * 1e3).round() as u32);
                Self::SetPressures(SetPressures { pressures_pa, valid_ms: VALID_MS })
            }
        }
    }
}

pub(super) async fn control(State(server): State<Server>, headers: HeaderMap, body: Bytes) -> Answer<()> {
    let shared = Arc::clone(&server.shared);
    // The token before anything else is looked at.
    shared
        .token
        .as_ref()
        .ok_or(Refused::ReadOnly)
        .and_then(|token| token.check(&headers))
        .map_err(Refused::into_response)?;
    let control: Control =
        serde_json::from_slice(&body).map_err(|error| (StatusCode::BAD_REQUEST, error.to_string()).into_response())?;
    let asked = run_blocking(move || shared.link.as_ref().map(|link| link.request(control.into())));
    match asked.await? {
        Some(done) => done.map_err(|error| server.failure(&error.into())),
        None => Err(Refused::ReadOnly.into_response()),
    }
}
