//! Dialogue with a board, without I/O: takes bytes and time, returns events and commands.

mod schedule;

use shared::stream::alignment::Alignment;
use shared::uart_line::answer::Answer;
use shared::uart_line::calibration::CalibrationReport;
use shared::uart_line::command::Command;
use shared::uart_line::emg::EmgReport;
use shared::uart_line::line::{Line, LineReader};
use shared::units::{Millis, SampleIndex};

use self::schedule::CommandSchedule;
use crate::event::Event;
use crate::installer::{InstallError, Installer};
use crate::outcome::InstallationState;
use crate::said::Said;

/// Time without a line after which no board is connected. A board answers every command.
const SILENCE_MS: u32 = 5_000;

/// Content of a received line.
#[derive(Clone, PartialEq, Debug)]
pub enum BoardEvent {
    /// Event for viewers.
    Publish(Event),
    /// Two samples, and the number missing before them; none for a new stream.
    Samples(EmgReport, Option<u32>),
    /// Alignment in force on the board.
    Alignment(Alignment),
    /// State of the calibration, and whether one is in use.
    Calibration(CalibrationReport, bool),
    /// Restart of the board: its counts begin anew.
    Restart,
}

/// Dialogue with a board.
#[derive(Debug)]
pub struct Dialogue {
    reader: LineReader,
    state: State,
}

/// State of the connection to a board.
#[derive(Debug)]
struct State {
    began: Millis,
    last_line: Option<Millis>,
    last_samples: Option<Millis>,
    schedule: CommandSchedule,
    /// Alignment in force; none while unknown.
    alignment: Option<Alignment>,
    /// Number of the next line.
    next_number: Option<u32>,
    /// Index of the next sample.
    next_sample: Option<SampleIndex>,
    losses: Losses,
    reported: Option<Losses>,
    /// Installation in progress or ended, and what viewers know of it.
    installer: Option<(Installer, Option<InstallationState>)>,
}

/// Losses on the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Losses {
    damaged: u32,
    missing: u32,
    samples: u32,
}

impl Dialogue {
    /// State at the beginning of a connection; continues the losses of earlier ones.
    ///
    /// With `imu` the board is asked for the armband's movement too.
    pub fn new(now: Millis, losses: Losses, imu: bool) -> Self {
        let state = State {
            began: now,
            last_line: None,
            last_samples: None,
            schedule: CommandSchedule::new(imu),
            alignment: None,
            next_number: None,
            next_sample: None,
            losses,
            reported: None,
            installer: None,
        };
        let reader = LineReader::default();
        Self { reader, state }
    }

    /// Begins a connection anew.
    pub fn connected(&mut self, now: Millis, imu: bool) {
        let installer = self.state.installer.take();
        *self = Self::new(now, self.state.losses, imu);
        self.state.installer = installer;
        if let Some((installer, _)) = &mut self.state.installer {
            installer.connected(now);
        }
    }

    /// Lets time pass without a connection.
    pub fn wait(&mut self, now: Millis) {
        if let Some((installer, _)) = &mut self.state.installer {
            installer.wait(now);
        }
    }

    /// Whether no line has come for 5 s.
    pub fn is_silent(&self, now: Millis) -> bool {
        now.elapsed_since(self.state.last_line.unwrap_or(self.state.began)) >= SILENCE_MS
    }

    /// Whether a line has come since the beginning.
    pub const fn has_received(&self) -> bool {
        self.state.last_line.is_some()
    }

    /// Begins an installation. The board is asked for nothing else until it ends.
    pub fn install(&mut self, installer: Installer) {
        self.state.installer = Some((installer, None));
    }

    /// Returns what is new of the installation, and the file once it is in use.
    pub fn installation(&mut self) -> Option<(InstallationState, Option<&[u8]>)> {
        let state = &mut self.state;
        let (installer, known) = state.installer.as_mut()?;
        if known.as_ref().is_some_and(|known| known.state != "running") {
            // Its end was told: this is asked every 10 ms.
            return None;
        }
        let told = InstallationState::of(installer);
        if known.as_ref() == Some(&told) {
            return None;
        }
        *known = Some(told.clone());
        let is_done = matches!(installer.end(), Some(Ok(())));
        if is_done {
            // What holds with the new model is asked for and told.
            state.schedule.restart();
            state.alignment = None;
        }
        Some((told, is_done.then(|| installer.file())))
    }

    /// Returns the next command that is due; to be called until no command is.
    pub fn command(&mut self, now: Millis) -> Option<Command> {
        if let Some((installer, _)) = &mut self.state.installer
            && installer.end().is_none()
        {
            return installer.command(now);
        }
        self.state.schedule.command(now, self.state.last_samples)
    }

