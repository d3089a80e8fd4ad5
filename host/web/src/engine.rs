//! A source of a stream, the session that is recorded of it, and what a page asks of both; without I/O.
//!
//! ```text
//! pages    -- requests -->  Engine  -- messages { "type": .. } -------------------->  pages
//! devices  -- bytes ----->          -- { "line": .. }, { "radio": .. } ------------>  serial port, Bluetooth
//! storage  -- what became of it ->  -- { "name": .., "journal": .. } -------------->  a disk, or a browser's
//! ```
//!
//! `myointent live` and `record` run it on a thread; in the page that needs no program it runs in a worker, which passes the
//! same messages as JSON. Time is an argument, in ms of any clock.

mod opening;
mod recording;

use recordings::labels::motion::Motion;
use serde::{Serialize, Serializer};
use shared::myo::{self, Action, Uuid};
use shared::uart_line::command::Command;
use shared::units::{CHANNELS, Millis};

use crate::armband::{self, Armband, Now};
use crate::blocks::Blocks;
use crate::board::{Board, Unheard};
use crate::electrodes::Electrodes;
use crate::event::{Event, Known, ViewerId};
use crate::outcome::{InstallationState, SessionResult};
use crate::person::DemoPerson;
use crate::playback::{LATE, Playback};
use crate::radio::{ForRadio, RadioEvent, advertising_data};
use crate::record::journal::Header;
use crate::record::protocol::Protocol;
use crate::record::remark::Remark;
use crate::record::session::{self, HoldReason, Input};
use crate::request::{NotDone, SessionCommand, SourceRequest, ViewerMessage};
use crate::said::Said;
use crate::scored_pipeline::ScoredPipeline;
use crate::simulated_board::{STEP_MS, SimulatedBoard};

use self::opening::chosen;
pub use self::opening::{Settings, Wanted};
use self::recording::{Files, RecordedSession};

/// Pause between two ticks of an armband's session in ms, as on a board.
const TICK_MS: f64 = 50.0;

/// Longest pause between two calls of [`Engine::tick`] in ms.
pub const WAIT_MS: f64 = 10.0;

/// Output of an engine.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(untagged)]
pub enum Output {
    /// Event for all viewers.
    Event(Event),
    /// Event for one viewer.
    #[serde(serialize_with = "answer")]
    Answer(ViewerId, Event),
    /// Command to the board.
    Line {
        /// Line to send.
        line: String,
    },
    /// Commands to the board, to be sent before its port is closed.
    Leave {
        /// Lines to send.
        leave: String,
    },
    /// Action of the radio.
    #[serde(serialize_with = "for_radio")]
    Radio(Action),
    /// New lines of a journal, to be kept.
    Journal(Lines),
    /// Line of a remark, to be kept.
    Remark(Lines),
    /// Tune a model on the recordings; never without a program.
    #[serde(skip)]
    Tune,
    /// Install the tuned model on the board; never without a program.
    #[serde(skip)]
    Install,
}

/// New lines of a journal, or of the notes beside it.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Lines {
    /// Name of the journal: `anna_20261122T110323Z_quick`.
    pub name: String,
    /// Whole lines.
    pub journal: String,
    /// Whether they are the first ones.
    #[serde(skip)]
    pub begins: bool,
    /// Whether they are the last ones.
    #[serde(skip)]
    pub is_over: bool,
}

/// Outcome of keeping a journal's lines.
#[derive(Clone, PartialEq, Debug)]
pub enum Stored {
    /// The journal cannot be begun, with the reason.
    Refused(Said),
    /// It is written again.
    Written,
    /// It had lost its name and was written anew, with a notice.
    Anew(Said),
    /// It cannot be written at the moment, with advice.
    Failed(HoldReason, Said),
    /// It is left without recordings, with advice.
    Left(Said),
    /// A note is not kept, with the reason; the session goes on.
    Unkept(Said),
    /// Recordings were made of it.
    Kept(SessionResult),
}

