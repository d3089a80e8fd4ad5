//! Scanning and connecting (`ble_gap.h`), as a central.

use shared::myo::Address;

use super::calls::answer;
use super::events::{self, HANDLE, Parameters, air_us};
use super::link::{Link, connection_parameters};
use super::{SoftDevice, refused};
use crate::memory::Memory;
use crate::refusal::What;
use crate::time::{ms, us};

/// Ticks from one advertisement of an armband to its next.
const ADVERTISING: u64 = ms(100);
/// Ticks from an advertisement to the first event of the connection.
const CONNECTING: u64 = ms(5);
/// Bytes that a scan's buffer has at least (`BLE_GAP_SCAN_BUFFER_MIN`).
const SCAN_BUFFER: u16 = 31;
/// Source of a time-out: scanning, connecting (`BLE_GAP_TIMEOUT_SRC_*`).
const SCAN: u8 = 1;
const CONNECT: u8 = 2;

/// A scan.
#[derive(Debug)]
pub struct Scan {
    buffer: u32,
    /// It waits until the program has read an advertisement.
    is_paused: bool,
    since: u64,
    times: ScanTimes,
    at: u64,
    until: u64,
    /// The armband whose advertisement comes next.
    turn: usize,
}

impl Scan {
    /// Ticks that the receiver was on by then.
    pub(super) fn receiver_on(&self, now: u64) -> u64 {
        let ScanTimes {
            interval, window, ..
        } = self.times;
        let (whole, part) = ((now - self.since) / interval, (now - self.since) % interval);
        whole * window + part.min(window)
    }

    /// Returns true if the receiver is on.
    fn hears(&self, now: u64) -> bool {
        (now - self.since) % self.times.interval < self.times.window
    }
}

/// Times of a scan in ticks: the receiver is on for a window in each interval.
#[derive(Clone, Copy, Debug)]
struct ScanTimes {
    interval: u64,
    window: u64,
    timeout: u64,
}

/// An attempt to connect.
#[derive(Debug)]
pub struct Attempt {
    at: u64,
    until: u64,
    parameters: Parameters,
}

impl SoftDevice {
    pub(super) fn set_whitelist(
        &mut self,
        addresses: u32,
        count: u8,
        memory: &Memory,
    ) -> Result<u32, What> {
        if self.attempt.is_some() || self.scan.is_some() {
            return Ok(answer::WHITELIST_IN_USE);
        }
        let mut whitelist = Vec::new();
        for number in 0..count.into() {
            let pointer = memory.word(addresses + 4 * number).unwrap_or_default();
            let address = memory
                .read(pointer, 7)
                .and_then(|bytes| bytes.try_into().ok());
            let Some(address) = address else {
                return Err(refused("with an address that is no memory"));
            };
            let [kind, .., last]: [u8; 7] = address;
            // The two highest bits of a random static address are ones.
            if kind >> 1 == 1 && last >> 6 != 3 {
                return Ok(answer::INVALID_BLE_ADDR);
            }
            whitelist.push(address);
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
            return Err(refused("with a buffer that is no memory"));
        };
        if length < SCAN_BUFFER || !memory.is_ram(data, length.into()) {
            return Ok(answer::INVALID_LENGTH);
        }
        if parameters == 0 {
            // It goes on after an advertisement.
            return Ok(match &mut self.scan {
                Some(scan) if scan.is_paused => {
                    scan.is_paused = false;
                    scan.at = scan.at.max(now);
                    scan.buffer = data;
                    answer::SUCCESS
                }
                _ => answer::INVALID_STATE,
            });
        }
        if self.scan.is_some() || self.attempt.is_some() {
            return Ok(answer::INVALID_STATE);
        }
        let Some(times) = scan_times(parameters, memory) else {
            return Ok(answer::INVALID_PARAM);
        };
        self.scan = Some(Scan {
            buffer: data,
            is_paused: false,
            since: now,
            times,
            at: now + ADVERTISING / 2,
            until: now.saturating_add(times.timeout),
            turn: 0,
        });
        Ok(answer::SUCCESS)
    }

    pub(super) fn stop_scan(&mut self, now: u64) -> u32 {
        match self.scan.take() {
            Some(scan) => {
                self.scanned += scan.receiver_on(now);
                answer::SUCCESS
            }
            None => answer::INVALID_STATE,
        }
    }

