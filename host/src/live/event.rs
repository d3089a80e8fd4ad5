//! What a viewer is told: the messages of the websocket, each a JSON object with its `type`.

use serde::Serialize;
use shared::intent::Intent;
use shared::model::file::Model;
use shared::stream::alignment::Alignment;
use shared::stream::safe_state::Cause;
use shared::uart_line::Report;
use shared::uart_line::alignment::AlignmentReport;
use shared::uart_line::answer::{Binding, Counts, Identity};
use shared::units::Sample;

use super::lead::ViewerId;
use super::outcome::{Installing, Kept, Tuning};
use crate::record::session::View;

/// One message. Times `at` are milliseconds of the server's clock, samples are numbered as on the UART.
#[derive(Clone, PartialEq, Debug, Serialize)]
#[serde(tag = "type", rename_all = "snake_case")]
pub(crate) enum Event {
    /// Where the stream comes from, and whether it does.
    Source {
        /// `demo`, `replay`, `port` or `bluetooth`.
        kind: &'static str,
        /// Path or name.
        name: String,
        connected: bool,
        /// What is known, and what to do; empty if nothing.
        detail: String,
    },
    /// The model that runs here.
    Model {
        classes: Vec<&'static str>,
        /// Whether the scores end with that of movement outside the vocabulary.
        other: bool,
        /// Samples from an instant to the label for it, and from one label to the next.
        look_ahead: usize,
        hold: usize,
    },
    /// What runs on the board, and the armband that is connected to it; null where unknown.
    Board {
        version: String,
        revision: String,
        image: String,
        model: Option<String>,
        armband: Option<String>,
        firmware: Option<String>,
        battery: Option<u8>,
    },
    /// Which armband the board follows, and why.
    Binding {
        /// `built-in`, `bound`, `strongest`, `nobody` or `pairing`.
        state: &'static str,
        armband: Option<String>,
        /// Whether it outlasts a restart.
        kept: bool,
    },
    /// What the board has lost and dropped since its start.
    Counts {
        connections: u32,
        notifications: u32,
        lost: u32,
        malformed: u32,
        packets_dropped: u32,
        lines_dropped: u32,
        emg_dropped: u32,
    },
    /// What was lost between board and PC since the program's start.
    Line {
        /// Lines that could not be read.
        damaged: u32,
        /// Lines with a number that never came.
        missing: u32,
        /// Samples whose `$EMG` line never came.
        samples: u32,
    },
    /// Consecutive samples, as the armband sent them.
    Samples {
        at: f64,
        first: u32,
        emg: Vec<Sample>,
        /// The recording's label of each, if it has any.
        #[serde(skip_serializing_if = "Option::is_none")]
        truth: Option<Vec<Option<&'static str>>>,
    },
    /// A label, or a change of state.
    Report {
        at: f64,
        is_label: bool,
        number: u32,
        instant: u32,
        emitted: u32,
        label: &'static str,
        valid: bool,
        /// Of the safe state.
        cause: Option<&'static str>,
        lost: u32,
        bridged: u32,
        resets: u32,
    },
    /// What an alignment does.
    Alignment {
        at: f64,
        state: &'static str,
        gestures: u8,
        turn: u8,
        mirrored: bool,
        /// In hundredths of a nat; with a result alone.
        distance: Option<u32>,
        margin: Option<u32>,
    },
    /// The probability of every class at an instant, as the label for it is decided.
    Scores { instant: u32, scores: Vec<f32> },
    /// A viewer marked a sample, or a recording begins again.
    Mark { sample: u32, text: String },
    /// What the board writes for people.
    Comment { at: f64, text: String },
    /// Where the recording session is.
    Session {
        #[serde(flatten)]
        view: View,
        /// What keeps it from being written, and what to do; empty if nothing.
        trouble: String,
    },
    /// Who leads it; nobody if null.
    Lead { viewer: Option<ViewerId> },
    /// What was kept of it.
    Kept(Kept),
    /// What comes of tuning a model on it.
    Tuning(Tuning),
    /// What comes of putting the tuned model on the board.
    Installing(Installing),
    /// The program ends.
    End,
}

/// What a new viewer is told first: the newest event of each of these kinds.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub(crate) enum Topic {
    Source,
    Model,
    Board,
    Binding,
    Counts,
    Line,
    Report,
    Alignment,
    Session,
    Lead,
    Kept,
    Tuning,
    Installing,
}

impl Event {
    /// The kind of those events that a new viewer is told; none for what is over when it happened.
    pub(crate) const fn topic(&self) -> Option<Topic> {
        Some(match self {
            Self::Source { .. } => Topic::Source,
            Self::Model { .. } => Topic::Model,
            Self::Board { .. } => Topic::Board,
            Self::Binding { .. } => Topic::Binding,
            Self::Counts { .. } => Topic::Counts,
            Self::Line { .. } => Topic::Line,
            Self::Report { .. } => Topic::Report,
            Self::Alignment { .. } => Topic::Alignment,
            Self::Session { .. } => Topic::Session,
            Self::Lead { .. } => Topic::Lead,
            Self::Kept(_) => Topic::Kept,
            Self::Tuning(_) => Topic::Tuning,
            Self::Installing(_) => Topic::Installing,
            _ => return None,
        })
    }

    pub(crate) fn of_report(at: f64, report: &Report) -> Self {
        Self::Report {
            at,
            is_label: report.kind == shared::uart_line::Kind::Label,
            number: report.sequence,
            instant: report.instant.0,
            emitted: report.emitted.0,
            label: report.status.label().name(),
            valid: report.status.valid(),
            cause: report.status.cause().map(Cause::name),
            lost: report.counters.lost,
            bridged: report.counters.bridged,
            resets: report.counters.resets,
        }
    }

    pub(crate) fn of_alignment(at: f64, report: &AlignmentReport) -> Self {
        Self::Alignment {
            at,
            state: report.state.name(),
            gestures: report.gestures,
            turn: report.alignment.turn(),
            mirrored: report.alignment.mirrored(),
            distance: report.quality.map(|(distance, _)| distance),
            margin: report.quality.map(|(_, margin)| margin),
        }
    }

    /// An alignment that was made before, or on a line that was lost.
    pub(crate) const fn of_placement(at: f64, alignment: Alignment) -> Self {
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

    pub(crate) fn of_model(model: &Model<'_>) -> Self {
        let header = &model.header;
        let intents = header.dimensions.vocabulary.intents();
        Self::Model {
            classes: intents.iter().copied().map(Intent::name).collect(),
            other: header.dimensions.other,
            look_ahead: header.smoother.look_ahead,
            hold: header.smoother.hold,
        }
    }

    pub(crate) fn of_identity(identity: &Identity<'_>) -> Self {
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

    pub(crate) fn of_binding(binding: &Binding) -> Self {
        let armband = binding.following.address();
        Self::Binding {
            state: binding.name(),
            armband: armband.map(|address| address.to_string()),
            kept: binding.is_kept,
        }
    }

    pub(crate) const fn of_counts(counts: &Counts) -> Self {
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