fn answer<S: Serializer>(_: &ViewerId, event: &Event, output: S) -> Result<S::Ok, S::Error> {
    event.serialize(output)
}

fn for_radio<S: Serializer>(action: &Action, output: S) -> Result<S::Ok, S::Error> {
    ForRadio::of(*action).serialize(output)
}

/// Simulated board, and the time of its next step.
struct Simulated {
    board: Box<SimulatedBoard>,
    due: f64,
}

/// Source that runs.
#[derive(Default)]
#[expect(clippy::large_enum_variant, reason = "an engine has one")]
enum Running {
    /// Nothing: the source was refused.
    #[default]
    Nothing,
    Playback {
        playback: Playback,
        /// Time of the next notification, and the time between two.
        due: f64,
        period: f64,
    },
    Board {
        board: Board,
        port: String,
        /// Whether the port is open: what is asked for before is not done after.
        is_open: bool,
        /// Simulated board in place of one at a port.
        simulated: Option<Simulated>,
    },
    Armband {
        armband: Armband,
        /// Time of the next tick.
        due: f64,
        /// Whether the session scans for the armband that the wearer has chosen, which the next tick finds; none for a radio that
        /// scans itself.
        scans: Option<bool>,
    },
}

/// Source, the session that is recorded of it, and the page that leads. Without a source until one is opened.
#[derive(Default)]
pub struct Engine {
    running: Running,
    outputs: Outputs,
    /// Description of the source for a journal, and whether its samples are synthetic.
    source: (String, bool),
    /// Viewer whose requests are done; none until one asks.
    leader: Option<ViewerId>,
}

/// Outputs that were not taken yet, and the session that takes part in the events.
#[derive(Default)]
struct Outputs {
    waiting: Vec<Output>,
    known: Known,
    electrodes: Electrodes,
    blocks: Blocks,
    recording: Option<RecordedSession>,
    /// Recordings made last.
    files: Option<Files>,
}

impl Outputs {
    fn event(&mut self, now: f64, event: Event) {
        if let Some(recording) = &mut self.recording {
            recording.event(millis(now), &event);
        }
        let more = [self.electrodes.take(&event), self.blocks.take(now, &event)];
        for event in std::iter::once(event).chain(more.into_iter().flatten()) {
            self.known.take(&event);
            let score = event.score();
            self.waiting.push(Output::Event(event));
            if let Some(score) = score {
                self.remark(now, |at| Some(Remark::blocks(at, score)));
            }
        }
    }

    /// Ends box and blocks without a score, if somebody plays.
    fn cancel_blocks(&mut self, now: f64) {
        if let Some(ended) = self.blocks.cancel(now) {
            self.event(now, ended);
        }
    }

    /// Keeps a remark on the session, made at a time in words. Without a session it is of nobody.
    fn remark(&mut self, now: f64, remark: impl FnOnce(String) -> Option<Remark>) {
        let Some(recording) = &mut self.recording else {
            return;
        };
        let Some(lines) = recording.remark(now, remark) else {
            return;
        };
        if let Some(files) = self.files.as_mut().filter(|files| files.name == lines.name) {
            files.notes += &lines.journal;
        }
        self.waiting.push(Output::Remark(lines));
        let remarks = recording.remarks().to_vec();
        self.event(now, Event::Remarks { remarks });
    }

    /// Sends the board a command.
    fn send(&mut self, simulated: &mut Option<Simulated>, command: &Command) {
        let line = command.to_string();
        match simulated {
            Some(simulated) => simulated.board.receive(line.as_bytes()),
            None => self.waiting.push(Output::Line { line }),
        }
    }

    fn made(&mut self, files: Files) {
        let kept = files.result.clone().map(Event::Kept);
        self.waiting.extend(kept.map(Output::Event));
        self.files = Some(files);
    }
}

