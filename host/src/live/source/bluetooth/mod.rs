//! An armband over this computer's own Bluetooth, without a board. The Myo session of the firmware makes the decisions, and
//! the device's pipeline makes the labels.
//!
//! ```text
//! MyoSession  -- actions -->  adapter (btleplug; feature `bluetooth`)  -- radio -->  armband
//!             <-- heard ----
//! ```

#[cfg(feature = "bluetooth")]
mod adapter;
#[cfg(feature = "bluetooth")]
mod link;
mod radio;
#[cfg(test)]
mod tests;

use std::cell::RefCell;
use std::sync::mpsc::RecvTimeoutError;
use std::time::{Duration, Instant};

use anyhow::{Context as _, bail};
use shared::model::encoder::HostEncoder;
use shared::model::file::Model;
use shared::myo::{self, Action, Address, MyoSession, Phase, Settings};
use shared::pipeline::Reports;
use shared::units::{Millis, Sample, SampleIndex};

use self::radio::{Radio, RadioEvent};
use super::Context;
use super::scored_pipeline::ScoredPipeline;
use crate::live::event::Event;
use execution::revision::revision;

/// Pause between two ticks of the session, as on a board.
const TICK: Duration = Duration::from_millis(50);

/// Advice while no armband streams, in order.
const STEPS: [&str; 3] = [
    "Put the armband on and move the hand: it sleeps when it is not worn. Its logo lights up or pulses when it is awake.",
    "If it stays dark, charge it with its USB cable.",
    "End every other program that may hold it: Myo Connect, a phone, a board of this project.",
];

/// Armband to follow, and the model that labels its samples.
#[derive(Debug)]
pub(crate) struct ArmbandSource {
    /// Address of the armband; none for the one with the strongest signal.
    pub(crate) address: Option<Address>,
    pub(crate) model: Vec<u8>,
}

impl ArmbandSource {
    /// Follows the armband until it is stopped.
    ///
    /// # Errors
    /// When the model is refused, or there is no Bluetooth adapter or it is lost.
    #[cfg(feature = "bluetooth")]
    pub(crate) fn run(&self, context: &Context) -> anyhow::Result<()> {
        self.run_on(&adapter::open()?, context)
    }

    fn run_on(&self, radio: &Radio, context: &Context) -> anyhow::Result<()> {
        let model = Model::parse(&self.model).context("the model is refused")?;
        let encoder = HostEncoder::new(&model)?;
        let outputs = RefCell::default();
        let mut state = encoder.fresh();
        let mut scored = ScoredPipeline::new(&model, encoder, &mut state, &outputs)?;
        context.hub.publish(&Event::of_model(&model));
        let report = Event::of_report(context.hub.now(), &scored.state_report());
        context.hub.publish(&report);
        let session = MyoSession::new(Settings {
            pinned: self.address,
            follow_strongest: true,
            ..Settings::default()
        });
        ArmbandSession {
            context,
            radio,
            session,
            scored,
            next: SampleIndex(0),
            streams: false,
            published: None,
        }
        .run()
    }
}

/// State of a running session.
struct ArmbandSession<'c, 'r> {
    context: &'c Context,
    radio: &'c Radio,
    session: MyoSession,
    scored: ScoredPipeline<'r, HostEncoder<'r>>,
    /// Index of the next sample.
    next: SampleIndex,
    /// Whether samples have come since the connection was established.
    streams: bool,
    /// Source and board that viewers were told last.
    published: Option<(Event, Event)>,
}

impl ArmbandSession<'_, '_> {
    fn run(mut self) -> anyhow::Result<()> {
        let mut due = Instant::now();
        while !self.context.stop.requested() {
            self.publish_changes();
            self.scored.requests(self.context);
            let wait = due.saturating_duration_since(Instant::now());
            match self.radio.events.recv_timeout(wait) {
                Ok(RadioEvent::Gone(why)) => bail!("Bluetooth: {why}"),
                Ok(event) => self.handle(event.as_event()),
                Err(RecvTimeoutError::Timeout) => {}
                Err(RecvTimeoutError::Disconnected) => bail!("Bluetooth has ended"),
            }
            if Instant::now() >= due {
                self.handle(myo::Event::Tick);
                due = Instant::now() + TICK;
            }
        }
        // The adapter ends with its channel; the connection ends first.
        let _ = self.radio.actions.send(Action::Disconnect);
        Ok(())
    }

    fn now(&self) -> Millis {
        self.context.hub.millis()
    }

    fn handle(&mut self, event: myo::Event<'_>) {
        let mut actions = Vec::new();
        let now = self.now();
        self.session
            .handle(now, event, &mut |action| actions.push(action));
        for action in actions {
            self.act(action);
        }
        if event == myo::Event::Tick {
            let reports = self.scored.tick(now);
            self.report(reports);
        }
    }

    fn act(&mut self, action: Action) {
        match action {
            Action::Deliver(pair) => self.samples(pair),
            Action::Gap { missing } => {
                let reports = self.scored.gap(self.now(), missing);
                self.next = self.next.plus(missing);
                self.report(reports);
            }
            Action::StreamEnded => {
                let reports = self.scored.disconnected(self.now());
                self.report(reports);
                self.streams = false;
                self.context.hub.forget_stream();
            }
            // No binding outlasts this program.
            Action::Keep(_) => {}
            // An adapter that is gone reports that.
            action => drop(self.radio.actions.send(action)),
        }
    }

    fn samples(&mut self, pair: [Sample; 2]) {
        let (now, at) = (self.now(), self.context.hub.now());
        self.streams = true;
        self.context.hub.publish(&Event::Samples {
            at,
            first: self.next.0,
            emg: pair.to_vec(),
            truth: None,
        });
        for sample in pair {
            let found = self.scored.sample(now, self.next, sample);
            found.publish(&self.context.hub, at);
            self.next = self.next.plus(1);
        }
    }

    fn report(&self, reports: Reports) {
        for report in reports {
            let event = Event::of_report(self.context.hub.now(), &report);
            self.context.hub.publish(&event);
        }
    }

    /// Tells viewers about changes of the armband.
    fn publish_changes(&mut self) {
        let armband = self.session.armband();
        let detail = match self.session.phase() {
            Phase::Streaming if self.streams => "",
            Phase::Streaming | Phase::SettingUp => "connected; no samples yet",
            Phase::Connecting => "connecting",
            Phase::Disconnecting | Phase::BackingOff => "lost; looking for it again",
            Phase::Idle | Phase::Unbound | Phase::Scanning => {
                "looking for it: wear it, and move the hand if it sleeps"
            }
        };
        let steps = if self.streams { &[][..] } else { &STEPS };
        let source = Event::Source {
            kind: "bluetooth",
            name: armband.map_or_else(|| "any armband".to_owned(), |address| address.to_string()),
            connected: self.streams,
            detail: detail.to_owned(),
            steps: steps.iter().map(|&step| step.to_owned()).collect(),
        };
        let board = Event::Board {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            revision: revision().unwrap_or_default().to_owned(),
            image: "this computer".to_owned(),
            model: None,
            armband: armband
                .filter(|_| self.streams)
                .map(|address| address.to_string()),
            firmware: None,
            battery: self.session.battery(),
        };
        let newest = (source, board);
        if self.published.as_ref() != Some(&newest) {
            self.context.hub.publish(&newest.0);
            self.context.hub.publish(&newest.1);
            self.published = Some(newest);
        }
    }
}
