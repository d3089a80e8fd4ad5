//! Writer of lines to an output that may fail: data it does not take is kept and tried again.

use std::io::{self, ErrorKind, Write};

use shared::myo::Imu;
use shared::units::{Sample, SampleIndex};

use super::Entry;

/// Samples in a line: a tenth of a second. A killed process loses so much, and the samples on their way here.
pub const TOGETHER: usize = 20;
/// Bytes that are kept while the output takes nothing: more than an hour of samples.
const MOST_PENDING: usize = 16 << 20;

/// Writer of a journal's lines.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    /// Bytes not yet taken; begins within a line if the output took a part of it.
    pending: Vec<u8>,
    /// Number of lines taken.
    lines: u32,
    first: SampleIndex,
    samples: Vec<Sample>,
    /// Movement since the last line, with the index of the sample that was due.
    movement: Vec<(u32, [i16; 10])>,
    /// Entries that each round repeats: without them the rest of a damaged journal has no meaning.
    repeated: Vec<Entry>,
}

impl<W: Write> Writer<W> {
    /// Creates a writer to an empty file.
    pub const fn new(out: W) -> Self {
        Self {
            out,
            pending: Vec::new(),
            lines: 0,
            first: SampleIndex(0),
            samples: Vec::new(),
            movement: Vec::new(),
            repeated: Vec::new(),
        }
    }

    /// Takes consecutive samples. Beyond the limit they are dropped, which leaves a gap in their index.
    pub fn samples(&mut self, first: SampleIndex, samples: &[Sample]) {
        if self.pending.len() > MOST_PENDING {
            return;
        }
        let due = self.first.plus(self.samples.len() as u32);
        if due != first {
            self.close();
        }
        if self.samples.is_empty() {
            self.first = first;
        }
        self.samples.extend_from_slice(samples);
        if self.samples.len() >= TOGETHER {
            self.close();
        }
    }

    /// Takes movement; it is written behind the next line of samples.
    pub fn imu(&mut self, due: SampleIndex, imu: Imu) {
        self.movement.push((due.0, imu.0));
    }

    /// Takes an entry of another kind, after the samples before it.
    pub fn entry(&mut self, entry: &Entry) {
        self.close();
        match entry {
            Entry::Begin(_) => self.repeated = vec![entry.clone()],
            Entry::Placement { .. } => {
                self.repeated.truncate(1);
                self.repeated.push(entry.clone());
            }
            Entry::Round { .. } => {
                for own in self.repeated.clone() {
                    self.line(&own);
                }
            }
            _ => {}
        }
        self.line(entry);
    }

    fn line(&mut self, entry: &Entry) {
        let line = entry.line(self.lines);
        self.pending.extend_from_slice(line.as_bytes());
        self.lines += 1;
    }

    /// Takes whole lines, which have their numbers.
    pub fn text(&mut self, lines: &str) {
        self.pending.extend_from_slice(lines.as_bytes());
    }

    /// Ends the line of samples, and that of movement.
    pub fn close(&mut self) {
        if !self.samples.is_empty() {
            let entry = Entry::samples(self.first, &self.samples);
            self.samples.clear();
            self.line(&entry);
            if !self.movement.is_empty() {
                let rows = std::mem::take(&mut self.movement);
                self.line(&Entry::Imu { rows });
            }
        }
    }

    /// Writes pending bytes.
    ///
    /// # Errors
    /// When the output takes no more. Bytes not yet taken are kept for the next call.
    pub fn flush(&mut self) -> io::Result<()> {
        while !self.pending.is_empty() {
            match self.out.write(&self.pending) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(taken) => drop(self.pending.drain(..taken)),
                Err(error) if error.kind() == ErrorKind::Interrupted => {}
                Err(error) => return Err(error),
            }
        }
        self.out.flush()
    }

    /// Continues in another output that has all bytes taken so far.
    pub fn redirect(&mut self, out: W) {
        self.out = out;
    }

    /// Number of bytes not yet taken.
    pub const fn pending(&self) -> usize {
        self.pending.len()
    }

    /// Output of the writer.
    pub const fn get_ref(&self) -> &W {
        &self.out
    }
}
