//! Dialogue with a board, without I/O: takes bytes and time, returns events and commands.

mod schedule;

use shared::myo::Following;
use shared::stream::alignment::Alignment;
use shared::uart_line::answer::Answer;
use shared::uart_line::command::Command;
use shared::uart_line::emg::EmgReport;
use shared::uart_line::line::{Line, LineReader};
use shared::units::{Millis, SampleIndex};

use self::schedule::CommandSchedule;
use crate::live::event::Event;

/// Time without a line after which no board is connected. A board answers every command.
const SILENCE_MS: u32 = 5_000;

/// Content of a received line.
#[derive(Clone, PartialEq, Debug)]
pub(super) enum BoardEvent {
    /// Event for viewers.
    Publish(Event),
    /// Two samples, and the number missing before them; none for a new stream.
    Samples(EmgReport, Option<u32>),
    /// Alignment in force on the board.
    Alignment(Alignment),
    /// Restart of the board: its counts begin anew.
    Restart,
}

/// State of the connection to a board.
#[derive(Debug)]
pub(super) struct Dialogue {
    reader: LineReader,
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
}

/// Losses on the line.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub(super) struct Losses {
    damaged: u32,
    missing: u32,
    samples: u32,
}

impl Dialogue {
    /// State at the beginning of a connection; continues the losses of earlier ones.
    pub(super) fn new(now: Millis, losses: Losses) -> Self {
        Self {
            reader: LineReader::new(),
            began: now,
            last_line: None,
            last_samples: None,
            schedule: CommandSchedule::default(),
            alignment: None,
            next_number: None,
            next_sample: None,
            losses,
            reported: None,
        }
    }

    pub(super) const fn losses(&self) -> Losses {
        self.losses
    }

    /// Whether no line has come for 5 s.
    pub(super) fn is_silent(&self, now: Millis) -> bool {
        now.elapsed_since(self.last_line.unwrap_or(self.began)) >= SILENCE_MS
    }

    /// Whether a line has come since the beginning.
    pub(super) const fn has_received(&self) -> bool {
        self.last_line.is_some()
    }

    /// Returns the next command that is due; to be called until there is none.
    pub(super) fn command(&mut self, now: Millis) -> Option<Command> {
        self.schedule.command(now, self.last_samples)
    }

    /// Takes received bytes. `at` is the time in the events for viewers.
    pub(super) fn bytes(
        &mut self,
        now: Millis,
        at: f64,
        bytes: &[u8],
        mut output: impl FnMut(BoardEvent),
    ) {
        for &byte in bytes {
            match self.reader.push(byte) {
                None => continue,
                Some(Err(_)) => self.losses.damaged = self.losses.damaged.saturating_add(1),
                Some(Ok(line)) => {
                    self.last_line = Some(now);
                    // The borrow of the reader ends before `take`.
                    let content = LineContent::of(line, at);
                    self.take(now, content, &mut output);
                }
            }
        }
        if self.reported != Some(self.losses) {
            self.reported = Some(self.losses);
            let Losses {
                damaged,
                missing,
                samples,
            } = self.losses;
            output(BoardEvent::Publish(Event::Line {
                damaged,
                missing,
                samples,
            }));
        }
    }

    fn take(&mut self, now: Millis, content: LineContent, output: &mut impl FnMut(BoardEvent)) {
        if let Some(number) = content.number {
            let restarted = self.next_number.is_some_and(|next| is_before(number, next));
            if restarted {
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
        if let Some(following) = content.following {
            self.schedule.follows(following);
        }
        if let Some(alignment) = content.alignment {
            self.alignment = Some(alignment);
            output(BoardEvent::Alignment(alignment));
        }
        // The alignment was made before this connection, or its report was lost.
        if let Some((at, alignment)) = content.placement
            && self.alignment != Some(alignment)
        {
            self.alignment = Some(alignment);
            output(BoardEvent::Alignment(alignment));
            output(BoardEvent::Publish(Event::of_placement(at, alignment)));
        }
        if let Some(report) = content.emg {
            self.last_samples = Some(now);
            let missing = self.missing(report.first);
            self.next_sample = Some(report.first.plus(report.samples.len() as u32));
            self.losses.samples = self.losses.samples.saturating_add(missing.unwrap_or(0));
            output(BoardEvent::Samples(report, missing));
        }
        if let Some(event) = content.event {
            output(BoardEvent::Publish(event));
        }
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

/// Content of one line.
#[derive(Default)]
struct LineContent {
    number: Option<u32>,
    emg: Option<EmgReport>,
    alignment: Option<Alignment>,
    following: Option<Following>,
    /// Answer to the question for the alignment, and its time.
    placement: Option<(f64, Alignment)>,
    event: Option<Event>,
}

impl LineContent {
    fn of(line: Line<'_>, at: f64) -> Self {
        match line {
            Line::Report(report) => Self {
                number: Some(report.sequence),
                event: Some(Event::of_report(at, &report)),
                ..Self::default()
            },
            Line::Alignment(report) => Self {
                number: Some(report.sequence),
                alignment: Some(report.alignment),
                event: Some(Event::of_alignment(at, &report)),
                ..Self::default()
            },
            Line::Emg(report) => Self {
                emg: Some(report),
                event: Some(Event::Samples {
                    at,
                    first: report.first.0,
                    emg: report.samples.to_vec(),
                    truth: None,
                }),
                ..Self::default()
            },
            Line::Answer(Answer::Alignment(alignment)) => Self {
                placement: Some((at, alignment)),
                ..Self::default()
            },
            Line::Answer(Answer::Binding(binding)) => Self {
                following: Some(binding.following),
                event: Some(Event::of_binding(&binding)),
                ..Self::default()
            },
            Line::Answer(answer) => Self {
                event: Self::of_answer(answer, at),
                ..Self::default()
            },
            Line::Comment(text) => Self {
                event: Some(Event::Comment {
                    at,
                    text: text.trim().to_owned(),
                }),
                ..Self::default()
            },
        }
    }

    fn of_answer(answer: Answer<'_>, at: f64) -> Option<Event> {
        match answer {
            Answer::Identity(identity) => Some(Event::of_identity(&identity)),
            Answer::Counts(counts) => Some(Event::of_counts(&counts)),
            // Refusals of a viewer's request: an alignment or a pairing.
            Answer::Refused(why) => Some(Event::Comment {
                at,
                text: format!("the board refuses: {why}"),
            }),
            Answer::Align(_)
            | Answer::Alignment(_)
            | Answer::Raw(_)
            | Answer::Binding(_)
            | Answer::Gate(_)
            | Answer::Install(_) => None,
        }
    }
}

#[cfg(test)]
mod tests;