impl Engine {
    /// Time until the next call of [`Engine::tick`] in ms.
    pub fn wait(&self, now: f64) -> f64 {
        match &self.running {
            Running::Playback { due, .. } => (due - now).clamp(0.0, WAIT_MS),
            _ => WAIT_MS,
        }
    }

    /// Lets time pass.
    pub fn tick(&mut self, now: f64) {
        if let Some(recording) = &mut self.outputs.recording {
            recording.handle(millis(now), Input::Tick);
        }
        self.simulate(now);
        let outputs = &mut self.outputs;
        match &mut self.running {
            Running::Nothing => {}
            Running::Playback {
                playback,
                due,
                period,
            } => {
                if now - *due > LATE.as_secs_f64() * 1000.0 {
                    *due = now;
                }
                while *due <= now {
                    let session = outputs.recording.as_ref().map(RecordedSession::cue);
                    playback.ask(session, outputs.blocks.hand());
                    playback.step(*due, &mut |event| outputs.event(now, event));
                    *due += *period;
                }
            }
            Running::Board { is_open: false, .. } => self.commands(now),
            Running::Board { board, port, .. } => {
                if let Some(change) = board.change(millis(now)) {
                    let steps = change
                        .state
                        .map_or_else(Vec::new, |state| state.steps(port));
                    let why = change.state.map(Unheard::said);
                    let state = source("port", port, why.is_none(), why, steps);
                    outputs.event(now, state);
                }
                self.commands(now);
            }
            Running::Armband { due, scans, .. } => {
                if now >= *due {
                    *due = now + TICK_MS;
                    if *scans == Some(true) {
                        *scans = Some(false);
                        self.radio(now, &advertisement());
                    }
                    self.handle(now, myo::MyoEvent::Tick);
                }
            }
        }
    }

    /// Lets the time of a simulated board pass, and takes what it sends.
    fn simulate(&mut self, now: f64) {
        while let Running::Board {
            simulated: Some(Simulated { board, due }),
            ..
        } = &mut self.running
        {
            if now - *due > LATE.as_secs_f64() * 1000.0 {
                *due = now;
            }
            if *due > now {
                return;
            }
            *due += f64::from(STEP_MS);
            let outputs = &self.outputs;
            let session = outputs.recording.as_ref().map(RecordedSession::cue);
            let lines = board.step(session, outputs.blocks.hand());
            self.heard(now, lines.as_bytes());
        }
    }

    /// Sends the board the commands that are due, and says how an installation goes.
    fn commands(&mut self, now: f64) {
        let Running::Board {
            board,
            is_open,
            simulated,
            ..
        } = &mut self.running
        else {
            return;
        };
        let outputs = &mut self.outputs;
        if *is_open {
            while let Some(command) = board.command(millis(now)) {
                outputs.send(simulated, &command);
            }
        } else {
            board.wait(millis(now));
        }
        let installed = board.installation(&mut |event| outputs.event(now, event));
        if let Some(Ok(scored)) = installed.map(ScoredPipeline::open) {
            let model = board.set_model(scored);
            outputs.event(now, model);
        }
    }

    /// Installs a model on the board, or without one runs it here.
    ///
    /// # Errors
    /// There is no source.
    pub fn install(&mut self, now: f64, file: &[u8]) -> Result<(), NotDone> {
        let outputs = &mut self.outputs;
        let emit = &mut |event| outputs.event(now, event);
        if let Running::Board { board, .. } = &mut self.running {
            board.install(millis(now), file, emit);
            self.commands(now);
            return Ok(());
        }
        let scored = match ScoredPipeline::open(file) {
            Ok(scored) => scored,
            Err(error) => {
                emit(Event::Installing(InstallationState::refused(Said::of(
                    "model", &error,
                ))));
                return Ok(());
            }
        };
        let checksum = scored.model().checksum;
        match &mut self.running {
            Running::Playback { playback, .. } => playback.set_model(now, scored, emit),
            Running::Armband { armband, .. } => armband.set_model(time(now), scored, emit),
            _ => return Err(NotDone::NoBoard),
        }
        emit(Event::Installing(InstallationState::here(checksum)));
        Ok(())
    }

