//! Distribution of events from one source to all viewers. A slow viewer loses messages; the source never waits for one.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use tokio::sync::broadcast;
use tokio::sync::broadcast::error::{RecvError, TryRecvError};

use web::event::{Event, Known, ViewerId};

/// Number of messages that a viewer or a reader of lines may be behind: 4 s of samples.
const BEHIND: usize = 512;

/// Message as JSON.
pub(crate) type Message = Arc<str>;

/// Viewer that a message is for, none for all; and the message.
type Addressed = (Option<ViewerId>, Message);

/// Distributor of events to all present viewers.
#[derive(Debug)]
pub(crate) struct Hub {
    known: Mutex<Known>,
    sender: broadcast::Sender<Addressed>,
    began: Instant,
}

/// Messages for one viewer.
#[derive(Debug)]
pub(crate) struct Subscription {
    viewer: ViewerId,
    /// Messages that come first.
    first: VecDeque<Message>,
    /// Messages that follow, without a gap.
    following: broadcast::Receiver<Addressed>,
}

/// Message of an event.
pub(crate) fn json(event: &Event) -> Message {
    // Maps with keys of text alone: they can be written.
    serde_json::to_string(event).unwrap_or_default().into()
}

impl Hub {
    pub(crate) fn new() -> Self {
        Self {
            known: Mutex::default(),
            sender: broadcast::channel(BEHIND).0,
            began: Instant::now(),
        }
    }

    /// Milliseconds since the hub was created.
    pub(crate) fn now(&self) -> f64 {
        // Tenths of a millisecond keep the messages short.
        (self.began.elapsed().as_secs_f64() * 10_000.0).round() / 10.0
    }

    /// Sends an event to one viewer, or to all.
    pub(crate) fn send(&self, viewer: Option<ViewerId>, event: &Event) {
        let mut known = self.lock();
        if viewer.is_none() {
            known.take(event);
        }
        // There may be no viewer.
        let _ = self.sender.send((viewer, json(event)));
    }

    /// Subscribes a viewer: what is known comes first.
    pub(crate) fn subscribe(&self, viewer: ViewerId) -> Subscription {
        let known = self.lock();
        Subscription {
            viewer,
            first: known.events().map(json).collect(),
            following: self.sender.subscribe(),
        }
    }

    fn lock(&self) -> MutexGuard<'_, Known> {
        // A panic leaves nothing half-changed: each insertion is whole.
        self.known.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Subscription {
    /// Takes the messages since the last call. A viewer that is too far behind is told how many it has lost, and what is known.
    pub(crate) fn take(&mut self, hub: &Hub) -> Vec<Message> {
        let mut messages = Vec::new();
        loop {
            messages.extend(self.first.drain(..));
            match self.following.try_recv() {
                Ok(addressed) => self.receive(addressed),
                Err(TryRecvError::Empty | TryRecvError::Closed) => return messages,
                Err(TryRecvError::Lagged(lost)) => self.skip(hub, lost),
            }
        }
    }

    /// Waits for the next message, as [`take`](Self::take) gives it. A dropped future loses nothing.
    pub(crate) async fn next(&mut self, hub: &Hub) -> Message {
        loop {
            if let Some(message) = self.first.pop_front() {
                return message;
            }
            match self.following.recv().await {
                Ok(addressed) => self.receive(addressed),
                Err(RecvError::Lagged(lost)) => self.skip(hub, lost),
                // The hub is there.
                Err(RecvError::Closed) => std::future::pending().await,
            }
        }
    }

    fn receive(&mut self, (viewer, message): Addressed) {
        if viewer.is_none_or(|viewer| viewer == self.viewer) {
            self.first.push_back(message);
        }
    }

    fn skip(&mut self, hub: &Hub, lost: u64) {
        // With those that it has not taken yet.
        let lost = lost + self.following.len() as u64;
        *self = hub.subscribe(self.viewer);
        let skipped = format!(r#"{{"type":"skipped","messages":{lost}}}"#);
        self.first.push_front(skipped.into());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mark(sample: u32) -> Event {
        let text = String::new();
        Event::Mark { sample, text }
    }

    fn line(damaged: u32) -> Event {
        Event::Line {
            damaged,
            missing: 0,
            samples: 0,
        }
    }

    #[test]
    fn a_viewer_is_told_the_newest_of_each_kind_what_follows_and_what_it_lost() {
        let hub = Hub::new();
        let send = |event| hub.send(None, &event);
        let texts = |messages: Vec<Message>| messages.join("\n");
        [line(1), mark(1), Event::End, line(2)]
            .into_iter()
            .for_each(send);
        let mut viewer = hub.subscribe(7);
        let known = r#"{"type":"line","damaged":2,"missing":0,"samples":0}"#;
        assert_eq!(texts(viewer.take(&hub)), known);
        hub.send(Some(8), &mark(8));
        hub.send(Some(7), &mark(7));
        assert_eq!(
            texts(viewer.take(&hub)),
            r#"{"type":"mark","sample":7,"text":""}"#
        );
        (0..600).map(mark).for_each(send);
        let skipped = r#"{"type":"skipped","messages":600}"#;
        assert_eq!(texts(viewer.take(&hub)), format!("{skipped}\n{known}"));
        send(mark(9));
        assert_eq!(viewer.take(&hub).len(), 1);
        // Of a stream that is gone no loss is known, and of its source that it is.
        send(Event::Source {
            kind: "demo",
            name: String::new(),
            connected: false,
            detail: None,
            steps: Vec::new(),
        });
        assert_eq!(hub.subscribe(9).take(&hub).len(), 2);
    }
}
