//! A recording through the device's pipeline in real time, again and again.

use std::cell::RefCell;
use std::time::{Duration, Instant};

use anyhow::Context as _;
use shared::intent::Intent;
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::units::{Millis, SAMPLE_PERIOD_MS, Sample, SampleIndex};

use super::scored::{Found, Scored};
use super::{Context, Request};
use crate::live::event::Event;

/// Samples of a notification of the armband.
const TOGETHER: usize = 2;

/// A stop of the whole machine that is longer is not caught up with.
const LATE: Duration = Duration::from_millis(500);

/// A recording and the model to run on it.
#[derive(Debug)]
pub(crate) struct Recorded {
    /// `demo` or `replay`.
    pub(crate) kind: &'static str,
    pub(crate) name: String,
    pub(crate) model: Vec<u8>,
    pub(crate) samples: Vec<Sample>,
    /// One of each sample.
    pub(crate) labels: Vec<Option<Intent>>,
}

impl Recorded {
    /// Plays the recording until it is stopped.
    ///
    /// # Errors
    /// When the model is refused.
    pub(crate) fn run(&self, context: &Context) -> anyhow::Result<()> {
        let hub = &context.hub;
        let model = Model::parse(&self.model).context("the model is refused")?;
        let encoder = HostEncoder::new(&model)?;
        let outputs = RefCell::default();
        let mut state = encoder.fresh();
        let mut scored = Scored::new(&model, encoder, &mut state, &outputs)?;
        hub.publish(&Event::Source {
            kind: self.kind,
            name: self.name.clone(),
            connected: true,
            detail: String::new(),
        });
        hub.publish(&Event::of_model(&model));
        hub.publish(&Event::of_report(hub.now(), &scored.state_report()));

        let mut next = SampleIndex(0);
        let mut due = Instant::now();
        while !context.stop.requested() {
            if next.0 > 0 {
                let text = "the recording begins again".to_owned();
                let sample = next.0;
                hub.publish(&Event::Mark { sample, text });
            }
            for place in (0..self.samples.len()).step_by(TOGETHER) {
                if context.stop.requested() {
                    break;
                }
                let now = Instant::now();
                std::thread::sleep(due.saturating_duration_since(now));
                if now.saturating_duration_since(due) > LATE {
                    due = now;
                }
                due += Duration::from_millis(u64::from(SAMPLE_PERIOD_MS)) * TOGETHER as u32;
                requests(context, &mut scored);
                next = self.pair(context, &mut scored, place, next);
            }
        }
        Ok(())
    }

    /// The samples of a notification; returns the index of the next one.
    fn pair(
        &self,
        context: &Context,
        scored: &mut Scored<'_, HostEncoder<'_>>,
        place: usize,
        first: SampleIndex,
    ) -> SampleIndex {
        let hub = &context.hub;
        let at = hub.now();
        let places = place..self.samples.len().min(place + TOGETHER);
        let truth = &self.labels[places.clone()];
        let names = || truth.iter().map(|label| label.map(Intent::name)).collect();
        hub.publish(&Event::Samples {
            at,
            first: first.0,
            emg: self.samples[places.clone()].to_vec(),
            truth: truth.iter().any(Option::is_some).then(names),
        });
        // The device's clock starts with the first sample.
        let now = Millis(first.0.wrapping_mul(SAMPLE_PERIOD_MS));
        let mut next = first;
        for &sample in &self.samples[places] {
            let found = scored.sample(now, next, sample);
            publish(context, at, found);
            next = next.plus(1);
        }
        next
    }
}

fn publish(context: &Context, at: f64, found: Found) {
    for report in found.reports {
        context.hub.publish(&Event::of_report(at, &report));
    }
    if let Some(report) = found.alignment {
        context.hub.publish(&Event::of_alignment(at, &report));
    }
    if let Some(scores) = found.scores {
        context.hub.publish(&scores);
    }
}

fn requests(context: &Context, scored: &mut Scored<'_, HostEncoder<'_>>) {
    while let Ok(request) = context.requests.try_recv() {
        if let Some(report) = scored.align(request == Request::Align) {
            let event = Event::of_alignment(context.hub.now(), &report);
            context.hub.publish(&event);
        }
    }
}
