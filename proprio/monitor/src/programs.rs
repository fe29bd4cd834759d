//! Handlers of requests by this user's other programs, which have the token of the monitor's file.

use axum::Json;
use axum::body::Bytes;
use axum::extract::State;
use axum::http::{HeaderMap, StatusCode};
use axum::response::IntoResponse;
use calibration_tables::ArmFile;
use proprio_link::Link;
use proprio_link::status::Status;
use proprio_link::table::{self, StoredTable, TableImageError, TableOnBoard};
use proprio_session::NoProgress;

use super::access::Refused;
use super::actions::{Answer, TareOutcome, run_blocking, tare_board};
use super::app_state::AppState;
use crate::error::Error;

/// Checks the token of the monitor's file.
pub(super) fn check_token(state: &AppState, headers: &HeaderMap) -> Result<(), Refused> {
    state.monitor.program_token.as_ref().ok_or(Refused::Token)?.check(headers)
}

/// Runs work on the board's link, which blocks.
async fn with_board<T: Send + 'static>(
    state: AppState,
    work: impl FnOnce(&Link) -> Result<T, Error> + Send + 'static,
) -> Answer<Json<T>> {
    let shared = state.monitor.clone();
    let done = run_blocking(move || shared.link.as_ref().map(work)).await?;
    let done = done.ok_or_else(|| (StatusCode::NOT_FOUND, "there is no board").into_response())?;
    done.map(Json).map_err(|error: Error| state.failure(&error))
}

/// The status of the board, measured within seconds, as `proprio status` has it.
pub(super) async fn status(State(state): State<AppState>) -> Answer<Json<Status>> {
    let shared = state.monitor.clone();
    with_board(state, move |link| {
        let has_table = shared.sessions.stored_table().is_ok_and(|table| table.is_some());
        Ok(Status::of(link, &link.subscribe(), has_table)?)
    })
    .await
}

/// Tares the board.
pub(super) async fn tare(State(state): State<AppState>, headers: HeaderMap, body: Bytes) -> Answer<Json<TareOutcome>> {
    check_token(&state, &headers).map_err(Refused::into_response)?;
    tare_board(state, &body, "").await
}

/// The table of the board.
pub(super) async fn table(State(state): State<AppState>) -> Answer<Json<TableOnBoard>> {
    with_board(state, |link| Ok(table::on_board(link)?)).await
}

/// The text of the board's table.
pub(super) async fn pull_table(State(state): State<AppState>) -> Answer<Json<String>> {
    with_board(state, |link| Ok(table::pull(link, &mut NoProgress)?.toml)).await
}

/// Stores the table in the body on the board, which restarts with it.
pub(super) async fn push_table(
    State(state): State<AppState>,
    headers: HeaderMap,
    body: Bytes,
) -> Answer<Json<TableOnBoard>> {
    check_token(&state, &headers).map_err(Refused::into_response)?;
    with_board(state, move |link| {
        let file = ArmFile::parse(&String::from_utf8_lossy(&body)).map_err(TableImageError::File)?;
        table::push(link, &StoredTable::new(&file, &body)?, &mut NoProgress)?;
        Ok(table::on_board(link)?)
    })
    .await
}

/// Erases the table of the board, which restarts without one.
pub(super) async fn erase_table(State(state): State<AppState>, headers: HeaderMap) -> Answer<Json<()>> {
    check_token(&state, &headers).map_err(Refused::into_response)?;
    with_board(state, |link| Ok(table::erase(link).map(|_| ())?)).await
}
