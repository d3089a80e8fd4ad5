//! A session that a source drives: its samples go to the session and its journal, cues to a simulated person.

use std::io::Write;

use recordings::labels::motion::Motion;
use shared::myo::Imu;
use shared::stream::alignment::Alignment;
use shared::units::{Millis, Sample, SampleIndex};

use super::journal::{Entry, Writer};
use super::protocol::Protocol;
use super::session::{HoldReason, Input, Output, Session};
use crate::SharedCue;
use crate::event::Event;

/// Journal that takes what is recorded.
pub trait Lines {
    /// Takes consecutive samples.
    fn samples(&mut self, first: SampleIndex, samples: &[Sample]);
    /// Takes movement, which is written with the samples around it.
    fn imu(&mut self, due: SampleIndex, imu: Imu);
    /// Takes an entry of another kind.
    fn entry(&mut self, entry: &Entry);
}

impl<W: Write> Lines for Writer<W> {
    fn samples(&mut self, first: SampleIndex, samples: &[Sample]) {
        Self::samples(self, first, samples);
    }

    fn imu(&mut self, due: SampleIndex, imu: Imu) {
        Self::imu(self, due, imu);
    }

    fn entry(&mut self, entry: &Entry) {
        Self::entry(self, entry);
    }
}

/// Session with its journal.
#[derive(Debug)]
pub struct Guided<J> {
    session: Session,
    journal: Option<J>,
    /// Placement of the armband, as it is aligned.
    placement: Alignment,
    /// Cue for a simulated person.
    cue: SharedCue,
}

impl<J: Lines> Guided<J> {
    /// A session that waits for its beginning.
    pub fn new(protocol: Protocol, cue: SharedCue) -> Self {
        Self {
            session: Session::new(protocol),
            journal: None,
            placement: Alignment::NONE,
            cue,
        }
    }

    /// Waits for the beginning of another session.
    pub fn restart(&mut self, protocol: Protocol) {
        self.session = Session::new(protocol);
    }

    /// The session.
    pub const fn session(&self) -> &Session {
        &self.session
    }

    /// The journal; none before the beginning.
    pub const fn journal(&mut self) -> &mut Option<J> {
        &mut self.journal
    }

    /// Takes a journal with its header.
    pub fn write_to(&mut self, journal: J) {
        self.journal = Some(journal);
        self.write_placement();
    }

    /// Takes an event of the source.
    pub fn event(&mut self, now: Millis, event: &Event) {
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
    pub fn handle(&mut self, now: Millis, input: Input) {
        self.session.handle(now, input);
        self.write_outputs();
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
        if let Some(journal) = &mut self.journal {
            journal.entry(&Entry::Placement { turn, mirrored });
        }
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
        self.cue.read(first.plus(count));
    }

    /// Writes the session's outputs to the journal, and passes cues to the simulated person.
    fn write_outputs(&mut self) {
        while let Some(output) = self.session.poll() {
            if let Output::Cue { cue, .. } = output {
                self.cue.set(cue.unwrap_or(Motion::RELAX));
            }
            if let Output::Pause | Output::Over = output {
                self.cue.set(Motion::RELAX);
            }
            if let Some(journal) = &mut self.journal {
                journal.entry(&Entry::of(output));
            }
        }
    }
}
