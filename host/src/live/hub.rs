//! Distribution of events from one source to all viewers. A slow viewer loses messages; the source never waits for one.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use tokio::sync::broadcast;

use web::event::{Event, Topic, ViewerId};

/// Number of messages that a viewer may be behind: 4 s of samples.
const BEHIND: usize = 512;

/// Number of the newest messages with samples that a new viewer gets: 5 s, the width of the picture.
const RECENT: usize = 500;

/// Message as JSON.
pub(crate) type Message = Arc<str>;

/// Viewer that a message is for, none for all; and the message.
pub(crate) type Addressed = (Option<ViewerId>, Message);

/// Distributor of events to all present viewers.
#[derive(Debug)]
pub(crate) struct Hub {
    state: Mutex<State>,
    began: Instant,
}

#[derive(Debug)]
struct State {
    newest: BTreeMap<Topic, Message>,
    recent: Recent,
    sender: broadcast::Sender<Addressed>,
}

/// Samples, scores, reports and marks of the last seconds, in order.
#[derive(Debug, Default)]
struct Recent {
    messages: VecDeque<(MessageKind, Message)>,
    samples: usize,
    reports: usize,
}

/// Kind of a recent message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum MessageKind {
    Samples,
    Report,
    Other,
}

impl Recent {
    fn push(&mut self, event: &Event, message: &Message) {
        let kind = match event {
            Event::Samples { .. } => MessageKind::Samples,
            Event::Report { .. } => MessageKind::Report,
            Event::Scores { .. } | Event::Mark { .. } => MessageKind::Other,
            _ => return,
        };
        self.messages.push_back((kind, message.clone()));
        self.samples += usize::from(kind == MessageKind::Samples);
        self.reports += usize::from(kind == MessageKind::Report);
        // The second bound is for a source without samples.
        while self.samples > RECENT || self.messages.len() > 2 * RECENT {
            let Some((kind, _)) = self.messages.pop_front() else {
                break;
            };
            self.samples -= usize::from(kind == MessageKind::Samples);
            self.reports -= usize::from(kind == MessageKind::Report);
        }
    }
}

/// Messages for one viewer.
#[derive(Debug)]
pub(crate) struct Subscription {
    /// Newest message of each topic, and for a new viewer those of the last seconds; sent first.
    pub(crate) known: Vec<Message>,
    /// Messages that follow, without a gap.
    pub(crate) following: broadcast::Receiver<Addressed>,
}

impl State {
    fn subscription(&self) -> Subscription {
        Subscription {
            known: self.newest.values().cloned().collect(),
            following: self.sender.subscribe(),
        }
    }

    /// Forgets what is known about labels, placement and board: there is no stream, or another one begins.
    fn forget_stream(&mut self) {
        for topic in [
            Topic::Report,
            Topic::Alignment,
            Topic::Calibration,
            Topic::Electrodes,
            Topic::Board,
            Topic::Binding,
            Topic::Counts,
        ] {
            self.newest.remove(&topic);
        }
        self.recent = Recent::default();
    }
}

/// Message of an event.
pub(crate) fn json(event: &Event) -> Message {
    // Maps with keys of text alone: they can be written.
    serde_json::to_string(event).unwrap_or_default().into()
}

impl Hub {
    pub(crate) fn new() -> Self {
        let state = State {
            newest: BTreeMap::new(),
            recent: Recent::default(),
            sender: broadcast::channel(BEHIND).0,
        };
        Self {
            state: Mutex::new(state),
            began: Instant::now(),
        }
    }

    /// Milliseconds since the hub was created.
    pub(crate) fn now(&self) -> f64 {
        // Tenths of a millisecond keep the messages short.
        (self.began.elapsed().as_secs_f64() * 10_000.0).round() / 10.0
    }

