//! Distribution of events from one source to all viewers. A slow viewer loses messages; the source never waits for one.

use std::collections::{BTreeMap, VecDeque};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

use shared::units::Millis;
use tokio::sync::broadcast;

use web::electrodes::Electrodes;
use web::event::{Event, Topic};

/// Number of messages that a viewer may be behind: 4 s of samples.
const BEHIND: usize = 512;

/// Number of the newest messages with samples that a new viewer gets: 5 s, the width of the picture.
const RECENT: usize = 500;

/// Message as JSON.
pub(crate) type Message = Arc<str>;

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
    electrodes: Electrodes,
    /// Recorder, which receives every event it needs without loss.
    recorder: Option<Sender<Event>>,
    sender: broadcast::Sender<Message>,
}

/// Samples, scores, reports and marks of the last seconds, in order.
#[derive(Debug, Default)]
struct Recent {
    messages: VecDeque<(Kind, Message)>,
    samples: usize,
    reports: usize,
}

/// Kind of a recent message.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Kind {
    Samples,
    Report,
    Other,
}

impl Recent {
    fn push(&mut self, event: &Event, message: &Message) {
        let kind = match event {
            Event::Samples { .. } => Kind::Samples,
            Event::Report { .. } => Kind::Report,
            Event::Scores { .. } | Event::Mark { .. } => Kind::Other,
            _ => return,
        };
        self.messages.push_back((kind, message.clone()));
        self.samples += usize::from(kind == Kind::Samples);
        self.reports += usize::from(kind == Kind::Report);
        // The second bound is for a source without samples.
        while self.samples > RECENT || self.messages.len() > 2 * RECENT {
            let Some((kind, _)) = self.messages.pop_front() else {
                break;
            };
            self.samples -= usize::from(kind == Kind::Samples);
            self.reports -= usize::from(kind == Kind::Report);
        }
    }
}

/// Messages for one viewer.
#[derive(Debug)]
pub(crate) struct Subscription {
    /// Newest message of each topic, and for a new viewer those of the last seconds; sent first.
    pub(crate) known: Vec<Message>,
    /// Messages that follow, without a gap.
    pub(crate) following: broadcast::Receiver<Message>,
}

impl State {
    fn subscription(&self) -> Subscription {
        Subscription {
            known: self.newest.values().cloned().collect(),
            following: self.sender.subscribe(),
        }
    }
}

impl Hub {
    pub(crate) fn new() -> Self {
        let state = State {
            newest: BTreeMap::new(),
            recent: Recent::default(),
            electrodes: Electrodes::default(),
            recorder: None,
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

    /// Milliseconds since the hub was created, as a wrapping clock like a board's.
    #[expect(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "wraps after 49 days, as this clock may"
    )]
    pub(crate) fn millis(&self) -> Millis {
        Millis(self.now() as u64 as u32)
    }

    /// Hands samples, sources and alignments to a recorder as well. The queue is not bounded: the recorder is faster than
    /// the samples.
    pub(crate) fn attach_recorder(&self, recorder: Sender<Event>) {
        self.lock().recorder = Some(recorder);
    }

    /// Sends an event to all viewers, and with samples what they say of the electrodes.
    pub(crate) fn publish(&self, event: &Event) {
        self.send(event);
        let faults = self.lock().electrodes.take(event);
        if let Some(faults) = faults {
            self.send(&faults);
        }
    }

    fn send(&self, event: &Event) {
        let Ok(text) = serde_json::to_string(event) else {
            return;
        };
        let message: Message = text.into();
        let mut state = self.lock();
        let is_recorded = matches!(
            event,
            Event::Samples { .. }
                | Event::Imu { .. }
                | Event::Source { .. }
                | Event::Alignment { .. }
        );
        if let Some(recorder) = state.recorder.as_ref().filter(|_| is_recorded) {
            // The recorder may have ended.
            let _ = recorder.send(event.clone());
        }
        if let Some(topic) = event.topic() {
            state.newest.insert(topic, message.clone());
        }
        state.recent.push(event, &message);
        // There may be no viewer.
        let _ = state.sender.send(message);
    }

    /// Forgets what is known about labels, placement and board of the stream before; a new one begins.
    pub(crate) fn forget_stream(&self) {
        let mut state = self.lock();
        for topic in [
            Topic::Report,
            Topic::Alignment,
            Topic::Calibration,
            Topic::Electrodes,
            Topic::Board,
            Topic::Binding,
            Topic::Counts,
        ] {
            state.newest.remove(&topic);
        }
        state.recent = Recent::default();
        state.electrodes = Electrodes::default();
    }

    /// Forgets the results of the session before; a new one begins.
    pub(crate) fn forget_session(&self) {
        let mut state = self.lock();
        for topic in [Topic::Kept, Topic::Tuning, Topic::Installing] {
            state.newest.remove(&topic);
        }
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
    use tokio::sync::broadcast::error::TryRecvError;

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
        let next = viewer.following.try_recv().unwrap();
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
        hub.forget_stream();
        assert_eq!(hub.subscribe().known.len(), 0);
    }

    #[test]
    fn a_slow_viewer_loses_messages_and_holds_up_nobody() {
        let hub = Hub::new();
        let mut slow = hub.subscribe().following;
        let mut fast = hub.subscribe().following;
        for sample in 0..3 * BEHIND as u32 {
            hub.publish(&mark(sample));
            assert!(fast.try_recv().unwrap().contains(&format!(":{sample},")));
        }
        assert_eq!(
            slow.try_recv(),
            Err(TryRecvError::Lagged(2 * BEHIND as u64))
        );
        let oldest = format!(":{},", 2 * BEHIND);
        assert!(slow.try_recv().unwrap().contains(&oldest));
    }
}
