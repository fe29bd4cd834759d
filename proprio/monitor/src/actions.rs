//! Handlers of a page's requests.

use std::io::Write;
use std::sync::Arc;

use axum::Json;
use axum::body::{Body, Bytes};
use axum::extract::{Query, State};
use axum::http::header::{CONTENT_TYPE, HeaderName};
use axum::http::{HeaderMap, StatusCode};
use axum::response::{IntoResponse, Response};
use proprio_link::TareError;
use proprio_session::NoProgress;
use serde::{Deserialize, Serialize};
use telemetry::{Command, MAX_REGULATORS, SetPressures, TareMode};

use super::access::Refused;
use super::app_state::AppState;
use super::body;
use super::sessions::SessionEntry;

const BYTES: [(HeaderName, &str); 1] = [(CONTENT_TYPE, "application/octet-stream")];

/// Time for which the board holds set-points, ms: it vents when the page is closed, or hidden and slowed by its browser.
const VALID_MS: u16 = 500;

pub(super) type Answer<T> = Result<T, Response>;

/// Runs work that blocks on a thread of its own.
pub(super) async fn run_blocking<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Answer<T> {
    let done = tokio::task::spawn_blocking(work).await;
    done.map_err(|_| (StatusCode::INTERNAL_SERVER_ERROR, "this is a fault of proprio").into_response())
}

/// The rows of the last minutes.
pub(super) async fn history(State(state): State<AppState>) -> Answer<impl IntoResponse> {
    #[derive(Serialize)]
    struct Nothing {}
    let bytes = run_blocking(move || state.monitor.history().to_bytes(&Nothing {})).await?;
    Ok((BYTES, bytes))
}

/// The last status.
pub(super) async fn status(State(state): State<AppState>) -> impl IntoResponse {
    ([(CONTENT_TYPE, "application/json")], state.monitor.status().to_string())
}

/// The sessions that can be opened, and the tables for them.
pub(super) async fn list(State(state): State<AppState>) -> Answer<Json<Vec<SessionEntry>>> {
    run_blocking(move || Json(state.monitor.sessions.list())).await
}

#[derive(Debug, Deserialize)]
pub(super) struct SessionPart {
    name: String,
    /// File of the folder that is the table, in place of the session's own.
    table: Option<String>,
    from_s: Option<f64>,
    to_s: Option<f64>,
}

/// The rows of a session, or of a part of it.
pub(super) async fn session(
    State(state): State<AppState>,
    Query(part): Query<SessionPart>,
) -> Answer<impl IntoResponse> {
    let Some(path) = state.monitor.sessions.path(&part.name) else {
        return Err((StatusCode::NOT_FOUND, format!("{}: there is no such session", part.name)).into_response());
    };
    let times_s = part.from_s.unwrap_or(f64::NEG_INFINITY)..=part.to_s.unwrap_or(f64::INFINITY);
    let shared = Arc::clone(&state.monitor);
    let rows = run_blocking(move || shared.sessions.rows(&part.name, &path, part.table.as_deref(), times_s)).await?;
    Ok((BYTES, rows.map_err(|error| state.failure(&error))?))
}

#[derive(Debug, Deserialize)]
pub(super) struct Upload {
    name: String,
}

/// Receives a session from the browser, piece by piece.
pub(super) async fn send(State(state): State<AppState>, Query(sent): Query<Upload>, body: Body) -> Answer<()> {
    let failed = |error: &dyn std::fmt::Display| (StatusCode::CONFLICT, error.to_string()).into_response();
    let suffix = std::path::Path::new(&sent.name).extension().unwrap_or_default().to_string_lossy().into_owned();
    let mut file = tempfile::Builder::new().suffix(&format!(".{suffix}")).tempfile().map_err(|error| failed(&error))?;
    body::read(body, body::SESSION_MB, |part| file.write_all(part)).await?;
    state.monitor.sessions.keep(&sent.name, file.into_temp_path());
    Ok(())
}

#[derive(Debug, Deserialize)]
pub(super) struct RecordRequest {
    on: bool,
}

/// Starts or ends a recording.
pub(super) async fn record(
    State(state): State<AppState>,
    Json(RecordRequest { on }): Json<RecordRequest>,
) -> Answer<Response> {
    let shared = Arc::clone(&state.monitor);
    let done = run_blocking(move || {
        if on { shared.begin_recording().map(|()| shared.recording()) } else { shared.finish_recording() }
    });
    Ok(Json(done.await?.map_err(|error| state.failure(&error))?).into_response())
}

#[derive(Debug, Deserialize)]
pub(super) struct MarkRequest {
    text: String,
}

/// Sets a mark in the recording.
pub(super) async fn mark(State(state): State<AppState>, Json(MarkRequest { text }): Json<MarkRequest>) -> Answer<()> {
    let is_marked = state.monitor.mark(text);
    is_marked.then_some(()).ok_or_else(|| (StatusCode::CONFLICT, "nothing is recorded: begin first").into_response())
}

