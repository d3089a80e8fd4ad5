//! Spans of executed instructions.

use core::hint::black_box;

use device::timer::{self, Instant};
use shared::model::encoder::{EncoderPart, Probe};

/// Counts of a repeated piece of work.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct Spans {
    sum: u64,
    largest: u32,
    count: u32,
}

impl Spans {
    pub fn push(&mut self, instructions: u32) {
        self.sum += u64::from(instructions);
        self.largest = self.largest.max(instructions);
        self.count += 1;
    }

    pub const fn count(&self) -> u32 {
        self.count
    }

    /// Their mean, rounded; 0 if there are none.
    pub fn mean(&self) -> u64 {
        let count = u64::from(self.count.max(1));
        (self.sum + count / 2) / count
    }

    pub const fn largest(&self) -> u32 {
        self.largest
    }
}

/// Counts spans, less the cost of counting.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    empty: u32,
}

impl Clock {
    /// Measures the count of an empty span.
    pub fn new() -> Self {
        let clock = Self { empty: 0 };
        let empty = (0..8).map(|_| clock.span(|| ()).1).min();
        Self {
            empty: empty.unwrap_or(0),
        }
    }

    /// Does the work; returns its result and its instructions.
    #[inline(always)]
    pub fn span<T>(&self, work: impl FnOnce() -> T) -> (T, u32) {
        let start = timer::now();
        let result = black_box(work());
        let end = timer::now();
        (result, self.between(start, end))
    }

    fn between(&self, start: Instant, end: Instant) -> u32 {
        (end.instructions() - start.instructions()).saturating_sub(self.empty)
    }

    /// A probe for a step that starts now.
    pub fn probe(&self) -> Steps {
        Steps {
            clock: *self,
            parts: [0; 4],
            last: timer::now(),
        }
    }
}

/// The parts of one step of the encoder.
#[derive(Debug)]
pub struct Steps {
    clock: Clock,
    /// Embed, attention, feed-forward, head; summed over the layers.
    pub parts: [u32; 4],
    last: Instant,
}

impl Probe for Steps {
    /// Reads the timer first and last: the bookkeeping between belongs to no part.
    #[inline(always)]
    fn done(&mut self, part: EncoderPart) {
        let end = timer::now();
        let place = match part {
            EncoderPart::Embed => 0,
            EncoderPart::Attention => 1,
            EncoderPart::FeedForward => 2,
            EncoderPart::Head => 3,
        };
        self.parts[place] += self.clock.between(self.last, end);
        self.last = timer::now();
    }
}
