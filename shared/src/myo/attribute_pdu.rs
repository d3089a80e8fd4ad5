//! Packets of a connection that a host may be given: PDUs of the attribute protocol that a server sends.
//!
//! A central that asks an armband for values needs its answers and its notifications, and nothing else of the link. The
//! Bluetooth host trouble 0.8 takes more, and trusts it more than it may: fields of a request that are not there, an error
//! without its code, the end of a channel that was never opened (docs/bad-input.md). Any of them would restart the
//! board, sent by whoever has the armband's address. So they do not reach it.
//!
//! Sources: Bluetooth Core, Vol 3, Part A, 3.1 (L2CAP header); Part F, 3.3 and 3.4 (opcodes and fields).

/// Length and channel of an L2CAP packet, 16 bits each, low byte first.
const HEADER: usize = 4;
/// L2CAP channel of the attribute protocol, on every Bluetooth Low Energy link.
const CHANNEL: u16 = 4;
/// Opcode of a refusal by the server. The request's opcode, a handle and an error code follow.
const ERROR_RESPONSE: u8 = 0x01;
const ERROR_BYTES: usize = 5;
/// The only request that is answered: which length of PDU both sides bear.
const MTU_REQUEST: u8 = 0x02;
const MTU_BYTES: usize = 3;

/// Whether the host takes a packet, of which these are the bytes up to the first fragment's end.
///
/// A server's opcodes are odd, a client's even. A fragment that ends within the mandatory fields is not from a
/// server that sends PDUs of 23 bytes: those fit one packet.
#[must_use]
pub fn may_be_taken(first: &[u8]) -> bool {
    let Some((&[length_low, length_high, channel @ ..], bytes)) =
        first.split_first_chunk::<HEADER>()
    else {
        return false;
    };
    let length = usize::from(u16::from_le_bytes([length_low, length_high]));
    let pdu = &bytes[..length.min(bytes.len())];
    let Some(&opcode) = pdu.first() else {
        return false;
    };
    let least = match opcode {
        ERROR_RESPONSE => ERROR_BYTES,
        MTU_REQUEST => MTU_BYTES,
        other if other % 2 == 1 => 1,
        _ => return false,
    };
    u16::from_le_bytes(channel) == CHANNEL && pdu.len() >= least
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec::Vec;

    /// A whole packet.
    fn packet(channel: u8, pdu: &[u8]) -> Vec<u8> {
        [&[pdu.len() as u8, 0, channel, 0], pdu].concat()
    }

    #[test]
    fn answers_and_notifications_are_taken() {
        let pdus: [&[u8]; 6] = [
            &[0x03, 23, 0],
            &[0x01, 0x0a, 9, 0, 0x0a],
            &[0x0b],
            &[0x13],
            &[0x1b, 0x27, 0, 1, 2, 3],
            &[0x02, 23, 0],
        ];
        for pdu in pdus {
            assert!(may_be_taken(&packet(4, pdu)), "{pdu:?}");
        }
    }

    #[test]
    fn requests_commands_and_nothing_are_not() {
        for opcode in (0..=254).step_by(2).filter(|&opcode| opcode != 2) {
            for length in 0..30 {
                let pdu = [&[opcode][..], &Vec::from([0; 30])[..length]].concat();
                assert!(!may_be_taken(&packet(4, &pdu)), "{pdu:?}");
            }
        }
        assert!(!may_be_taken(&packet(4, &[])));
        // Its fields say that it has no bytes, whatever follows.
        assert!(!may_be_taken(&[0, 0, 4, 0, 0x0b]));
    }

    #[test]
    fn errors_and_mtu_requests_are_taken_with_all_their_fields_alone() {
        let error = packet(4, &[0x01, 0x0a, 9, 0, 0x0a]);
        let request = packet(4, &[0x02, 23, 0]);
        for whole in [error, request] {
            for end in 0..whole.len() {
                assert!(!may_be_taken(&whole[..end]), "a fragment of {end} bytes");
                let mut shorter = whole[..end].to_vec();
                if let [length, _, _, _, ..] = &mut shorter[..] {
                    *length = (end - HEADER) as u8;
                }
                assert!(!may_be_taken(&shorter), "a packet of {end} bytes");
            }
            assert!(may_be_taken(&whole));
        }
    }

    #[test]
    fn other_channels_are_not_taken() {
        // Signals, among them the end of channel 0; pairing; a channel of a connection's own.
        for channel in [0, 5, 6, 0x3a, 0x40] {
            assert!(!may_be_taken(&packet(
                channel,
                &[0x07, 1, 4, 0, 0, 0, 0, 0]
            )));
        }
        assert!(!may_be_taken(&[1, 0, 4, 1, 0x0b]), "channel 260");
    }

    #[test]
    fn a_longer_answer_may_come_in_fragments() {
        assert!(may_be_taken(&[40, 0, 4, 0, 0x0b, 1, 2, 3]));
    }
}
