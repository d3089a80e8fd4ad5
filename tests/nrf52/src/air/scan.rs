//! Scanning, and connecting to what a scan hears, as a central.

use shared::myo::Address;

use super::link::{AirLink, Parameters};
use super::{Air, AirEvent, air_us};
use crate::time::{ms, us};

/// Ticks from one advertisement of an armband to its next.
const ADVERTISING: u64 = ms(100);
/// Ticks from an advertisement to the first event of the connection.
const CONNECTING: u64 = ms(5);

/// Times of a scan in ticks: the receiver is on for a window in each interval.
#[derive(Clone, Copy, Debug)]
pub struct ScanTimes {
    /// Ticks from the start of one window to the next.
    pub interval: u64,
    /// Ticks that the receiver is on.
    pub window: u64,
    /// Ticks after which it ends by itself.
    pub timeout: u64,
}

impl ScanTimes {
    /// Converts interval and window from units of 0.625 ms, if they are allowed: 2.5 ms at least. Nothing ends the scan.
    pub fn of_units(interval: u16, window: u16) -> Option<Self> {
        (4..=interval).contains(&window).then_some(Self {
            interval: us(625) * u64::from(interval),
            window: us(625) * u64::from(window),
            timeout: u64::MAX,
        })
    }
}

#[derive(Debug)]
pub(super) struct Scan {
    /// True if it waits after each advertisement until it is told to go on.
    pauses: bool,
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
    fn receiver_on(&self, now: u64) -> u64 {
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

    pub(super) fn next(&self) -> u64 {
        match self.is_paused {
            true => self.until,
            false => self.at.min(self.until),
        }
    }
}

/// An attempt to connect.
#[derive(Debug)]
pub(super) struct Attempt {
    at: u64,
    until: u64,
    /// Armbands that are meant.
    accepted: Vec<Address>,
    parameters: Parameters,
}

impl Attempt {
    pub(super) fn next(&self) -> u64 {
        self.at.min(self.until)
    }
}

impl Air {
    /// Starts a scan. One that `pauses` waits after each advertisement for [`Self::resume_scan`].
    pub fn start_scan(&mut self, now: u64, times: ScanTimes, pauses: bool) {
        self.scan = Some(Scan {
            pauses,
            is_paused: false,
            since: now,
            times,
            at: now + ADVERTISING / 2,
            until: now.saturating_add(times.timeout),
            turn: 0,
        });
    }

    /// Continues a scan that waits; false if no scan waits.
    pub fn resume_scan(&mut self, now: u64) -> bool {
        let Some(scan) = self.scan.as_mut().filter(|scan| scan.is_paused) else {
            return false;
        };
        scan.is_paused = false;
        scan.at = scan.at.max(now);
        true
    }

    pub fn stop_scan(&mut self, now: u64) -> bool {
        let scan = self.scan.take();
        self.scanned += scan.as_ref().map_or(0, |scan| scan.receiver_on(now));
        scan.is_some()
    }

    /// Ticks that the receiver was on for scans, from the start on.
    pub fn scanned(&self, now: u64) -> u64 {
        let present = self.scan.as_ref().map_or(0, |scan| scan.receiver_on(now));
        self.scanned + present
    }

    /// Tries to connect to one of these armbands.
    pub fn connect(
        &mut self,
        now: u64,
        timeout: u64,
        parameters: Parameters,
        accepted: Vec<Address>,
    ) {
        self.attempt = Some(Attempt {
            at: now + ADVERTISING / 2,
            until: now.saturating_add(timeout),
            accepted,
            parameters,
        });
    }

    /// Ends the attempt to connect; false without an attempt, or if the connection is there first.
    pub fn cancel_connect(&mut self, now: u64) -> bool {
        if let Some(attempt) = self.attempt.as_mut().filter(|_| self.cancel_comes_late) {
            attempt.at = now;
            self.advance_attempt(now);
        }
        self.attempt.take().is_some()
    }

    pub(super) fn advance_scan(&mut self, now: u64) {
        let Some(scan) = &mut self.scan else {
            return;
        };
        if scan.until <= now {
            self.stop_scan(now);
            return self.events.push_back(AirEvent::ScanTimedOut);
        }
        if scan.is_paused || scan.at > now {
            return;
        }
        let count = self.armbands.len().max(1);
        // Armbands share the time between two of their advertisements.
        scan.at = now + ADVERTISING / count as u64;
        scan.turn = (scan.turn + 1) % count;
        let heard = self.armbands.get(scan.turn).filter(|_| scan.hears(now));
        if heard.is_some_and(|one| one.advertisement(air_us(now)).is_some()) {
            scan.is_paused = scan.pauses;
            self.events.push_back(AirEvent::Advertised(scan.turn));
        }
    }

    pub(super) fn advance_attempt(&mut self, now: u64) {
        let Some(attempt) = &mut self.attempt else {
            return;
        };
        if attempt.until <= now {
            self.attempt = None;
            return self.events.push_back(AirEvent::AttemptTimedOut);
        }
        if attempt.at > now {
            return;
        }
        attempt.at = now + ADVERTISING;
        let [_, interval, latency, timeout] = attempt.parameters;
        let found = self.armbands.iter().position(|one| {
            attempt.accepted.contains(&one.address) && one.advertisement(air_us(now)).is_some()
        });
        let Some(armband) = found else {
            return;
        };
        self.attempt = None;
        let parameters = [interval, interval, latency, timeout];
        let is_kept = self.armbands[armband].connected();
        self.link = Some(AirLink::new(armband, parameters, now + CONNECTING, is_kept));
        self.events
            .push_back(AirEvent::Connected(armband, parameters));
    }
}
