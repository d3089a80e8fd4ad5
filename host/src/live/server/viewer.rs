//! Connection of one viewer: messages to it, and requests from it.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocket};
use tokio::sync::broadcast::error::TryRecvError;
use tokio::time::{MissedTickBehavior, interval, interval_at, timeout};
use web::event::{Event, ViewerId};
use web::request::UNKNOWN;

use super::ServerState;
use crate::live::hub::{Message, Subscription, json};
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
        let mut subscription = self.server.hub.subscribe();
        let records = self.server.history.is_some();
        let tunes = cfg!(feature = "train");
        let hello = json(&Event::hello(
            self.server.hub.now(),
            self.id,
            records,
            tunes,
        ));
        let known = std::mem::take(&mut subscription.known);
        if !send(&mut socket, std::iter::once(hello).chain(known)).await {
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
                Wakeup::Tick => self.send_following(&mut socket, &mut subscription).await,
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
        if self.send_following(&mut socket, &mut subscription).await {
            let _ = timeout(COLLECT, socket.send(Frame::Close(None))).await;
        }
    }

    /// Sends the messages since the last call; false if the viewer is gone.
    async fn send_following(
        &self,
        socket: &mut WebSocket,
        subscription: &mut Subscription,
    ) -> bool {
        let mut messages = Vec::new();
        loop {
            match subscription.following.try_recv() {
                Ok((viewer, message)) if viewer.is_none_or(|viewer| viewer == self.id) => {
                    messages.push(message);
                }
                Ok(_) => {}
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
                Err(TryRecvError::Lagged(messages_lost)) => {
                    // The topics known may be older than the lost messages.
                    let skipped = self.server.hub.resubscribe(subscription, messages_lost);
                    messages.clear();
                    messages.push(skipped);
                    messages.append(&mut subscription.known);
                }
            }
        }
        messages.is_empty() || send(socket, messages).await
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
                let (request, text) = ("", UNKNOWN);
                send(socket, [json(&Event::Refused { request, text })]).await;
                false
            }
        }
    }
}

/// Sends messages as one JSON array; false if the viewer is gone.
async fn send(socket: &mut WebSocket, messages: impl IntoIterator<Item = Message>) -> bool {
    let mut text = String::from("[");
    for message in messages {
        if text.len() > 1 {
            text.push(',');
        }
        text += &message;
    }
    text.push(']');
    is_sent(socket, Frame::text(text)).await
}

/// Sends a frame; false if the viewer is gone.
async fn is_sent(socket: &mut WebSocket, frame: Frame) -> bool {
    matches!(timeout(SEND_TIMEOUT, socket.send(frame)).await, Ok(Ok(())))
}
