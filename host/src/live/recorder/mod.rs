//! Recorder of a session: a thread that takes samples from the hub, leads through a protocol and writes a journal. Neither
//! source nor viewers wait for it or its disk.

mod summary;
#[cfg_attr(not(feature = "train"), path = "untrained.rs")]
mod tuning;
mod writing;

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender};
use std::time::Duration;

use shared::units::Millis;
#[cfg(feature = "train")]
use training::backend::Device;

use self::tuning::TuningProgress;
use super::hub::Hub;
use super::source::Stop;
use crate::record::journal::Journal;
use web::SharedCue;
use web::event::Event;
use web::outcome::InstallationState;
use web::record::guided::Guided;
use web::record::protocol::Protocol;
use web::record::session::{Action, HoldReason, Input, View};
use web::request::SourceRequest;

/// Longest wait for samples between two checks for requests: too short to notice.
const WAIT: Duration = Duration::from_millis(20);

/// Settings of a recording session.
#[derive(Clone, Debug)]
pub struct RecordOptions {
    /// Folder with a folder for each person.
    pub folder: PathBuf,
    /// Name of the person.
    pub person: String,
    /// Protocol of the session.
    pub protocol: Protocol,
    /// Path of the model file to tune afterwards, for the commands that are shown.
    pub model: PathBuf,
    /// Device for tuning.
    #[cfg(feature = "train")]
    pub device: Device,
    /// Speed-up of a demo or a replay, to try a protocol out.
    pub speed: u32,
    /// Whether the session begins by itself and its end ends the program; nobody looks at the cues.
    pub unattended: bool,
}

/// Request to the recorder.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum RecorderRequest {
    /// Action on the session in progress.
    Action(Action),
    /// The leader has left the page.
    LeaderLeft,
    /// Begin another session.
    NewSession,
    /// Tune the model on all of the person's recordings.
    Tune,
    /// Install the tuned model on the board.
    Install,
}

/// Settings and channels of a recorder.
#[derive(Debug)]
pub(super) struct Recorder {
    pub(super) options: RecordOptions,
    /// Description of the source for the journal, and whether it is synthetic.
    pub(super) source: (String, bool),
    /// Serial port of the board that the tuned model is for; none without a board.
    pub(super) port: Option<PathBuf>,
    /// Channel for requests to the source.
    pub(super) source_requests: SyncSender<SourceRequest>,
    /// Command-line option of the source, for the commands that are shown.
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    pub(super) option: String,
    /// Bytes of the model file.
    #[cfg_attr(not(feature = "train"), expect(dead_code, reason = "of the tune step"))]
    pub(super) model: Vec<u8>,
    pub(super) hub: std::sync::Arc<Hub>,
    /// Cue for a simulated person.
    pub(super) cue: SharedCue,
}

/// State of a running recorder.
struct RunningRecorder {
    recorder: Recorder,
    guided: Guided<Journal>,
    /// View that viewers know; none after a change of the texts.
    published: Option<View>,
    trouble: String,
    /// Warning about the journal, shown until the person continues.
    notice: String,
    /// Earlier sessions without recordings.
    unconverted: Vec<Unconverted>,
    tuning: Option<Receiver<TuningProgress>>,
    /// Bytes of the newest tuned model file.
    tuned: Option<Vec<u8>>,
}

/// Session without recordings.
#[derive(Debug)]
struct Unconverted {
    /// Journal to try again; none if its writing failed.
    journal: Option<PathBuf>,
    /// Message that viewers got.
    message: String,
}

