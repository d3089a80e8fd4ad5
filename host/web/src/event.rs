//! Events for viewers: the messages of the websocket, each a JSON object with its `type`.

use std::mem::discriminant;

use serde::{Serialize, Serializer};
use shared::intent::Intent;
use shared::model::file::Model;
use shared::myo::Imu;
use shared::stream::alignment::Alignment;
use shared::stream::safe_state::Cause;
use shared::stream::strength::Percent;
use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::uart_line::answer::{Binding, Counts, Identity};
use shared::units::{CHANNELS, Sample};

use crate::outcome::{InstallationState, SessionResult, TuningState};
use crate::record::remark::Remark;
use crate::record::session::View;
use crate::request::NotDone;
use crate::said::Said;

/// Greatest number of characters of a mark.
const MAX_MARK: usize = 80;

/// Number of a viewer.
pub type ViewerId = u64;

/// Message to viewers. Times `at` are milliseconds of the server's clock; samples are numbered as on the UART.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
#[expect(missing_docs, reason = "docs/live.md has a table of the fields")]
pub enum Event {
    /// First message: program, time in ms, number of the viewer, whether a session is recorded, and whether a model can be tuned.
    Hello {
        version: &'static str,
        now: f64,
        you: ViewerId,
        record: bool,
        tunes: bool,
    },
    /// Answer to a ping.
    Pong { sent: f64, now: f64 },
    /// Refusal of a request, with the reason.
    Refused {
        #[serde(flatten)]
        why: Said,
    },
    /// Source of the stream, and whether it is connected.
    Source {
        /// `demo`, `replay`, `port` or `bluetooth`.
        kind: &'static str,
        /// Path or name.
        name: String,
        connected: bool,
        /// State of the source; null if there is nothing to say.
        detail: Option<Said>,
        /// Steps that help, in order.
        steps: Vec<Said>,
    },
    /// Model that this program runs.
    Model {
        classes: Vec<&'static str>,
        /// Whether the last score is that of movement outside the vocabulary.
        other: bool,
        /// Samples from an instant to its label (`look_ahead`), and from one label to the next (`hold`).
        look_ahead: usize,
        hold: usize,
    },
    /// Program and model on the board, and the connected armband; null where unknown.
    Board {
        version: String,
        revision: String,
        image: String,
        model: Option<String>,
        armband: Option<String>,
        firmware: Option<String>,
        battery: Option<u8>,
    },
    /// Armband that the board follows, and why.
    Binding {
        /// `built-in`, `bound`, `strongest`, `nobody` or `pairing`.
        state: &'static str,
        armband: Option<String>,
        /// Whether the binding outlasts a restart.
        kept: bool,
    },
    /// Losses and dropped data that the board has counted since its start.
    Counts {
        connections: u32,
        notifications: u32,
        lost: u32,
        malformed: u32,
        packets_dropped: u32,
        lines_dropped: u32,
        emg_dropped: u32,
    },
    /// Losses between board and PC since the program's start.
    Line {
        /// Lines that could not be read.
        damaged: u32,
        /// Numbered lines that never came.
        missing: u32,
        /// Samples whose `$EMG` line never came.
        samples: u32,
    },
    /// Consecutive samples, as the armband sent them.
    Samples {
        at: f64,
        first: u32,
        emg: Vec<Sample>,
        /// Label of each sample in the recording, if it has any.
        #[serde(skip_serializing_if = "Option::is_none")]
        truth: Option<Vec<Option<&'static str>>>,
    },
    /// Fault of each electrode: `silent`, `clipped` or `hum`; null without one. When they change, or the strengths.
    Electrodes {
        faults: [Option<&'static str>; CHANNELS],
        /// Greatest number of times its rest that each electrode has reached; null before the hand was moved.
        times: Option<[u8; CHANNELS]>,
    },
    /// Movement of the armband.
    Imu {
        at: f64,
        /// Sample that was due when it came.
        sample: u32,
        #[serde(flatten, serialize_with = "units")]
        imu: Imu,
    },
    /// Label, or change of state.
    Report {
        at: f64,
        is_label: bool,
        number: u32,
        instant: u32,
        emitted: u32,
        label: &'static str,
        valid: bool,
        /// Cause of the safe state.
        cause: Option<&'static str>,
        lost: u32,
        bridged: u32,
        resets: u32,
        /// Percent of the wearer's range; null if a board does not write it.
        strength: Option<u8>,
    },
    /// State of an alignment.
    Alignment {
        at: f64,
        state: &'static str,
        gestures: u8,
        turn: u8,
        mirrored: bool,
        /// Distance in hundredths of a nat; only with a result.
        distance: Option<u32>,
        margin: Option<u32>,
    },
    /// State of a calibration.
    Calibration {
        at: f64,
        state: &'static str,
        /// Cue of the wearer, its seconds, and the next one; null where unknown.
        cue: Option<&'static str>,
        seconds: Option<f64>,
        next: Option<&'static str>,
        /// Seconds from the beginning of the cue to the end.
        left: Option<f64>,
        /// Recall in round two in thousandths, of the head before and of the learnt one; only with a result.
        before: Option<u32>,
        learnt: Option<u32>,
        in_use: bool,
    },
    /// State of the task of box and blocks.
    Blocks {
        at: f64,
        /// `running`, `done`, `cancelled` or `interrupted`.
        state: &'static str,
        /// Hand that is asked for; null unless it is running.
        cue: Option<&'static str>,
        moved: u32,
        /// Seconds left; null before the first fist and after the end.
        left: Option<f64>,
    },
    /// Remarks on the session.
    Remarks { remarks: Vec<Remark> },
    /// File to save; each letter of the content is a byte.
    File { name: String, content: String },
    /// Probability of each class at an instant, sent when its label is decided.
    Scores { instant: u32, scores: Vec<f32> },
    /// Mark of a viewer at a sample, or the restart of a recording.
    Mark { sample: u32, text: String },
    /// Comment line of the board.
    Comment {
        at: f64,
        #[serde(flatten)]
        said: Said,
    },
    /// State of the recording session.
    Session {
        #[serde(flatten)]
        view: View,
        /// Error that keeps the session from being written, and advice; null if none.
        trouble: Option<Box<Said>>,
    },
    /// Viewer who leads the session; null if nobody does.
    Lead { viewer: Option<ViewerId> },
    /// Recordings that were kept of the session.
    Kept(SessionResult),
    /// Progress or result of tuning a model on the recordings.
    Tuning(Box<TuningState>),
    /// Progress or result of installing the tuned model on the board.
    Installing(InstallationState),
    /// End of the program.
    End,
}

/// Writes a movement in its units: g, degrees a second.
fn units<S: Serializer>(imu: &Imu, output: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Units {
        quaternion: [f32; 4],
        acceleration: [f32; 3],
        turn_rate: [f32; 3],
    }
    let (quaternion, acceleration, turn_rate) =
        (imu.quaternion(), imu.acceleration(), imu.turn_rate());
    Units {
        quaternion,
        acceleration,
        turn_rate,
    }
    .serialize(output)
}

/// Newest event of each kind: what a new viewer has to know.
#[derive(Debug, Default)]
pub struct Known(Vec<Event>);

impl Known {
    /// Takes an event. One that the stream is gone has all forgotten about labels, placement and board; one that a session waits,
    /// about the session before it.
    pub fn take(&mut self, event: &Event) {
        let is_over: fn(&Event) -> bool = match event {
            Event::Source {
                connected: false, ..
            } => Event::is_of_stream,
            Event::Session { view, .. } if view.phase == "waiting" => Event::is_of_ended_session,
            _ => |_| false,
        };
        self.0.retain(|known| !is_over(known));
        let is_same = |known: &&mut Event| discriminant(*known) == discriminant(event);
        match self.0.iter_mut().find(is_same) {
            Some(known) => known.clone_from(event),
            None if event.is_of_moment() => {}
            None => self.0.push(event.clone()),
        }
    }

