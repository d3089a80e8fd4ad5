//! Commands of the host (Bluetooth Core Specification, volume 4, part E, 7). Each is a function of the library's, which
//! answers with the status; no event follows that says so.

use shared::myo::{Address, AddressKind};

use super::hci::HANDLE;
use super::memory::ACCEPTED;
use super::{Controller, give, take, wrong};
use crate::air::{ScanTimes, parameters_are_allowed};
use crate::chip::Chip;
use crate::memory::Memory;
use crate::refusal::What;

/// Statuses (volume 1, part F, 1.3).
const SUCCESS: u8 = 0x00;
const UNKNOWN_COMMAND: u8 = 0x01;
pub(super) const UNKNOWN_CONNECTION: u8 = 0x02;
const MEMORY_EXCEEDED: u8 = 0x07;
const LIMITED_RESOURCES: u8 = 0x0d;
const DISALLOWED: u8 = 0x0c;
const INVALID: u8 = 0x12;
/// Reasons of the host's for the end of a connection (7.1.6).
const REASONS: [u8; 7] = [0x05, 0x13, 0x14, 0x15, 0x1a, 0x29, 0x3b];

#[derive(Clone, Copy, Debug)]
pub struct ScanParameters {
    interval: u16,
    window: u16,
    /// True if only armbands are reported that are in the list.
    pub filters: bool,
    is_random: bool,
}

impl Default for ScanParameters {
    fn default() -> Self {
        Self {
            interval: 16,
            window: 16,
            filters: false,
            is_random: false,
        }
    }
}

/// Interval and window in units of 0.625 ms, if they are allowed.
fn scan_times(interval: u16, window: u16) -> Option<ScanTimes> {
    ScanTimes::of_units(interval, window).filter(|_| interval <= 0x4000)
}

/// The half words of parameters from a place on.
fn halves<const N: usize>(bytes: &[u8], from: usize) -> [u16; N] {
    let half = |number: usize| {
        let at = from + 2 * number;
        let both = bytes.get(at..at + 2).and_then(|two| two.try_into().ok());
        both.map_or(0, u16::from_le_bytes)
    };
    std::array::from_fn(half)
}

fn address(kind: u8, bytes: &[u8]) -> Option<Address> {
    let kind = match kind {
        0 => AddressKind::Public,
        1 => AddressKind::Random,
        _ => return None,
    };
    let bytes = *bytes.first_chunk()?;
    Some(Address { kind, bytes })
}

impl Controller {
    /// Carries a command out, whose name follows `sdc_hci_cmd_`; returns its status.
    pub(super) fn command(
        &mut self,
        name: &str,
        arguments: [u32; 4],
        chip: &Chip,
    ) -> Result<u8, What> {
        let (now, memory) = (chip.bus.now, &chip.bus.memory);
        let [at, ..] = arguments;
        let mask = || {
            let bytes = take(memory, at, 8)?;
            Ok(u64::from_le_bytes(bytes.try_into().unwrap_or_default()))
        };
        Ok(match name {
            "cb_reset" => {
                self.air.reset(now);
                self.hci = Default::default();
                SUCCESS
            }
            "cb_set_event_mask" => {
                self.hci.mask = mask()?;
                SUCCESS
            }
            "le_set_event_mask" => {
                self.hci.le_mask = mask()?;
                SUCCESS
            }
            // Nothing that it asks for is modelled: the second page of events, and flow control towards the host, which
            // nobody has switched on.
            "cb_set_event_mask_page_2"
            | "cb_host_buffer_size"
            | "cb_host_number_of_completed_packets" => SUCCESS,
            "le_read_filter_accept_list_size" => {
                give(memory, at, &[ACCEPTED as u8])?;
                SUCCESS
            }
            "le_read_buffer_size" => {
                let configuration = &self.sdc.configuration;
                let [a, b] = configuration.packet_bytes[0].to_le_bytes();
                give(memory, at, &[a, b, configuration.packets[0]])?;
                SUCCESS
            }
            // It has no public address unless it is given one.
            "ip_read_bd_addr" => {
                give(memory, at, &[0; 6])?;
                SUCCESS
            }
            "le_clear_filter_accept_list" => self.change_accepted(None),
            "le_add_device_to_filter_accept_list" => {
                let bytes = take(memory, at, 7)?;
                match address(bytes[0], &bytes[1..]) {
                    Some(address) => self.change_accepted(Some(address)),
                    None => INVALID,
                }
            }
            "le_set_random_address" if self.air.scans() || self.air.connects() => DISALLOWED,
            "le_set_random_address" => {
                let bytes = take(memory, at, 6)?;
                self.hci.own = bytes.first_chunk().copied();
                SUCCESS
            }
            "lc_disconnect" => {
                let bytes = take(memory, at, 3)?;
                match halves(&bytes, 0) {
                    [HANDLE] if !REASONS.contains(&bytes[2]) => INVALID,
                    [HANDLE] if self.air.is_linked() && self.hci.is_ending => DISALLOWED,
                    [HANDLE] if self.air.is_linked() => {
                        // One that is being lost ends with its time-out.
                        self.air.disconnect(now);
                        self.hci.is_ending = true;
                        SUCCESS
                    }
                    _ => UNKNOWN_CONNECTION,
                }
            }
            "le_set_scan_params" => self.set_scan_parameters(&take(memory, at, 7)?),
            "le_set_scan_enable" => self.enable_scan(&take(memory, at, 2)?, now),
            // Extended scanning is supported only if it is asked for.
            "le_set_ext_scan_enable" => UNKNOWN_COMMAND,
            "le_create_conn" => self.create_connection(at, now, memory)?,
            "le_create_conn_cancel" if self.air.cancel_connect(now) => {
                self.connection_failed();
                SUCCESS
            }
            "le_create_conn_cancel" => DISALLOWED,
            _ => return Err(What::UnknownCall { arguments }),
        })
    }