    /// Takes that the board's port is open, which begins the dialogue, or cannot be used: the reason, and steps that help.
    pub fn port(&mut self, now: f64, opened: Result<(), (Said, Vec<Said>)>) {
        let Running::Board {
            board,
            port,
            is_open,
            ..
        } = &mut self.running
        else {
            return;
        };
        *is_open = opened.is_ok();
        let (why, steps) = match opened {
            Ok(()) => {
                board.connected(millis(now));
                (Unheard::NothingYet.said(), Vec::new())
            }
            Err(missing) => {
                board.ended(millis(now));
                missing
            }
        };
        let state = source("port", port, false, Some(why), steps);
        self.outputs.event(now, state);
    }

    /// Takes what a device has sent: bytes of a board, or an event of a browser's Bluetooth as JSON. What is neither is dropped.
    pub fn heard(&mut self, now: f64, bytes: &[u8]) {
        match &mut self.running {
            Running::Board { board, .. } => {
                let outputs = &mut self.outputs;
                board.bytes(millis(now), now, bytes, &mut |event| {
                    outputs.event(now, event)
                });
                self.commands(now);
            }
            Running::Armband { .. } => {
                if let Ok(event) = serde_json::from_slice(bytes) {
                    self.radio(now, &event);
                }
            }
            Running::Nothing | Running::Playback { .. } => {}
        }
    }

    /// Takes an event of the radio.
    pub fn radio(&mut self, now: f64, event: &RadioEvent) {
        self.handle(now, event.as_event());
    }

    /// Takes an event of something else, for all viewers.
    pub fn event(&mut self, now: f64, event: Event) {
        self.outputs.event(now, event);
    }

    /// Takes a message of the only page, as JSON; `file` is the journal or model that it is about, or empty.
    pub fn request(&mut self, now: f64, text: &[u8], file: &[u8]) {
        let Ok(message) = serde_json::from_slice::<ViewerMessage>(text) else {
            return self.refuse(1, NotDone::Unknown);
        };
        let result = match &message {
            ViewerMessage::Record {
                person,
                protocol,
                time,
            } => self.prepare(now, person, protocol, *time),
            ViewerMessage::Recover { name } => match Files::recover(name, file) {
                Some(files) => {
                    self.outputs.made(files);
                    Ok(())
                }
                None => Err(NotDone::Unknown),
            },
            ViewerMessage::Install => self.install(now, file),
            ViewerMessage::Keep => {
                let files = self.outputs.files.iter().flat_map(Files::all);
                let files = files.map(|(name, content)| Event::File { name, content });
                self.outputs.waiting.extend(files.map(Output::Event));
                Ok(())
            }
            message => self.act(now, 1, message),
        };
        if let Err(why) = result {
            self.refuse(1, why);
        }
    }

    /// Takes a message of one of several viewers: the first to send a request has the lead until it leaves, and all others watch.
    pub fn request_of(&mut self, now: f64, viewer: ViewerId, message: &ViewerMessage) {
        let is_ping = matches!(message, ViewerMessage::Ping { .. });
        if !is_ping && self.leader.is_none() {
            self.leader = Some(viewer);
            self.lead(now);
        }
        let result = if is_ping || self.leader == Some(viewer) {
            self.act(now, viewer, message)
        } else {
            Err(NotDone::Watches)
        };
        if let Err(why) = result {
            self.refuse(viewer, why);
        }
    }

    /// Takes that a viewer has left.
    pub fn left(&mut self, now: f64, viewer: ViewerId) {
        if self.leader.take_if(|leader| *leader == viewer).is_some() {
            self.lead(now);
            if let Some(recording) = &mut self.outputs.recording {
                recording.handle(millis(now), Input::Hold(HoldReason::LeaderLeft));
            }
        }
    }

