//! Writing of a session to its journal, and to recordings at its end.

use std::path::PathBuf;
use std::time::SystemTime;

use super::summary::summary;
use super::{RecordOptions, RunningRecorder, Unconverted};
use crate::record::RecordError;
use crate::record::convert;
use crate::record::journal::{ENDING, FlushOutcome, Journal};
use execution::progress;
use execution::utc::utc;
use web::event::Event;
use web::record::journal::Header;
use web::record::session::{Action, HoldReason, Input};

impl RunningRecorder {
    /// Creates a journal. Returns false on failure, which viewers are told.
    pub(super) fn create(&mut self) -> bool {
        if self.guided.session().is_over() {
            return false;
        }
        if !self.guided.session().has_stream() {
            "no samples have come yet: begin when the traces move".clone_into(&mut self.trouble);
            self.published = None;
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
            classes: protocol.names().into_iter().map(str::to_owned).collect(),
            free: protocol.is_free(),
            source,
            synthetic,
        };
        let created = std::fs::create_dir_all(&folder)
            .map_err(|error| format!("{}: {error}", folder.display()));
        let journal = created
            .and_then(|()| Journal::create(&path, header).map_err(|error| error.to_string()));
        match journal {
            Ok(journal) => {
                self.guided.write_to(journal);
                self.trouble.clear();
                true
            }
            Err(error) => {
                self.trouble = format!("the recording cannot begin: {error}");
                self.published = None;
                false
            }
        }
    }

    pub(super) fn flush(&mut self) {
        let now = self.now();
        let Some(journal) = self.guided.journal() else {
            return;
        };
        match journal.flush(now) {
            Ok(FlushOutcome::InPlace) if journal.is_full() => {
                self.note(
                    "a session cannot last longer: it is ended and kept; record another one"
                        .to_owned(),
                );
                self.handle(now, Input::Action(Action::Finish));
            }
            Ok(FlushOutcome::InPlace) => self.clear_trouble(),
            Ok(FlushOutcome::Rewritten { gone }) => {
                let path = journal.path().display();
                let text = format!(
                    "{} was deleted, moved or replaced: all of the session was written anew to {path}. If it was moved, what was \
                    written before is in the moved file, too",
                    gone.display()
                );
                self.clear_trouble();
                self.note(text);
                self.handle(now, Input::Hold(HoldReason::Gone));
            }
            Err(error) => {
                let reason = match error {
                    RecordError::Gone { .. } => HoldReason::Gone,
                    _ => HoldReason::Disk,
                };
                let trouble = format!(
                    "{error}; what was recorded is kept while this program runs, and writing is tried again"
                );
                // While waiting, the error only says that it will be tried again: the first one stays.
                if self.trouble.is_empty() {
                    self.fail(trouble);
                }
                self.handle(now, Input::Hold(reason));
            }
        }
    }

    /// Clears the error: the journal is written again.
    fn clear_trouble(&mut self) {
        if !self.trouble.is_empty() {
            self.trouble.clear();
            self.published = None;
        }
    }

    /// Sets a notice for viewers and logs it; it stays until the person continues.
    fn note(&mut self, text: String) {
        progress::log(&format!("warning: {text}"));
        self.notice = text;
        self.published = None;
    }

    /// Sets an error for viewers and logs it; it stays until writing succeeds.
    fn fail(&mut self, text: String) {
        progress::log(&format!("warning: {text}"));
        self.trouble = text;
        self.published = None;
    }

    pub(super) fn end_if_over(&mut self) {
        if !self.guided.session().is_over() {
            return;
        }
        let Some(journal) = self.guided.journal().take() else {
            return;
        };
        // Told before the journal is closed, which takes a moment.
        self.publish_changes();
        match journal.close() {
            Ok(path) => self.convert(path),
            Err(error) => {
                let message = match error {
                    RecordError::Elsewhere { .. } => error.to_string(),
                    _ => format!("{error}. {NEXT_START}"),
                };
                self.unconverted.push(Unconverted {
                    journal: None,
                    message: message.clone(),
                });
                self.fail(message);
            }
        }
    }

    /// Makes recordings of a complete journal.
    fn convert(&mut self, path: PathBuf) {
        match convert(&path) {
            Ok(conversion) => {
                if let Some(damage) = conversion.damage() {
                    self.unconverted.push(Unconverted {
                        journal: None,
                        message: format!("{}: {damage}", path.display()),
                    });
                }
                let result = summary(&conversion, &self.recorder);
                self.recorder.hub.publish(&Event::Kept(result));
            }
            Err(error) => {
                let message = format!(
                    "{error}. What was recorded is in {}. {NEXT_START}",
                    path.display()
                );
                self.fail(message.clone());
                self.unconverted.push(Unconverted {
                    journal: Some(path),
                    message,
                });
            }
        }
    }

    /// Tries again to make recordings of journals for which it failed: the disk may have room now.
    ///
    /// # Errors
    /// When a session is not kept; the message names the journals.
    pub(super) fn retry_conversions(&mut self) -> anyhow::Result<()> {
        let mut left = Vec::new();
        for unconverted in self.unconverted.drain(..) {
            let converted = unconverted.journal.as_deref().map(convert);
            if !matches!(converted, Some(Ok(_))) {
                left.push(unconverted.message);
            }
        }
        anyhow::ensure!(left.is_empty(), "{}", left.join("\n"));
        Ok(())
    }
}

/// Advice about a journal that is left.
const NEXT_START: &str =
    "The next start of `myointent record` for this person makes recordings of the journal";
