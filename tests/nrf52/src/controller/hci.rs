//! Packets to the program: events and data (Bluetooth Core Specification, volume 4, part E, 5.4 and 7.7).

use std::collections::VecDeque;

use shared::myo::{Address, AddressKind};

use super::commands::UNKNOWN_CONNECTION;
use super::{Controller, answer, give, needs, wrong};
use crate::air::{AirEvent, Parameters};
use crate::memory::Memory;
use crate::refusal::What;

/// Bytes of the buffer that the program gives (`HCI_MSG_BUFFER_MAX_SIZE`).
const BUFFER: u32 = 258;
/// Kinds of packets (`sdc_hci_msg_type_t`).
const DATA: u8 = 2;
const EVENT: u8 = 4;
/// The handle of the only connection.
pub const HANDLE: u16 = 0;
/// Bits of the event masks (7.3.1, 7.8.1).
const DISCONNECTIONS: u64 = 1 << 4;
const LE_META: u64 = 1 << 61;
const ENHANCED: u64 = 1 << 9;

/// State of the interface to the host: what it has set, and what waits for it.
#[derive(Debug)]
pub struct Hci {
    pub(super) mask: u64,
    pub(super) le_mask: u64,
    pub(super) own: Option<[u8; 6]>,
    pub(super) scan: super::commands::ScanParameters,
    /// Armbands that this scan has reported, if it reports each once.
    pub(super) reported: Option<Vec<usize>>,
    messages: VecDeque<(u8, Vec<u8>)>,
    /// True if the host has ended the connection, which is there until the event that says so.
    pub(super) is_ending: bool,
    /// Packets that the armband has not got yet.
    pub(super) in_flight: u8,
}

impl Default for Hci {
    fn default() -> Self {
        Self {
            // 7.3.1 and 7.8.1.
            mask: 0x1fff_ffff_ffff,
            le_mask: 0x1f,
            own: None,
            scan: super::commands::ScanParameters::default(),
            reported: None,
            messages: VecDeque::new(),
            is_ending: false,
            in_flight: 0,
        }
    }
}

/// An address as packets have it: kind, and bytes.
pub fn address(address: Address) -> Vec<u8> {
    let kind = match address.kind {
        AddressKind::Public => 0,
        AddressKind::Random => 1,
    };
    [&[kind], &address.bytes[..]].concat()
}

fn parameters([_, interval, latency, timeout]: Parameters) -> Vec<u8> {
    [interval, latency, timeout].map(u16::to_le_bytes).concat()
}

impl Controller {
    pub(super) fn give_message(
        &mut self,
        [packet, kind, ..]: [u32; 4],
        memory: &Memory,
    ) -> Result<i32, What> {
        needs(self.sdc.is_enabled(), "before sdc_enable")?;
        if !memory.is_ram(packet, BUFFER) {
            return Err(wrong("with a buffer that is no RAM, or too short"));
        }
        let Some((of, bytes)) = self.hci.messages.pop_front() else {
            return Ok(answer::AGAIN);
        };
        give(memory, packet, &bytes)?;
        give(memory, kind, &[of])?;
        Ok(answer::SUCCESS)
    }

    fn push(&mut self, kind: u8, bytes: Vec<u8>) {
        self.hci.messages.push_back((kind, bytes));
        if let Some(callback) = self.sdc.callback {
            self.call_later(callback, [0, 0]);
        }
    }

    fn event(&mut self, code: u8, body: &[u8]) {
        let header = [code, body.len() as u8];
        self.push(EVENT, [&header, body].concat());
    }

    fn le_event(&mut self, code: u8, body: &[u8]) {
        if self.hci.mask & LE_META != 0 && self.hci.le_mask >> (code - 1) & 1 == 1 {
            self.event(0x3e, &[&[code], body].concat());
        }
    }

    /// A protocol data unit of a channel (volume 3, part A, 3.1).
    pub(super) fn channel_data(&mut self, channel: u16, unit: &[u8]) {
        const FIRST: u16 = 2 << 12;
        let length = unit.len() as u16;
        let header = [HANDLE | FIRST, length + 4, length, channel];
        self.push(
            DATA,
            [&header.map(u16::to_le_bytes).concat(), unit].concat(),
        );
    }

    /// The connection that was asked for is not made.
    pub(super) fn connection_failed(&mut self) {
        self.connection(UNKNOWN_CONNECTION, &[0; 7], [0; 4]);
    }

    fn connection(&mut self, status: u8, peer: &[u8], with: Parameters) {
        const CENTRAL: u8 = 0;
        let mut body = vec![status];
        body.extend(HANDLE.to_le_bytes());
        body.push(CENTRAL);
        body.extend(peer);
        let is_enhanced = self.hci.le_mask & ENHANCED != 0;
        if is_enhanced {
            // No resolvable addresses on either side.
            body.extend([0; 12]);
        }
        body.extend(parameters(with));
        // Accuracy of the other side's clock.
        body.push(0);
        self.le_event(if is_enhanced { 0x0a } else { 0x01 }, &body);
    }

    fn report(&mut self, index: usize) {
        let armband = &self.air.armbands[index];
        let is_new = match &mut self.hci.reported {
            Some(reported) if reported.contains(&index) => false,
            Some(reported) => {
                reported.push(index);
                true
            }
            None => true,
        };
        if !is_new {
            return;
        }
        let data = armband.advertisement(u64::MAX).unwrap_or_default();
        // One report, of a connectable undirected advertisement.
        let mut body = vec![1, 0];
        body.extend(address(armband.address));
        body.push(data.len() as u8);
        body.extend(data);
        body.push(armband.rssi.cast_unsigned());
        self.le_event(0x02, &body);
    }

    /// Tells the program of something on the air.
    pub(super) fn tell(&mut self, event: AirEvent) {
        let handle = HANDLE.to_le_bytes();
        match event {
            AirEvent::Advertised(armband) => self.report(armband),
            // Without a limit of time.
            AirEvent::ScanTimedOut | AirEvent::AttemptTimedOut => {}
            AirEvent::Connected(armband, with) => {
                let peer = address(self.air.armbands[armband].address);
                self.connection(0, &peer, with);
            }
            AirEvent::Disconnected(reason) => {
                self.hci.in_flight = 0;
                self.hci.is_ending = false;
                if self.hci.mask & DISCONNECTIONS != 0 {
                    self.event(0x05, &[&[0], &handle[..], &[reason]].concat());
                }
            }
            AirEvent::Updated(with) => {
                let body = [&[0], &handle[..], &parameters(with)].concat();
                self.le_event(0x03, &body);
            }
            AirEvent::Sent(count) => {
                self.hci.in_flight = self.hci.in_flight.saturating_sub(count as u8);
                self.event(0x13, &[&[1], &handle[..], &count.to_le_bytes()].concat());
            }
            data => self.tell_of_data(data),
        }
    }
}