    fn lead(&mut self, now: f64) {
        let viewer = self.leader;
        self.outputs.event(now, Event::Lead { viewer });
    }

    fn refuse(&mut self, viewer: ViewerId, why: NotDone) {
        let refused = Event::refused(why);
        self.outputs.waiting.push(Output::Answer(viewer, refused));
    }

    /// Does what a message asks for.
    ///
    /// # Errors
    /// The reason why it is not done.
    fn act(&mut self, now: f64, viewer: ViewerId, message: &ViewerMessage) -> Result<(), NotDone> {
        let recording = self.outputs.recording.as_mut().ok_or(NotDone::NoSession);
        match message {
            ViewerMessage::Ping { sent } => {
                let pong = Event::Pong { sent: *sent, now };
                self.outputs.waiting.push(Output::Answer(viewer, pong));
            }
            ViewerMessage::Mark { sample, text } => {
                self.outputs.event(now, Event::of_mark(*sample, text));
            }
            ViewerMessage::Session { command } => match command {
                SessionCommand::Action(action) => {
                    recording?.act(now, *action);
                    self.outputs.cancel_blocks(now);
                }
                SessionCommand::Again => {
                    if recording?.restart() {
                        let remarks = Vec::new();
                        self.outputs.event(now, Event::Remarks { remarks });
                    }
                }
                SessionCommand::Tune => self.outputs.waiting.extend(recording?.job(Output::Tune)?),
                SessionCommand::Install => {
                    let install = recording?.job(Output::Install)?;
                    self.outputs.waiting.extend(install);
                }
            },
            ViewerMessage::Gesture { class } => match Motion::from_name(class) {
                None | Some(Motion::Unknown) => return Err(NotDone::Unknown),
                Some(motion) => recording?.act(now, session::Action::Mark(motion)),
            },
            ViewerMessage::Blocks { begin: true } => {
                let begun = self.outputs.blocks.begin(now);
                self.outputs.event(now, begun);
            }
            ViewerMessage::Blocks { begin: false } => {
                self.outputs.cancel_blocks(now);
            }
            ViewerMessage::Note { text } => {
                recording?;
                self.outputs.remark(now, |at| Remark::note(at, text));
            }
            ViewerMessage::Source(request) => match request {
                SourceRequest::Place { turn, .. } if usize::from(*turn) >= CHANNELS => {
                    return Err(NotDone::Unknown);
                }
                SourceRequest::Bind if !matches!(self.running, Running::Board { .. }) => {
                    return Err(NotDone::NoBoard);
                }
                SourceRequest::Turn => match self.simulated_person() {
                    Some(person) => person.turn(),
                    None => return Err(NotDone::NoTurn),
                },
                request => self.source(now, *request),
            },
            // Of a page without a program.
            ViewerMessage::Record { .. }
            | ViewerMessage::Recover { .. }
            | ViewerMessage::Install
            | ViewerMessage::Keep => return Err(NotDone::Unknown),
        }
        Ok(())
    }

    fn simulated_person(&mut self) -> Option<&mut DemoPerson> {
        match &mut self.running {
            Running::Playback { playback, .. } => playback.person(),
            Running::Board { simulated, .. } => Some(&mut simulated.as_mut()?.board.person),
            Running::Nothing | Running::Armband { .. } => None,
        }
    }

    fn source(&mut self, now: f64, request: SourceRequest) {
        let outputs = &mut self.outputs;
        let emit = &mut |event| outputs.event(now, event);
        match &mut self.running {
            Running::Nothing | Running::Board { is_open: false, .. } => {}
            Running::Playback { playback, .. } => playback.request(now, request, emit),
            Running::Armband { armband, .. } => armband.request(time(now), request, emit),
            Running::Board { simulated, .. } => {
                if let Some(command) = request.command() {
                    outputs.send(simulated, &command);
                }
            }
        }
    }

