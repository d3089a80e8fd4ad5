//! A session that is recorded: its samples go to its journal, whose new lines are given away; cues go to a simulated person.

use std::time::{Duration, SystemTime};

use execution::utc::utc;
use recordings::labels::motion::Motion;
use serde::Serialize;
use shared::stream::alignment::Alignment;
use shared::units::{Millis, Sample, SampleIndex};

use super::{Lines, Output, Stored, millis};
use crate::event::Event;
use crate::outcome::SessionResult;
use crate::record::assembly::assemble;
use crate::record::csv::{csv, movement, pieces};
use crate::record::journal::{Entry, FORMAT, FULL, Header, Writer, read};
use crate::record::protocol::Protocol;
use crate::record::quality::judge;
use crate::record::remark::{NOTES, Remark};
use crate::record::session::{self, Action, HoldReason, Input, Session, View};
use crate::request::NotDone;
use crate::said::Said;

/// Notice to the person about a session.
#[derive(Serialize, thiserror::Error, Debug)]
#[serde(tag = "name", rename_all = "kebab-case")]
enum Notice {
    #[error("no samples have come yet: begin when the traces move")]
    NoSamples,
    #[error("a session cannot last longer: it is ended and kept; record another one")]
    Full,
}

/// Session with its journal.
pub(super) struct RecordedSession {
    session: Session,
    /// Journal of the session; none before its beginning and after its end.
    journal: Option<Writer>,
    /// Placement of the armband, as it is aligned.
    placement: Alignment,
    /// Motion that a simulated person is asked for.
    cue: Motion,
    protocol: Protocol,
    header: Header,
    /// Name of the journal; empty before its beginning and the first remark.
    name: String,
    remarks: Vec<Remark>,
    /// View that viewers know; none after a change of the texts.
    published: Option<View>,
    /// Error that keeps the session from being written, and a warning that stays until the person continues.
    trouble: Option<Said>,
    notice: Option<Said>,
    /// Bytes of the journal that were given away.
    pub(super) given: usize,
    /// Time since 1970 when the clock of the engine began, in ms.
    epoch: f64,
    /// All of the journal, of which recordings are made here; none where they are made by who stores it.
    whole: Option<String>,
}

impl RecordedSession {
    /// A session that waits for its beginning.
    pub(super) fn new(header: Header, protocol: Protocol, epoch: f64, makes_files: bool) -> Self {
        Self {
            session: Session::new(protocol.clone()),
            journal: None,
            placement: Alignment::NONE,
            cue: Motion::RELAX,
            header: Header {
                format: FORMAT,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                protocol: protocol.name.clone(),
                classes: protocol.names().into_iter().map(str::to_owned).collect(),
                free: protocol.is_free(),
                ..header
            },
            protocol,
            name: String::new(),
            remarks: Vec::new(),
            published: None,
            trouble: None,
            notice: None,
            given: 0,
            epoch,
            whole: makes_files.then(String::new),
        }
    }

    /// Motion that a simulated person is asked for.
    pub(super) const fn cue(&self) -> Motion {
        self.cue
    }

    /// Takes an event of the source.
    pub(super) fn event(&mut self, now: Millis, event: &Event) {
        match event {
            Event::Samples { first, emg, .. } => self.samples(now, SampleIndex(*first), emg),
            Event::Imu { sample, imu, .. } if self.session.is_running() => {
                if let Some(journal) = &mut self.journal {
                    journal.imu(SampleIndex(*sample), *imu);
                }
            }
            Event::Source {
                connected: false, ..
            } => {
                self.place(Alignment::NONE);
                self.handle(now, Input::Hold(HoldReason::SourceLost));
            }
            Event::Alignment { turn, mirrored, .. } => self.place(Alignment::new(*turn, *mirrored)),
            _ => {}
        }
    }

    /// Takes an input of the session.
    pub(super) fn handle(&mut self, now: Millis, input: Input) {
        self.session.handle(now, input);
        while let Some(output) = self.session.poll() {
            match output {
                session::Output::Cue { cue, .. } => self.cue = cue.unwrap_or(Motion::RELAX),
                session::Output::Pause | session::Output::Over => self.cue = Motion::RELAX,
                _ => {}
            }
            self.entry(&Entry::of(output));
        }
    }

    fn entry(&mut self, entry: &Entry) {
        if let Some(journal) = &mut self.journal {
            journal.entry(entry);
        }
    }

    /// Sets the placement of the armband from the next sample on.
    fn place(&mut self, placement: Alignment) {
        if self.placement != placement {
            self.placement = placement;
            self.write_placement();
        }
    }

    fn write_placement(&mut self) {
        let (turn, mirrored) = (self.placement.turn(), self.placement.mirrored());
        self.entry(&Entry::Placement { turn, mirrored });
    }