    /// Sends an event to all viewers.
    pub(crate) fn publish(&self, event: &Event) {
        let message = json(event);
        let mut state = self.lock();
        match event {
            Event::Source {
                connected: false, ..
            } => state.forget_stream(),
            Event::Session { view, .. } if view.phase == "waiting" => {
                for topic in [Topic::Kept, Topic::Tuning, Topic::Installing] {
                    state.newest.remove(&topic);
                }
            }
            _ => {}
        }
        if let Some(topic) = event.topic() {
            state.newest.insert(topic, message.clone());
        }
        state.recent.push(event, &message);
        // There may be no viewer.
        let _ = state.sender.send((None, message));
    }

    /// Sends an event to one viewer.
    pub(crate) fn answer(&self, viewer: ViewerId, event: &Event) {
        let _ = self.lock().sender.send((Some(viewer), json(event)));
    }

    /// Subscribes a new viewer.
    pub(crate) fn subscribe(&self) -> Subscription {
        let state = self.lock();
        let mut subscription = state.subscription();
        if state.recent.reports > 0 {
            let others = state
                .newest
                .iter()
                .filter(|(topic, _)| **topic != Topic::Report);
            subscription.known = others.map(|(_, message)| message.clone()).collect();
        }
        let recent = state.recent.messages.iter();
        subscription
            .known
            .extend(recent.map(|(_, message)| message.clone()));
        subscription
    }

    /// Subscribes a viewer again that has lost messages. Returns a message with their number, untaken ones included.
    pub(crate) fn resubscribe(&self, subscription: &mut Subscription, lost: u64) -> Message {
        let state = self.lock();
        let messages = lost + subscription.following.len() as u64;
        *subscription = state.subscription();
        format!(r#"{{"type":"skipped","messages":{messages}}}"#).into()
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        // A panic leaves nothing half-changed: each insertion is whole.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
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
    fn a_new_viewer_is_told_the_newest_of_each_kind_and_what_follows() {
        let hub = Hub::new();
        for event in [line(1), mark(1), Event::End, line(2)] {
            hub.publish(&event);
        }
        let mut viewer = hub.subscribe();
        let expected = [
            r#"{"type":"line","damaged":2,"missing":0,"samples":0}"#,
            r#"{"type":"mark","sample":1,"text":""}"#,
        ];
        let known: Vec<&str> = viewer.known.iter().map(|message| &**message).collect();
        assert_eq!(known, expected);
        hub.publish(&mark(7));
        let (_, next) = viewer.following.try_recv().unwrap();
        assert_eq!(&*next, r#"{"type":"mark","sample":7,"text":""}"#);
    }

    #[test]
    fn a_new_viewer_gets_the_samples_and_reports_of_the_last_seconds_in_order() {
        let hub = Hub::new();
        let samples = |first: usize| Event::Samples {
            at: 0.0,
            first: first as u32,
            emg: Vec::new(),
            truth: None,
        };
        let report = |number| Event::Report {
            at: 0.0,
            is_label: true,
            number,
            instant: 0,
            emitted: 0,
            label: "open",
            valid: true,
            cause: None,
            lost: 0,
            bridged: 0,
            resets: 0,
            strength: None,
        };
        hub.publish(&report(1));
        for first in 0..RECENT {
            hub.publish(&samples(first));
        }
        assert_eq!(hub.subscribe().known.len(), 1 + RECENT);
        // Without a recent report, the newest one is known.
        hub.publish(&samples(RECENT));
        let known = hub.subscribe().known;
        assert_eq!(known.len(), 1 + RECENT);
        assert!(known[0].contains(r#""number":1,"#), "{}", known[0]);
        hub.publish(&report(2));
        let known = hub.subscribe().known;
        assert_eq!(known.len(), RECENT + 1);
        assert!(known[0].contains(r#""first":1,"#), "{}", known[0]);
        assert!(known[RECENT].contains(r#""number":2,"#));
        hub.publish(&Event::Source {
            kind: "demo",
            name: String::new(),
            connected: false,
            detail: String::new(),
            steps: Vec::new(),
        });
        assert_eq!(hub.subscribe().known.len(), 1);
    }
}
