//! Scanning and connecting (`ble_gap.h`), as a central.

use shared::myo::{Address, AddressKind};

use super::SoftDevice;
use super::calls::answer;
use super::events::HANDLE;
use crate::air::{Parameters, ScanTimes, parameters_are_allowed};
use crate::memory::{Memory, halves, take};
use crate::refusal::{What, needs, wrong};
use crate::time::ms;

/// Bytes that a scan's buffer has at least (`BLE_GAP_SCAN_BUFFER_MIN`).
const SCAN_BUFFER: u16 = 31;

impl SoftDevice {
    pub(super) fn set_whitelist(
        &mut self,
        addresses: u32,
        count: u8,
        memory: &Memory,
    ) -> Result<(), What> {
        let is_used = self.air.connects() || self.air.scans();
        needs(!is_used, "while the list is in use")?;
        let mut whitelist = Vec::new();
        for number in 0..count.into() {
            let pointer = memory.word(addresses + 4 * number).unwrap_or_default();
            let address = take(memory, pointer, 7)?;
            let bytes: [u8; 6] = address[1..].try_into().unwrap_or_default();
            let kind = match address[0] >> 1 {
                0 => AddressKind::Public,
                // The two highest bits of a random static address are ones.
                1 if bytes[5] >> 6 == 3 => AddressKind::Random,
                _ => return Err(wrong("with an address that none can have")),
            };
            whitelist.push(Address { kind, bytes });
        }
        self.whitelist = whitelist;
        Ok(())
    }

    pub(super) fn start_scan(
        &mut self,
        parameters: u32,
        buffer: u32,
        now: u64,
        memory: &Memory,
    ) -> Result<(), What> {
        let (data, length) = memory
            .word(buffer)
            .zip(memory.half(buffer + 4))
            .unwrap_or_default();
        let fits = length >= SCAN_BUFFER && memory.is_ram(data, length.into());
        needs(fits, "with a buffer that is no RAM, or too short")?;
        self.scan_buffer = data;
        if parameters == 0 {
            // It goes on after an advertisement.
            return needs(
                self.air.resume_scan(now),
                "to go on with a scan that does not wait",
            );
        }
        self.needs_idle()?;
        self.air
            .start_scan(now, scan_times(parameters, memory)?, true);
        Ok(())
    }

    pub(super) fn connect(
        &mut self,
        [scan, parameters, tag]: [u32; 3],
        now: u64,
        memory: &Memory,
    ) -> Result<(), What> {
        self.needs_idle()?;
        needs(
            !self.air.is_linked(),
            "beside a link: there is room for one",
        )?;
        // The tag of the configuration that the library sets.
        needs(
            tag as u8 == 1,
            "for another configuration than the library's",
        )?;
        let ScanTimes { timeout, .. } = scan_times(scan, memory)?;
        let parameters = connection_parameters(parameters, memory)?;
        let meant = self.whitelist.clone();
        self.air.connect(now, timeout, parameters, meant);
        Ok(())
    }

    /// Refuses a call beside a scan or an attempt to connect.
    fn needs_idle(&self) -> Result<(), What> {
        let is_idle = !self.air.scans() && !self.air.connects();
        needs(is_idle, "beside a scan or an attempt to connect")
    }

    pub(super) fn update_parameters(
        &mut self,
        handle: u16,
        parameters: u32,
        now: u64,
        memory: &Memory,
    ) -> Result<u32, What> {
        let parameters = connection_parameters(parameters, memory)?;
        Ok(match self.answer_of(handle) {
            answer::SUCCESS if !self.air.update_parameters(now, parameters) => answer::BUSY,
            answer => {
                // It grants what the armband has asked for, if it has.
                if let Some(identifier) = self.asked.take() {
                    self.air.answer(identifier);
                }
                answer
            }
        })
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
}

/// The times of `ble_gap_scan_params_t`.
fn scan_times(parameters: u32, memory: &Memory) -> Result<ScanTimes, What> {
    let [interval, window, timeout] = halves(&take(memory, parameters, 8)?, 2);
    let timeout = match timeout {
        0 => u64::MAX,
        units => ms(10) * u64::from(units),
    };
    let times = ScanTimes::of_units(interval, window);
    let times = times.ok_or_else(|| wrong("with times that no scan can have"))?;
    Ok(ScanTimes { timeout, ..times })
}

/// `ble_gap_conn_params_t`.
fn connection_parameters(address: u32, memory: &Memory) -> Result<Parameters, What> {
    let parameters = halves(&take(memory, address, 8)?, 0);
    needs(
        parameters_are_allowed(parameters),
        "with parameters that no connection can have",
    )?;
    Ok(parameters)
}