    /// Takes received bytes. `at` is the time in the events for viewers.
    pub fn bytes(
        &mut self,
        now: Millis,
        at: f64,
        bytes: &[u8],
        mut output: impl FnMut(BoardEvent),
    ) {
        let Self { reader, state } = self;
        for &byte in bytes {
            match reader.push(byte) {
                None => {}
                Some(Err(_)) => state.losses.damaged = state.losses.damaged.saturating_add(1),
                Some(Ok(line)) => state.line(now, at, line, &mut output),
            }
        }
        if state.reported != Some(state.losses) {
            state.reported = Some(state.losses);
            let Losses {
                damaged,
                missing,
                samples,
            } = state.losses;
            output(BoardEvent::Publish(Event::Line {
                damaged,
                missing,
                samples,
            }));
        }
    }
}

impl State {
    fn line(&mut self, now: Millis, at: f64, line: Line<'_>, output: &mut impl FnMut(BoardEvent)) {
        self.last_line = Some(now);
        if let Some((installer, _)) = &mut self.installer {
            installer.line(now, &line);
        }
        let event = match line {
            Line::Report(report) => {
                self.number(report.sequence, output);
                Event::of_report(at, &report)
            }
            Line::Alignment(report) => {
                self.number(report.sequence, output);
                self.alignment = Some(report.alignment);
                output(BoardEvent::Alignment(report.alignment));
                Event::of_alignment(at, &report)
            }
            Line::Emg(report) => {
                self.last_samples = Some(now);
                let missing = self.missing(report.first);
                self.next_sample = Some(report.first.plus(report.samples.len() as u32));
                self.losses.samples = self.losses.samples.saturating_add(missing.unwrap_or(0));
                output(BoardEvent::Samples(report, missing));
                Event::Samples {
                    at,
                    first: report.first.0,
                    emg: report.samples.to_vec(),
                    truth: None,
                }
            }
            Line::Imu(report) => Event::Imu {
                at,
                sample: report.sample.0,
                imu: report.imu,
            },
            // The alignment was made before this connection, or its report was lost.
            Line::Answer(Answer::Alignment(alignment)) if self.alignment != Some(alignment) => {
                self.alignment = Some(alignment);
                output(BoardEvent::Alignment(alignment));
                Event::of_placement(at, alignment)
            }
            Line::Answer(Answer::Binding(binding)) => {
                self.schedule.follows(binding.following);
                Event::of_binding(&binding)
            }
            Line::Answer(Answer::Calibration(report, in_use)) => {
                self.schedule.calibrates(report.state);
                return output(BoardEvent::Calibration(report, in_use));
            }
            Line::Answer(Answer::Identity(identity)) => Event::of_identity(&identity),
            Line::Answer(Answer::Counts(counts)) => Event::of_counts(&counts),
            // Refusal of a viewer's request: an alignment or a pairing.
            Line::Answer(Answer::Refused(why)) => Event::Comment {
                at,
                said: Said::of("board", &InstallError::Refused { why }),
            },
            Line::Answer(
                Answer::Battery(_)
                | Answer::Align(_)
                | Answer::Alignment(_)
                | Answer::Raw(_)
                | Answer::Imu(_)
                | Answer::Strength(_)
                | Answer::Gate(_)
                | Answer::Lock(_)
                | Answer::Hid(_)
                | Answer::Install(_),
            )
            | Line::Calibration(_) => return,
            Line::Comment(text) => Event::Comment {
                at,
                said: Said::plain(text.trim()),
            },
        };
        output(BoardEvent::Publish(event));
    }

    /// Takes the number of a line, which tells of lost lines and of a restart.
    fn number(&mut self, number: u32, output: &mut impl FnMut(BoardEvent)) {
        if self.next_number.is_some_and(|next| is_before(number, next)) {
            self.next_sample = None;
            self.schedule.restart();
            self.alignment = None;
            output(BoardEvent::Restart);
        } else {
            let missing = self.next_number.map_or(0, |next| number.wrapping_sub(next));
            self.losses.missing = self.losses.missing.saturating_add(missing);
        }
        self.next_number = Some(number.wrapping_add(1));
    }

    /// Number of samples missing before `first`; none if it begins a stream.
    fn missing(&self, first: SampleIndex) -> Option<u32> {
        let next = self.next_sample?;
        (!is_before(first.0, next.0)).then(|| first.since(next))
    }
}

/// Whether a count went backwards; correct across a wrap.
const fn is_before(count: u32, expected: u32) -> bool {
    count.wrapping_sub(expected) > u32::MAX / 2
}

#[cfg(test)]
mod tests;