    /// The events, in the order in which their kinds came.
    pub fn events(&self) -> impl Iterator<Item = &Event> {
        self.0.iter()
    }
}

impl Event {
    /// Whether a new viewer need not know it.
    const fn is_of_moment(&self) -> bool {
        matches!(
            self,
            Self::Hello { .. }
                | Self::Pong { .. }
                | Self::Refused { .. }
                | Self::Samples { .. }
                | Self::Imu { .. }
                | Self::Scores { .. }
                | Self::Mark { .. }
                | Self::File { .. }
                | Self::Comment { .. }
                | Self::End
        )
    }

    /// Whether it tells of labels, placement or the board.
    const fn is_of_stream(&self) -> bool {
        matches!(
            self,
            Self::Report { .. }
                | Self::Alignment { .. }
                | Self::Calibration { .. }
                | Self::Electrodes { .. }
                | Self::Board { .. }
                | Self::Binding { .. }
                | Self::Counts { .. }
        )
    }

    /// Whether it tells what became of a session.
    const fn is_of_ended_session(&self) -> bool {
        matches!(self, Self::Kept(_) | Self::Tuning(_) | Self::Installing(_))
    }

    /// Score of a task that has ended.
    pub fn score(&self) -> Option<u32> {
        match self {
            Self::Blocks {
                state: "done",
                moved,
                ..
            } => Some(*moved),
            _ => None,
        }
    }

