//! One viewer: what it is told, and what it asks for.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use axum::extract::ws::{Message as Frame, WebSocket};
use serde::Deserialize;
use tokio::sync::broadcast::error::TryRecvError;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval, timeout};

use crate::live::event::Event;
use crate::live::hub::{Hub, Message, Subscription};
use crate::live::source::Request;

/// Messages are collected for so long: half of what a screen shows for.
const TOGETHER: Duration = Duration::from_millis(8);
/// A viewer that takes nothing for so long is gone.
const GONE: Duration = Duration::from_secs(20);
/// Characters of the text of a mark.
const MAX_MARK: usize = 80;

/// A viewer.
#[derive(Debug)]
pub(super) struct Viewer {
    pub(super) hub: Arc<Hub>,
    pub(super) requests: SyncSender<Request>,
    pub(super) stop: watch::Receiver<bool>,
}

/// What there is to do.
enum Woken {
    Stop,
    Said(Option<Result<Frame, axum::Error>>),
    Tick,
}

/// What a viewer says.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
enum Said {
    /// What is the time there? Answered with `sent` as it is.
    Ping { sent: f64 },
    /// Remember this sample.
    Mark { sample: u32, text: String },
    /// Begin an alignment.
    Align,
    /// End it.
    Cancel,
}

impl Viewer {
    /// Until the viewer leaves or the program ends.
    pub(super) async fn serve(self, mut socket: WebSocket) {
        let mut stop = self.stop.clone();
        let mut subscription = self.hub.subscribe();
        let hello = self.hello();
        let known = std::mem::take(&mut subscription.known);
        if !send(&mut socket, std::iter::once(hello).chain(known)).await {
            return;
        }
        let mut ticks = interval(TOGETHER);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        loop {
            // What the branches borrow ends here: a guard of `stop` may not be held while something is sent.
            let woken = tokio::select! {
                biased;
                _ = stop.wait_for(|stop| *stop) => Woken::Stop,
                said = socket.recv() => Woken::Said(said),
                _ = ticks.tick() => Woken::Tick,
            };
            let stays = match woken {
                Woken::Stop => break,
                Woken::Tick => self.tell(&mut socket, &mut subscription).await,
                Woken::Said(Some(Ok(Frame::Text(text)))) => self.hear(&mut socket, &text).await,
                Woken::Said(Some(Ok(Frame::Ping(_) | Frame::Pong(_)))) => true,
                Woken::Said(_) => false,
            };
            if !stays {
                return;
            }
        }
        // That the program ends was published before.
        if self.tell(&mut socket, &mut subscription).await {
            let _ = timeout(TOGETHER, socket.send(Frame::Close(None))).await;
        }
    }

    /// Sends what was published since the last time; false if the viewer is gone.
    async fn tell(&self, socket: &mut WebSocket, subscription: &mut Subscription) -> bool {
        let mut messages = Vec::new();
        loop {
            match subscription.following.try_recv() {
                Ok(message) => messages.push(message),
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
                Err(TryRecvError::Lagged(messages_lost)) => {
                    // What is known may be older than what was lost.
                    *subscription = self.hub.subscribe();
                    messages.clear();
                    let skipped = format!(r#"{{"type":"skipped","messages":{messages_lost}}}"#);
                    messages.push(skipped.into());
                    messages.append(&mut subscription.known);
                }
            }
        }
        messages.is_empty() || send(socket, messages).await
    }

    /// Does what a viewer asks for; false if it is gone, or says what no page of ours does.
    async fn hear(&self, socket: &mut WebSocket, text: &str) -> bool {
        let Ok(said) = serde_json::from_str(text) else {
            return false;
        };
        match said {
            Said::Ping { sent } => {
                let now = self.hub.now();
                let pong = serde_json::json!({ "type": "pong", "sent": sent, "now": now });
                return send(socket, [pong.to_string().into()]).await;
            }
            Said::Mark { sample, text } => {
                let letters = text.chars().filter(|letter| !letter.is_control());
                let text = letters.take(MAX_MARK).collect();
                self.hub.publish(&Event::Mark { sample, text });
            }
            // A source that takes no requests is busy or ending: the viewer sees that nothing happens.
            Said::Align => drop(self.requests.try_send(Request::Align)),
            Said::Cancel => drop(self.requests.try_send(Request::CancelAlignment)),
        }
        true
    }

    fn hello(&self) -> Message {
        let version = env!("CARGO_PKG_VERSION");
        let now = self.hub.now();
        serde_json::json!({ "type": "hello", "version": version, "now": now })
            .to_string()
            .into()
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
    let sent = timeout(GONE, socket.send(Frame::text(text))).await;
    matches!(sent, Ok(Ok(())))
}
