//! Bytes of an input as numbers and choices, from the first byte on; zeros after the end.

/// Rest of an input.
pub struct Input<'b>(pub &'b [u8]);

impl<'b> Input<'b> {
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    /// Takes the next bytes, `count` at most.
    pub fn take(&mut self, count: usize) -> &'b [u8] {
        let (taken, rest) = self.0.split_at(count.min(self.0.len()));
        self.0 = rest;
        taken
    }

    pub fn array<const N: usize>(&mut self) -> [u8; N] {
        let mut bytes = [0; N];
        let taken = self.take(N);
        bytes[..taken.len()].copy_from_slice(taken);
        bytes
    }

    pub fn byte(&mut self) -> u8 {
        let [byte] = self.array();
        byte
    }

    /// Takes a number below `count`.
    pub fn below(&mut self, count: usize) -> usize {
        usize::from(self.byte()) % count
    }

    /// Takes a byte; returns true if it is odd.
    pub fn flag(&mut self) -> bool {
        self.byte() & 1 == 1
    }

    pub fn word(&mut self) -> u32 {
        u32::from_le_bytes(self.array())
    }

    /// Takes as many bytes as the next byte says.
    pub fn short(&mut self) -> &'b [u8] {
        let count = self.byte();
        self.take(usize::from(count))
    }

    /// Takes the milliseconds between two events: mostly few, sometimes many, rarely any number.
    pub fn pause(&mut self) -> u32 {
        match self.byte() {
            few @ 0..=199 => u32::from(few % 32),
            more @ 200..=251 => u32::from(more - 199) * 250,
            _ => self.word(),
        }
    }
}
