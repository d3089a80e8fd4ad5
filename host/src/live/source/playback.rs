//! A recording or a simulated person, through the device's pipeline in real time.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample, SampleIndex};

use super::Context;
use super::person::Person;
use super::scored_pipeline::ScoredPipeline;
use crate::live::event::Event;

/// Samples in one notification of the armband.
const TOGETHER: usize = 2;

/// Longest delay that is caught up with; after a longer one, time continues from now.
const LATE: Duration = Duration::from_millis(500);

/// Source of the samples.
#[derive(Debug)]
pub(crate) enum SampleSource {
    /// Recording, repeated.
    Recording {
        samples: Vec<Sample>,
        /// Labels, one for each sample.
        labels: Vec<Option<Intent>>,
    },
    /// Simulated person who does what is asked for.
    Person(Box<Person>),
}

/// Samples to play in real time, and the model to run on them.
#[derive(Debug)]
pub(crate) struct Playback {
    /// `demo` or `replay`.
    pub(crate) kind: &'static str,
    pub(crate) name: String,
    pub(crate) model: Vec<u8>,
    pub(crate) samples: SampleSource,
    /// Speed-up, at least 1.
    pub(crate) speed: u32,
}

/// Samples of a notification.
struct Notification {
    emg: Vec<Sample>,
    truth: Option<Vec<Option<&'static str>>>,
    /// Whether a recording begins again with it.
    again: bool,
}

impl SampleSource {
    /// Returns at most a notification of samples, from `first` on.
    fn next(&mut self, first: SampleIndex) -> Notification {
        match self {
            Self::Recording { samples, labels } => {
                let offset = first.0 as usize % samples.len();
                let range = offset..samples.len().min(offset + TOGETHER);
                let truth = &labels[range.clone()];
                let names = || truth.iter().map(|label| label.map(Intent::name)).collect();
                Notification {
                    emg: samples[range].to_vec(),
                    truth: truth.iter().any(Option::is_some).then(names),
                    again: offset == 0 && first.0 > 0,
                }
            }
            Self::Person(person) => {
                let (emg, cues) = person.next::<TOGETHER>(first, LATE);
                let names = || cues.map(|cue| cue.map(Intent::name)).to_vec();
                Notification {
                    emg: emg.to_vec(),
                    truth: cues.iter().any(Option::is_some).then(names),
                    again: false,
                }
            }
        }
    }

    /// Tells a person whether an alignment is in progress. Returns whether it has to begin anew, because the person has come to
    /// rest: an alignment that begins in a gesture could take that for an opening.
    fn align(&mut self, is_aligning: bool) -> bool {
        match self {
            Self::Recording { .. } => false,
            Self::Person(person) => person.align(is_aligning),
        }
    }
}

impl Playback {
    /// Plays until it is stopped.
    ///
    /// # Errors
    /// When the model is refused.
    pub(crate) fn run(mut self, context: &Context) -> anyhow::Result<()> {
        let hub = &context.hub;
        let model = Model::parse(&self.model).context("the model is refused")?;
        let encoder = HostEncoder::new(&model)?;
        let outputs = RefCell::default();
        let mut state = encoder.fresh();
        let mut scored = ScoredPipeline::new(&model, encoder, &mut state, &outputs)?;
        hub.publish(&Event::Source {
            kind: self.kind,
            name: self.name.clone(),
            connected: true,
            detail: String::new(),
            steps: Vec::new(),
        });
        hub.publish(&Event::of_model(&model));
        hub.publish(&Event::of_report(hub.now(), &scored.state_report()));

        let mut next = SampleIndex(0);
        let mut due = Instant::now();
        while !context.stop.requested() {
            let now = Instant::now();
            std::thread::sleep(due.saturating_duration_since(now));
            if now.saturating_duration_since(due) > LATE {
                due = now;
            }
            let period = Duration::from_millis(u64::from(SAMPLE_PERIOD_MS)) * TOGETHER as u32;
            due += period / self.speed.max(1);
            scored.requests(context);
            if self.samples.align(scored.is_aligning()) {
                scored.begin_alignment();
            }
            let notification = self.samples.next(next);
            next = take(context, &mut scored, notification, next);
        }
        Ok(())
    }
}

/// Publishes and labels the samples of a notification. Returns the index of the next sample.
fn take(
    context: &Context,
    scored: &mut ScoredPipeline<'_, HostEncoder<'_>>,
    notification: Notification,
    first: SampleIndex,
) -> SampleIndex {
    let hub = &context.hub;
    let Notification { emg, truth, again } = notification;
    if again {
        let text = "the recording begins again".to_owned();
        let sample = first.0;
        hub.publish(&Event::Mark { sample, text });
    }
    let at = hub.now();
    hub.publish(&Event::Samples {
        at,
        first: first.0,
        emg: emg.clone(),
        truth,
    });
    // The device's clock starts with the first sample.
    let now = Millis(first.0.wrapping_mul(SAMPLE_PERIOD_MS));
    let mut next = first;
    for sample in emg {
        scored.sample(now, next, sample).publish(hub, at);
        next = next.plus(1);
    }
    next
}