    /// Adds to the filter accept list, or clears it (7.8.15, 7.8.16).
    fn change_accepted(&mut self, added: Option<Address>) -> u8 {
        if self.air.connects() || (self.air.scans() && self.hci.scan.filters) {
            return DISALLOWED;
        }
        match added {
            None => self.hci.accepted.clear(),
            Some(_) if self.hci.accepted.len() >= ACCEPTED => return MEMORY_EXCEEDED,
            Some(address) => self.hci.accepted.push(address),
        }
        SUCCESS
    }

    fn set_scan_parameters(&mut self, bytes: &[u8]) -> u8 {
        let [interval, window] = halves(bytes, 1);
        let [kind, .., own, policy] = *bytes else {
            return INVALID;
        };
        if self.air.scans() {
            return DISALLOWED;
        }
        if kind > 1 || own > 1 || policy > 1 || scan_times(interval, window).is_none() {
            return INVALID;
        }
        self.hci.scan = ScanParameters {
            interval,
            window,
            filters: policy == 1,
            is_random: own == 1,
        };
        SUCCESS
    }

    fn enable_scan(&mut self, bytes: &[u8], now: u64) -> u8 {
        let ScanParameters {
            interval,
            window,
            is_random,
            ..
        } = self.hci.scan;
        match (bytes, scan_times(interval, window)) {
            ([0, _], _) => {
                self.air.stop_scan(now);
                SUCCESS
            }
            _ if is_random && self.hci.own.is_none() => INVALID,
            _ if self.air.connects() && !self.sdc.configuration.does_both => DISALLOWED,
            ([1, once @ 0..=1], Some(times)) => {
                self.air.stop_scan(now);
                self.hci.reported = (*once == 1).then(Vec::new);
                self.air.start_scan(now, times, false);
                SUCCESS
            }
            _ => INVALID,
        }
    }

    fn create_connection(&mut self, at: u32, now: u64, memory: &Memory) -> Result<u8, What> {
        let bytes = take(memory, at, 25)?;
        let [interval, window] = halves(&bytes, 0);
        let (uses_list, own) = (bytes[4] == 1, bytes[12]);
        let with = halves(&bytes, 13);
        let accepted = match uses_list {
            true => Some(self.hci.accepted.clone()),
            false => address(bytes[5], &bytes[6..]).map(|peer| vec![peer]),
        };
        let is_scanning = self.air.scans() && !self.sdc.configuration.does_both;
        if self.air.connects() || is_scanning {
            return Ok(DISALLOWED);
        }
        if self.air.is_linked() || self.sdc.configuration.centrals == 0 {
            return Ok(LIMITED_RESOURCES);
        }
        if own == 1 && self.hci.own.is_none() {
            return Ok(INVALID);
        }
        if self.sdc.configuration.centrals > 1 {
            return Err(wrong("with several links, which are not modelled"));
        }
        let is_allowed = scan_times(interval, window).is_some() && parameters_are_allowed(with);
        Ok(match accepted.filter(|_| is_allowed) {
            Some(accepted) => {
                self.air.connect(now, u64::MAX, with, accepted);
                SUCCESS
            }
            None => INVALID,
        })
    }
}