impl Recorder {
    /// Leads through sessions until it is stopped or an unattended session is over; then ends and keeps the one in progress.
    ///
    /// # Errors
    /// When an unattended session cannot be written, or a journal could not be made into recordings.
    pub(super) fn run(
        self,
        events: &Receiver<Event>,
        requests: &Receiver<RecorderRequest>,
        stop: &Stop,
    ) -> anyhow::Result<()> {
        let guided = Guided::new(self.options.protocol.clone(), self.cue.clone());
        let mut running = RunningRecorder {
            recorder: self,
            guided,
            published: None,
            trouble: String::new(),
            notice: String::new(),
            unconverted: Vec::new(),
            tuning: None,
            tuned: None,
        };
        let mut result = Ok(());
        loop {
            running.publish_changes();
            // Read before the events: what was published before a stop is still taken.
            let stopped = stop.requested();
            for request in requests.try_iter() {
                running.handle_request(request);
            }
            match events.recv_timeout(WAIT) {
                Ok(event) => {
                    running.handle_event(event);
                    for event in events.try_iter().take(64) {
                        running.handle_event(event);
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
                match running.advance_unattended() {
                    Ok(false) => {}
                    ended => {
                        result = ended.map(drop);
                        break;
                    }
                }
            }
        }
        if running.guided.journal().is_some() {
            running.handle_request(RecorderRequest::Action(Action::Finish));
            running.publish_changes();
        }
        running.retry_conversions().and(result)
    }
}

impl RunningRecorder {
    /// Whether a session is written.
    fn records(&mut self) -> bool {
        self.guided.journal().is_some()
    }

    fn now(&self) -> Millis {
        self.recorder.hub.millis()
    }

    fn handle_event(&mut self, event: Event) {
        let now = self.now();
        self.guided.event(now, &event);
        self.end_if_over();
    }

    fn handle(&mut self, now: Millis, input: Input) {
        self.guided.handle(now, input);
        self.end_if_over();
    }

    fn handle_request(&mut self, request: RecorderRequest) {
        let now = self.now();
        match request {
            RecorderRequest::Action(action) => {
                if action == Action::Begin && !self.records() && !self.create() {
                    return;
                }
                if action == Action::Begin {
                    self.notice.clear();
                }
                self.handle(now, Input::Action(action));
            }
            RecorderRequest::LeaderLeft => self.handle(now, Input::Hold(HoldReason::LeaderLeft)),
            RecorderRequest::NewSession if self.guided.session().is_over() => {
                let protocol = self.recorder.options.protocol.clone();
                self.guided.restart(protocol);
                self.trouble.clear();
                self.notice.clear();
                self.recorder.hub.forget_session();
            }
            RecorderRequest::Tune if self.tuning.is_none() && !self.records() => self.tune(),
            RecorderRequest::Install if !self.records() => self.install(),
            RecorderRequest::NewSession | RecorderRequest::Tune | RecorderRequest::Install => {}
        }
    }

    /// Begins an unattended session when samples come, and continues it after a hold. Returns whether it is over.
    fn advance_unattended(&mut self) -> anyhow::Result<bool> {
        let is_over = self.guided.session().is_over() && !self.records();
        let session = self.guided.session();
        if !is_over && !session.is_running() && session.has_stream() {
            self.handle_request(RecorderRequest::Action(Action::Begin));
        }
        anyhow::ensure!(self.trouble.is_empty(), "{}", self.trouble);
        Ok(is_over)
    }

    /// Tells viewers about changes.
    pub(super) fn publish_changes(&mut self) {
        let view = self.guided.session().view();
        if self.published.as_ref() != Some(&view) {
            let texts = [&self.trouble, &self.notice];
            let trouble = texts.into_iter().find(|text| !text.is_empty());
            self.recorder.hub.publish(&Event::Session {
                view: view.clone(),
                trouble: trouble.cloned().unwrap_or_default(),
            });
            self.published = Some(view);
        }
        self.publish_tuning();
    }

    /// Asks the board's thread to install the tuned model; that thread reports the result.
    fn install(&self) {
        let (Some(tuned), Some(_)) = (&self.tuned, &self.recorder.port) else {
            return;
        };
        let begun = InstallationState::running("waiting for the board");
        self.recorder.hub.publish(&Event::Installing(begun));
        let request = SourceRequest::Install(tuned.clone());
        // A source that takes no requests is ending.
        let _ = self.recorder.source_requests.try_send(request);
    }
}

impl Recorder {
    /// Path of the person's folder.
    fn folder(&self) -> PathBuf {
        self.options.folder.join(&self.options.person)
    }
}