    /// Prepares a session that the page keeps.
    fn prepare(
        &mut self,
        now: f64,
        person: &str,
        protocol: &str,
        time: f64,
    ) -> Result<(), NotDone> {
        let protocol = Protocol::find(protocol).map_err(|_| NotDone::Unknown)?;
        self.record(now, person.to_owned(), protocol, time, true);
        self.outputs.event(now, Event::hello(now, 1, true, false));
        let known = self.outputs.known.events().cloned();
        self.outputs.waiting.extend(known.map(Output::Event));
        Ok(())
    }

    /// Prepares a session. `time` is the present time in ms since 1970. Recordings are made here at its end, or else by who stores
    /// the journal.
    pub fn record(
        &mut self,
        now: f64,
        person: String,
        protocol: Protocol,
        time: f64,
        makes_files: bool,
    ) {
        let (source, synthetic) = self.source.clone();
        let header = Header {
            person,
            source,
            synthetic,
            ..Header::default()
        };
        let recording = RecordedSession::new(header, protocol, time - now, makes_files);
        self.outputs.recording = Some(recording);
        let remarks = Vec::new();
        self.outputs.known.take(&Event::Remarks { remarks });
    }

    /// Takes what became of lines of the journal.
    pub fn stored(&mut self, now: f64, stored: Stored) {
        if let Stored::Kept(result) = stored {
            self.outputs.event(now, Event::Kept(result));
        } else if let Some(recording) = &mut self.outputs.recording {
            recording.stored(millis(now), stored);
        }
    }

    /// Leads through a session that nobody looks at: begins it when samples come, and continues it after a hold. Returns whether
    /// it is over.
    ///
    /// # Errors
    /// The trouble that keeps it from being recorded.
    pub fn lead_unattended(&mut self, now: f64) -> Result<bool, Said> {
        let recording = self.outputs.recording.as_mut();
        recording.map_or(Ok(false), |own| own.lead_unattended(now))
    }

    /// Ends the session that is recorded.
    pub fn finish(&mut self, now: f64) {
        if let Some(recording) = &mut self.outputs.recording {
            recording.finish(now);
        }
    }

    /// Returns the outputs since the last call.
    pub fn take(&mut self) -> Vec<Output> {
        let outputs = &mut self.outputs;
        if let Some(recording) = &mut outputs.recording
            && let Some(files) = recording.changes(&mut outputs.waiting)
        {
            outputs.made(files);
        }
        std::mem::take(&mut outputs.waiting)
    }

    fn handle(&mut self, now: f64, event: myo::MyoEvent<'_>) {
        let Running::Armband { armband, scans, .. } = &mut self.running else {
            return;
        };
        let outputs = &mut self.outputs;
        armband.handle(
            time(now),
            event,
            &mut |output| match (output, &mut *scans) {
                (armband::Output::Event(event), _) => outputs.event(now, event),
                (armband::Output::Radio(Action::Scan), Some(scans)) => *scans = true,
                (armband::Output::Radio(Action::StopScan), Some(scans)) => *scans = false,
                (armband::Output::Radio(action), _) => outputs.waiting.push(Output::Radio(action)),
            },
        );
    }
}

/// Time of an armband's session.
fn time(now: f64) -> Now {
    Now {
        session: millis(now),
        at: now,
    }
}

/// Time as a wrapping clock like a board's.
fn millis(now: f64) -> Millis {
    Millis(now as u64 as u32)
}

/// Advertisement of the armband that the wearer has chosen.
fn advertisement() -> RadioEvent {
    RadioEvent::Advertisement {
        address: chosen(),
        rssi: 127,
        data: advertising_data([Uuid::CONTROL.to_le_bytes()]),
    }
}

fn source(
    kind: &'static str,
    name: &str,
    connected: bool,
    detail: Option<Said>,
    steps: Vec<Said>,
) -> Event {
    Event::Source {
        kind,
        name: name.to_owned(),
        connected,
        detail,
        steps,
    }
}

#[cfg(test)]
mod tests;
