//! Commands of the host (Bluetooth Core Specification, volume 4, part E, 7). Each is a function of the library's, which
//! answers with the status; no event follows that says so. One that would fail by a mistake of the host's is refused.

use shared::myo::{Address, AddressKind};

use super::hci::HANDLE;
use super::memory::ACCEPTED;
use super::{Controller, give, needs, take, wrong};
use crate::air::{ScanTimes, parameters_are_allowed};
use crate::chip::Chip;
use crate::memory::halves;
use crate::refusal::What;

/// Statuses of commands that a link or an attempt to connect may overtake (volume 1, part F, 1.3).
const SUCCESS: u8 = 0x00;
pub(super) const UNKNOWN_CONNECTION: u8 = 0x02;
const DISALLOWED: u8 = 0x0c;
/// Reasons of the host's for the end of a connection (7.1.6).
const REASONS: [u8; 7] = [0x05, 0x13, 0x14, 0x15, 0x1a, 0x29, 0x3b];

#[derive(Clone, Copy, Debug)]
pub struct ScanParameters {
    interval: u16,
    window: u16,
    is_random: bool,
}

impl Default for ScanParameters {
    fn default() -> Self {
        Self {
            interval: 16,
            window: 16,
            is_random: false,
        }
    }
}

/// Interval and window in units of 0.625 ms.
fn scan_times(interval: u16, window: u16) -> Result<ScanTimes, What> {
    let times = ScanTimes::of_units(interval, window).filter(|_| interval <= 0x4000);
    times.ok_or_else(|| wrong("with times that no scan can have"))
}

/// An address, from its kind on.
fn address(bytes: &[u8]) -> Result<Address, What> {
    let kind = match bytes[0] {
        0 => AddressKind::Public,
        1 => AddressKind::Random,
        _ => return Err(wrong("with an address of a kind that is not modelled")),
    };
    let bytes = *bytes[1..]
        .first_chunk()
        .ok_or_else(|| wrong("with half an address"))?;
    Ok(Address { kind, bytes })
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
        match name {
            "cb_reset" => {
                self.air.reset(now);
                self.hci = Default::default();
            }
            "cb_set_event_mask" => self.hci.mask = mask()?,
            "le_set_event_mask" => self.hci.le_mask = mask()?,
            // Nothing that it asks for is modelled: the second page of events, and flow control towards the host.
            "cb_set_event_mask_page_2" | "cb_host_buffer_size" => {}
            "le_read_filter_accept_list_size" => give(memory, at, &[ACCEPTED as u8])?,
            "le_read_buffer_size" => {
                let configuration = &self.sdc.configuration;
                let [a, b] = configuration.packet_bytes[0].to_le_bytes();
                give(memory, at, &[a, b, configuration.packets[0]])?;
            }
            // It has no public address unless it is given one.
            "ip_read_bd_addr" => give(memory, at, &[0; 6])?,
            "le_set_random_address" => {
                let is_used = self.air.scans() || self.air.connects();
                needs(!is_used, "while the address is in use")?;
                self.hci.own = take(memory, at, 6)?.first_chunk().copied();
            }
            "lc_disconnect" => {
                let bytes = take(memory, at, 3)?;
                let is_allowed = halves(&bytes, 0) == [HANDLE] && REASONS.contains(&bytes[2]);
                needs(
                    is_allowed,
                    "of another link, or with a reason that the specification does not allow",
                )?;
                if !self.air.is_linked() {
                    return Ok(UNKNOWN_CONNECTION);
                }
                if self.hci.is_ending {
                    return Ok(DISALLOWED);
                }
                // One that is being lost ends with its time-out.
                self.air.disconnect(now);
                self.hci.is_ending = true;
            }
            "le_set_scan_params" => self.set_scan_parameters(&take(memory, at, 7)?)?,
            "le_set_scan_enable" => self.enable_scan(&take(memory, at, 2)?, now)?,
            "le_create_conn" => self.create_connection(&take(memory, at, 25)?, now)?,
            "le_create_conn_cancel" if self.air.cancel_connect(now) => self.connection_failed(),
            "le_create_conn_cancel" => return Ok(DISALLOWED),
            _ => return Err(What::UnknownCall { arguments }),
        }
        Ok(SUCCESS)
    }

    fn set_scan_parameters(&mut self, bytes: &[u8]) -> Result<(), What> {
        let [interval, window] = halves(bytes, 1);
        let (kind, own, policy) = (bytes[0], bytes[5], bytes[6]);
        needs(!self.air.scans(), "while it scans")?;
        let is_allowed = kind <= 1 && own <= 1 && policy == 0;
        needs(is_allowed, "with parameters that are not modelled")?;
        scan_times(interval, window)?;
        self.hci.scan = ScanParameters {
            interval,
            window,
            is_random: own == 1,
        };
        Ok(())
    }

    fn enable_scan(&mut self, bytes: &[u8], now: u64) -> Result<(), What> {
        let scan = self.hci.scan;
        self.air.stop_scan(now);
        if bytes[0] == 0 {
            return Ok(());
        }
        needs(
            bytes[0] == 1 && bytes[1] <= 1,
            "with parameters that are not modelled",
        )?;
        let has_address = !scan.is_random || self.hci.own.is_some();
        needs(has_address, "before the address is set that it uses")?;
        let is_free = !self.air.connects() || self.sdc.configuration.does_both;
        needs(is_free, "beside an attempt to connect")?;
        self.hci.reported = (bytes[1] == 1).then(Vec::new);
        let times = scan_times(scan.interval, scan.window)?;
        self.air.start_scan(now, times, false);
        Ok(())
    }

    fn create_connection(&mut self, bytes: &[u8], now: u64) -> Result<(), What> {
        let [interval, window] = halves(bytes, 0);
        let (uses_list, own) = (bytes[4] != 0, bytes[12]);
        let with = halves(bytes, 13);
        needs(
            !uses_list,
            "with the filter accept list, which is not modelled",
        )?;
        let accepted = vec![address(&bytes[5..])?];
        let is_scanning = self.air.scans() && !self.sdc.configuration.does_both;
        let is_free = !self.air.connects() && !is_scanning && !self.air.is_linked();
        needs(is_free, "beside a scan, an attempt to connect, or a link")?;
        let has_one_link = self.sdc.configuration.centrals == 1;
        needs(
            has_one_link,
            "with no link or several, which are not modelled",
        )?;
        let has_address = own == 0 || self.hci.own.is_some();
        needs(has_address, "before the address is set that it uses")?;
        scan_times(interval, window)?;
        let is_allowed = parameters_are_allowed(with);
        needs(is_allowed, "with parameters that no connection can have")?;
        self.air.connect(now, u64::MAX, with, accepted);
        Ok(())
    }
}
