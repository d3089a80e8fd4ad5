//! Signaling packets of L2CAP: what an armband asks for beside the attribute protocol, and is refused.
//!
//! A peripheral may ask for other connection parameters, and disconnects if nobody answers. The Bluetooth host trouble 0.8
//! answers every command, but trusts the fields of some more than it may (docs/bad-input.md). So it is given, in the place
//! of each, a whole packet with the same identifier that it refuses in the way that the specification demands.
//!
//! Sources: Bluetooth Core, Vol 3, Part A, 3.1 (L2CAP header), 4 (commands), 4.1 (command reject), 4.20 and 4.21 (connection
//! parameters).

/// L2CAP channel of signals, on every Bluetooth Low Energy link.
const CHANNEL: [u8; 2] = [5, 0];
/// Request for other connection parameters, and the bytes of its fields.
const PARAMETERS_REQUEST: u8 = 0x12;
const PARAMETERS_BYTES: u8 = 8;
/// Code of no command.
const RESERVED: u8 = 0x00;

/// Bytes of the longest packet that is given to the host.
pub const MOST_BYTES: usize = 16;

/// Packet that the host gets in place of a received one, to refuse it. `first` is the received one up to its first fragment's
/// end. `None` if nothing is to be answered: another channel, a response, a packet without an identifier.
///
/// A request for connection parameters becomes one for parameters that no link can have, which the host refuses as such; any
/// other command, and a malformed one, becomes one that the host does not know.
#[must_use]
pub fn refused<'b>(first: &[u8], packet: &'b mut [u8; MOST_BYTES]) -> Option<&'b [u8]> {
    let &[low, high, a, b, code, identifier, ref rest @ ..] = first else {
        return None;
    };
    if [a, b] != CHANNEL || identifier == 0 || !is_answered(code) {
        return None;
    }
    let is_whole = [low, high] == [4 + PARAMETERS_BYTES, 0]
        && rest.len() == 2 + usize::from(PARAMETERS_BYTES)
        && rest.starts_with(&[PARAMETERS_BYTES, 0]);
    let (code, length) = if code == PARAMETERS_REQUEST && is_whole {
        (code, PARAMETERS_BYTES)
    } else {
        (RESERVED, 0)
    };
    *packet = [0; MOST_BYTES];
    packet[..8].copy_from_slice(&[
        4 + length,
        0,
        CHANNEL[0],
        CHANNEL[1],
        code,
        identifier,
        length,
        0,
    ]);
    packet.get(..8 + usize::from(length))
}

/// Whether a command is answered: neither a response nor, 0x16, a grant of credits (4, table 4.2).
const fn is_answered(code: u8) -> bool {
    !matches!(
        code,
        0x01 | 0x03
            | 0x05
            | 0x07
            | 0x09
            | 0x0b
            | 0x0d
            | 0x0f
            | 0x11
            | 0x13
            | 0x15
            | 0x16
            | 0x18
            | 0x1a
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    const REQUEST: [u8; 16] = [12, 0, 5, 0, 0x12, 7, 8, 0, 16, 0, 32, 0, 0, 0, 200, 0];

    fn given(first: &[u8]) -> Vec<u8> {
        let mut packet = [0xaa; MOST_BYTES];
        refused(first, &mut packet).unwrap_or_default().to_vec()
    }

    #[test]
    fn a_request_for_parameters_becomes_one_that_no_link_can_have() {
        let mut expected = REQUEST;
        expected[8..].fill(0);
        assert_eq!(given(&REQUEST), expected);
    }

    #[test]
    fn other_commands_and_malformed_ones_become_one_that_the_host_does_not_know() {
        let rejected = |identifier| [4, 0, 5, 0, 0, identifier, 0, 0];
        // The end of channel 0; a channel of credits; pings of the other kind of link; codes that are not defined.
        for code in [
            0x00, 0x02, 0x04, 0x06, 0x08, 0x0a, 0x14, 0x17, 0x19, 0x1b, 0x7f, 0xff,
        ] {
            for fields in 0..12 {
                let head = [4 + fields, 0, 5, 0, code, 9, fields, 0];
                let packet = [&head, &[0; 12][..fields.into()]].concat();
                assert_eq!(given(&packet), rejected(9), "{packet:x?}");
            }
        }
        for end in 6..REQUEST.len() {
            assert_eq!(given(&REQUEST[..end]), rejected(7), "cut after {end} bytes");
        }
        for (place, value) in [(0, 11), (0, 13), (1, 1), (6, 7), (6, 9), (7, 1)] {
            let mut packet = REQUEST;
            packet[place] = value;
            assert_eq!(given(&packet), rejected(7), "{packet:x?}");
        }
        assert_eq!(
            given(&[&REQUEST[..], &[0]].concat()),
            rejected(7),
            "a byte too many"
        );
    }

    #[test]
    fn responses_other_channels_and_packets_without_an_identifier_are_not_answered() {
        for code in [0x01, 0x03, 0x07, 0x0b, 0x13, 0x15, 0x16, 0x18, 0x1a] {
            let packet = [6, 0, 5, 0, code, 9, 2, 0, 0, 0];
            assert!(given(&packet).is_empty(), "{code:#x}");
        }
        for (place, value) in [(2, 4), (2, 6), (3, 1), (5, 0)] {
            let mut packet = REQUEST;
            packet[place] = value;
            assert!(given(&packet).is_empty(), "{packet:x?}");
        }
        for end in 0..6 {
            assert!(given(&REQUEST[..end]).is_empty(), "{end} bytes");
        }
    }
}
