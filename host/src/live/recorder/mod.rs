//! A recording session beside a stream: a thread that takes samples from the hub, leads through a protocol and writes a
//! journal. Neither source nor viewers ever wait for it, or for its disk.

mod told;
#[cfg_attr(not(feature = "train"), path = "untrained.rs")]
mod tuning;
mod writing;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use shared::stream::alignment::Alignment;
use shared::units::{Millis, Sample, SampleIndex};
#[cfg(feature = "train")]
use training::backend::Device;

use self::tuning::Heard;
use super::event::Event;
use super::hub::Hub;
use super::outcome::Installing;
use super::source::{Asked, Request, Stop};
use crate::record::journal::{Entry, Journal};
use crate::record::protocol::Protocol;
use crate::record::session::{Action, Held, Input, Session, View};

/// How long it waits for samples before it looks for wishes: less than a person notices.
const WAIT: Duration = Duration::from_millis(20);

/// What is recorded, of whom, and where to.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// The folder that has a folder for each person.
    pub folder: PathBuf,
    /// Whose muscles.
    pub person: String,
    /// What is asked for.
    pub protocol: Protocol,
    /// The model file that is tuned afterwards, as a command names it.
    pub model: PathBuf,
    /// What tuning computes on.
    #[cfg(feature = "train")]
    pub device: Device,
    /// How many times faster a demo or a recording plays, to try a protocol out.
    pub speed: u32,
    /// Begin by itself when samples come, and end with the session: nobody looks at the cues.
    pub unattended: bool,
}

/// What a viewer wants of a session.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Wish {
    /// Of the session in progress.
    Action(Action),
    /// Nobody looks at the cues any more.
    LeaderLeft,
    /// Another session.
    Again,
    /// Tune the model on all of the person's recordings.
    Tune,
    /// Put the tuned model on the board.
    Install,
}

/// What a recorder works with.
#[derive(Debug)]
pub(super) struct Recorder {
    pub(super) options: RecordOptions,
    /// What `source` is, for the journal, and whether it is of nobody.
    pub(super) source: (String, bool),
    /// The serial port of the board that the tuned model is for.
    pub(super) port: Option<PathBuf>,
    /// What the source is asked through.
    pub(super) requests: SyncSender<Request>,
    /// The option of the same source, for another command.
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    pub(super) option: String,
    /// The model file's bytes.
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    pub(super) model: Vec<u8>,
    pub(super) hub: std::sync::Arc<Hub>,
    /// What a simulated person is asked for.
    pub(super) asked: Asked,
}

/// While it runs.
struct Running {
    recorder: Recorder,
    session: Session,
    journal: Option<Journal>,
    told: Option<View>,
    /// How the armband sits, as the board is aligned.
    placement: Alignment,
    trouble: String,
    /// What has happened to the journal, until the person goes on.
    notice: String,
    /// What was not kept of earlier sessions.
    unkept: Vec<Unkept>,
    tuning: Option<Receiver<Heard>>,
    /// The model file that was tuned last.
    tuned: Option<Vec<u8>>,
}

/// What was not kept of a session.
#[derive(Debug)]
struct Unkept {
    /// The journal of which no recordings could be made; none if it is not whole.
    journal: Option<PathBuf>,
    /// What viewers were told.
    told: String,
}

impl Recorder {
    /// Leads through sessions until it is stopped, or an unattended one is over; then ends and keeps the one in progress.
    ///
    /// # Errors
    /// When an unattended session cannot be written, or recordings of a session could not be made until the end.
    pub(super) fn run(
        self,
        events: &Receiver<Event>,
        wishes: &Receiver<Wish>,
        stop: &Stop,
    ) -> anyhow::Result<()> {
        let session = Session::new(self.options.protocol.clone());
        let mut running = Running {
            recorder: self,
            session,
            journal: None,
            told: None,
            placement: Alignment::NONE,
            trouble: String::new(),
            notice: String::new(),
            unkept: Vec::new(),
            tuning: None,
            tuned: None,
        };
        let mut led = Ok(());
        loop {
            running.tell();
            // Asked before the events are read: what was published before a stop is still taken.
            let stopped = stop.requested();
            for wish in wishes.try_iter() {
                running.wish(wish);
            }
            match events.recv_timeout(WAIT) {
                Ok(event) => {
                    running.event(event);
                    for event in events.try_iter().take(64) {
                        running.event(event);
                    }
                }
                Err(RecvTimeoutError::Timeout) if !stopped => {
                    let now = running.now();
                    running.handle(now, Input::Tick);
                }
                Err(_) => break,
            }
            running.flush();
            if running.recorder.options.unattended {
                match running.lead() {
                    Ok(false) => {}
                    Ok(true) => break,
                    Err(error) => {
                        led = Err(error);
                        break;
                    }
                }
            }
        }
        if running.journal.is_some() {
            running.wish(Wish::Action(Action::Finish));
            running.tell();
        }
        running.keep_the_rest().and(led)
    }
}

