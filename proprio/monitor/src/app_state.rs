//! State of the request handlers.

use std::sync::Arc;

use axum::http::StatusCode;
use axum::response::{IntoResponse, Response};

use super::error::Error;
use super::monitor_state::MonitorState;

/// State that axum passes to every handler.
#[derive(Debug, Clone)]
pub(super) struct AppState {
    pub monitor: Arc<MonitorState>,
    pub port: u16,
}

impl AppState {
    /// The answer to a request that failed: the error and its remedy, which the page shows.
    pub fn failure(&self, error: &Error) -> Response {
        (StatusCode::CONFLICT, format!("{error}: {}", (self.monitor.help)(error))).into_response()
    }
}