    /// Ticks that the receiver was on for scans, from the start on.
    pub fn scanned(&self, now: u64) -> u64 {
        let present = self.scan.as_ref().map_or(0, |scan| scan.receiver_on(now));
        self.scanned + present
    }

    /// Returns true while it scans, tries to connect, or has a link.
    pub const fn uses_the_air(&self) -> bool {
        self.scan.is_some() || self.attempt.is_some() || self.link.is_some()
    }

    pub(super) fn connect(
        &mut self,
        [scan, parameters, tag]: [u32; 3],
        now: u64,
        memory: &Memory,
    ) -> Result<u32, What> {
        if self.scan.is_some() || self.attempt.is_some() {
            return Ok(answer::INVALID_STATE);
        }
        if self.link.is_some() {
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
        self.attempt = Some(Attempt {
            at: now + ADVERTISING / 2,
            until: now.saturating_add(timeout),
            parameters,
        });
        Ok(answer::SUCCESS)
    }

    pub(super) fn cancel_connect(&mut self) -> u32 {
        match self.attempt.take() {
            Some(_) => answer::SUCCESS,
            None => answer::INVALID_STATE,
        }
    }

    pub(super) fn next_on_air(&self) -> Option<u64> {
        let scan = self.scan.as_ref().map(|scan| match scan.is_paused {
            true => scan.until,
            false => scan.at.min(scan.until),
        });
        let attempt = self.attempt.as_ref().map(|one| one.at.min(one.until));
        let link = self.link.as_ref().map(|link| link.at);
        [scan, attempt, link].into_iter().flatten().min()
    }

    pub(super) fn advance_on_air(&mut self, now: u64, memory: &Memory) {
        self.advance_scan(now, memory);
        self.advance_attempt(now);
        self.advance_link(now);
    }

    fn advance_scan(&mut self, now: u64, memory: &Memory) {
        let Some(scan) = &mut self.scan else {
            return;
        };
        if scan.until <= now {
            self.stop_scan(now);
            return self.push(events::timed_out(SCAN));
        }
        if scan.is_paused || scan.at > now {
            return;
        }
        let count = self.armbands.len().max(1);
        // Armbands share the time between two of their advertisements.
        scan.at = now + ADVERTISING / count as u64;
        scan.turn = (scan.turn + 1) % count;
        let heard = self.armbands.get(scan.turn).filter(|_| scan.hears(now));
        let heard = heard.and_then(|one| Some((one, one.advertisement(air_us(now))?)));
        if let Some((armband, data)) = heard {
            scan.is_paused = true;
            memory.write(scan.buffer, data);
            let (address, rssi) = (armband.address, armband.rssi);
            let event = events::advertised(address, rssi, scan.buffer, data.len() as u16);
            self.push(event);
        }
    }

    fn advance_attempt(&mut self, now: u64) {
        let Some(attempt) = &mut self.attempt else {
            return;
        };
        if attempt.until <= now {
            self.attempt = None;
            return self.push(events::timed_out(CONNECT));
        }
        if attempt.at > now {
            return;
        }
        attempt.at = now + ADVERTISING;
        let parameters = attempt.parameters;
        let (whitelist, us) = (&self.whitelist, air_us(now));
        let is_meant = |address: Address| whitelist.contains(&events::address(address));
        let found = self
            .armbands
            .iter()
            .position(|one| is_meant(one.address) && one.advertisement(us).is_some());
        let Some(armband) = found else {
            return;
        };
        self.attempt = None;
        let [_, interval, latency, timeout] = parameters;
        let parameters = [interval, interval, latency, timeout];
        let is_kept = self.armbands[armband].connected();
        self.link = Some(Link::new(armband, parameters, now + CONNECTING, is_kept));
        let address = self.armbands[armband].address;
        self.push(events::connected(HANDLE, address, parameters));
    }
}

/// The times of `ble_gap_scan_params_t`, if they are allowed.
fn scan_times(parameters: u32, memory: &Memory) -> Option<ScanTimes> {
    let interval = memory.half(parameters + 2)?;
    let window = memory.half(parameters + 4)?;
    let timeout = memory.half(parameters + 6)?;
    // At least 2.5 ms, in units of 0.625 ms.
    let is_allowed = interval >= 4 && window >= 4 && window <= interval;
    let timeout = match timeout {
        0 => u64::MAX,
        units => ms(10) * u64::from(units),
    };
    is_allowed.then_some(ScanTimes {
        interval: us(625) * u64::from(interval),
        window: us(625) * u64::from(window),
        timeout,
    })
}
