//! Connection of one viewer: messages to it, and requests from it.

use std::sync::Arc;
use std::time::{Duration, Instant};

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocket};
use recordings::labels::motion::Motion;
use tokio::sync::broadcast::error::TryRecvError;
use tokio::time::{MissedTickBehavior, interval, interval_at, timeout};
use web::event::{Event, ViewerId};
use web::request::{SessionCommand, SourceRequest, UNKNOWN, ViewerMessage};

use super::ServerState;
use super::rate_limit::{Admission, RateLimit};
use super::rights::{self, Right};
use crate::live::hub::{Message, Subscription};
use crate::live::recorder::RecorderRequest;
use crate::record::session::Action;

/// Time for which messages are collected: half a frame of a screen.
const COLLECT: Duration = Duration::from_millis(8);
/// Time after which a viewer that takes nothing is gone.
const SEND_TIMEOUT: Duration = Duration::from_secs(20);
/// Pause between two pings. A viewer that is cut off does not answer, and its connection ends.
const PING_PERIOD: Duration = Duration::from_secs(60);

const TOO_OFTEN: &str = "asked too often: at most 20 requests at once and 10 a second are heard";
const WATCHES: &str = "another page leads the session, and this one watches";
const BUSY: &str = "not done, because the program is busy or ends: ask again";

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
        if self.server.lead.release(self.id) {
            self.server.hub.publish(&Event::Lead { viewer: None });
            // Without a recorder, or with a full queue, nobody waits for the leader.
            let _ = self.request_recorder(RecorderRequest::LeaderLeft);
        }
    }

    async fn run(&self, mut socket: WebSocket) {
        let mut stop = self.server.stop.clone();
        let mut subscription = self.server.hub.subscribe();
        let hello = self.hello();
        let known = std::mem::take(&mut subscription.known);
        if !send(&mut socket, std::iter::once(hello).chain(known)).await {
            return;
        }
        let mut ticks = interval(COLLECT);
        ticks.set_missed_tick_behavior(MissedTickBehavior::Delay);
        let mut pings = interval_at(tokio::time::Instant::now() + PING_PERIOD, PING_PERIOD);
        let mut rate_limit = RateLimit::new(Instant::now());
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
                    self.handle_message(&mut socket, &mut rate_limit, &text)
                        .await
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
                Ok(message) => messages.push(message),
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

    /// Handles a message: does it or refuses it. Returns false if the viewer is gone or the message is malformed.
    async fn handle_message(
        &self,
        socket: &mut WebSocket,
        rate_limit: &mut RateLimit,
        text: &str,
    ) -> bool {
        let Ok(message) = serde_json::from_str::<ViewerMessage>(text) else {
            refuse(socket, "", UNKNOWN).await;
            return false;
        };
        let name = message.name();
        match rate_limit.admit(Instant::now()) {
            Admission::Admitted => {}
            Admission::Refused => return refuse(socket, name, TOO_OFTEN).await,
            Admission::Ignored => {
                // The other viewers get a turn between many requests.
                tokio::task::yield_now().await;
                return true;
            }
        }
        let done = self.authorize(name).and_then(|()| match message {
            ViewerMessage::Ping { .. } => Ok(()),
            ViewerMessage::Mark { sample, ref text } => {
                self.server.hub.publish(&Event::of_mark(sample, text));
                Ok(())
            }
            ViewerMessage::Session { command } => self.request_recorder(recorder_request(command)),
            ViewerMessage::Gesture { ref class } => match Motion::from_name(class) {
                None | Some(Motion::Unknown) => Err(UNKNOWN),
                Some(motion) => {
                    self.request_recorder(RecorderRequest::Action(Action::Mark(motion)))
                }
            },
            ref message => match message.for_source() {
                Some(request) => self.request_source(request),
                None => Err(UNKNOWN),
            },
        });
        match (done, message) {
            (Err(why), _) => refuse(socket, name, why).await,
            (Ok(()), ViewerMessage::Ping { sent }) => {
                let now = self.server.hub.now();
                send(socket, [json(&Event::Pong { sent, now })]).await
            }
            (Ok(()), _) => true,
        }
    }

    /// Whether this viewer may send a request. If the request needs a leader and nobody leads, this viewer does.
    ///
    /// # Errors
    /// The reason, in words.
    fn authorize(&self, name: &str) -> Result<(), &'static str> {
        match rights::of(name, self.server.mode) {
            Right::All => Ok(()),
            Right::Nobody(why) => Err(why),
            Right::Leader => {
                let (leads, is_new) = self.server.lead.claim(self.id);
                if is_new {
                    let viewer = Some(self.id);
                    self.server.hub.publish(&Event::Lead { viewer });
                }
                leads.then_some(()).ok_or(WATCHES)
            }
        }
    }

    /// Passes a request to the source.
    fn request_source(&self, request: SourceRequest) -> Result<(), &'static str> {
        let source = &self.server.requests.source;
        source.try_send(request).map_err(|_| BUSY)
    }

    /// Passes a request to the recorder.
    fn request_recorder(&self, request: RecorderRequest) -> Result<(), &'static str> {
        let recorder = self.server.requests.recorder.as_ref().ok_or(BUSY)?;
        recorder.try_send(request).map_err(|_| BUSY)
    }

    fn hello(&self) -> Message {
        let now = self.server.hub.now();
        let record = self.server.requests.recorder.is_some();
        json(&Event::hello(now, self.id, record))
    }
}

/// Request to the recorder that a command makes.
const fn recorder_request(command: SessionCommand) -> RecorderRequest {
    match command {
        SessionCommand::Begin => RecorderRequest::Action(Action::Begin),
        SessionCommand::Repeat => RecorderRequest::Action(Action::Repeat),
        SessionCommand::Hold => RecorderRequest::Action(Action::Hold),
        SessionCommand::Finish => RecorderRequest::Action(Action::Finish),
        SessionCommand::Again => RecorderRequest::NewSession,
        SessionCommand::Tune => RecorderRequest::Tune,
        SessionCommand::Install => RecorderRequest::Install,
    }
}

/// Message of an event to one viewer.
fn json(event: &Event) -> Message {
    // Maps with keys of text alone: they can be written.
    serde_json::to_string(event).unwrap_or_default().into()
}

/// Tells a viewer why a request is refused; false if the viewer is gone.
async fn refuse(socket: &mut WebSocket, request: &'static str, text: &'static str) -> bool {
    send(socket, [json(&Event::Refused { request, text })]).await
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
