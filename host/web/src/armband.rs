//! An armband without a board. The Myo session of the firmware makes the decisions, and the device's pipeline makes the
//! labels.

use serde::Serialize;
use shared::myo::{self, Action, MyoSession, Phase, Settings};
use shared::pipeline::Reports;
use shared::units::{Millis, Sample, SampleIndex};

use crate::event::Event;
use crate::request::SourceRequest;
use crate::said::Said;
use crate::scored_pipeline::ScoredPipeline;
use execution::revision::revision;

/// Step that may help while no armband streams, in order.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Step {
    #[error(
        "Put the armband on and move the hand: it sleeps when it is not worn. Its logo lights up or pulses when it is awake."
    )]
    Wear,
    #[error("If it stays dark, charge it with its USB cable.")]
    Charge,
    #[error(
        "End every other program that may hold it: Myo Connect, a phone, a board of this project."
    )]
    End,
}

/// State of an armband that does not stream.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum State {
    #[error("connected; no samples yet")]
    NoSamples,
    #[error("connecting")]
    Connecting,
    #[error("lost; looking for it again")]
    Lost,
    #[error("looking for it: wear it, and move the hand if it sleeps")]
    Looking,
}

/// Output of an armband's session.
#[derive(Clone, PartialEq, Debug)]
pub enum Output {
    /// Event for viewers.
    Event(Event),
    /// Action of the radio.
    Radio(Action),
}

/// Time of the session, and the same in the events.
#[derive(Clone, Copy, Debug)]
pub struct Now {
    /// Time of the session.
    pub session: Millis,
    /// Time in the events, in ms.
    pub at: f64,
}

/// Session with an armband.
pub struct Armband {
    session: MyoSession,
    scored: ScoredPipeline,
    /// Where this runs, and what the armband is called there; none for its address.
    here: &'static str,
    name: Option<String>,
    /// Index of the next sample.
    next: SampleIndex,
    /// Whether samples have come since the connection was established.
    streams: bool,
    /// Source and board that viewers were told last.
    published: Option<(Event, Event)>,
}

impl Armband {
    /// State before the first event. The settings name an armband, or none for the one with the strongest signal, and say whether
    /// movement is wanted. Emits the model and the pipeline's state.
    pub fn begin(
        settings: Settings,
        (here, name): (&'static str, Option<String>),
        mut scored: ScoredPipeline,
        at: f64,
        emit: &mut dyn FnMut(Event),
    ) -> Self {
        emit(Event::of_model(scored.model()));
        emit(Event::of_report(at, &scored.state_report()));
        let session = MyoSession::new(Settings {
            follow_strongest: true,
            ..settings
        });
        Self {
            session,
            scored,
            here,
            name,
            next: SampleIndex(0),
            streams: false,
            published: None,
        }
    }

    /// Does what is asked for.
    pub fn request(&mut self, now: Now, request: SourceRequest, emit: &mut dyn FnMut(Event)) {
        self.scored.request(now.session, now.at, request, emit);
    }

    /// Runs another model. Emits it and the pipeline's state.
    pub fn set_model(&mut self, now: Now, scored: ScoredPipeline, emit: &mut dyn FnMut(Event)) {
        self.scored.replace(now.session, now.at, scored, emit);
    }

    /// Handles an event of the radio, or a tick. The answer to an action needs a call of its own.
    pub fn handle(&mut self, now: Now, event: myo::MyoEvent<'_>, output: &mut dyn FnMut(Output)) {
        let mut actions = Vec::new();
        self.session
            .handle(now.session, event, &mut |action| actions.push(action));
        for action in actions {
            self.act(now, action, output);
        }
        if event == myo::MyoEvent::Tick {
            let reports = self.scored.tick(now.session);
            report(now, reports, output);
        }
        self.changes(output);
    }

    fn act(&mut self, now: Now, action: Action, output: &mut dyn FnMut(Output)) {
        match action {
            Action::Deliver(pair) => self.samples(now, pair, output),
            Action::Gap { missing } => {
                let reports = self.scored.gap(now.session, missing);
                self.next = self.next.plus(missing);
                report(now, reports, output);
            }
            Action::StreamEnded => {
                let reports = self.scored.disconnected(now.session);
                report(now, reports, output);
                self.streams = false;
            }
            Action::Imu(imu) => output(Output::Event(Event::Imu {
                at: now.at,
                sample: self.next.0,
                imu,
            })),
            // No binding outlasts this program.
            Action::Keep(_) => {}
            action => output(Output::Radio(action)),
        }
    }

    fn samples(&mut self, now: Now, pair: [Sample; 2], output: &mut dyn FnMut(Output)) {
        self.streams = true;
        output(Output::Event(Event::Samples {
            at: now.at,
            first: self.next.0,
            emg: pair.to_vec(),
            truth: None,
        }));
        for sample in pair {
            let found = self.scored.sample(now.session, now.at, self.next, sample);
            found.events(now.at, &mut |event| output(Output::Event(event)));
            self.next = self.next.plus(1);
        }
    }

    /// Emits what has changed of the armband.
    fn changes(&mut self, output: &mut dyn FnMut(Output)) {
        let armband = self.session.armband().map(|address| {
            let name = self.name.clone();
            name.unwrap_or_else(|| address.to_string())
        });
        let detail = match self.session.phase() {
            Phase::Streaming if self.streams => None,
            Phase::Streaming | Phase::SettingUp => Some(State::NoSamples),
            Phase::Connecting => Some(State::Connecting),
            Phase::Disconnecting | Phase::BackingOff => Some(State::Lost),
            Phase::Idle | Phase::Unbound | Phase::Scanning => Some(State::Looking),
        };
        let steps = if self.streams {
            Vec::new()
        } else {
            let steps = [Step::Wear, Step::Charge, Step::End];
            steps.map(|step| Said::of("wear", &step)).into()
        };
        let source = Event::Source {
            kind: "bluetooth",
            name: armband.clone().unwrap_or_else(|| "any armband".to_owned()),
            connected: self.streams,
            detail: detail.map(|state| Said::of("armband", &state)),
            steps,
        };
        let board = Event::Board {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            revision: revision().unwrap_or_default().to_owned(),
            image: self.here.to_owned(),
            model: None,
            armband: armband.filter(|_| self.streams),
            firmware: None,
            battery: self.session.battery(),
        };
        let newest = (source, board);
        if self.published.as_ref() != Some(&newest) {
            output(Output::Event(newest.0.clone()));
            output(Output::Event(newest.1.clone()));
            self.published = Some(newest);
        }
    }
}

fn report(now: Now, reports: Reports, output: &mut dyn FnMut(Output)) {
    for report in reports {
        output(Output::Event(Event::of_report(now.at, &report)));
    }
}
