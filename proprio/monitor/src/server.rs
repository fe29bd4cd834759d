//! Routes of the server: the page, the feed, sessions and requests.

use std::io;

use axum::Router;
use axum::body::Body;
use axum::extract::{Request, State};
use axum::http::Method;
use axum::http::header::{
    CACHE_CONTROL, CONTENT_SECURITY_POLICY, CONTENT_TYPE, HeaderName, HeaderValue, X_CONTENT_TYPE_OPTIONS,
};
use axum::middleware::{self, Next};
use axum::response::{IntoResponse, Response};
use axum::routing::{get, post};
use proprio_server::serve_connection;
use tokio::net::TcpListener;

use super::access::{Refused, check_host, check_origin};
use super::app_state::AppState;
use super::{actions, body, line_feed, programs, socket};

/// The files of the page, embedded in this program.
const FILES: [(&str, &str, &str); 21] = [
    ("/", "text/html; charset=utf-8", include_str!("page/index.html")),
    ("/style.css", "text/css; charset=utf-8", include_str!("page/style.css")),
    ("/main.js", SCRIPT, include_str!("page/main.js")),
    ("/store.js", SCRIPT, include_str!("page/store.js")),
    ("/feed.js", SCRIPT, include_str!("page/feed.js")),
    ("/arm.js", SCRIPT, include_str!("page/arm.js")),
    ("/plot.js", SCRIPT, include_str!("page/plot.js")),
    ("/view.js", SCRIPT, include_str!("page/view.js")),
    ("/catalogue.js", SCRIPT, include_str!("page/catalogue.js")),
    ("/figures.js", SCRIPT, include_str!("page/figures.js")),
    ("/faults.js", SCRIPT, include_str!("page/faults.js")),
    ("/delay.js", SCRIPT, include_str!("page/delay.js")),
    ("/picture.js", SCRIPT, include_str!("page/picture.js")),
    ("/export.js", SCRIPT, include_str!("page/export.js")),
    ("/board_panel.js", SCRIPT, include_str!("page/board_panel.js")),
    ("/findings.js", SCRIPT, include_str!("page/findings.js")),
    ("/sensors.js", SCRIPT, include_str!("page/sensors.js")),
    ("/sessions.js", SCRIPT, include_str!("page/sessions.js")),
    ("/saver.js", SCRIPT, include_str!("page/saver.js")),
    ("/sweep.js", SCRIPT, include_str!("page/sweep.js")),
    ("/control.js", SCRIPT, include_str!("page/control.js")),
];
const SCRIPT: &str = "text/javascript; charset=utf-8";

/// Content security policy: no external and no inline content, and no frame of another page, which could steal clicks.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src 'self' data: blob:; \
                      frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// Paths of WebSockets, which a script of another page could open.
const SOCKETS: [&str; 2] = ["/feed", "/board/line"];

const HEADERS: [(HeaderName, &str); 3] =
    [(CONTENT_SECURITY_POLICY, POLICY), (X_CONTENT_TYPE_OPTIONS, "nosniff"), (CACHE_CONTROL, "no-store")];

/// The router with all paths of the server.
pub(super) fn router(state: AppState) -> Router {
    let mut router = Router::new();
    for (path, kind, text) in FILES {
        router = router.route(path, get(move || async move { ([(CONTENT_TYPE, kind)], text) }));
    }
    router
        .route("/feed", get(socket::feed))
        .route("/history", get(actions::history))
        .route("/status", get(actions::status))
        .route("/sessions", get(actions::list).post(actions::send))
        .route("/session", get(actions::session))
        .route("/record", post(actions::record))
        .route("/mark", post(actions::mark))
        .route("/unlock", post(actions::unlock))
        .route("/control", post(actions::control))
        .route("/tare", post(actions::tare))
        .route("/table", post(actions::push_table))
        .route("/board", get(programs::status))
        .route("/board/tare", post(programs::tare))
        .route("/board/table", get(programs::table).post(programs::push_table).delete(programs::erase_table))
        .route("/board/table.toml", get(programs::pull_table))
        .route("/board/line", get(line_feed::line))
        .layer(middleware::from_fn_with_state(state.clone(), guard))
        .with_state(state)
}

/// Serves connections until the listener fails.
pub(super) async fn serve(listener: TcpListener, router: Router) -> io::Result<()> {
    loop {
        let (stream, _) = listener.accept().await?;
        // Small messages are not held back for larger ones. A stream without this option is served as well.
        let _ = stream.set_nodelay(true);
        tokio::spawn(serve_connection(stream, router.clone(), body::PART_TIMEOUT));
    }
}

/// Checks the access of every request, receives its body, and adds headers to every response.
async fn guard(State(state): State<AppState>, request: Request, next: Next) -> Response {
    let headers = request.headers();
    let mut checked = check_host(headers, state.port).map(drop);
    if request.method() != Method::GET || SOCKETS.contains(&request.uri().path()) {
        checked = check_origin(headers, state.port);
    }
    let received = match checked {
        Ok(()) => receive(request).await,
        Err(refused) => Err(refused.into_response()),
    };
    let mut response = match received {
        Ok(request) => next.run(request).await,
        Err(response) => response,
    };
    for (name, value) in HEADERS {
        response.headers_mut().insert(name, HeaderValue::from_static(value));
    }
    response
}

/// Receives the body of a request; a session is received by its handler, piece by piece.
async fn receive(request: Request) -> Result<Request, Response> {
    if request.method() == Method::GET || request.uri().path() == "/sessions" {
        return Ok(request);
    }
    let (head, body) = request.into_parts();
    let mut whole = Vec::new();
    body::read(body, body::REQUEST_MB, |part| {
        whole.extend(part);
        Ok(())
    })
    .await?;
    Ok(Request::from_parts(head, Body::from(whole)))
}

impl IntoResponse for Refused {
    fn into_response(self) -> Response {
        (self.status(), self.to_string()).into_response()
    }
}
