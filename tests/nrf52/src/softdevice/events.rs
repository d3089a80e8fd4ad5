//! Structures of the events that the program takes (`ble_evt_t` of ble.h; ble_gap.h, ble_gattc.h).

use shared::myo::{Address, AddressKind};
use virtual_armband::gatt::ASKED_PARAMETERS;

use super::SoftDevice;
use super::calls::{attribute as status_of, event};
use super::gattc::WRITE_REQUEST;
use crate::air::{AirEvent, Parameters};
use crate::memory::Memory;

/// The handle of the only connection.
pub const HANDLE: u16 = 0;
/// Handle of the connection where there is none.
const NO_HANDLE: u16 = 0xffff;
/// Source of a time-out: scanning, connecting (`BLE_GAP_TIMEOUT_SRC_*`).
const SCAN: u8 = 1;
const CONNECT: u8 = 2;
/// Role of the program (`BLE_GAP_ROLE_CENTRAL`).
const CENTRAL: u8 = 2;
/// Status of an attribute, and the attribute that an error is about.
const SUCCESS: (u16, u16) = (0, 0);

fn header(id: u16, body: Vec<u8>) -> Vec<u8> {
    let length = 4 + body.len() as u16;
    [&id.to_le_bytes()[..], &length.to_le_bytes(), &body].concat()
}

/// `ble_gap_evt_t`: the handle, and parameters at a multiple of four.
fn gap(id: u16, handle: u16, parameters: &[u8]) -> Vec<u8> {
    let mut body = [handle.to_le_bytes(), [0, 0]].concat();
    body.extend(parameters);
    // As large as the union of all parameters.
    body.resize(body.len().max(40), 0);
    header(id, body)
}

/// `ble_gattc_evt_t`: handle, status, the attribute that an error is about, parameters.
fn gattc(id: u16, (status, about): (u16, u16), parameters: &[u8]) -> Vec<u8> {
    let mut body = [HANDLE, status, about].map(u16::to_le_bytes).concat();
    body.extend(parameters);
    header(id, body)
}

/// Parameters of an attribute's event: the attribute, what was done, a value with its length.
fn valued([attribute, done]: [u16; 2], value: &[u8]) -> Vec<u8> {
    let fields = [attribute, done, value.len() as u16].map(u16::to_le_bytes);
    [&fields.concat(), value].concat()
}

/// `ble_gap_addr_t`: the kind above the lowest bit, and six bytes.
fn address(address: Address) -> [u8; 7] {
    let kind = match address.kind {
        AddressKind::Public => 0,
        AddressKind::Random => 1,
    };
    let [a, b, c, d, e, f] = address.bytes;
    [kind << 1, a, b, c, d, e, f]
}

fn parameters(parameters: Parameters) -> Vec<u8> {
    parameters.map(u16::to_le_bytes).concat()
}

impl SoftDevice {
    /// Tells the program of an event.
    pub(super) fn tell(&mut self, event: AirEvent, memory: &Memory) {
        const NOTIFICATION: u16 = 1;
        let event = match event {
            AirEvent::Advertised(armband) => self.advertised(armband, memory),
            AirEvent::ScanTimedOut => gap(event::TIMEOUT, NO_HANDLE, &[SCAN]),
            AirEvent::AttemptTimedOut => gap(event::TIMEOUT, NO_HANDLE, &[CONNECT]),
            AirEvent::Connected(armband, with) => {
                let to = address(self.air.armbands[armband].address);
                let body = [&to[..], &[CENTRAL], &parameters(with)].concat();
                gap(event::CONNECTED, HANDLE, &body)
            }
            AirEvent::Disconnected(reason) => gap(event::DISCONNECTED, HANDLE, &[reason]),
            AirEvent::Updated(with) => gap(event::CONN_PARAM_UPDATE, HANDLE, &parameters(with)),
            AirEvent::Asked(identifier) => {
                self.asked = Some(identifier);
                let asked = parameters(ASKED_PARAMETERS);
                gap(event::CONN_PARAM_UPDATE_REQUEST, HANDLE, &asked)
            }
            // Only writes without a response are told of (`BLE_GATTC_EVT_WRITE_CMD_TX_COMPLETE`).
            AirEvent::Sent(_) | AirEvent::Mtu(_) => return,
            AirEvent::Read(attribute, Some(value)) => {
                gattc(event::READ_RSP, SUCCESS, &valued([attribute, 0], &value))
            }
            AirEvent::Read(attribute, None) => {
                let failed = (status_of::READ_NOT_PERMITTED, attribute);
                gattc(event::READ_RSP, failed, &[0; 6])
            }
            AirEvent::Written(attribute, is_taken) => {
                let status = match is_taken {
                    true => SUCCESS,
                    false => (status_of::WRITE_NOT_PERMITTED, attribute),
                };
                // An offset, and a value that is empty.
                let fields = [attribute, WRITE_REQUEST.into(), 0, 0].map(u16::to_le_bytes);
                gattc(event::WRITE_RSP, status, &fields.concat())
            }
            AirEvent::Notified(attribute, value) => gattc(
                event::HVX,
                SUCCESS,
                &valued([attribute, NOTIFICATION], &value),
            ),
        };
        self.push(event);
    }

    /// Puts an armband's advertisement into the program's buffer; returns the event that says so.
    fn advertised(&self, armband: usize, memory: &Memory) -> Vec<u8> {
        let armband = &self.air.armbands[armband];
        let data = armband.advertisement(u64::MAX).unwrap_or_default();
        memory.write(self.scan_buffer, data);
        // Connectable and undirected.
        let mut body = 1_u16.to_le_bytes().to_vec();
        body.extend(address(armband.address));
        body.extend([0; 7]);
        // Physical layers 1 and none, unknown power of the sender, strength, channel, no set.
        body.extend([1, 0, 127, armband.rssi.cast_unsigned(), 37, 0xff]);
        body.resize(24, 0);
        body.extend(self.scan_buffer.to_le_bytes());
        body.extend((data.len() as u16).to_le_bytes());
        gap(event::ADV_REPORT, NO_HANDLE, &body)
    }
}
