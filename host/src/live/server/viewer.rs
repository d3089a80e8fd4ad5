//! Connection of one viewer: messages to it, and requests from it.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocket};
use tokio::time::{MissedTickBehavior, interval, interval_at, timeout};
use web::event::{Event, ViewerId};
use web::request::NotDone;

use super::ServerState;
use crate::live::hub::{Message, json};
use crate::live::stream::Input;

/// Time for which messages are collected: half a frame of a screen.
const COLLECT: Duration = Duration::from_millis(8);
/// Time after which a viewer that takes nothing is gone.
const SEND_TIMEOUT: Duration = Duration::from_secs(20);
/// Pause between two pings. A viewer that is cut off does not answer, and its connection ends.
const PING_PERIOD: Duration = Duration::from_secs(60);

/// State of a viewer's connection.
#[derive(Debug)]
pub(super) struct Viewer {
    pub(super) id: ViewerId,
    pub(super) server: Arc<ServerState>,
}

/// Event that wakes the connection.
enum Wakeup {
    Stop,
    Received(Option<Result<Frame, axum::Error>>),
    Tick,
    Ping,
}

impl Viewer {
    /// Serves until the viewer leaves or the program ends.
    pub(super) async fn serve(self, socket: WebSocket) {
        self.run(socket).await;
        // An engine that has ended has no leader.
        let _ = self.server.inputs.send(Input::Left(self.id));
    }

    async fn run(&self, mut socket: WebSocket) {
        let mut stop = self.server.stop.clone();
        let hub = &self.server.hub;
        let mut subscription = hub.subscribe(self.id);
        let records = self.server.history.is_some();
        let hello = Event::hello(hub.now(), self.id, records, cfg!(feature = "train"));
        let first = std::iter::once(json(&hello)).chain(subscription.take(hub));
        if !send(&mut socket, first).await {
            return;
        }
        let mut ticks = interval(COLLECT);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut pings = interval_at(tokio::time::Instant::now() + PING_PERIOD, PING_PERIOD);
        loop {
            // The borrows of the branches end here: a guard of `stop` must not be held across a send.
            let wakeup = tokio::select! {
                biased;
                _ = stop.wait_for(|stop| *stop) => Wakeup::Stop,
                // Polled before the viewer's messages: a viewer that sends many still gets its own.
                _ = ticks.tick() => Wakeup::Tick,
                _ = pings.tick() => Wakeup::Ping,
                message = socket.recv() => Wakeup::Received(message),
            };
            let stays = match wakeup {
                Wakeup::Stop => break,
                Wakeup::Tick => send(&mut socket, subscription.take(hub)).await,
                Wakeup::Ping => is_sent(&mut socket, Frame::Ping(Bytes::new())).await,
                Wakeup::Received(Some(Ok(Frame::Text(text)))) => {
                    self.handle_message(&mut socket, &text).await
                }
                Wakeup::Received(Some(Ok(Frame::Ping(_) | Frame::Pong(_)))) => true,
                Wakeup::Received(_) => false,
            };
            if !stays {
                return;
            }
        }
        // The end of the program was published before.
        if send(&mut socket, subscription.take(hub)).await {
            let _ = timeout(COLLECT, socket.send(Frame::Close(None))).await;
        }
    }

    /// Passes a message on to the engine. Returns false if the viewer is gone or the message is malformed.
    async fn handle_message(&self, socket: &mut WebSocket, text: &str) -> bool {
        match serde_json::from_str(text) {
            Ok(message) => self
                .server
                .inputs
                .send(Input::Request(self.id, message))
                .is_ok(),
            Err(_) => {
                send(socket, [json(&Event::refused(NotDone::Unknown))]).await;
                false
            }
        }
    }
}

/// Sends messages as one JSON array, if there are any; false if the viewer is gone.
async fn send(socket: &mut WebSocket, messages: impl IntoIterator<Item = Message>) -> bool {
    let messages: Vec<_> = messages.into_iter().collect();
    let text = format!("[{}]", messages.join(","));
    messages.is_empty() || is_sent(socket, Frame::text(text)).await
}

/// Sends a frame; false if the viewer is gone.
async fn is_sent(socket: &mut WebSocket, frame: Frame) -> bool {
    matches!(timeout(SEND_TIMEOUT, socket.send(frame)).await, Ok(Ok(())))
}