impl Running {
    fn now(&self) -> Millis {
        self.recorder.hub.millis()
    }

    fn event(&mut self, event: Event) {
        let now = self.now();
        match event {
            Event::Samples { first, emg, .. } => self.samples(now, SampleIndex(first), &emg),
            Event::Source {
                connected: false, ..
            } => {
                self.place(Alignment::NONE);
                self.handle(now, Input::Hold(Held::SourceLost));
            }
            Event::Alignment { turn, mirrored, .. } => self.place(Alignment::new(turn, mirrored)),
            _ => {}
        }
    }

    /// From the next sample on the armband sits so.
    fn place(&mut self, placement: Alignment) {
        if self.placement != placement {
            self.placement = placement;
            self.write_placement();
        }
    }

    fn write_placement(&mut self) {
        let (turn, mirrored) = (self.placement.turn(), self.placement.mirrored());
        if let Some(journal) = &mut self.journal {
            journal.entry(&Entry::Placement { turn, mirrored });
        }
    }

    fn samples(&mut self, now: Millis, first: SampleIndex, emg: &[Sample]) {
        let before = self.session.is_running();
        let count = emg.len() as u32;
        self.session.handle(now, Input::Samples { first, count });
        self.write_down();
        // The samples with which a session ends are its last; those with which it is held belong to another stream.
        let kept = self.session.is_running() || before && self.session.is_over();
        if let Some(journal) = &mut self.journal
            && kept
        {
            journal.samples(first, emg);
        }
        self.end_if_over();
        self.recorder.asked.read(first.plus(count));
    }

    fn handle(&mut self, now: Millis, input: Input) {
        self.session.handle(now, input);
        self.write_down();
        self.end_if_over();
    }

    fn wish(&mut self, wish: Wish) {
        let now = self.now();
        match wish {
            Wish::Action(action) => {
                if action == Action::Begin && self.journal.is_none() && !self.create() {
                    return;
                }
                if action == Action::Begin {
                    self.notice.clear();
                }
                self.handle(now, Input::Action(action));
            }
            Wish::LeaderLeft => self.handle(now, Input::Hold(Held::LeaderLeft)),
            Wish::Again if self.session.is_over() => {
                self.session = Session::new(self.recorder.options.protocol.clone());
                self.trouble.clear();
                self.notice.clear();
                self.recorder.hub.forget_session();
            }
            Wish::Tune if self.tuning.is_none() && self.journal.is_none() => self.tune(),
            Wish::Install if self.journal.is_none() => self.install(),
            Wish::Again | Wish::Tune | Wish::Install => {}
        }
    }

    /// Of an unattended session: begins it when samples come, and goes on after a wait; whether it is over.
    fn lead(&mut self) -> anyhow::Result<bool> {
        let is_over = self.session.is_over() && self.journal.is_none();
        if !is_over && !self.session.is_running() && self.session.has_stream() {
            self.wish(Wish::Action(Action::Begin));
        }
        anyhow::ensure!(self.trouble.is_empty(), "{}", self.trouble);
        Ok(is_over)
    }

    /// Tells viewers what has changed.
    pub(super) fn tell(&mut self) {
        let view = self.session.view();
        if self.told.as_ref() != Some(&view) {
            let told = [&self.trouble, &self.notice];
            let trouble = told.into_iter().find(|text| !text.is_empty());
            self.recorder.hub.publish(&Event::Session {
                view: view.clone(),
                trouble: trouble.cloned().unwrap_or_default(),
            });
            self.told = Some(view);
        }
        self.tell_tuning();
    }

    /// Asks the board's thread for it; that one tells what comes of it.
    fn install(&self) {
        let (Some(tuned), Some(_)) = (&self.tuned, &self.recorder.port) else {
            return;
        };
        let begun = Installing::running("waiting for the board");
        self.recorder.hub.publish(&Event::Installing(begun));
        // A source that takes no requests is ending.
        let _ = self
            .recorder
            .requests
            .try_send(Request::Install(tuned.clone()));
    }
}

impl Recorder {
    /// The person's folder.
    fn folder(&self) -> PathBuf {
        self.options.folder.join(&self.options.person)
    }
}