/// Checks the token, before a page shows what needs it.
pub(super) async fn unlock(State(state): State<AppState>, headers: HeaderMap) -> Answer<()> {
    check_token(&state, &headers).map_err(Refused::into_response)
}

fn check_token(state: &AppState, headers: &HeaderMap) -> Result<(), Refused> {
    state.monitor.token.as_ref().ok_or(Refused::ReadOnly)?.check(headers)
}

/// A request of the page to the board.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Control {
    Arm,
    /// Vents, and disarms.
    Vent,
    SetPressures {
        kpa: Vec<f64>,
    },
}

impl From<Control> for Command {
    fn from(control: Control) -> Self {
        match control {
            Control::Arm => Self::Arm,
            Control::Vent => Self::Disarm,
            Control::SetPressures { kpa } => {
                // The cast saturates. The board refuses a pressure over its regulator's full scale, and more or fewer
                // pressures than it has regulators.
                let pressures_pa = kpa.iter().map(|kpa| (kpa * 1e3).round() as u32);
                Self::SetPressures(SetPressures { pressures_pa: pressures_pa.collect(), valid_ms: VALID_MS })
            }
        }
    }
}

/// The command in the body of a page's request, or the reason why there is none.
fn command_of(body: &[u8]) -> Result<Command, String> {
    let control: Control = serde_json::from_slice(body).map_err(|error| error.to_string())?;
    match control {
        Control::SetPressures { kpa } if kpa.len() > MAX_REGULATORS => {
            Err(format!("a board has {MAX_REGULATORS} regulators at most"))
        }
        control => Ok(control.into()),
    }
}

/// Sends a request to the board.
pub(super) async fn control(State(state): State<AppState>, headers: HeaderMap, body: Bytes) -> Answer<()> {
    // The token is checked before the body is parsed.
    check_token(&state, &headers).map_err(Refused::into_response)?;
    let command = command_of(&body).map_err(|text| (StatusCode::BAD_REQUEST, text).into_response())?;
    let shared = Arc::clone(&state.monitor);
    // This handler is dropped with its connection: nothing is sent for a page that has gone, except what vents.
    let page = Arc::new(());
    let asker = Arc::downgrade(&page);
    let kept = (command == Command::Disarm).then(|| Arc::clone(&page));
    let requested = run_blocking(move || {
        let done = shared.link.as_ref().map(|link| link.request_of(&asker, command));
        drop(kept);
        done
    });
    match requested.await? {
        Some(done) => done.map_err(|error| state.failure(&error.into())),
        None => Err(Refused::ReadOnly.into_response()),
    }
}

/// A request to tare the board.
#[derive(Debug, Deserialize)]
pub(super) struct TareRequest {
    /// Tares an arm that moves, too.
    force: bool,
}

/// Outcome of a request to tare.
#[derive(Debug, Serialize, Deserialize)]
pub(super) struct TareOutcome {
    /// The arm moves, and was not tared.
    pub is_moving: bool,
    pub text: String,
}

/// Tares the board for a page.
pub(super) async fn tare(State(state): State<AppState>, headers: HeaderMap, body: Bytes) -> Answer<Json<TareOutcome>> {
    check_token(&state, &headers).map_err(Refused::into_response)?;
    tare_board(state, &body, ": let it rest, or tare it anyway").await
}

/// Tares the board; `remedy` follows the error of an arm that moves.
pub(super) async fn tare_board(state: AppState, body: &[u8], remedy: &str) -> Answer<Json<TareOutcome>> {
    let TareRequest { force } =
        serde_json::from_slice(body).map_err(|error| (StatusCode::BAD_REQUEST, error.to_string()).into_response())?;
    let mode = if force { TareMode::Force } else { TareMode::IfStill };
    let shared = Arc::clone(&state.monitor);
    let tared = run_blocking(move || shared.link.as_ref().map(|link| proprio_link::tare(link, mode))).await?;
    let outcome = match tared.ok_or_else(|| Refused::ReadOnly.into_response())? {
        Ok(tared) => TareOutcome { is_moving: false, text: tared.to_string() },
        Err(error @ TareError::Moving(_)) => TareOutcome { is_moving: true, text: format!("{error}{remedy}") },
        Err(TareError::Link(error)) => return Err(state.failure(&error.into())),
    };
    Ok(Json(outcome))
}

/// Stores the monitor's table on the board, which restarts with it.
pub(super) async fn push_table(State(state): State<AppState>, headers: HeaderMap) -> Answer<Json<String>> {
    check_token(&state, &headers).map_err(Refused::into_response)?;
    let shared = Arc::clone(&state.monitor);
    let pushed = run_blocking(move || {
        let Some((link, table)) = shared.link.as_ref().zip(shared.sessions.stored_table()?) else { return Ok(None) };
        Ok(Some(proprio_link::table::push(link, &table, &mut NoProgress)?))
    });
    match pushed.await? {
        Ok(Some(hello)) => Ok(Json(format!("the board has table {:08x} of arm {}", hello.table, hello.arm))),
        Ok(None) => Err(Refused::ReadOnly.into_response()),
        Err(error) => Err(state.failure(&error)),
    }
}
