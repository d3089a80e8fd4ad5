//! Connection of one viewer: messages to it, and requests from it.

use std::sync::Arc;
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocket};
use shared::intent::Intent;
use tokio::sync::broadcast::error::TryRecvError;
use tokio::sync::watch;
use tokio::time::{MissedTickBehavior, interval, interval_at, timeout};

use super::rate::{Heard, Rate};
use super::rights::{self, Lead, Mode, Right};
use super::said::Said;
use crate::live::event::{Event, ViewerId};
use crate::live::hub::{Hub, Message, Subscription};
use crate::live::recorder::Wish;
use crate::live::source::Request;
use crate::record::session::Action;

/// Time for which messages are collected: half a frame of a screen.
const TOGETHER: Duration = Duration::from_millis(8);
/// Time after which a viewer that takes nothing is gone.
const GONE: Duration = Duration::from_secs(20);
/// Pause between two pings. A viewer that is cut off does not answer, and its connection ends.
const BEAT: Duration = Duration::from_secs(60);

const UNKNOWN: &str = "there is no such request: load the page again, it may be of another version";
const TOO_OFTEN: &str = "asked too often: at most 20 requests at once and 10 a second are heard";
const WATCHES: &str = "another page leads the session, and this one watches";
const BUSY: &str = "not done, because the program is busy or ends: ask again";
/// Greatest number of characters of a mark.
const MAX_MARK: usize = 80;

/// State of a viewer's connection.
#[derive(Debug)]
pub(super) struct Viewer {
    pub(super) hub: Arc<Hub>,
    pub(super) mode: Mode,
    pub(super) requests: SyncSender<Request>,
    /// Channel to the recorder, if there is one.
    pub(super) wishes: Option<SyncSender<Wish>>,
    pub(super) lead: Arc<Lead>,
    pub(super) id: ViewerId,
    pub(super) stop: watch::Receiver<bool>,
}

/// Event that wakes the connection.
enum Woken {
    Stop,
    Said(Option<Result<Frame, axum::Error>>),
    Tick,
    Beat,
}

impl Viewer {
    /// Serves until the viewer leaves or the program ends.
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
        let mut beats = interval_at(tokio::time::Instant::now() + BEAT, BEAT);
        let mut rate = Rate::new(Instant::now());
        loop {
            // The borrows of the branches end here: a guard of `stop` must not be held across a send.
            let woken = tokio::select! {
                biased;
                _ = stop.wait_for(|stop| *stop) => Woken::Stop,
                // Polled before the viewer's messages: a viewer that sends many still gets its own.
                _ = ticks.tick() => Woken::Tick,
                _ = beats.tick() => Woken::Beat,
                said = socket.recv() => Woken::Said(said),
            };
            let stays = match woken {
                Woken::Stop => break,
                Woken::Tick => self.tell(&mut socket, &mut subscription).await,
                Woken::Beat => is_sent(&mut socket, Frame::Ping(Bytes::new())).await,
                Woken::Said(Some(Ok(Frame::Text(text)))) => {
                    self.hear(&mut socket, &mut rate, &text).await
                }
                Woken::Said(Some(Ok(Frame::Ping(_) | Frame::Pong(_)))) => true,
                Woken::Said(_) => false,
            };
            if !stays {
                return;
            }
        }
        // The end of the program was published before.
        if self.tell(&mut socket, &mut subscription).await {
            let _ = timeout(TOGETHER, socket.send(Frame::Close(None))).await;
        }
    }

    /// Sends the messages since the last call; false if the viewer is gone.
    async fn tell(&self, socket: &mut WebSocket, subscription: &mut Subscription) -> bool {
        let mut messages = Vec::new();
        loop {
            match subscription.following.try_recv() {
                Ok(message) => messages.push(message),
                Err(TryRecvError::Empty | TryRecvError::Closed) => break,
                Err(TryRecvError::Lagged(messages_lost)) => {
                    // The topics known may be older than the lost messages.
                    let skipped = self.hub.resubscribe(subscription, messages_lost);
                    messages.clear();
                    messages.push(skipped);
                    messages.append(&mut subscription.known);
                }
            }
        }
        messages.is_empty() || send(socket, messages).await
    }

    /// Handles a message: does it or refuses it. Returns false if the viewer is gone or the message is malformed.
    async fn hear(&self, socket: &mut WebSocket, rate: &mut Rate, text: &str) -> bool {
        let Ok(said) = serde_json::from_str::<Said>(text) else {
            refuse(socket, "", UNKNOWN).await;
            return false;
        };
        let name = said.name();
        match rate.ask(Instant::now()) {
            Heard::Yes => {}
            Heard::Refused => return refuse(socket, name, TOO_OFTEN).await,
            Heard::Ignored => {
                // The other viewers get a turn between many requests.
                tokio::task::yield_now().await;
                return true;
            }
        }
        let done = self.may(name).and_then(|()| match said {
            Said::Ping { .. } => Ok(()),
            Said::Mark { sample, ref text } => {
                let letters = text.chars().filter(|letter| !letter.is_control());
                let text = letters.take(MAX_MARK).collect();
                self.hub.publish(&Event::Mark { sample, text });
                Ok(())
            }
            Said::Align => self.request(Request::Align),
            Said::Cancel => self.request(Request::CancelAlignment),
            Said::Bind => self.request(Request::Bind),
            Said::Session { wish } => self.wish(wish.wish()),
            Said::Gesture { ref class } => match Intent::from_name(class) {
                Some(intent) => self.wish(Wish::Action(Action::Mark(intent))),
                None => Err(UNKNOWN),
            },
        });
        match (done, said) {
            (Err(why), _) => refuse(socket, name, why).await,
            (Ok(()), Said::Ping { sent }) => {
                let now = self.hub.now();
                let pong = serde_json::json!({ "type": "pong", "sent": sent, "now": now });
                send(socket, [pong.to_string().into()]).await
            }
            (Ok(()), _) => true,
        }
    }

    /// Whether this viewer may send a request. If the request needs a leader and there is none, this viewer becomes it.
    ///
    /// # Errors
    /// The reason, in words.
    fn may(&self, name: &str) -> Result<(), &'static str> {
        match rights::of(name, self.mode) {
            Right::All => Ok(()),
            Right::Nobody(why) => Err(why),
            Right::Leader => {
                let (leads, is_new) = self.lead.claim(self.id);
                if is_new {
                    let viewer = Some(self.id);
                    self.hub.publish(&Event::Lead { viewer });
                }
                leads.then_some(()).ok_or(WATCHES)
            }
        }
    }

    /// Passes a request to the source.
    fn request(&self, request: Request) -> Result<(), &'static str> {
        self.requests.try_send(request).map_err(|_| BUSY)
    }

    /// Passes a wish to the session.
    fn wish(&self, wish: Wish) -> Result<(), &'static str> {
        let wishes = self.wishes.as_ref().ok_or(BUSY)?;
        wishes.try_send(wish).map_err(|_| BUSY)
    }

    fn hello(&self) -> Message {
        let version = env!("CARGO_PKG_VERSION");
        let now = self.hub.now();
        serde_json::json!({ "type": "hello", "version": version, "now": now, "you": self.id, "record": self.wishes.is_some() })
            .to_string()
            .into()
    }
}

/// Tells a viewer why a request is refused; false if the viewer is gone.
async fn refuse(socket: &mut WebSocket, name: &str, why: &str) -> bool {
    let refused = serde_json::json!({ "type": "refused", "do": name, "text": why });
    send(socket, [refused.to_string().into()]).await
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
    matches!(timeout(GONE, socket.send(frame)).await, Ok(Ok(())))
}