    fn samples(&mut self, now: Millis, first: SampleIndex, emg: &[Sample]) {
        let before = self.session.is_running();
        let count = emg.len() as u32;
        self.handle(now, Input::Samples { first, count });
        // Samples that end a session belong to it; samples that hold it belong to another stream.
        let is_kept = self.session.is_running() || before && self.session.is_over();
        if let Some(journal) = &mut self.journal
            && is_kept
        {
            journal.samples(first, emg);
        }
    }

    /// Carries out an action of the person.
    pub(super) fn act(&mut self, now: f64, action: Action) {
        if action == Action::Begin {
            if self.journal.is_none() && !self.begin(now) {
                return;
            }
            self.notice = None;
        }
        self.handle(millis(now), Input::Action(action));
    }

    /// Begins a journal; false if that is not possible.
    fn begin(&mut self, now: f64) -> bool {
        if self.session.is_over() {
            return false;
        }
        self.published = None;
        if !self.session.has_stream() {
            self.trouble = Some(Said::of("session", &Notice::NoSamples));
            return false;
        }
        self.trouble = None;
        self.given = 0;
        if let Some(whole) = &mut self.whole {
            whole.clear();
        }
        self.header.began = self.utc(now);
        self.call(now);
        self.journal = Some(Writer::default());
        self.entry(&Entry::Begin(self.header.clone()));
        self.write_placement();
        true
    }

    /// Present time in words.
    fn utc(&self, now: f64) -> String {
        let since = Duration::try_from_secs_f64((self.epoch + now) / 1000.0);
        utc(SystemTime::UNIX_EPOCH + since.unwrap_or_default())
    }

    /// Names the session, unless it has a name.
    fn call(&mut self, now: f64) {
        if self.name.is_empty() {
            let now = self.utc(now);
            let stamp: String = now.chars().filter(char::is_ascii_alphanumeric).collect();
            self.name = format!("{}_{stamp}_{}", self.header.person, self.header.protocol);
        }
    }

    /// Remarks on the session.
    pub(super) fn remarks(&self) -> &[Remark] {
        &self.remarks
    }

    /// Takes a remark that is made at a time in words. Returns its line.
    pub(super) fn remark(
        &mut self,
        now: f64,
        remark: impl FnOnce(String) -> Option<Remark>,
    ) -> Option<Lines> {
        let remark = remark(self.utc(now))?;
        self.call(now);
        let journal = remark.line();
        self.remarks.push(remark);
        Some(Lines {
            name: self.name.clone(),
            journal,
            begins: false,
            is_over: false,
        })
    }

    /// Waits for the beginning of another session, once this one is over. Returns whether it is.
    pub(super) fn restart(&mut self) -> bool {
        let is_over = self.session.is_over();
        if is_over {
            self.session = Session::new(self.protocol.clone());
            self.trouble = None;
            self.notice = None;
            self.name.clear();
            self.remarks.clear();
        }
        is_over
    }

    /// Work of the program on what was recorded; none while a session is written.
    ///
    /// # Errors
    /// Where there is no program.
    pub(super) fn job(&self, job: Output) -> Result<Option<Output>, NotDone> {
        let job = self.journal.is_none().then_some(job);
        self.whole
            .as_ref()
            .map_or(Ok(job), |_| Err(NotDone::Unknown))
    }

    /// Takes what became of the journal's lines.
    pub(super) fn stored(&mut self, now: Millis, stored: Stored) {
        match stored {
            Stored::Refused(why) => {
                self.journal = None;
                self.session = Session::new(self.protocol.clone());
                self.cue = Motion::RELAX;
                self.trouble = Some(why);
                if self.remarks.is_empty() {
                    self.name.clear();
                }
            }
            Stored::Written => self.trouble = None,
            Stored::Anew(notice) => {
                self.trouble = None;
                self.notice = Some(notice);
                self.handle(now, Input::Hold(HoldReason::Gone));
            }
            Stored::Failed(reason, why) => {
                self.handle(now, Input::Hold(reason));
                if self.trouble.is_some() {
                    // While waiting, the error only says that it will be tried again: the first one stays.
                    return;
                }
                self.trouble = Some(why);
            }
            Stored::Left(why) => self.trouble = Some(why),
            Stored::Unkept(why) => self.notice = Some(why),
            Stored::Kept(_) => return,
        }
        self.published = None;
    }

    /// Begins the session when samples come, and continues it after a hold. Returns whether it is over.
    ///
    /// # Errors
    /// The trouble that keeps it from being recorded.
    pub(super) fn lead_unattended(&mut self, now: f64) -> Result<bool, Said> {
        let session = &self.session;
        if !session.is_over() && !session.is_running() && session.has_stream() {
            self.act(now, Action::Begin);
        }
        match &self.trouble {
            None => Ok(self.session.is_over() && self.journal.is_none()),
            Some(trouble) => Err(trouble.clone()),
        }
    }

