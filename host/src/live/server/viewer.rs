//! One viewer: what it is told, and what it asks for.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::Duration;

use axum::extract::ws::{Message as Frame, WebSocket};
use serde::Deserialize;
use shared::intent::Intent;
use tokio::sync::broadcast::error::TryRecvError;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval, timeout};

use crate::live::event::Event;
use crate::live::hub::{Hub, Message, Subscription};
use crate::live::lead::{Lead, ViewerId};
use crate::live::recorder::Wish;
use crate::live::source::Request;
use crate::record::session::Action;

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
    /// Of a recording session, if there is one.
    pub(super) wishes: Option<SyncSender<Wish>>,
    pub(super) lead: Arc<Lead>,
    pub(super) id: ViewerId,
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
    /// Begin a pairing of the board.
    Bind,
    /// Of the recording session.
    Session { wish: SessionWish },
    /// Free: this is done from now on.
    Gesture { class: String },
}

/// What a viewer wants of a session.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum SessionWish {
    Begin,
    Repeat,
    Hold,
    Finish,
    Again,
    Tune,
    Install,
}

impl SessionWish {
    const fn wish(self) -> Wish {
        match self {
            Self::Begin => Wish::Action(Action::Begin),
            Self::Repeat => Wish::Action(Action::Repeat),
            Self::Hold => Wish::Action(Action::Hold),
            Self::Finish => Wish::Action(Action::Finish),
            Self::Again => Wish::Again,
            Self::Tune => Wish::Tune,
            Self::Install => Wish::Install,
        }
    }
}

impl Viewer {
    /// Until the viewer leaves or the program ends.
    pub(super) async fn serve(self, socket: WebSocket) {
        self.attend(socket).await;
        if self.lead.release(self.id) {
            self.hub.publish(&Event::Lead { viewer: None });
            if let Some(wishes) = &self.wishes {
                let _ = wishes.try_send(Wish::LeaderLeft);
            }
        }
    }

    async fn attend(&self, mut socket: WebSocket) {
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
            Said::Bind => drop(self.requests.try_send(Request::Bind)),
            Said::Session { wish } => self.wish(wish.wish()),
            Said::Gesture { class } => {
                if let Some(intent) = Intent::from_name(&class) {
                    self.wish(Wish::Action(Action::Mark(intent)));
                }
            }
        }
        true
    }

    /// Passes a wish on if this viewer leads, or nobody does yet.
    fn wish(&self, wish: Wish) {
        let Some(wishes) = &self.wishes else {
            return;
        };
        let (leads, is_new) = self.lead.claim(self.id);
        if is_new {
            let viewer = Some(self.id);
            self.hub.publish(&Event::Lead { viewer });
        }
        if leads {
            let _ = wishes.try_send(wish);
        }
    }

    fn hello(&self) -> Message {
        let version = env!("CARGO_PKG_VERSION");
        let now = self.hub.now();
        serde_json::json!({ "type": "hello", "version": version, "now": now, "you": self.id, "record": self.wishes.is_some() })
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
