//! Lines to a writer that may fail: what it does not take is kept, and tried again.

use std::io::{self, ErrorKind, Write};

use shared::units::{Sample, SampleIndex};

use super::Entry;

/// Samples of a line: a tenth of a second. So much is lost if the process is killed, and what was on its way here.
const TOGETHER: usize = 20;
/// Bytes that are kept while the writer takes nothing: an hour and more of samples.
const MOST_PENDING: usize = 16 << 20;

/// A journal's lines on their way.
#[derive(Debug)]
pub struct Writer<W> {
    out: W,
    /// Not yet taken; begins within a line if the writer has taken a part of it.
    pending: Vec<u8>,
    first: SampleIndex,
    samples: Vec<Sample>,
}

impl<W: Write> Writer<W> {
    /// To an empty file.
    pub const fn new(out: W) -> Self {
        Self {
            out,
            pending: Vec::new(),
            first: SampleIndex(0),
            samples: Vec::new(),
        }
    }

    /// Takes consecutive samples. Beyond what is kept they are dropped, and leave a gap in the count.
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

    /// Takes anything else, behind the samples before it.
    pub fn entry(&mut self, entry: &Entry) {
        self.close();
        self.pending.extend_from_slice(entry.line().as_bytes());
    }

    /// Ends the line of samples.
    pub fn close(&mut self) {
        if !self.samples.is_empty() {
            let entry = Entry::samples(self.first, &self.samples);
            self.samples.clear();
            self.pending.extend_from_slice(entry.line().as_bytes());
        }
    }

    /// Writes what waits.
    ///
    /// # Errors
    /// When the writer takes no more. What it has not taken is kept for the next time.
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

    /// Goes on in another place, which has all that this one has taken.
    pub fn go_on_in(&mut self, out: W) {
        self.out = out;
    }

    /// Bytes that were not taken.
    pub const fn pending(&self) -> usize {
        self.pending.len()
    }

    /// What it writes to.
    pub const fn get_ref(&self) -> &W {
        &self.out
    }
}
