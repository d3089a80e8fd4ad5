//! Device addresses.

use core::fmt;

/// Assignment of an address. A Myo's address is public, although it looks like a random one.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum AddressKind {
    /// Assigned by the manufacturer.
    Public,
    /// Generated at random.
    Random,
}

/// A device address. Displayed and parsed as `FA:01:23:45:67:89`: the last byte on air first.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub struct Address {
    /// Kind of the address.
    pub kind: AddressKind,
    /// Bytes of the address, little-endian as on air.
    pub bytes: [u8; 6],
}

/// Why a text is not an address.
#[derive(Clone, Copy, PartialEq, Eq, Debug, thiserror::Error)]
#[expect(missing_docs, reason = "the messages say it")]
pub enum AddressError {
    #[error("an address has 17 characters, found {0}: write it as FA:01:23:45:67:89")]
    Length(usize),
    #[error("expected a colon at character {0} of the address: write it as FA:01:23:45:67:89")]
    Colon(usize),
    #[error("expected a hexadecimal digit at character {0} of the address: 0-9, a-f or A-F")]
    Digit(usize),
}

impl Address {
    /// The public address of a text like `FA:01:23:45:67:89`. Works in constants.
    ///
    /// # Errors
    /// Refuses anything but six pairs of hexadecimal digits with colons between them.
    pub const fn parse(text: &str) -> Result<Self, AddressError> {
        let text = text.as_bytes();
        if text.len() != 17 {
            return Err(AddressError::Length(text.len()));
        }
        let mut bytes = [0; 6];
        // `for` does not work in a `const fn`.
        let mut place = 0;
        while place < text.len() {
            let byte = 5 - place / 3;
            match place % 3 {
                2 if text[place] != b':' => return Err(AddressError::Colon(place)),
                2 => {}
                _ => match (text[place] as char).to_digit(16) {
                    Some(digit) => bytes[byte] = bytes[byte] << 4 | digit as u8,
                    None => return Err(AddressError::Digit(place)),
                },
            }
            place += 1;
        }
        Ok(Self {
            kind: AddressKind::Public,
            bytes,
        })
    }
}

impl fmt::Display for Address {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [first, rest @ ..] = self.bytes;
        for byte in rest.iter().rev() {
            write!(formatter, "{byte:02X}:")?;
        }
        write!(formatter, "{first:02X}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::string::ToString;

    const PINNED: Result<Address, AddressError> = Address::parse("FA:01:23:45:67:8b");

    #[test]
    fn an_address_is_parsed_in_a_constant_and_shown_in_capitals() {
        let address = PINNED.unwrap();
        assert_eq!(address.bytes, [0x8b, 0x67, 0x45, 0x23, 0x01, 0xfa]);
        assert_eq!(address.to_string(), "FA:01:23:45:67:8B");
    }

    #[test]
    fn other_texts_are_refused_by_what_is_wrong() {
        for (text, error) in [
            ("", AddressError::Length(0)),
            ("FA:01:23:45:67:8B:", AddressError::Length(18)),
            ("FA-01-23-45-67-8B", AddressError::Colon(2)),
            ("FA:01:23:45:67:8G", AddressError::Digit(16)),
            ("FA:0é:23:45:67:8", AddressError::Digit(4)),
        ] {
            assert_eq!(Address::parse(text), Err(error), "{text}");
        }
    }
}
