//! Lines of a journal, made of samples and of what happens between them.

use shared::myo::Imu;
use shared::units::{Sample, SampleIndex};

use super::Entry;

/// Samples in a line: a tenth of a second. A killed process loses so much, and the samples on their way here.
pub const TOGETHER: usize = 20;

/// Writer of a journal's lines.
#[derive(Debug, Default)]
pub struct Writer {
    /// Lines that were not taken yet.
    text: String,
    /// Number of all lines.
    lines: u32,
    /// Index of the first of `samples`, which are for the next line.
    first: u32,
    samples: Vec<Sample>,
    /// Movement since the last line, with the index of the sample that was due.
    movement: Vec<(u32, [i16; 10])>,
    /// Entries that each round repeats: without them the rest of a damaged journal has no meaning.
    repeated: Vec<Entry>,
}

impl Writer {
    /// Writes consecutive samples.
    pub fn samples(&mut self, first: SampleIndex, samples: &[Sample]) {
        let due = SampleIndex(self.first).plus(self.samples.len() as u32);
        if due != first {
            self.close();
        }
        if self.samples.is_empty() {
            self.first = first.0;
        }
        self.samples.extend_from_slice(samples);
        if self.samples.len() >= TOGETHER {
            self.close();
        }
    }

    /// Writes movement, behind the next line of samples.
    pub fn imu(&mut self, due: SampleIndex, imu: Imu) {
        self.movement.push((due.0, imu.0));
    }

    /// Writes an entry of another kind, after the samples before it.
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
        self.text += &entry.line(self.lines);
        self.lines += 1;
    }

    /// Ends the line of samples, and that of movement.
    pub fn close(&mut self) {
        if !self.samples.is_empty() {
            let samples = std::mem::take(&mut self.samples);
            self.line(&Entry::samples(SampleIndex(self.first), &samples));
            if !self.movement.is_empty() {
                let rows = std::mem::take(&mut self.movement);
                self.line(&Entry::Imu { rows });
            }
        }
    }

    /// Returns the whole lines since the last call.
    pub fn take(&mut self) -> String {
        std::mem::take(&mut self.text)
    }
}
