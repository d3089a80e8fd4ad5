//! Sources of the page that needs no program, in a worker of the browser.
//!
//! ```text
//! the page  -- requests -->  Tab  -- messages { "type": .. } -------------------->  the page
//! devices   -- bytes ----->       -- { "line": .. }, { "radio": .. } ------------>  Web Serial, Web Bluetooth
//! ```
//!
//! Every output is an element of a JSON array. Time is an argument, in ms of the worker's clock.

mod recording;

use std::path::Path;

use recordings::labels::motion::Motion;
use recordings::{LoadOptions, Recording, load_bytes};
use serde::{Deserialize, Serialize};
use shared::model::file::Model;
use shared::myo::{self, Action, Address, Characteristic, Uuid};
use shared::uart_line::command::Command;
use shared::units::Millis;

use crate::armband::{Armband, Now, Output};
use crate::board::{self, Board};
use crate::dialogue::Losses;
use crate::electrodes::Electrodes;
use crate::event::Event;
use crate::person::{Cues, Person};
use crate::playback::{LATE, PERIOD, Playback, SampleSource};
use crate::radio::{RadioEvent, advertising_data};
use crate::record::journal::Header;
use crate::record::session::{self, Input};
use crate::request::{SourceRequest, UNKNOWN, ViewerMessage};
use crate::scored_pipeline::ScoredPipeline;
use crate::{SHIPPED, SharedCue, demo, radio};

use self::recording::{Files, RecordedSession, RecordingRequest};

/// Address that stands for the armband that the wearer has chosen: a browser names none.
const CHOSEN: [u8; 6] = [1, 0, 0, 0, 0, 0xc0];

/// Name of the port that the user has chosen: a browser names none.
const PORT: &str = "USB";

/// Pause between two ticks of an armband's session in ms, as on a board.
const TICK_MS: f64 = 50.0;

/// Source that a page asks for.
#[derive(Clone, PartialEq, Eq, Debug, Deserialize)]
#[serde(tag = "source", rename_all = "snake_case", deny_unknown_fields)]
pub enum Wanted {
    /// Simulated person.
    Demo,
    /// File of a recording.
    Recording {
        /// Name of the file.
        name: String,
    },
    /// Board on a serial port.
    Port,
    /// Armband.
    Bluetooth {
        /// Name of the armband.
        name: String,
    },
}

/// Output for a device.
#[derive(Serialize)]
#[serde(untagged)]
enum ForDevice {
    /// Command to send.
    Line {
        line: String,
    },
    /// Command to send before the port is closed.
    Leave {
        leave: String,
    },
    Radio(ForRadio),
}

/// Action for the browser's Bluetooth. There is no scan: the wearer has chosen the armband.
#[derive(Serialize)]
#[serde(tag = "radio", rename_all = "snake_case")]
enum ForRadio {
    Connect,
    Discover,
    Disconnect,
    Read {
        #[serde(serialize_with = "radio::uuid")]
        characteristic: Characteristic,
    },
    Subscribe {
        #[serde(serialize_with = "radio::uuid")]
        characteristic: Characteristic,
    },
    Write {
        #[serde(serialize_with = "radio::uuid")]
        characteristic: Characteristic,
        bytes: Vec<u8>,
    },
}

impl ForRadio {
    /// Action of a session for the browser; none for what the browser has no part in.
    fn of(action: Action) -> Option<Self> {
        Some(match action {
            Action::Connect(_) => Self::Connect,
            Action::Discover => Self::Discover,
            Action::Disconnect => Self::Disconnect,
            Action::Read(characteristic) => Self::Read { characteristic },
            Action::Subscribe(characteristic) => Self::Subscribe { characteristic },
            Action::Write(characteristic, payload) => Self::Write {
                characteristic,
                bytes: payload.as_slice().to_vec(),
            },
            _ => return None,
        })
    }
}

/// Source that runs.
#[expect(clippy::large_enum_variant, reason = "a worker has one")]
enum Running {
    /// Nothing: the source was refused.
    Nothing,
    Playback {
        playback: Playback,
        /// Time of the next notification.
        due: f64,
    },
    Board {
        board: Board<'static>,
        model: Model<'static>,
        /// Whether the board runs the page's model: then its scores are shown.
        is_same: bool,
    },
    Armband {
        armband: Armband,
        /// Time of the next tick.
        due: f64,
        /// Whether the session scans, and finds the chosen armband with the next tick.
        scans: bool,
    },
}