    /// Ends the session that is written.
    pub(super) fn finish(&mut self, now: f64) {
        if self.journal.is_some() {
            self.act(now, Action::Finish);
        }
    }

    /// Gives what is new: lines of the journal, the view, and recordings once the session is over.
    pub(super) fn changes(&mut self, outputs: &mut Vec<Output>) -> Option<Files> {
        let is_over = self.session.is_over();
        let mut files = None;
        if let Some(writer) = &mut self.journal {
            if is_over {
                writer.close();
            }
            let journal = writer.take();
            let begins = self.given == 0;
            self.given += journal.len();
            if let Some(whole) = &mut self.whole {
                *whole += &journal;
            }
            if !journal.is_empty() || is_over {
                let name = self.name.clone();
                outputs.push(Output::Journal(Lines {
                    name,
                    journal,
                    begins,
                    is_over,
                }));
            }
            if let (Some(whole), true) = (&self.whole, is_over) {
                let notes = self.remarks.iter().map(Remark::line);
                files = Files::of(&self.name, whole.as_bytes(), notes.collect());
            }
            if is_over {
                self.journal = None;
            } else if self.given > FULL {
                self.notice = Some(Said::of("session", &Notice::Full));
                self.published = None;
                // The clock has no part in it.
                self.handle(Millis(0), Input::Action(Action::Finish));
            }
        }
        let view = self.session.view();
        if self.published.as_ref() != Some(&view) {
            self.published = Some(view.clone());
            let trouble = self
                .trouble
                .as_ref()
                .or(self.notice.as_ref())
                .cloned()
                .map(Box::new);
            outputs.push(Output::Event(Event::Session { view, trouble }));
        }
        files
    }
}

/// Recordings made of a journal, the notes beside it, and what is said of them.
pub(super) struct Files {
    /// Name of the journal.
    pub(super) name: String,
    /// Names and contents of the recordings.
    files: Vec<(String, String)>,
    /// Names and contents of their movement.
    beside: Vec<(String, String)>,
    pub(super) notes: String,
    /// Verdict on the recordings; none without any.
    pub(super) result: Option<SessionResult>,
}

impl Files {
    /// Makes recordings of lines that a browser has kept: a journal's, and those of remarks, which are JSON alone.
    pub(super) fn recover(name: &str, kept: &[u8]) -> Option<Self> {
        let lines = kept.split_inclusive(|&byte| byte == b'\n');
        let (notes, journal): (Vec<_>, Vec<_>) = lines.partition(|line| line.starts_with(b"{"));
        let notes = String::from_utf8_lossy(&notes.concat()).into_owned();
        Self::of(name, &journal.concat(), notes)
    }

    /// Makes recordings of a journal; none if there is neither its header nor a note, or it has another format.
    fn of(name: &str, journal: &[u8], notes: String) -> Option<Self> {
        let contents = read(journal);
        let mut entries = contents.entries.iter();
        let header = entries.find_map(|entry| match entry {
            Entry::Begin(header) => Some(header),
            _ => None,
        });
        let mut made = Self {
            name: name.to_owned(),
            files: Vec::new(),
            beside: Vec::new(),
            notes,
            result: None,
        };
        let Some(header) = header else {
            return (!made.notes.is_empty()).then_some(made);
        };
        if !header.is_read() {
            return None;
        }
        let assembly = assemble(&contents.entries);
        for (number, (part, piece)) in (1..).zip(pieces(&assembly)) {
            if let Some(text) = movement(part, &piece) {
                made.beside.push((format!("{name}_{number}.imu"), text));
            }
            let text = csv(&assembly, part, piece, header.synthetic);
            made.files.push((format!("{name}_{number}.csv"), text));
        }
        let quality = judge(&assembly);
        let person = &header.person;
        let names = made.files.iter().map(|(name, _)| name.clone()).collect();
        let commands = [
            format!("myointent data inspect {person}"),
            format!(
                "myointent personalize --model models/three-class.intent --data {person} --out {person}.intent"
            ),
            String::new(),
        ];
        let bad = assembly.rejected.len();
        let result = SessionResult::of(&quality, bad, person.clone(), names, commands);
        made.result = Some(result);
        Some(made)
    }

    /// Names and contents of all files.
    pub(super) fn all(&self) -> Vec<(String, String)> {
        let notes = (format!("{}.{NOTES}", self.name), self.notes.clone());
        let notes = Some(notes).filter(|(_, notes)| !notes.is_empty());
        notes
            .into_iter()
            .chain(self.beside.iter().chain(&self.files).cloned())
            .collect()
    }
}
