//! Server of the page over HTTP, with a websocket for each viewer; one thread for all viewers.

pub(crate) mod access;
mod assets;
mod viewer;

use std::net::TcpListener;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::thread::JoinHandle;
use std::time::Duration;

use axum::Router;
use axum::extract::State;
use axum::extract::ws::WebSocketUpgrade;
use axum::extract::ws::rejection::WebSocketUpgradeRejection;
use axum::http::header::{CACHE_CONTROL, CONTENT_TYPE};
use axum::http::{HeaderMap, Method, StatusCode, Uri};
use axum::response::{IntoResponse as _, Response};
use tokio::sync::{Mutex, Semaphore, watch};

use self::access::Access;
use super::hub::Hub;
use super::stream::Input;
use crate::record::HistoryOf;

/// Greatest number of viewers.
const MOST_VIEWERS: usize = 16;
/// Greatest length of a viewer's message in bytes: a mark with its text.
const MAX_REQUEST_BYTES: usize = 1024;
/// Time that viewers have to take the last message.
const PATIENCE: Duration = Duration::from_secs(1);

/// State that all connections share.
#[derive(Debug)]
struct ServerState {
    hub: Arc<Hub>,
    access: Access,
    inputs: Sender<Input>,
    /// Sessions of the person who is recorded; none for `live`. Read by one viewer at a time.
    history: Option<Mutex<Arc<HistoryOf>>>,
    ids: AtomicU64,
    viewers: Arc<Semaphore>,
    stop: watch::Receiver<bool>,
}

/// Thread of the server.
#[derive(Debug)]
pub(crate) struct Server {
    thread: JoinHandle<()>,
    stop: watch::Sender<bool>,
}

impl Server {
    /// Serves on a thread of its own.
    ///
    /// # Errors
    /// When the system gives no thread or no events for its sockets.
    pub(crate) fn start(
        listener: TcpListener,
        access: Access,
        hub: Arc<Hub>,
        inputs: Sender<Input>,
        history: Option<HistoryOf>,
    ) -> std::io::Result<Self> {
        let runtime = tokio::runtime::Builder::new_current_thread()
            .enable_io()
            .enable_time()
            .build()?;
        listener.set_nonblocking(true)?;
        let listener = {
            let _within = runtime.enter();
            tokio::net::TcpListener::from_std(listener)?
        };
        let (stop, stopped) = watch::channel(false);
        let state = ServerState {
            hub,
            access,
            inputs,
            history: history.map(|own| Mutex::new(Arc::new(own))),
            ids: AtomicU64::new(1),
            viewers: Arc::new(Semaphore::new(MOST_VIEWERS)),
            stop: stopped.clone(),
        };
        let router = Router::new().fallback(answer).with_state(Arc::new(state));
        let thread = std::thread::Builder::new()
            .name("server".to_owned())
            .spawn(move || {
                let ended = async move {
                    let mut stopped = stopped;
                    let _ = stopped.wait_for(|stop| *stop).await;
                };
                runtime.block_on(async {
                    let serve = axum::serve(listener, router).into_future();
                    tokio::select! {
                        _ = serve => {}
                        () = ended => tokio::time::sleep(PATIENCE / 4).await,
                    }
                });
                runtime.shutdown_timeout(PATIENCE);
            })?;
        Ok(Self { thread, stop })
    }

    /// Ends the server after the messages published before.
    pub(crate) fn stop(self) {
        let _ = self.stop.send(true);
        // A panic of the server was printed already.
        let _ = self.thread.join();
    }
}

/// Checks a request and answers it.
async fn answer(
    State(state): State<Arc<ServerState>>,
    method: Method,
    uri: Uri,
    headers: HeaderMap,
    upgrade: Result<WebSocketUpgrade, WebSocketUpgradeRejection>,
) -> Response {
    let (path, host) = match state.access.check(uri.path(), &headers) {
        Ok(allowed) => allowed,
        Err(denied) => return (denied.status(), denied.to_string()).into_response(),
    };
    if method != Method::GET && method != Method::HEAD {
        return StatusCode::METHOD_NOT_ALLOWED.into_response();
    }
    if let ("sessions.json", Some(history)) = (path, &state.history) {
        let one_at_a_time = history.lock().await;
        return sessions(Arc::clone(&one_at_a_time)).await;
    }
    if path != "socket" {
        return assets::answer(path, host);
    }
    let upgrade = match upgrade {
        Ok(upgrade) => upgrade,
        Err(rejection) => return rejection.into_response(),
    };
    let Ok(permit) = state.viewers.clone().try_acquire_owned() else {
        return StatusCode::SERVICE_UNAVAILABLE.into_response();
    };
    let viewer = viewer::Viewer {
        id: state.ids.fetch_add(1, Ordering::Relaxed),
        server: state,
    };
    upgrade
        .max_message_size(MAX_REQUEST_BYTES)
        .max_frame_size(MAX_REQUEST_BYTES)
        .on_upgrade(async move |socket| {
            viewer.serve(socket).await;
            drop(permit);
        })
}

/// Reads the sessions on another thread: viewers of the stream do not wait.
async fn sessions(history: Arc<HistoryOf>) -> Response {
    let read = tokio::task::spawn_blocking(move || history.read()).await;
    let read = read.map_err(anyhow::Error::from).flatten();
    let answer = match read.and_then(|found| Ok(serde_json::to_string(&found)?)) {
        Ok(json) => (StatusCode::OK, json),
        Err(error) => (StatusCode::INTERNAL_SERVER_ERROR, format!("{error:#}")),
    };
    let headers = [
        (CACHE_CONTROL, "no-store"),
        (CONTENT_TYPE, "application/json"),
    ];
    (headers, answer).into_response()
}