/// Source of a page, and the session that it records. A page that changes its source begins another one, in another worker.
pub struct Tab {
    running: Running,
    outputs: Outputs,
    /// How the source is called in a journal, and whether its samples are synthetic.
    source: (String, bool),
}

/// Outputs that were not taken yet, and the session that takes part in the events.
#[derive(Default)]
struct Outputs {
    /// Elements of a JSON array.
    text: String,
    electrodes: Electrodes,
    recording: Option<RecordedSession>,
    /// Recordings made last.
    files: Option<Files>,
}

impl Outputs {
    fn push(text: &mut String, output: &impl Serialize) {
        // Maps with keys of text alone: they can be written.
        let Ok(output) = serde_json::to_string(output) else {
            return;
        };
        if !text.is_empty() {
            text.push(',');
        }
        *text += &output;
    }

    fn device(&mut self, output: &ForDevice) {
        Self::push(&mut self.text, output);
    }

    fn event(&mut self, now: f64, event: &Event) {
        Self::push(&mut self.text, event);
        if let Some(faults) = self.electrodes.take(event) {
            Self::push(&mut self.text, &faults);
        }
        if let Some(recording) = &mut self.recording {
            recording.event(millis(now), event);
        }
    }

    /// Gives what is new of the session.
    fn changes(&mut self) {
        if let Some(recording) = &mut self.recording
            && let Some(files) = recording.changes(&mut self.text)
        {
            self.made(files);
        }
    }

    fn made(&mut self, files: Files) {
        Self::push(&mut self.text, &Event::Kept(files.result.clone()));
        self.files = Some(files);
    }
}

impl Tab {
    /// Opens a source. `file` is the content of a recording's file, and `model` that of a model file; none for the shipped one.
    pub fn open(now: f64, wanted: &Wanted, file: &[u8], model: Option<&[u8]>) -> Self {
        let mut tab = Self {
            running: Running::Nothing,
            outputs: Outputs::default(),
            source: match wanted {
                Wanted::Demo => ("demo".to_owned(), true),
                Wanted::Recording { name } => (format!("replay of {name}"), false),
                Wanted::Port => (format!("port {PORT}"), false),
                Wanted::Bluetooth { name } => (format!("{name} over Bluetooth"), false),
            },
        };
        tab.outputs.event(now, &Event::hello(now, 1, false));
        match tab.run(now, wanted, file, model) {
            Ok(running) => tab.running = running,
            Err(why) => {
                let (kind, name) = match wanted {
                    Wanted::Demo => ("demo", String::new()),
                    Wanted::Recording { name } => ("replay", name.clone()),
                    Wanted::Port => ("port", PORT.to_owned()),
                    Wanted::Bluetooth { name } => ("bluetooth", name.clone()),
                };
                tab.outputs.event(
                    now,
                    &Event::Source {
                        kind,
                        name,
                        connected: false,
                        detail: why,
                        steps: Vec::new(),
                    },
                );
            }
        }
        tab
    }

    fn run(
        &mut self,
        now: f64,
        wanted: &Wanted,
        file: &[u8],
        model: Option<&[u8]>,
    ) -> Result<Running, String> {
        let scored =
            ScoredPipeline::open(model.unwrap_or(SHIPPED)).map_err(|error| error.to_string())?;
        let outputs = &mut self.outputs;
        let mut emit = |event: Event| outputs.event(now, &event);
        Ok(match wanted {
            Wanted::Demo => {
                let person = Person::new(demo::follower(), Cues::List(demo::cues()));
                let named = ("demo", "simulated arm".to_owned());
                let samples = SampleSource::Person(Box::new(person));
                let playback = Playback::begin(named, samples, scored, now, &mut emit);
                Running::Playback { playback, due: now }
            }
            Wanted::Recording { name } => {
                let recording = read(name, file)?;
                let named = ("replay", recording.full_name());
                let samples = SampleSource::Recording {
                    samples: recording.samples,
                    labels: recording.labels,
                };
                let playback = Playback::begin(named, samples, scored, now, &mut emit);
                Running::Playback { playback, due: now }
            }
            Wanted::Port => {
                outputs.event(now, &port_state(false, board::NOTHING_YET, Vec::new()));
                let leave = Command::Raw(false).to_string();
                outputs.device(&ForDevice::Leave { leave });
                let model = *scored.model();
                let scored = Box::leak(Box::new(scored));
                Running::Board {
                    board: Board::new(millis(now), Losses::default(), false, Some(scored)),
                    model,
                    is_same: false,
                }
            }
            Wanted::Bluetooth { name } => Running::Armband {
                armband: Armband::begin(
                    myo::Settings {
                        pinned: Some(chosen()),
                        ..myo::Settings::default()
                    },
                    ("this browser", Some(name.clone())),
                    scored,
                    now,
                    &mut emit,
                ),
                due: now,
                scans: false,
            },
        })
    }

