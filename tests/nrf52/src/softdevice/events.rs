//! Structures of the events that the program takes (`ble_evt_t` of ble.h; ble_gap.h, ble_gattc.h).

use super::calls::{attribute as status_of, event};
use crate::air::Parameters;
use shared::myo::{Address, AddressKind};

/// The handle of the only connection.
pub const HANDLE: u16 = 0;
/// Handle of the connection where there is none.
pub const NO_HANDLE: u16 = 0xffff;

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
fn gattc(id: u16, handle: u16, status: u16, about: u16, parameters: &[u8]) -> Vec<u8> {
    let mut body = [handle, status, about].map(u16::to_le_bytes).concat();
    body.extend(parameters);
    header(id, body)
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

/// An advertisement that is in the program's buffer.
pub fn advertised(from: Address, rssi: i8, buffer: u32, length: u16) -> Vec<u8> {
    let mut body = Vec::new();
    // Connectable and undirected.
    body.extend(1_u16.to_le_bytes());
    body.extend(address(from));
    body.extend([0; 7]);
    // Physical layers 1 and none, unknown power of the sender, strength, channel, no set.
    body.extend([1, 0, 127, rssi.cast_unsigned(), 37, 0xff]);
    body.resize(24, 0);
    body.extend(buffer.to_le_bytes());
    body.extend(length.to_le_bytes());
    gap(event::ADV_REPORT, NO_HANDLE, &body)
}

/// A connection is there, as a central.
pub fn connected(handle: u16, to: Address, with: Parameters) -> Vec<u8> {
    const CENTRAL: u8 = 2;
    let mut body = address(to).to_vec();
    body.push(CENTRAL);
    body.extend(parameters(with));
    gap(event::CONNECTED, handle, &body)
}

/// A connection has ended.
pub fn disconnected(handle: u16, reason: u8) -> Vec<u8> {
    gap(event::DISCONNECTED, handle, &[reason])
}

/// A connection has other parameters.
pub fn updated(handle: u16, with: Parameters) -> Vec<u8> {
    gap(event::CONN_PARAM_UPDATE, handle, &parameters(with))
}

/// The armband asks for other parameters.
pub fn asked(handle: u16, with: Parameters) -> Vec<u8> {
    gap(event::CONN_PARAM_UPDATE_REQUEST, handle, &parameters(with))
}

/// Scanning or connecting has ended by itself.
pub fn timed_out(source: u8) -> Vec<u8> {
    gap(event::TIMEOUT, NO_HANDLE, &[source])
}

/// An attribute was read, or could not be.
pub fn read(handle: u16, attribute: u16, value: Option<&[u8]>) -> Vec<u8> {
    match value {
        Some(value) => {
            let fields = [attribute, 0, value.len() as u16].map(u16::to_le_bytes);
            gattc(
                event::READ_RSP,
                handle,
                0,
                0,
                &[&fields.concat(), value].concat(),
            )
        }
        None => {
            let status = status_of::READ_NOT_PERMITTED;
            gattc(event::READ_RSP, handle, status, attribute, &[0; 6])
        }
    }
}

/// An attribute was written, or could not be.
pub fn written(handle: u16, attribute: u16, is_taken: bool) -> Vec<u8> {
    const REQUEST: u16 = 1;
    let (status, about) = match is_taken {
        true => (0, 0),
        false => (status_of::WRITE_NOT_PERMITTED, attribute),
    };
    let fields = [attribute, REQUEST, 0, 0].map(u16::to_le_bytes).concat();
    gattc(event::WRITE_RSP, handle, status, about, &fields)
}

/// A notification.
pub fn notified(handle: u16, attribute: u16, value: &[u8]) -> Vec<u8> {
    const NOTIFICATION: u16 = 1;
    let fields = [attribute, NOTIFICATION, value.len() as u16].map(u16::to_le_bytes);
    gattc(
        event::HVX,
        handle,
        0,
        0,
        &[&fields.concat(), value].concat(),
    )
}
