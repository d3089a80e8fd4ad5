//! Connection of one viewer: messages to it, and requests from it.

use std::sync::Arc;
use std::time::Duration;

use axum::body::Bytes;
use axum::extract::ws::{Message as Frame, WebSocket};
use recordings::labels::motion::Motion;
use tokio::sync::broadcast::error::TryRecvError;
use tokio::time::{MissedTickBehavior, interval, interval_at, timeout};
use web::event::{Event, ViewerId};
use web::record::session::Action;
use web::request::{SessionCommand, UNKNOWN, ViewerMessage};

use super::ServerState;
use crate::live::hub::{Message, Subscription};
use crate::live::recorder::RecorderRequest;

/// Time for which messages are collected: half a frame of a screen.
const COLLECT: Duration = Duration::from_millis(8);
/// Time after which a viewer that takes nothing is gone.
const SEND_TIMEOUT: Duration = Duration::from_secs(20);
/// Pause between two pings. A viewer that is cut off does not answer, and its connection ends.
const PING_PERIOD: Duration = Duration::from_secs(60);

const WATCHES: &str = "another page leads, and this one watches";
const NO_SESSION: &str = "no session is recorded here: `myointent record` has a page for it";
const NO_BOARD: &str = "there is no board here: `myointent record --port PATH` has one";
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
        if self
            .server
            .leader()
            .take_if(|leader| *leader == self.id)
            .is_some()
        {
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
    async fn handle_message(&self, socket: &mut WebSocket, text: &str) -> bool {
        let Ok(message) = serde_json::from_str::<ViewerMessage>(text) else {
            refuse(socket, "", UNKNOWN).await;
            return false;
        };
        if let ViewerMessage::Ping { sent } = message {
            let now = self.server.hub.now();
            return send(socket, [json(&Event::Pong { sent, now })]).await;
        }
        match self.lead().and_then(|()| self.act(&message)) {
            Ok(()) => true,
            Err(why) => refuse(socket, message.name(), why).await,
        }
    }

    /// Claims the lead: the first viewer to send a request has it until it leaves, and all others watch.
    fn lead(&self) -> Result<(), &'static str> {
        let mut leader = self.server.leader();
        if leader.is_none() {
            let viewer = Some(self.id);
            self.server.hub.publish(&Event::Lead { viewer });
        }
        let leads = *leader.get_or_insert(self.id) == self.id;
        leads.then_some(()).ok_or(WATCHES)
    }

    /// Does what a message asks for.
    ///
    /// # Errors
    /// The reason why it is not done, in words.
    fn act(&self, message: &ViewerMessage) -> Result<(), &'static str> {
        match message {
            ViewerMessage::Mark { sample, text } => {
                self.server.hub.publish(&Event::of_mark(*sample, text));
                Ok(())
            }
            ViewerMessage::Session { command } => self.request_recorder(recorder_request(*command)),
            ViewerMessage::Gesture { class } => match Motion::from_name(class) {
                None | Some(Motion::Unknown) => Err(UNKNOWN),
                Some(motion) => {
                    self.request_recorder(RecorderRequest::Action(Action::Mark(motion)))
                }
            },
            ViewerMessage::Bind if !self.server.has_board => Err(NO_BOARD),
            message => {
                let request = message.for_source().ok_or(UNKNOWN)?;
                let source = &self.server.requests.source;
                source.try_send(request).map_err(|_| BUSY)
            }
        }
    }

    /// Passes a request to the recorder.
    fn request_recorder(&self, request: RecorderRequest) -> Result<(), &'static str> {
        let recorder = self.server.requests.recorder.as_ref();
        let recorder = recorder.ok_or(NO_SESSION)?;
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