    /// Lets time pass; to be called every 10 ms.
    pub fn tick(&mut self, now: f64) {
        if let Some(recording) = &mut self.outputs.recording {
            recording.handle(millis(now), Input::Tick);
        }
        let outputs = &mut self.outputs;
        match &mut self.running {
            Running::Nothing => {}
            Running::Playback { playback, due } => {
                if now - *due > LATE.as_secs_f64() * 1000.0 {
                    *due = now;
                }
                while *due <= now {
                    playback.step(*due, &mut |event| outputs.event(now, &event));
                    *due += PERIOD.as_secs_f64() * 1000.0;
                }
            }
            Running::Board { board, .. } => {
                if let Some(change) = board.change(millis(now)) {
                    let steps = if change.is_silent {
                        board::silent(PORT)
                    } else {
                        Vec::new()
                    };
                    outputs.event(
                        now,
                        &port_state(change.state.is_empty(), change.state, steps),
                    );
                }
                self.commands(now);
            }
            Running::Armband { due, scans, .. } => {
                if now >= *due {
                    *due = now + TICK_MS;
                    if std::mem::take(scans) {
                        self.radio(now, &advertisement());
                    }
                    self.handle(now, myo::Event::Tick);
                }
            }
        }
    }

    /// Sends the board the commands that are due, and says how an installation goes.
    fn commands(&mut self, now: f64) {
        let Running::Board {
            board,
            model,
            is_same,
        } = &mut self.running
        else {
            return;
        };
        let outputs = &mut self.outputs;
        while let Some(command) = board.command(millis(now)) {
            let line = command.to_string();
            outputs.device(&ForDevice::Line { line });
        }
        let installed = board.installation(&mut |event| outputs.event(now, &event));
        if let Some(Ok(scored)) = installed.map(ScoredPipeline::open) {
            (*model, *is_same) = (*scored.model(), false);
            board.score(Box::leak(Box::new(scored)));
        }
    }

