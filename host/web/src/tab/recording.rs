//! A session that a page records: the browser keeps its journal line by line, and gets the recordings made of it.

use std::time::{Duration, SystemTime};

use execution::utc::utc;
use serde::{Deserialize, Serialize};
use shared::units::Millis;

use super::Outputs;
use crate::SharedCue;
use crate::event::Event;
use crate::outcome::SessionResult;
use crate::record::assembly::assemble;
use crate::record::csv::{csv, pieces};
use crate::record::guided::Guided;
use crate::record::journal::{Entry, FORMAT, Header, Writer, read};
use crate::record::protocol::Protocol;
use crate::record::quality::judge;
use crate::record::session::{Action, Input, View};
use crate::request::SessionCommand;

/// Request of a page about its files.
#[derive(Deserialize)]
#[serde(tag = "do", rename_all = "snake_case", deny_unknown_fields)]
pub enum RecordingRequest {
    /// Prepare a session.
    Record {
        /// Name of the person.
        person: String,
        /// Name of a built-in protocol.
        protocol: String,
        /// Time now, in ms since 1970.
        time: f64,
    },
    /// Make recordings of a journal that the page has kept, whose bytes were given as a file.
    Recover {
        /// Name of the journal.
        name: String,
    },
    /// Install the model, whose bytes were given as a file, on the board.
    Install,
    /// Give the newest recordings as files.
    Keep,
}

/// Lines of a journal, for the browser to keep.
#[derive(Serialize)]
struct Kept<'j> {
    /// Name of the journal.
    name: &'j str,
    journal: &'j str,
}

/// Session of a page.
pub(super) struct RecordedSession {
    guided: Guided<Writer<Vec<u8>>>,
    protocol: Protocol,
    header: Header,
    published: Option<View>,
    trouble: &'static str,
    /// Bytes of the journal that the browser has.
    given: usize,
    /// Time since 1970 when the clock of the worker began, in ms.
    epoch: f64,
}

impl RecordedSession {
    /// A session that waits for its beginning; none without such a protocol.
    pub(super) fn new(header: Header, epoch: f64, cue: SharedCue) -> Option<Self> {
        let protocol = Protocol::find(&header.protocol).ok()?;
        Some(Self {
            guided: Guided::new(protocol.clone(), cue),
            header: Header {
                format: FORMAT,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                classes: protocol.names().into_iter().map(str::to_owned).collect(),
                free: protocol.is_free(),
                ..header
            },
            protocol,
            published: None,
            trouble: "",
            given: 0,
            epoch,
        })
    }

    /// Takes an event of the source.
    pub(super) fn event(&mut self, now: Millis, event: &Event) {
        self.guided.event(now, event);
    }

    /// Takes an input of the session.
    pub(super) fn handle(&mut self, now: Millis, input: Input) {
        self.guided.handle(now, input);
    }

    /// Carries out a command; false if the page has none like it.
    pub(super) fn command(&mut self, now: Millis, at: f64, command: SessionCommand) -> bool {
        let action = match command {
            SessionCommand::Begin => Action::Begin,
            SessionCommand::Repeat => Action::Repeat,
            SessionCommand::Hold => Action::Hold,
            SessionCommand::Finish => Action::Finish,
            SessionCommand::Again => {
                self.guided.restart(self.protocol.clone());
                return true;
            }
            SessionCommand::Tune | SessionCommand::Install => return false,
        };
        if action == Action::Begin && self.guided.journal().is_none() {
            self.published = None;
            self.trouble = "no samples have come yet: begin when the traces move";
            if !self.guided.session().has_stream() {
                return true;
            }
            self.trouble = "";
            self.given = 0;
            let since = Duration::try_from_secs_f64((self.epoch + at) / 1000.0);
            self.header.began = utc(SystemTime::UNIX_EPOCH + since.unwrap_or_default());
            let mut journal = Writer::new(Vec::new());
            journal.entry(&Entry::Begin(self.header.clone()));
            self.guided.write_to(journal);
        }
        self.handle(now, Input::Action(action));
        true
    }

    /// Gives what is new: lines of the journal, the view, and recordings once the session is over.
    pub(super) fn changes(&mut self, outputs: &mut String) -> Option<Files> {
        let is_over = self.guided.session().is_over();
        let name = name(&self.header);
        let mut files = None;
        if let Some(writer) = self.guided.journal() {
            if is_over {
                writer.close();
            }
            // A list of bytes takes all.
            let _ = writer.flush();
            let bytes = writer.get_ref();
            if let Ok(journal) = std::str::from_utf8(&bytes[self.given..])
                && !journal.is_empty()
            {
                Outputs::push(
                    outputs,
                    &Kept {
                        name: &name,
                        journal,
                    },
                );
                self.given = bytes.len();
            }
            if is_over {
                files = Files::of(&name, bytes);
                *self.guided.journal() = None;
            }
        }
        let view = self.guided.session().view();
        if self.published.as_ref() != Some(&view) {
            self.published = Some(view.clone());
            let trouble = self.trouble.to_owned();
            Outputs::push(outputs, &Event::Session { view, trouble });
        }
        files
    }
}

/// Name of a journal: `anna_20261122T110323Z_quick`.
fn name(header: &Header) -> String {
    let stamp = header.began.chars().filter(char::is_ascii_alphanumeric);
    let stamp: String = stamp.collect();
    format!("{}_{stamp}_{}", header.person, header.protocol)
}

/// Recordings made of a journal, and what is said of them.
pub(super) struct Files {
    /// Names and contents.
    pub(super) files: Vec<(String, String)>,
    pub(super) result: SessionResult,
}

impl Files {
    /// Makes recordings of a journal; none if it has no header.
    pub(super) fn of(name: &str, journal: &[u8]) -> Option<Self> {
        let contents = read(journal);
        let mut entries = contents.entries.iter();
        let header = entries.find_map(|entry| match entry {
            Entry::Begin(header) => Some(header),
            _ => None,
        })?;
        let assembly = assemble(&contents.entries);
        let files = (1..).zip(pieces(&assembly)).map(|(number, (part, piece))| {
            let text = csv(&assembly, part, piece, header.synthetic);
            (format!("{name}_{number}.csv"), text)
        });
        let files: Vec<_> = files.collect();
        let quality = judge(&assembly);
        let person = &header.person;
        let names = files.iter().map(|(name, _)| name.clone()).collect();
        let commands = [
            format!("myointent data inspect {person}"),
            format!(
                "myointent personalize --model models/three-class.intent --data {person} --out {person}.intent"
            ),
            String::new(),
        ];
        let bad = assembly.rejected.len();
        let result = SessionResult::of(&quality, bad, person.clone(), names, commands);
        Some(Self { files, result })
    }
}