    /// First message to a viewer.
    pub const fn hello(now: f64, you: ViewerId, record: bool, tunes: bool) -> Self {
        Self::Hello {
            version: env!("CARGO_PKG_VERSION"),
            now,
            you,
            record,
            tunes,
        }
    }

    /// Refusal of a request.
    pub fn refused(why: NotDone) -> Self {
        Self::Refused {
            why: Said::of("request", &why),
        }
    }

    /// Mark of a viewer: at most 80 characters, none of them a control character.
    pub fn of_mark(sample: u32, text: &str) -> Self {
        let letters = text.chars().filter(|letter| !letter.is_control());
        Self::Mark {
            sample,
            text: letters.take(MAX_MARK).collect(),
        }
    }

    /// Event for a report of a pipeline or a board.
    pub fn of_report(at: f64, report: &Report) -> Self {
        Self::Report {
            at,
            is_label: report.kind == shared::uart_line::ReportKind::Label,
            number: report.sequence,
            instant: report.instant.0,
            emitted: report.emitted.0,
            label: report.status.label().name(),
            valid: report.status.valid(),
            cause: report.status.cause().map(Cause::name),
            lost: report.counters.lost,
            bridged: report.counters.bridged,
            resets: report.counters.resets,
            strength: report.strength.map(Percent::get),
        }
    }

    /// Event for a report of an alignment.
    pub fn of_alignment(at: f64, report: &AlignmentReport) -> Self {
        Self::Alignment {
            at,
            state: report.state.name(),
            gestures: report.gestures,
            turn: report.alignment.turn(),
            mirrored: report.alignment.mirrored(),
            distance: report.quality.map(|own| own.distance),
            margin: report.quality.map(|own| own.margin),
        }
    }

    /// Event for an alignment in force whose own report was not received.
    pub const fn of_placement(at: f64, alignment: Alignment) -> Self {
        Self::Alignment {
            at,
            state: "in-force",
            gestures: 0,
            turn: alignment.turn(),
            mirrored: alignment.mirrored(),
            distance: None,
            margin: None,
        }
    }

    /// Event for the model that runs.
    pub fn of_model(model: &Model<'_>) -> Self {
        let header = &model.header;
        let intents = header.dimensions.vocabulary.intents();
        Self::Model {
            classes: intents.iter().copied().map(Intent::name).collect(),
            other: header.dimensions.other,
            look_ahead: header.smoother.look_ahead,
            hold: header.smoother.hold,
        }
    }

    /// Event for what a board says of itself.
    pub fn of_identity(identity: &Identity<'_>) -> Self {
        let firmware = |version: shared::myo::FirmwareVersion| {
            format!("{}.{}.{}", version.major, version.minor, version.patch)
        };
        Self::Board {
            version: identity.version.to_owned(),
            revision: identity.revision.to_owned(),
            image: identity.image.to_owned(),
            model: identity.model.map(|checksum| format!("{checksum:08x}")),
            armband: identity.armband.map(|address| address.to_string()),
            firmware: identity.firmware.map(firmware),
            battery: identity.battery,
        }
    }

    /// Event for what a board follows.
    pub fn of_binding(binding: &Binding) -> Self {
        let armband = binding.following.address();
        Self::Binding {
            state: binding.name(),
            armband: armband.map(|address| address.to_string()),
            kept: binding.is_kept,
        }
    }

    /// Event for what a board has lost.
    pub const fn of_counts(counts: &Counts) -> Self {
        Self::Counts {
            connections: counts.session.connections,
            notifications: counts.session.notifications,
            lost: counts.session.lost,
            malformed: counts.session.malformed,
            packets_dropped: counts.packets_dropped,
            lines_dropped: counts.lines_dropped,
            emg_dropped: counts.emg_dropped,
        }
    }
}
