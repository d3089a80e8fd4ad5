//! Scanning and connecting (`ble_gap.h`), as a central.

use shared::myo::{Address, AddressKind};
use virtual_armband::gatt::ASKED_PARAMETERS;

use super::calls::answer;
use super::events::{self, HANDLE};
use super::{SoftDevice, wrong};
use crate::air::{AirEvent, Parameters, ScanTimes, parameters_are_allowed};
use crate::memory::Memory;
use crate::refusal::What;
use crate::time::ms;

/// Bytes that a scan's buffer has at least (`BLE_GAP_SCAN_BUFFER_MIN`).
const SCAN_BUFFER: u16 = 31;
/// Source of a time-out: scanning, connecting (`BLE_GAP_TIMEOUT_SRC_*`).
const SCAN: u8 = 1;
const CONNECT: u8 = 2;

impl SoftDevice {
    pub(super) fn set_whitelist(
        &mut self,
        addresses: u32,
        count: u8,
        memory: &Memory,
    ) -> Result<u32, What> {
        if self.air.connects() || self.air.scans() {
            return Ok(answer::WHITELIST_IN_USE);
        }
        let mut whitelist = Vec::new();
        for number in 0..count.into() {
            let pointer = memory.word(addresses + 4 * number).unwrap_or_default();
            let address = memory
                .read(pointer, 7)
                .and_then(|bytes| bytes.try_into().ok());
            let Some(address) = address else {
                return Err(wrong("with an address that is no memory"));
            };
            let [kind, bytes @ ..]: [u8; 7] = address;
            let kind = match kind >> 1 {
                0 => AddressKind::Public,
                // The two highest bits of a random static address are ones.
                1 if bytes[5] >> 6 == 3 => AddressKind::Random,
                _ => return Ok(answer::INVALID_BLE_ADDR),
            };
            whitelist.push(Address { kind, bytes });
        }
        self.whitelist = whitelist;
        Ok(answer::SUCCESS)
    }

    pub(super) fn start_scan(
        &mut self,
        parameters: u32,
        buffer: u32,
        now: u64,
        memory: &Memory,
    ) -> Result<u32, What> {
        let (Some(data), Some(length)) = (memory.word(buffer), memory.half(buffer + 4)) else {
            return Err(wrong("with a buffer that is no memory"));
        };
        if length < SCAN_BUFFER || !memory.is_ram(data, length.into()) {
            return Ok(answer::INVALID_LENGTH);
        }
        if parameters == 0 {
            // It goes on after an advertisement.
            if !self.air.resume_scan(now) {
                return Ok(answer::INVALID_STATE);
            }
            self.scan_buffer = data;
            return Ok(answer::SUCCESS);
        }
        if self.air.scans() || self.air.connects() {
            return Ok(answer::INVALID_STATE);
        }
        let Some(times) = scan_times(parameters, memory) else {
            return Ok(answer::INVALID_PARAM);
        };
        self.scan_buffer = data;
        self.air.start_scan(now, times, true);
        Ok(answer::SUCCESS)
    }

    pub(super) fn connect(
        &mut self,
        [scan, parameters, tag]: [u32; 3],
        now: u64,
        memory: &Memory,
    ) -> Result<u32, What> {
        if self.air.scans() || self.air.connects() {
            return Ok(answer::INVALID_STATE);
        }
        if self.air.is_linked() {
            return Ok(answer::CONN_COUNT);
        }
        // The tag of the configuration that the library sets.
        if tag as u8 != 1 {
            return Ok(answer::NOT_FOUND);
        }
        let Some(ScanTimes { timeout, .. }) = scan_times(scan, memory) else {
            return Ok(answer::INVALID_PARAM);
        };
        let Some(parameters) = connection_parameters(parameters, memory) else {
            return Ok(answer::INVALID_PARAM);
        };
        let meant = self.whitelist.clone();
        self.air.connect(now, timeout, parameters, meant);
        Ok(answer::SUCCESS)
    }

    pub(super) fn update_parameters(
        &mut self,
        handle: u16,
        parameters: u32,
        now: u64,
        memory: &Memory,
    ) -> u32 {
        let Some(parameters) = connection_parameters(parameters, memory) else {
            return answer::INVALID_PARAM;
        };
        match self.answer_of(handle) {
            answer::SUCCESS if !self.air.update_parameters(now, parameters) => answer::BUSY,
            answer => {
                // It grants what the armband has asked for, if it has.
                if let Some(identifier) = self.asked.take() {
                    self.air.answer(identifier);
                }
                answer
            }
        }
    }

    pub(super) fn disconnect(&mut self, handle: u16, now: u64) -> u32 {
        match self.answer_of(handle) {
            answer::SUCCESS if !self.air.disconnect(now) => answer::INVALID_STATE,
            answer => answer,
        }
    }

    /// Returns success if that is the handle of a connection.
    pub(super) fn answer_of(&self, handle: u16) -> u32 {
        match self.air.is_linked() && handle == HANDLE {
            true => answer::SUCCESS,
            false => answer::INVALID_CONN_HANDLE,
        }
    }

    /// Tells the program of an event.
    pub(super) fn tell(&mut self, event: AirEvent, memory: &Memory) {
        let event = match event {
            AirEvent::Advertised(armband) => {
                let armband = &self.air.armbands[armband];
                let data = armband.advertisement(u64::MAX).unwrap_or_default();
                memory.write(self.scan_buffer, data);
                let length = data.len() as u16;
                events::advertised(armband.address, armband.rssi, self.scan_buffer, length)
            }
            AirEvent::ScanTimedOut => events::timed_out(SCAN),
            AirEvent::AttemptTimedOut => events::timed_out(CONNECT),
            AirEvent::Connected(armband, parameters) => {
                events::connected(HANDLE, self.air.armbands[armband].address, parameters)
            }
            AirEvent::Disconnected(reason) => events::disconnected(HANDLE, reason),
            AirEvent::Updated(parameters) => events::updated(HANDLE, parameters),
            AirEvent::Asked(identifier) => {
                self.asked = Some(identifier);
                events::asked(HANDLE, ASKED_PARAMETERS)
            }
            // Only writes without a response are told of (`BLE_GATTC_EVT_WRITE_CMD_TX_COMPLETE`).
            AirEvent::Sent(_) | AirEvent::Mtu(_) => return,
            AirEvent::Read(attribute, value) => events::read(HANDLE, attribute, value.as_deref()),
            AirEvent::Written(attribute, is_taken) => events::written(HANDLE, attribute, is_taken),
            AirEvent::Notified(attribute, value) => events::notified(HANDLE, attribute, &value),
        };
        self.push(event);
    }
}

/// The times of `ble_gap_scan_params_t`, if they are allowed.
fn scan_times(parameters: u32, memory: &Memory) -> Option<ScanTimes> {
    let interval = memory.half(parameters + 2)?;
    let window = memory.half(parameters + 4)?;
    let timeout = memory.half(parameters + 6)?;
    let timeout = match timeout {
        0 => u64::MAX,
        units => ms(10) * u64::from(units),
    };
    let times = ScanTimes::of_units(interval, window)?;
    Some(ScanTimes { timeout, ..times })
}

/// `ble_gap_conn_params_t`, if it is allowed.
fn connection_parameters(address: u32, memory: &Memory) -> Option<Parameters> {
    let mut parameters = [0; 4];
    for (number, field) in (0..).step_by(2).zip(&mut parameters) {
        *field = memory.half(address + number)?;
    }
    parameters_are_allowed(parameters).then_some(parameters)
}
