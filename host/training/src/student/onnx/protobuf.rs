//! Messages of Protocol Buffers, written field by field.

/// Message: the bytes of its fields so far.
#[derive(Debug, Default)]
pub(super) struct Message(Vec<u8>);

/// Encoding of a field's value, beside its number.
#[derive(Clone, Copy)]
enum Wire {
    Variable = 0,
    Bytes = 2,
    FourBytes = 5,
}

impl Message {
    pub(super) fn as_bytes(&self) -> &[u8] {
        &self.0
    }

    /// Adds an integer that is not negative.
    pub(super) fn integer(&mut self, field: u64, value: u64) {
        self.key(field, Wire::Variable);
        self.variable(value);
    }

    /// Adds an f32.
    pub(super) fn float(&mut self, field: u64, value: f32) {
        self.key(field, Wire::FourBytes);
        self.0.extend(value.to_le_bytes());
    }

    /// Adds bytes, a text or the bytes of a message.
    pub(super) fn bytes(&mut self, field: u64, bytes: impl AsRef<[u8]>) {
        let bytes = bytes.as_ref();
        self.key(field, Wire::Bytes);
        self.variable(bytes.len() as u64);
        self.0.extend(bytes);
    }

    /// Adds a message whose fields `fill` writes.
    pub(super) fn message(&mut self, field: u64, fill: impl FnOnce(&mut Self)) {
        let mut message = Self::default();
        fill(&mut message);
        self.bytes(field, message.as_bytes());
    }

    fn key(&mut self, field: u64, wire: Wire) {
        self.variable((field << 3) | wire as u64);
    }

    /// Seven bits a byte, the lowest first; the high bit says that more follow.
    fn variable(&mut self, mut value: u64) {
        while value >= 0x80 {
            self.0.push(value as u8 | 0x80);
            value >>= 7;
        }
        self.0.push(value as u8);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The examples of the format's documentation.
    #[test]
    fn fields_have_the_bytes_of_the_format() {
        let mut message = Message::default();
        message.integer(1, 150);
        message.bytes(2, "testing");
        message.message(3, |inner| inner.integer(1, 150));
        message.float(16, 1.0);
        let expected = [
            &[0x08, 0x96, 0x01][..],
            &[0x12, 0x07, 0x74, 0x65, 0x73, 0x74, 0x69, 0x6e, 0x67],
            &[0x1a, 0x03, 0x08, 0x96, 0x01],
            &[0x85, 0x01, 0x00, 0x00, 0x80, 0x3f],
        ];
        assert_eq!(message.as_bytes(), expected.concat());
    }
}
