//! What a session says and hears, into its journal; and recordings of that at its end.

use std::time::SystemTime;

use shared::intent::Intent;

use super::told::told;
use super::{RecordOptions, Running};
use crate::execution::run_folder::utc;
use crate::live::event::Event;
use crate::record::journal::{ENDING, Entry, Header, Journal};
use crate::record::keep;
use crate::record::protocol::Course;
use crate::record::session::{Held, Input, Output};

impl Running {
    /// A new journal; false if there is none, which viewers are told.
    pub(super) fn create(&mut self) -> bool {
        if self.session.is_over() {
            return false;
        }
        if !self.session.has_stream() {
            "no samples have come yet: begin when the traces move".clone_into(&mut self.trouble);
            self.told = None;
            return false;
        }
        let RecordOptions {
            person, protocol, ..
        } = &self.recorder.options;
        let began = utc(SystemTime::now());
        let stamp: String = began.chars().filter(char::is_ascii_alphanumeric).collect();
        let folder = self.recorder.folder();
        let path = folder.join(format!("{person}_{stamp}_{}.{ENDING}", protocol.name));
        let (source, synthetic) = self.recorder.source.clone();
        let header = Header {
            format: 0,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            began,
            person: person.clone(),
            protocol: protocol.name.clone(),
            classes: protocol
                .intents()
                .into_iter()
                .map(|intent| intent.name().to_owned())
                .collect(),
            free: matches!(protocol.course, Course::Free { .. }),
            source,
            synthetic,
        };
        let made = std::fs::create_dir_all(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()));
        let journal =
            made.and_then(|()| Journal::create(&path, header).map_err(|error| error.to_string()));
        match journal {
            Ok(journal) => {
                self.journal = Some(journal);
                self.write_placement();
                self.trouble.clear();
                true
            }
            Err(error) => {
                self.trouble = format!("the recording cannot begin: {error}");
                self.told = None;
                false
            }
        }
    }

    /// What the session says, into the journal and to the demo.
    pub(super) fn write_down(&mut self) {
        while let Some(output) = self.session.poll() {
            if let Output::Cue { cue, .. } = output {
                self.recorder.asked.set(cue.unwrap_or(Intent::Relax));
            }
            if let Output::Pause | Output::Over = output {
                self.recorder.asked.set(Intent::Relax);
            }
            if let Some(journal) = &mut self.journal {
                journal.entry(&Entry::of(output));
            }
        }
    }

    pub(super) fn flush(&mut self) {
        let now = self.now();
        let Some(journal) = &mut self.journal else {
            return;
        };
        match journal.flush(now) {
            Ok(()) if self.trouble.is_empty() => {}
            Ok(()) => {
                self.trouble.clear();
                self.told = None;
            }
            Err(error) => {
                let path = journal.path().display();
                let trouble = format!(
                    "{path}: {error}; what was recorded is kept, and writing is tried again"
                );
                if self.trouble != trouble {
                    self.trouble = trouble;
                    self.told = None;
                }
                self.handle(now, Input::Hold(Held::Disk));
            }
        }
    }

    pub(super) fn end_if_over(&mut self) {
        if !self.session.is_over() {
            return;
        }
        let Some(journal) = self.journal.take() else {
            return;
        };
        // Before what was kept: it takes a moment.
        self.tell();
        let path = journal.path().to_owned();
        let closed = journal
            .close()
            .map_err(|error| format!("{}: {error}", path.display()));
        let kept = closed.and_then(|()| keep(&path).map_err(|error| error.to_string()));
        match kept {
            Ok(kept) => {
                let kept = told(&kept, &self.recorder);
                self.recorder.hub.publish(&Event::Kept(kept));
            }
            Err(error) => {
                self.trouble = format!(
                    "{error}. What was recorded is in {}: the next start of `myointent record` for this person makes it into recordings",
                    path.display()
                );
                self.told = None;
            }
        }
    }
}
