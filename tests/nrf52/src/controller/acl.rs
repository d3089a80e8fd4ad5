//! Data of the host: requests to the armband's attributes, answers to its signals (Bluetooth Core Specification, volume 3,
//! parts A and F).

use virtual_armband::gatt::ASKED_PARAMETERS;

use super::hci::HANDLE;
use super::{Controller, answer, needs, take, wrong};
use crate::air::{AirEvent, AirRequest};
use crate::memory::Memory;
use crate::refusal::What;

/// Opcodes (part F, 3.4.8).
const ERROR: u8 = 0x01;
const MTU_REQUEST: u8 = 0x02;
const MTU_RESPONSE: u8 = 0x03;
const READ_REQUEST: u8 = 0x0a;
const READ_RESPONSE: u8 = 0x0b;
const WRITE_REQUEST: u8 = 0x12;
const WRITE_RESPONSE: u8 = 0x13;
const NOTIFICATION: u8 = 0x1b;
/// Channels (part A, 2.1).
const ATTRIBUTES: u16 = 4;
const SIGNALS: u16 = 5;
/// Codes of signals (part A, 4).
const COMMAND_REJECT: u8 = 0x01;
const PARAMETERS_REQUEST: u8 = 0x12;
const PARAMETERS_RESPONSE: u8 = 0x13;
/// Reasons of errors (3.4.1.1).
const READ_NOT_PERMITTED: u8 = 0x02;
const WRITE_NOT_PERMITTED: u8 = 0x03;

impl Controller {
    /// Takes a packet of data from the program.
    pub(super) fn put_data(&mut self, [at, ..]: [u32; 4], memory: &Memory) -> Result<i32, What> {
        needs(self.sdc.is_enabled(), "before sdc_enable")?;
        let header = take(memory, at, 4)?;
        let handle = u16::from_le_bytes([header[0], header[1]]);
        let length = u16::from_le_bytes([header[2], header[3]]);
        let configuration = self.sdc.configuration;
        let fits = length <= configuration.packet_bytes[0];
        needs(fits, &format!("with {length} bytes: a packet has fewer"))?;
        // Not the first part of a packet, or of another connection.
        needs(
            handle & 0x3fff == HANDLE,
            &format!("with the header {handle:#06x}"),
        )?;
        if !self.air.is_linked() {
            // The connection has ended; the program does not know yet.
            return Ok(answer::SUCCESS);
        }
        self.hci.in_flight += 1;
        let has_room = self.hci.in_flight <= configuration.packets[0];
        needs(
            has_room,
            "beyond the packets that the controller has room for",
        )?;
        self.air.send_packet();
        let unit = take(memory, at + 4, length.into())?;
        let [a, b, low, high, ref unit @ ..] = unit[..] else {
            return Err(wrong(&format!("without a channel: {unit:x?}")));
        };
        let whole = usize::from(u16::from_le_bytes([a, b])) == unit.len();
        needs(whole, "with a part of a unit, which is not modelled")?;
        match u16::from_le_bytes([low, high]) {
            ATTRIBUTES => {}
            SIGNALS => return self.put_signal(unit),
            other => {
                return Err(wrong(&format!(
                    "of a channel that is not modelled: {other}"
                )));
            }
        }
        let request = match *unit {
            [MTU_REQUEST, _, _] => AirRequest::Mtu,
            [READ_REQUEST, a, b] => AirRequest::Read(u16::from_le_bytes([a, b])),
            [WRITE_REQUEST, a, b, ref value @ ..] => {
                AirRequest::Write(u16::from_le_bytes([a, b]), value.to_vec())
            }
            _ => return Err(wrong(&format!("of a kind that is not modelled: {unit:x?}"))),
        };
        // Part F, 3.3.2.
        let is_sequential = self.air.request(request);
        needs(
            is_sequential,
            "with a request before the one before is answered",
        )?;
        Ok(answer::SUCCESS)
    }

    /// Takes a response to the armband's request for connection parameters.
    fn put_signal(&mut self, unit: &[u8]) -> Result<i32, What> {
        match *unit {
            [PARAMETERS_RESPONSE, identifier, 2, 0, 0 | 1, 0]
            | [COMMAND_REJECT, identifier, 2, 0, ..] => self.air.answer(identifier),
            _ => return Err(wrong(&format!("with a malformed signal: {unit:x?}"))),
        }
        Ok(answer::SUCCESS)
    }

    /// Tells the program what comes from the armband.
    pub(super) fn tell_of_data(&mut self, event: AirEvent) {
        let failed = |request: u8, attribute: u16, why: u8| {
            let [a, b] = attribute.to_le_bytes();
            vec![ERROR, request, a, b, why]
        };
        let unit = match event {
            AirEvent::Mtu(bytes) => [&[MTU_RESPONSE], &bytes.to_le_bytes()[..]].concat(),
            AirEvent::Read(_, Some(value)) => [&[READ_RESPONSE], &value[..]].concat(),
            AirEvent::Read(attribute, None) => failed(READ_REQUEST, attribute, READ_NOT_PERMITTED),
            AirEvent::Written(_, true) => vec![WRITE_RESPONSE],
            AirEvent::Written(attribute, false) => {
                failed(WRITE_REQUEST, attribute, WRITE_NOT_PERMITTED)
            }
            AirEvent::Notified(attribute, value) => {
                [&[NOTIFICATION], &attribute.to_le_bytes()[..], &value].concat()
            }
            AirEvent::Asked(identifier) => {
                let fields = ASKED_PARAMETERS.map(u16::to_le_bytes).concat();
                let head = [PARAMETERS_REQUEST, identifier, fields.len() as u8, 0];
                return self.channel_data(SIGNALS, &[&head, &fields[..]].concat());
            }
            _ => return,
        };
        self.channel_data(ATTRIBUTES, &unit);
    }
}