    /// Takes what a device has sent: bytes of a board, or an event of the browser's Bluetooth as JSON. What is neither is dropped.
    pub fn heard(&mut self, now: f64, bytes: &[u8]) {
        match &mut self.running {
            Running::Board {
                board,
                model,
                is_same,
            } => {
                let outputs = &mut self.outputs;
                board.bytes(millis(now), now, bytes, &mut |event| {
                    if let Event::Board { model: runs, .. } = &event {
                        let was_same = *is_same;
                        *is_same = *runs == Some(format!("{:08x}", model.checksum));
                        if *is_same && !was_same {
                            outputs.event(now, &Event::of_model(model));
                        }
                    }
                    if *is_same || !matches!(event, Event::Scores { .. }) {
                        outputs.event(now, &event);
                    }
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

    /// Takes a message of the page; `file` is the journal or model that it is about, or empty.
    pub fn request(&mut self, now: f64, text: &[u8], file: &[u8]) {
        if let Ok(request) = serde_json::from_slice(text) {
            return self.record(now, request, file);
        }
        let Ok(message) = serde_json::from_slice::<ViewerMessage>(text) else {
            return self.refuse(now, "");
        };
        match message {
            ViewerMessage::Ping { sent } => self.outputs.event(now, &Event::Pong { sent, now }),
            ViewerMessage::Mark { sample, text } => {
                self.outputs.event(now, &Event::of_mark(sample, &text));
            }
            ViewerMessage::Session { command } => {
                let recording = self.outputs.recording.as_mut();
                if !recording.is_some_and(|own| own.command(millis(now), now, command)) {
                    self.refuse(now, message.name());
                }
            }
            ViewerMessage::Gesture { ref class } => {
                let motion = Motion::from_name(class);
                match (&mut self.outputs.recording, motion) {
                    (Some(recording), Some(motion)) => {
                        recording.handle(millis(now), Input::Action(session::Action::Mark(motion)));
                    }
                    _ => self.refuse(now, message.name()),
                }
            }
            message => match message.for_source() {
                Some(request) => self.source(now, &request),
                None => self.refuse(now, message.name()),
            },
        }
    }

    fn record(&mut self, now: f64, request: RecordingRequest, file: &[u8]) {
        match request {
            RecordingRequest::Record {
                person,
                protocol,
                time,
            } => {
                let cue = SharedCue::default();
                let (source, synthetic) = self.source.clone();
                let header = Header {
                    person,
                    protocol,
                    source,
                    synthetic,
                    ..Header::default()
                };
                let Some(recording) = RecordedSession::new(header, time - now, cue.clone()) else {
                    return self.refuse(now, "record");
                };
                if let Running::Playback { playback, .. } = &mut self.running {
                    playback.follow(cue);
                }
                self.outputs.recording = Some(recording);
            }
            RecordingRequest::Recover { name } => match Files::of(&name, file) {
                Some(files) => self.outputs.made(files),
                None => self.refuse(now, "recover"),
            },
            RecordingRequest::Install => {
                let outputs = &mut self.outputs;
                match &mut self.running {
                    Running::Board { board, .. } => {
                        board.install(millis(now), file, &mut |event| outputs.event(now, &event));
                        self.commands(now);
                    }
                    _ => self.refuse(now, "install"),
                }
            }
            RecordingRequest::Keep => {
                for (name, content) in self.outputs.files.iter().flat_map(|own| &own.files) {
                    let (name, content) = (name.clone(), content.clone());
                    Outputs::push(&mut self.outputs.text, &Event::File { name, content });
                }
            }
        }
    }

    /// Returns the outputs since the last call as a JSON array.
    pub fn take(&mut self) -> String {
        self.outputs.changes();
        format!("[{}]", std::mem::take(&mut self.outputs.text))
    }

    fn source(&mut self, now: f64, request: &SourceRequest) {
        let outputs = &mut self.outputs;
        let emit = &mut |event| outputs.event(now, &event);
        match &mut self.running {
            Running::Nothing => {}
            Running::Playback { playback, .. } => playback.request(now, request, emit),
            Running::Armband { armband, .. } => armband.request(time(now), request, emit),
            Running::Board { .. } => {
                let line = request.command().map(|command| command.to_string());
                if let Some(line) = line {
                    outputs.device(&ForDevice::Line { line });
                }
            }
        }
    }

    fn refuse(&mut self, now: f64, request: &'static str) {
        let text = UNKNOWN;
        self.outputs.event(now, &Event::Refused { request, text });
    }

    fn radio(&mut self, now: f64, event: &RadioEvent) {
        self.handle(now, event.as_event());
    }

    fn handle(&mut self, now: f64, event: myo::Event<'_>) {
        let Running::Armband { armband, scans, .. } = &mut self.running else {
            return;
        };
        let outputs = &mut self.outputs;
        armband.handle(time(now), event, &mut |output| match output {
            Output::Event(event) => outputs.event(now, &event),
            Output::Radio(Action::Scan) => *scans = true,
            Output::Radio(Action::StopScan) => *scans = false,
            Output::Radio(action) => {
                if let Some(action) = ForRadio::of(action) {
                    outputs.device(&ForDevice::Radio(action));
                }
            }
        });
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

/// The armband that the wearer has chosen.
const fn chosen() -> Address {
    Address {
        bytes: CHOSEN,
        kind: myo::AddressKind::Random,
    }
}

/// Advertisement of the armband that the wearer has chosen.
fn advertisement() -> RadioEvent {
    RadioEvent::Advertisement {
        address: chosen(),
        rssi: 127,
        data: advertising_data([Uuid::CONTROL.to_le_bytes()]),
    }
}

fn port_state(connected: bool, detail: &str, steps: Vec<String>) -> Event {
    Event::Source {
        kind: "port",
        name: PORT.to_owned(),
        connected,
        detail: detail.to_owned(),
        steps,
    }
}

/// Reads the first recording of a file.
fn read(name: &str, bytes: &[u8]) -> Result<Recording, String> {
    let library = load_bytes(Path::new(name), bytes, &LoadOptions::default());
    let recordings = library.map_err(|error| error.to_string())?.recordings;
    let first = recordings.into_iter().next();
    first.ok_or_else(|| "it has no recording".to_owned())
}
